"""The judge: equal controllers agree, and every deliberate error is found, on whichever side it is."""

import json

import numpy as np
import pytest
from distorted import (
    Change,
    Distorted,
    FollowingDistorted,
    WrongSign,
    diagnostics_of_another_arm,
    moved,
    negated,
    with_diagnostics,
    with_qdot,
    with_status,
)

from proxgen.compare import Comparison, Judge, Tolerances, compare_controllers_on, random_states
from proxgen.compare.comparison import MAX_SENTENCES
from proxgen.compare.judge import QUANTITIES
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Controller, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.errors import CompareError
from proxgen.model import RobotModel

SEED = 41


def judged(
    config: Config, model: RobotModel, candidate: Controller, reference: Controller, count: int = 80
) -> Comparison:
    """Both on the same random states."""
    return compare_controllers_on(
        config, random_states(config, model, count, seed=SEED), candidate, reference
    )


def fresh(config: Config, model: RobotModel) -> ReferenceController:
    """A new reference."""
    return ReferenceController(config, model)


def test_equal_controllers_agree_exactly(any_config: Config, any_model: RobotModel) -> None:
    result = judged(any_config, any_model, fresh(any_config, any_model), fresh(any_config, any_model))
    scene = result.scenes[0]
    assert result.verdict == "pass"
    assert result.failures == ()
    assert scene.status_mismatches == 0 and not scene.row_mismatches.any()
    for quantity in ("qdot", "slack", "H", "g", "A", "ubA", "lb", "ub", "distance", "bound_penetration"):
        assert scene.greatest(quantity) == 0.0
    assert scene.greatest("kkt_residual") < 1e-10
    assert {Status.SOLVED} < {Status(number) for number in scene.status.tolist()}


WRONG: dict[str, tuple[Change, str]] = {
    "one row of A": (negated("A", 1), "A[1"),
    "the active row": (negated("A", 3), "A[3"),
    "right-hand sides": (negated("ubA"), "ubA["),
    "one row of H": (negated("H", 0), "H[0"),
    "g": (negated("g"), "g["),
    "lower bounds": (negated("lb", 2), "lb[2"),
    "upper bounds": (negated("ub", 6), "ub[6"),
    "velocity": (with_qdot(factor=-1.0), "qdot["),
    "distance": (moved("distance", 1e-6), "distance[0]"),
    "nearest points": (negated("nearest_point"), "nearest_point["),
    "speed of the law": (negated("approach_speed"), "approach_speed["),
    "manipulability": (moved("manipulability", 1e-6), "manipulability[0]"),
    "damping": (moved("damping", 1e-6), "damping[0]"),
    "rows on": (
        lambda c: with_diagnostics(c, row_on=~c.diagnostics.row_on),
        "row 0 is o",
    ),
    "slack": (moved("slack", 1e-6), "slack[0]"),
    "status": (with_status(Status.REDUCED_ACTIVE), "in the reference"),
    "no velocity": (with_qdot(offset=np.nan), "qdot["),
    "no matrix": (moved("H", np.nan), "H[0, 0] is"),
}


@pytest.mark.parametrize("name", WRONG)
@pytest.mark.parametrize("side", ["candidate", "reference"])
def test_a_wrong_sign_on_either_side_fails(
    iiwa7_config: Config, iiwa7_model: RobotModel, name: str, side: str
) -> None:
    change, words = WRONG[name]
    right = fresh(iiwa7_config, iiwa7_model)
    if side == "candidate":
        result = judged(iiwa7_config, iiwa7_model, Distorted(fresh(iiwa7_config, iiwa7_model), change), right)
    else:
        wrong = FollowingDistorted(fresh(iiwa7_config, iiwa7_model), change)
        result = judged(iiwa7_config, iiwa7_model, right, wrong)
    assert result.verdict == "fail"
    assert any(words in sentence for sentence in result.failures), result.failures[:3]


@pytest.mark.parametrize("side", ["candidate", "reference"])
def test_a_wrong_sign_inside_either_controller_fails(
    iiwa7_config: Config, iiwa7_model: RobotModel, side: str
) -> None:
    """The whole controller follows from the wrong row, so its own certificate is perfect."""
    pair = [fresh(iiwa7_config, iiwa7_model), WrongSign(iiwa7_config, iiwa7_model, 2)]
    candidate, reference = pair[::-1] if side == "candidate" else pair
    result = judged(iiwa7_config, iiwa7_model, candidate, reference)
    scene = result.scenes[0]
    assert result.verdict == "fail"
    assert scene.greatest("A") > 0.1
    assert scene.greatest("qdot") > 1e-3
    assert scene.greatest("kkt_residual") > 1e-3
    assert scene.greatest("H") == 0.0


@pytest.mark.parametrize(
    ("change", "verdict"),
    [
        (moved("H", 0.9e-10), "pass"),
        (moved("H", 1.2e-10), "fail"),
        (moved("A", 1.2e-10), "fail"),
        (moved("lb", 1.2e-10), "fail"),
        (with_qdot(offset=0.0), "pass"),
        (with_qdot(offset=3e-8), "fail"),
    ],
)
def test_tolerances_are_held(
    planar2_config: Config, planar2_model: RobotModel, change: Change, verdict: str
) -> None:
    candidate = Distorted(fresh(planar2_config, planar2_model), change)
    assert (
        judged(planar2_config, planar2_model, candidate, fresh(planar2_config, planar2_model)).verdict
        == verdict
    )


def test_every_quantity_has_the_tolerance_that_is_promised() -> None:
    """1e-8 rad/s and 1e-10 of all that a QP is made of, to be found in the sentence that a finding makes."""
    velocities, certificates = {"qdot", "slack"}, {"kkt_residual", "bound_penetration"}
    matrices = {
        "H", "g", "A", "ubA", "lb", "ub", "distance", "self_distance", "tangent", "nearest_point",
        "approach_speed", "manipulability", "damping",
    }  # fmt: skip
    found = {name: Tolerances().of(name) for name in QUANTITIES}
    assert found == dict.fromkeys(velocities | certificates, 1e-8) | dict.fromkeys(matrices, 1e-10)
    apart = Tolerances(qdot=1.0, matrices=2.0, kkt=3.0)
    found = {name: apart.of(name) for name in QUANTITIES}
    assert found == (
        dict.fromkeys(velocities, 1.0) | dict.fromkeys(matrices, 2.0) | dict.fromkeys(certificates, 3.0)
    )


def test_the_velocity_is_held_to_its_own_tolerance(planar2_config: Config, planar2_model: RobotModel) -> None:
    """Not only by its residual: an answer that is 2e-8 rad/s off is named."""
    candidate = Distorted(fresh(planar2_config, planar2_model), with_qdot(offset=2e-8))
    loose = Tolerances(kkt=1.0)
    states = random_states(planar2_config, planar2_model, 20, seed=SEED)
    reference = fresh(planar2_config, planar2_model)
    result = compare_controllers_on(planar2_config, states, candidate, reference, tolerances=loose)
    assert result.failures and all("qdot[" in sentence for sentence in result.failures)


def test_bounds_are_compared_after_a_fault_too(planar2_config: Config, planar2_model: RobotModel) -> None:
    states = list(random_states(planar2_config, planar2_model, 100, seed=SEED, faults=1.0))
    for name in ("lb", "ub"):
        candidate = Distorted(fresh(planar2_config, planar2_model), moved(name, 1e-6))
        reference = fresh(planar2_config, planar2_model)
        result = compare_controllers_on(planar2_config, states, candidate, reference)
        assert result.scenes[0].findings >= 100
        assert all(f"{name}[0]" in sentence for sentence in result.scenes[0].sentences)


def test_other_tolerances_can_be_asked_for(planar2_config: Config, planar2_model: RobotModel) -> None:
    candidate = Distorted(fresh(planar2_config, planar2_model), moved("H", 1e-6))
    states = random_states(planar2_config, planar2_model, 20, seed=SEED)
    loose = Tolerances(matrices=1e-5)
    reference = fresh(planar2_config, planar2_model)
    result = compare_controllers_on(planar2_config, states, candidate, reference, tolerances=loose)
    assert result.verdict == "pass"
    assert result.tolerances is loose


def test_the_residual_is_not_taken_from_the_candidate(
    planar2_config: Config, planar2_model: RobotModel
) -> None:
    """A velocity that is 0.01 rad/s off within its bounds, and a certificate that says 0."""

    def lie(command):  # type: ignore[no-untyped-def]
        found = command.diagnostics
        near = np.where(command.qdot < 0.5 * (found.lb + found.ub), 0.01, -0.01)
        return with_diagnostics(with_qdot(offset=near)(command), kkt_residual=0.0)

    result = judged(
        planar2_config,
        planar2_model,
        Distorted(fresh(planar2_config, planar2_model), lie),
        fresh(planar2_config, planar2_model),
    )
    assert result.scenes[0].greatest("kkt_residual") > 1e-6
    assert any("the controller itself says 0" in sentence for sentence in result.failures)


def test_residual_of_a_stage_that_has_no_solution(planar2_config: Config, planar2_model: RobotModel) -> None:
    """A candidate that claims stage 0 where the reference has proven it infeasible."""
    reference = fresh(planar2_config, planar2_model)
    judge, found = Judge(planar2_config, reference), 0
    for state in random_states(planar2_config, planar2_model, 200, seed=SEED, faults=0.0):
        command = reference.step(state.q, state.xdot, state.measurement)
        if command.status is Status.REDUCED_REPULSION:
            judgement = judge.judge(with_status(Status.SOLVED)(command), command)
            assert judgement.errors["kkt_residual"] == np.inf
            assert "status SOLVED, in the reference REDUCED_REPULSION (at SOLVED" in judgement.findings[0]
            found += 1
    assert found > 20


def test_a_single_wrong_cycle_is_found_in_that_cycle_only(
    iiwa7_config: Config, iiwa7_model: RobotModel
) -> None:
    """The reference follows what was commanded, so the next cycle begins from the same velocity."""
    candidate = Distorted(fresh(iiwa7_config, iiwa7_model), with_qdot(factor=0.5), only=60)
    states = list(random_states(iiwa7_config, iiwa7_model, 100, seed=SEED, faults=0.0))
    result = compare_controllers_on(iiwa7_config, states, candidate, fresh(iiwa7_config, iiwa7_model))
    errors = result.scenes[0].errors["qdot"]
    assert np.flatnonzero(errors > 0.0).tolist() == [60]
    assert all("cycle 60:" in sentence for sentence in result.failures)


def test_faults_are_compared_too(planar2_config: Config, planar2_model: RobotModel) -> None:
    """All faults are among the states, and a wrong safe stop is noticed."""
    states = list(random_states(planar2_config, planar2_model, 300, seed=SEED, faults=0.9))
    right = fresh(planar2_config, planar2_model)
    result = compare_controllers_on(planar2_config, states, fresh(planar2_config, planar2_model), right)
    seen = {Status(number) for number in result.scenes[0].status.tolist()}
    assert result.verdict == "pass"
    assert {status for status in Status if status.fault} - {Status.FAULT_DEADLINE} <= seen
    wrong = Distorted(
        fresh(planar2_config, planar2_model),
        lambda command: with_qdot(offset=1e-6)(command) if command.status.fault else command,
    )
    assert compare_controllers_on(planar2_config, states, wrong, right).verdict == "fail"


def test_json_has_exactly_the_agreed_keys(planar2_config: Config, planar2_model: RobotModel) -> None:
    """Numbers only, also where something is not a number."""
    candidate = Distorted(fresh(planar2_config, planar2_model), with_qdot(offset=np.nan))
    document = judged(
        planar2_config, planar2_model, candidate, fresh(planar2_config, planar2_model), 20
    ).to_json()
    assert list(document) == ["scenes", "verdict"]
    assert document["verdict"] == "fail"
    assert list(document["scenes"][0]) == [
        "scene",
        "cycles",
        "max_abs_qdot_error",
        "max_abs_H_error",
        "max_abs_A_error",
        "max_kkt_residual",
        "status_mismatches",
    ]
    again = json.loads(json.dumps(document, allow_nan=False))
    assert again["scenes"][0]["cycles"] == 20
    assert again["scenes"][0]["max_abs_qdot_error"] >= 1e300


def test_sentences_name_scene_cycle_quantity_and_both_values(
    planar2_config: Config, planar2_model: RobotModel
) -> None:
    candidate = Distorted(fresh(planar2_config, planar2_model), moved("g", 0.5), only=3)
    states = random_states(planar2_config, planar2_model, 10, seed=SEED, faults=0.0)
    reference = fresh(planar2_config, planar2_model)
    result = compare_controllers_on(planar2_config, states, candidate, reference, name="table")
    (sentence,) = result.failures
    assert sentence.startswith("table, cycle 3: g[0] is ")
    assert sentence.endswith(": error 0.5, tolerance 1e-10")
    values = [
        float(word.strip(",:")) for word in sentence.split() if "." in word and word[0] in "-0123456789"
    ]
    assert values[0] - values[1] == pytest.approx(0.5)


def test_sentences_are_limited_and_the_rest_is_counted(
    planar2_config: Config, planar2_model: RobotModel
) -> None:
    candidate = Distorted(fresh(planar2_config, planar2_model), moved("g", 0.5))
    states = random_states(planar2_config, planar2_model, 100, seed=SEED, faults=0.0)
    result = compare_controllers_on(planar2_config, states, candidate, fresh(planar2_config, planar2_model))
    assert len(result.failures) == MAX_SENTENCES + 1
    assert result.failures[-1] == f"states: {100 - MAX_SENTENCES} more findings"


def test_no_cycle_is_no_agreement(planar2_config: Config, planar2_model: RobotModel) -> None:
    pair = fresh(planar2_config, planar2_model), fresh(planar2_config, planar2_model)
    result = compare_controllers_on(planar2_config, [], *pair)
    assert result.verdict == "fail"
    assert result.failures == ("no cycle was compared",)
    assert result.scenes[0].to_json()["max_abs_H_error"] == 0.0


def test_controllers_of_different_arms_are_refused(planar2_config: Config, planar2_model: RobotModel) -> None:
    candidate = Distorted(
        fresh(planar2_config, planar2_model),
        lambda c: with_diagnostics(c, H=diagnostics_of_another_arm(c.diagnostics).H),
    )
    with pytest.raises(CompareError, match=r"diagnostics\.H is \(1, 1\), in the reference \(2, 2\)"):
        judged(planar2_config, planar2_model, candidate, fresh(planar2_config, planar2_model))


def test_a_reference_that_cannot_follow_runs_by_itself(
    planar2_config: Config, planar2_model: RobotModel
) -> None:
    """Any two controllers will do; then agreement is that of whole trajectories."""
    reference = Distorted(fresh(planar2_config, planar2_model), lambda command: command)
    assert (
        judged(planar2_config, planar2_model, fresh(planar2_config, planar2_model), reference).verdict
        == "pass"
    )


@pytest.mark.parametrize(
    ("excess", "later", "allowed"),
    [
        (1e-9, Status.REDUCED_REPULSION, True),
        (9e-9, Status.REDUCED_REPULSION, True),
        (2e-8, Status.REDUCED_REPULSION, False),  # infeasible: one should not have been solved
        (0.0, Status.REDUCED_REPULSION, False),  # feasible: the other should have been solved
        (1e-9, Status.REDUCED_CRITICAL, False),  # with rows raised it is feasible
        (1e-9, Status.STOPPED_INFEASIBLE, False),
        (1e-9, Status.STOPPED_SOLVER, False),
    ],
)
@pytest.mark.parametrize("swapped", [False, True])
def test_both_verdicts_about_a_tie_are_right(
    iiwa7_config: Config,
    iiwa7_model: RobotModel,
    excess: float,
    later: Status,
    allowed: bool,
    swapped: bool,
) -> None:
    """Two critical rows, q̇_0 ≤ -0.1 - 2 excess and -q̇_0 ≤ 0.1: the worse is exceeded by `excess` at best."""
    reference = fresh(iiwa7_config, iiwa7_model)
    state = next(random_states(iiwa7_config, iiwa7_model, 1, seed=SEED, faults=0.0))
    command = with_qdot(factor=0.0)(reference.step(state.q, state.xdot, state.measurement))
    A = np.zeros_like(command.diagnostics.A)
    A[:2, 0] = 1.0, -1.0
    command = with_diagnostics(
        command,
        A=A,
        ubA=np.array([-0.1 - 2.0 * excess, 0.1, 1e20, 1e20]),
        row_on=np.array([True, True, False, False]),
        distance=np.array([0.01, 0.01, np.inf]),
        lb=np.full(7, -1.0),
        ub=np.full(7, 1.0),
    )
    pair = [with_status(Status.SOLVED)(command), with_status(later)(command)]
    candidate, other = pair[::-1] if swapped else pair
    findings = Judge(iiwa7_config, reference).judge(candidate, other).findings
    assert any("status" in words for words in findings) is not allowed
    assert not allowed or findings == ()
