"""The judge: what additions say and count, bounds, and scenes after the first one."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from distorted import Distorted, negated, with_diagnostics
from made_up import make_comparison

from proxgen.compare import Judge, State, compare_controllers_on, random_states
from proxgen.config import load
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array, Measurement
from proxgen.controllers.reference import ReferenceController
from proxgen.model import RobotModel, build_model

SEED = 41
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def test_self_distances_are_compared(tmp_path: Path) -> None:
    path = tmp_path / "own.yaml"
    points = "points: [{name: post, frame: base, position: [0.3, 0.2, 0.1]}]"
    path.write_text(
        f"extends: {EXAMPLES}/planar2/planar2.yaml\navoidance: {{self_collision: {{{points}}}}}\n"
    )
    config = load(path)
    model = build_model(config)
    wrong = Distorted(ReferenceController(config, model), negated("self_distance"))
    states = random_states(config, model, 10, seed=SEED, faults=0.0)
    result = compare_controllers_on(config, states, wrong, ReferenceController(config, model))
    assert result.scenes[0].findings >= 10
    assert all("self_distance[" in sentence for sentence in result.scenes[0].sentences)


def test_tangents_are_compared(planar2_config: Config, planar2_model: RobotModel) -> None:
    """As if both had circulation: equal, unequal, and known to one side only."""
    reference = ReferenceController(planar2_config, planar2_model)
    state = next(random_states(planar2_config, planar2_model, 1, seed=SEED, faults=0.0))
    command, judge = reference.step(*vars_of(state)), Judge(planar2_config, reference)
    one, other, unknown = (np.array([0.0, value, 0.5]) for value in (1.0, 1.0 + 2e-10, np.nan))
    sides = [with_diagnostics(command, tangent=value) for value in (one, other, unknown)]
    assert judge.judge(sides[0], sides[0]).findings == ()
    for wrong in sides[1:]:
        for pair in ((sides[0], wrong), (wrong, sides[0])):
            (sentence,) = judge.judge(*pair).findings
            assert sentence.startswith("tangent[1] is ")


@pytest.mark.parametrize("name", ["self_readings", "memory_points", "circulating"])
def test_what_additions_count_is_compared(
    planar2_config: Config, planar2_model: RobotModel, name: str
) -> None:
    reference = ReferenceController(planar2_config, planar2_model)
    state = next(random_states(planar2_config, planar2_model, 1, seed=SEED, faults=0.0))
    command, judge = reference.step(*vars_of(state)), Judge(planar2_config, reference)
    counted = with_diagnostics(command, **{name: 1})
    assert judge.judge(counted, counted).findings == ()
    assert judge.judge(counted, command).findings == (f"{name} is 1, in the reference 0",)
    assert judge.judge(command, counted).findings == (f"{name} is 0, in the reference 1",)


def test_a_velocity_outside_its_bounds_is_found_on_either_side(
    planar2_config: Config, planar2_model: RobotModel
) -> None:
    """Also where both say the same, and in a fault."""
    reference = ReferenceController(planar2_config, planar2_model)
    judge = Judge(planar2_config, reference)
    for faults in (0.0, 1.0):
        state = next(random_states(planar2_config, planar2_model, 1, seed=SEED, faults=faults))
        command = reference.step(*vars_of(state))
        lb, ub = command.diagnostics.lb, command.diagnostics.ub
        for qdot in (ub + np.array([0.0, 1e-6]), lb - np.array([1e-6, 0.0])):
            outside = replace(command, qdot=qdot)
            judgement = judge.judge(outside, outside)
            assert judgement.errors["bound_penetration"] == pytest.approx(1e-6, rel=1e-6)
            assert any(words.startswith("qdot outside its bounds") for words in judgement.findings)
        inside = replace(command, qdot=ub)
        assert judge.judge(inside, inside).errors["bound_penetration"] == 0.0


def vars_of(state: State) -> tuple[Array, Array, Measurement]:
    """What a controller is given in a state."""
    return state.q, state.xdot, state.measurement


def test_a_later_scene_counts_as_well() -> None:
    assert make_comparison().verdict == "pass"
    assert make_comparison(qdot_error=1e-3).verdict == "fail"


def test_the_greatest_error_is_that_of_the_worst_cycle() -> None:
    """Cycles that have nothing to compare do not count."""
    scene = make_comparison().scenes[0]
    mixed = replace(scene, errors=scene.errors | {"qdot": np.array([1e-12, np.nan, 4e-9, 0.0])})
    assert mixed.greatest("qdot") == 4e-9
    assert mixed.to_json()["max_abs_qdot_error"] == 4e-9
    assert mixed.greatest("slack") == 0.0
