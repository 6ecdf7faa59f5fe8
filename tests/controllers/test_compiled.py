import copy
import dataclasses
import pickle
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from compiled_tools import XDOT, Q, free_space

from proxgen.compare import random_states
from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import OFF, Diagnostics, Measurement, Status
from proxgen.errors import ControllerError
from proxgen.model import RobotModel


def test_a_cycle_in_free_space_solves_the_task(controller: CompiledController, nothing: Measurement) -> None:
    command = controller.step(Q, XDOT, nothing)
    assert command.status is Status.SOLVED and command.status.success
    found = command.diagnostics
    assert command.qdot.shape == (2,) and command.qdot.dtype == np.float64
    H, g = found.H, found.g
    np.testing.assert_allclose(H, H.T)
    expected = np.clip(np.linalg.solve(H, -g), found.lb, found.ub)
    assert np.all((found.lb < expected) & (expected < found.ub)), "a bound acts"
    np.testing.assert_allclose(command.qdot, expected, atol=1e-9)
    assert np.all(found.lb <= command.qdot) and np.all(command.qdot <= found.ub)


def test_diagnostics_have_the_shapes_and_types_of_the_protocol(
    controller: CompiledController, nothing: Measurement
) -> None:
    found = controller.step(Q, XDOT, nothing).diagnostics
    assert isinstance(found, Diagnostics)
    capsules = controller.manifest["dimensions"]["capsules"]
    rows = controller.manifest["dimensions"]["rows"]
    shapes = {
        "H": (2, 2), "g": (2,), "A": (rows, 2), "ubA": (rows,), "lb": (2,), "ub": (2,), "row_on": (rows,),
        "distance": (capsules,), "nearest_point": (capsules, 3), "approach_speed": (capsules,),
        "slack": (rows,),
    }  # fmt: skip
    for name, shape in shapes.items():
        value = getattr(found, name)
        assert value.shape == shape, name
        assert value.dtype == (bool if name == "row_on" else np.float64), name
    for name in ("manipulability", "damping", "kkt_residual"):
        assert type(getattr(found, name)) is float, name
    for name in ("iterations", "solves", "second_chances"):
        assert type(getattr(found, name)) is int, name
    assert not found.row_on.any() and np.all(found.ubA == OFF)
    assert np.all(np.isinf(found.distance)) and np.all(np.isnan(found.nearest_point))


def test_an_obstacle_gives_a_row(controller: CompiledController, planar2_model: RobotModel) -> None:
    capsule = controller.manifest["capsules"][-1]
    reach = planar2_model_points(planar2_model)
    command = controller.step(Q, XDOT, free_space(planar2_model, points=reach[None, :]))
    found = command.diagnostics
    index = len(controller.manifest["capsules"]) - 1
    assert found.row_on[index], capsule["name"]
    np.testing.assert_allclose(found.nearest_point[index], reach)
    assert np.all(found.A[found.row_on] @ command.qdot <= found.ubA[found.row_on] + 1e-8)


def planar2_model_points(model: RobotModel) -> np.ndarray:
    """A point 0.1 m beyond the end of the last capsule."""
    from proxgen.model import kinematics

    last = model.capsules[-1]
    pose = kinematics.body_poses(model, Q)[last.body]
    start, end = (pose[:3, :3] @ point + pose[:3, 3] for point in (last.start, last.end))
    beyond: np.ndarray = end + 0.1 * (end - start) / np.linalg.norm(end - start)
    return beyond


def test_diagnostics_are_those_of_their_own_cycle(
    controller: CompiledController, planar2_model: RobotModel
) -> None:
    first = controller.step(Q, XDOT, free_space(planar2_model, 1.0))
    eager = first.diagnostics.g.copy()
    late = controller.step(Q, XDOT, free_space(planar2_model, 2.0))
    controller.step(Q + 0.1, -XDOT, free_space(planar2_model, 3.0))
    np.testing.assert_array_equal(late.diagnostics.g, eager)
    np.testing.assert_array_equal(first.diagnostics.g, eager)


def test_commands_behave_as_plain_data(controller: CompiledController, nothing: Measurement) -> None:
    command = controller.step(Q, XDOT, nothing)
    text = repr(command.diagnostics)
    assert text.startswith("Diagnostics(H=array") and "_snapshot" not in text
    for again in (pickle.loads(pickle.dumps(command)), copy.deepcopy(command)):
        np.testing.assert_array_equal(again.qdot, command.qdot)
        np.testing.assert_array_equal(again.diagnostics.H, command.diagnostics.H)
    changed = dataclasses.replace(command, status=Status.STOPPED_SOLVER)
    assert changed.diagnostics is command.diagnostics
    with pytest.raises(AttributeError, match="no attribute 'hessian'"):
        _ = command.diagnostics.hessian  # type: ignore[attr-defined]
    with pytest.raises(dataclasses.FrozenInstanceError):
        command.diagnostics.damping = 0.0  # type: ignore[misc]


def test_the_command_is_the_callers_own(controller: CompiledController, planar2_model: RobotModel) -> None:
    first = controller.step(Q, XDOT, free_space(planar2_model, 1.0))
    kept = first.qdot.copy()
    controller.step(Q, -XDOT, free_space(planar2_model, 2.0))
    np.testing.assert_array_equal(first.qdot, kept)


def test_lists_and_integers_are_taken_too(library: Path, planar2_model: RobotModel) -> None:
    one, two = CompiledController.load(library), CompiledController.load(library)
    seen = free_space(planar2_model)
    listed = dataclasses.replace(
        seen,
        tof_range=seen.tof_range.tolist(),
        capacitive=seen.capacitive.astype(int),
        points=[[9, 9, 9]],  # type: ignore[arg-type]
    )
    expected = one.step(np.array([0.0, 1.0]), XDOT, seen)
    found = two.step([0, 1], XDOT.tolist(), listed)  # type: ignore[arg-type]
    np.testing.assert_array_equal(found.qdot, expected.qdot)


def test_arrays_that_are_not_contiguous_are_read_right(library: Path, nothing: Measurement) -> None:
    one, two = CompiledController.load(library), CompiledController.load(library)
    strided = np.stack([Q, Q + 1.0], axis=1)[:, 0]
    np.testing.assert_array_equal(one.step(strided, XDOT, nothing).qdot, two.step(Q, XDOT, nothing).qdot)


@pytest.mark.parametrize("shape", [(1,), (3,), (2, 1), (1, 2), ()])
def test_a_wrong_size_of_q_is_refused(
    controller: CompiledController, nothing: Measurement, shape: tuple[int, ...]
) -> None:
    with pytest.raises(ControllerError, match="q must be 2 numbers, not shape"):
        controller.step(np.zeros(shape), XDOT, nothing)


def replaced(measurement: Measurement, field: str, value: object) -> Measurement:
    changes: Any = {field: value}
    return dataclasses.replace(measurement, **changes)


def test_wrong_sizes_and_types_are_refused(controller: CompiledController, nothing: Measurement) -> None:
    size = len(nothing.tof_range)
    with pytest.raises(ControllerError, match="xdot must be 2 numbers, not shape"):
        controller.step(Q, np.zeros(3), nothing)
    with pytest.raises(ControllerError, match="q must be 2 numbers, not"):
        controller.step(["a", "b"], XDOT, nothing)  # type: ignore[arg-type]
    with pytest.raises(ControllerError, match="q must be 2 numbers, not"):
        controller.step(Q + 1j, XDOT, nothing)  # type: ignore[arg-type]
    for field in ("tof_range", "tof_age"):
        wrong = replaced(nothing, field, np.ones(size + 1))
        with pytest.raises(ControllerError, match=f"measurement.{field} must be {size} numbers"):
            controller.step(Q, XDOT, wrong)
    for field in ("capacitive", "capacitive_age"):
        wrong = replaced(nothing, field, np.zeros(len(nothing.capacitive) + 1))
        with pytest.raises(ControllerError, match=f"measurement.{field} must be"):
            controller.step(Q, XDOT, wrong)
    with pytest.raises(ControllerError, match="time must be a number"):
        controller.step(Q, XDOT, dataclasses.replace(nothing, time="now"))  # type: ignore[arg-type]
    assert controller.counters.cycles == 0
    assert controller.step(Q, XDOT, nothing).status is Status.SOLVED, "nothing of it was remembered"


def test_points_are_checked(controller: CompiledController, nothing: Measurement) -> None:
    capacity = controller.manifest["dimensions"]["max_points"]
    far = np.full((capacity, 3), 50.0)
    assert controller.step(Q, XDOT, dataclasses.replace(nothing, points=far)).status is Status.SOLVED
    later = dataclasses.replace(nothing, time=2.0)
    with pytest.raises(ControllerError, match=f"{capacity + 1} points; skin.max_points allows {capacity}"):
        controller.step(Q, XDOT, dataclasses.replace(later, points=np.zeros((capacity + 1, 3))))
    with pytest.raises(ControllerError, match=r"must have the shape \(P, 3\)"):
        controller.step(Q, XDOT, dataclasses.replace(later, points=np.zeros((2, 2))))


def test_bad_measurements_have_a_status_and_are_no_error(
    controller: CompiledController, nothing: Measurement
) -> None:
    assert controller.step(Q * np.nan, XDOT, nothing).status is Status.FAULT_NOT_FINITE
    stale = dataclasses.replace(nothing, tof_age=np.full(len(nothing.tof_range), 5.0))
    fresh = dataclasses.replace(nothing, time=2.0, tof_age=np.zeros(len(nothing.tof_range)))
    assert controller.step(Q, XDOT, stale).status is Status.FAULT_STALE
    assert controller.step(Q, XDOT, fresh).status is Status.SOLVED
    assert controller.step(Q, XDOT, fresh).status is Status.FAULT_TIME
    assert controller.step(Q, XDOT, dataclasses.replace(nothing, time=3.0)).status is Status.SOLVED


def test_ages_that_are_no_longer_given_are_fresh_again(
    controller: CompiledController, nothing: Measurement
) -> None:
    old = np.full(len(nothing.capacitive), 5.0)
    stale = dataclasses.replace(nothing, capacitive_age=old)
    assert controller.step(Q, XDOT, stale).status is Status.FAULT_STALE
    assert controller.step(Q, XDOT, dataclasses.replace(nothing, time=2.0)).status is Status.SOLVED


def test_a_controller_says_what_it_is(library: Path, nothing: Measurement) -> None:
    controller = CompiledController.load(library)
    size = controller.manifest["dimensions"]
    controller.step(Q, XDOT, nothing)
    assert repr(controller) == (
        f"CompiledController(robot='planar2', backend='{controller.backend}', joints=2, task_rows=2, "
        f"capsules={size['capsules']}, tof={size['tof']}, capacitive={size['capacitive']}, cycles=1)"
    )


def test_counters_add_up(controller: CompiledController, planar2_model: RobotModel) -> None:
    for time in (1.0, 2.0, 2.0, 3.0):
        controller.step(Q, XDOT, free_space(planar2_model, time))
    counted = controller.counters
    assert counted.cycles == 4 == sum(counted.status_count.values())
    assert counted.status_count == {Status.SOLVED: 3, Status.FAULT_TIME: 1}
    assert counted.solves == 3 and counted.certificate_failures == 0


def test_counters_are_the_sums_of_the_cycles(
    controller: CompiledController, planar2_config: Config, planar2_model: RobotModel
) -> None:
    """Over states of all kinds, of which some need no solve."""
    states = random_states(planar2_config, planar2_model, 300, seed=71)
    commands = [controller.step(state.q, state.xdot, state.measurement) for state in states]
    counted, cycles = controller.counters, [command.diagnostics for command in commands]
    assert counted.status_count == Counter(command.status for command in commands)
    assert counted.solves == sum(cycle.solves for cycle in cycles) < counted.cycles == 300
    assert counted.iterations == sum(cycle.iterations for cycle in cycles)
    assert counted.second_chances == sum(cycle.second_chances for cycle in cycles)
    assert counted.max_iterations_in_cycle == max(cycle.iterations for cycle in cycles) > 1


def test_no_row_is_on_after_a_fault(controller: CompiledController, planar2_model: RobotModel) -> None:
    """Whatever the cycle before said."""
    beside = np.array([[0.2, 0.2, 0.1]])
    assert controller.step(Q, XDOT, free_space(planar2_model, 1.0, beside)).diagnostics.row_on.any()
    for q, time in ((Q, 0.5), (Q * np.nan, 1.5)):
        command = controller.step(q, XDOT, free_space(planar2_model, time, beside))
        assert command.status.fault and not command.diagnostics.row_on.any()


def test_reset_forgets_the_time_and_keeps_the_counters(
    controller: CompiledController, nothing: Measurement
) -> None:
    first = controller.step(Q, XDOT, nothing)
    assert controller.step(Q, XDOT, nothing).status is Status.FAULT_TIME
    controller.reset()
    again = controller.step(Q, XDOT, nothing)
    assert again.status is Status.SOLVED
    np.testing.assert_array_equal(again.qdot, first.qdot)
    assert controller.counters.cycles == 3
