"""Random states: the same for a seed, of every kind, for any arm."""

import numpy as np
import pytest

from proxgen.compare import random_states
from proxgen.compare.states import UNLIMITED
from proxgen.config.schema import Config
from proxgen.config.variants import override
from proxgen.controllers.protocol import Status
from proxgen.controllers.reference import ReferenceController
from proxgen.model import RobotModel, build_model


def test_a_seed_gives_the_same_states(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    once, again, other = (list(random_states(iiwa7_config, iiwa7_model, 20, seed=s)) for s in (1, 1, 2))
    for a, b in zip(once, again, strict=True):
        np.testing.assert_array_equal(a.q, b.q)
        np.testing.assert_array_equal(a.xdot, b.xdot)
        np.testing.assert_array_equal(a.measurement.points, b.measurement.points)
        np.testing.assert_array_equal(a.measurement.tof_range, b.measurement.tof_range)
    assert any((a.q != c.q).any() for a, c in zip(once, other, strict=True))


def test_states_fit_the_arm(any_config: Config, any_model: RobotModel) -> None:
    tolerance = any_config.limits.tolerance
    for state in random_states(any_config, any_model, 100, seed=3, faults=0.0):
        measurement = state.measurement
        assert state.q.shape == (any_model.n,) and state.xdot.shape == (any_model.m,)
        assert measurement.tof_range.shape == (len(any_model.tof_modules),)
        assert measurement.capacitive.shape == (len(any_model.capacitive_modules),)
        assert measurement.points.shape[1:] == (3,)
        limited = any_model.q_upper <= UNLIMITED
        assert (state.q <= any_model.q_upper + tolerance)[limited].all()
        assert (state.q >= any_model.q_lower - tolerance)[limited].all()


@pytest.mark.parametrize("without", ["tof", "capacitive", "both"])
def test_states_of_a_skin_without_some_sensors(without: str, planar2_config: Config) -> None:
    gone: dict[str, object] = {"skin.cuffs": []} if without == "both" else {f"skin.{without}": None}
    additions = {  # each where some sensor gives it something
        "skin.self_measurement.enabled": without != "both",
        "skin.memory.enabled": without == "capacitive",
    }
    config = override(planar2_config, gone | additions)
    model = build_model(config)
    controller = ReferenceController(config, model)
    for state in random_states(config, model, 50, seed=6, faults=0.0):
        assert state.measurement.capacitive.shape == (len(model.capacitive_modules),)
        assert not controller.step(state.q, state.xdot, state.measurement).status.fault


def test_no_fault_is_met_unless_asked_for(any_config: Config, any_model: RobotModel) -> None:
    controller = ReferenceController(any_config, any_model)
    for state in random_states(any_config, any_model, 100, seed=4, faults=0.0):
        assert not controller.step(state.q, state.xdot, state.measurement).status.fault


def test_calm_and_crowded_states_are_both_there(any_config: Config, any_model: RobotModel) -> None:
    controller = ReferenceController(any_config, any_model)
    rows, decided = [], set()
    for state in random_states(any_config, any_model, 200, seed=5, faults=0.0):
        command = controller.step(state.q, state.xdot, state.measurement)
        rows.append(int(command.diagnostics.row_on.sum()))
        decided.add(command.status)
    assert min(rows) == 0
    assert max(rows) >= len(any_model.capsules) - 1
    if any_config.relaxation.mode == "staged":
        assert {Status.SOLVED, Status.REDUCED_REPULSION} <= decided


def test_joints_are_met_at_and_beyond_both_of_their_limits(
    iiwa7_config: Config, iiwa7_model: RobotModel
) -> None:
    q = np.array([s.q for s in random_states(iiwa7_config, iiwa7_model, 400, seed=5, faults=0.0)])
    assert (q == iiwa7_model.q_upper).any() and (q == iiwa7_model.q_lower).any()
    assert (q > iiwa7_model.q_upper).any() and (q < iiwa7_model.q_lower).any()
