import copy
import dataclasses
import json
import pickle
import shutil
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import proxgen
from proxgen.builder import build
from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import OFF, Diagnostics, Measurement, Status
from proxgen.errors import ControllerError
from proxgen.model import RobotModel

Q = np.array([0.4, 0.9])
XDOT = np.array([0.05, -0.02])


@pytest.fixture(scope="module")
def library(planar2_config: Config, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The planar arm over DAQP."""
    return build(planar2_config, tmp_path_factory.mktemp("planar2") / "built", backend="daqp").library_dir


@pytest.fixture
def controller(library: Path) -> CompiledController:
    return CompiledController.load(library)


@pytest.fixture
def nothing(planar2_model: RobotModel) -> Measurement:
    """A measurement of free space."""
    return free_space(planar2_model)


def free_space(model: RobotModel, time: float = 1.0, points: np.ndarray | None = None) -> Measurement:
    ranges = np.array([module.tof.range for module in model.tof_modules if module.tof])
    closed = np.zeros(len(model.capacitive_modules), dtype=bool)
    return Measurement(time, ranges, closed, points=np.empty((0, 3)) if points is None else points)


def test_a_cycle_in_free_space_solves_the_task(controller: CompiledController, nothing: Measurement) -> None:
    command = controller.step(Q, XDOT, nothing)
    assert command.status is Status.SOLVED and command.status.success
    found = command.diagnostics
    assert command.qdot.shape == (2,) and command.qdot.dtype == np.float64
    H, g = found.H, found.g
    np.testing.assert_allclose(H, H.T)
    expected = np.clip(np.linalg.solve(H, -g), found.lb, found.ub)
    if np.all((found.lb < expected) & (expected < found.ub)):
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
    if len(nothing.tof_range):
        assert controller.step(Q, XDOT, stale).status is Status.FAULT_STALE
    assert controller.step(Q, XDOT, fresh).status is Status.SOLVED
    assert controller.step(Q, XDOT, fresh).status is Status.FAULT_TIME
    assert controller.step(Q, XDOT, dataclasses.replace(nothing, time=3.0)).status is Status.SOLVED


def test_ages_that_are_no_longer_given_are_fresh_again(
    controller: CompiledController, nothing: Measurement
) -> None:
    old = np.full(len(nothing.capacitive), 5.0)
    if len(old):
        stale = dataclasses.replace(nothing, capacitive_age=old)
        assert controller.step(Q, XDOT, stale).status is Status.FAULT_STALE
    assert controller.step(Q, XDOT, dataclasses.replace(nothing, time=2.0)).status is Status.SOLVED


def test_counters_add_up(controller: CompiledController, planar2_model: RobotModel) -> None:
    for time in (1.0, 2.0, 2.0, 3.0):
        controller.step(Q, XDOT, free_space(planar2_model, time))
    counted = controller.counters
    assert counted.cycles == 4 == sum(counted.status_count.values())
    assert counted.status_count == {Status.SOLVED: 3, Status.FAULT_TIME: 1}
    assert counted.solves == 3 and counted.certificate_failures == 0


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


def test_parameters_are_those_of_the_manifest(controller: CompiledController) -> None:
    found = controller.parameters
    entries = controller.manifest["parameters"]
    assert list(found) == [entry["name"] for entry in entries]
    for entry in entries:
        np.testing.assert_array_equal(found[entry["name"]], entry["default"])
        assert np.shape(found[entry["name"]]) == tuple(entry["shape"])


def test_parameters_are_changed_by_name(controller: CompiledController, nothing: Measurement) -> None:
    controller.set_parameters(d_a=0.5, qdot_limit=[0.001, 0.002], viability=1)
    assert controller.parameters["d_a"] == 0.5
    np.testing.assert_array_equal(controller.parameters["qdot_limit"], [0.001, 0.002])
    found = controller.step(Q, XDOT, nothing).diagnostics
    assert np.all(np.abs(found.ub) <= [0.001, 0.002])


def test_parameters_that_are_read_are_copies(controller: CompiledController) -> None:
    lower = controller.parameters["q_lower"]
    assert isinstance(lower, np.ndarray)
    lower[:] = 7.0
    assert not np.any(np.asarray(controller.parameters["q_lower"]) == 7.0)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"d_aa": 0.3}, "unknown parameter 'd_aa'; did you mean 'd_a'"),
        ({"d_a": -1.0}, r"'d_a' must be within \S+ and \S+ m, not -1\.0"),
        ({"d_a": float("nan")}, "'d_a' must be within"),
        ({"d_a": [0.3, 0.3]}, r"'d_a' must be one number, not shape \(2,\)"),
        ({"q_lower": 0.0}, r"'q_lower' must be 2 numbers, not shape \(\)"),
        ({"q_lower": "low"}, "'q_lower' must be 2 numbers, not 'low'"),
        ({"qdot_limit": [1.0, 0.0]}, "'qdot_limit' must be within"),
        ({"repulse_speed": 0.1}, r"'repulse_speed' must be within \S+ and 0 m/s, not 0\.1"),
        ({"viability": 0.5}, "'viability' must be 0 or 1, not 0.5"),
        ({"q_lower": [9.0, 0.0]}, "parameters must keep q_lower < q_upper"),
        ({"d_0u": 0.9}, "parameters must keep d_0u < d_a"),
        ({"d_r": 0.1, "d_0l": 0.1}, r"parameters must keep d_r < d_0l, not 0\.1 and 0\.1"),
        ({"d_0l": 0.13}, "parameters must keep d_0l <= d_0u"),
        ({"damper_safety": 0.5}, "parameters must keep damper_safety < damper_influence"),
    ],
)
def test_a_parameter_that_is_not_accepted_changes_none(
    controller: CompiledController, values: dict[str, object], message: str
) -> None:
    before = controller.parameters
    with pytest.raises(ControllerError, match=message):
        controller.set_parameters(period=0.005, **values)
    after = controller.parameters
    for name, value in before.items():
        np.testing.assert_array_equal(after[name], value)


def test_c_refuses_what_python_would_let_through(
    controller: CompiledController, monkeypatch: pytest.MonkeyPatch
) -> None:
    from proxgen.controllers.compiled import controller as module

    monkeypatch.setattr(module, "check_orders", lambda values, names: None)
    with pytest.raises(ControllerError, match="set_parameters failed: ERROR_PARAMETER"):
        controller.set_parameters(d_0u=0.9)


def test_controllers_of_one_library_are_independent(library: Path, nothing: Measurement) -> None:
    one, two = CompiledController.load(library), CompiledController.load(library)
    one.set_parameters(d_a=0.9)
    one.step(Q, XDOT, nothing)
    assert two.parameters["d_a"] != 0.9 and two.counters.cycles == 0


def test_two_back_ends_of_one_robot_live_in_one_process(
    controller: CompiledController, planar2_config: Config, nothing: Measurement, tmp_path: Path
) -> None:
    other = CompiledController.load(build(planar2_config, tmp_path, backend="qpoases").library_dir)
    assert (controller.backend, other.backend) == ("daqp", "qpoases")
    np.testing.assert_allclose(
        other.step(Q, XDOT, nothing).qdot, controller.step(Q, XDOT, nothing).qdot, atol=1e-8
    )


def test_a_controller_can_be_used_from_many_threads(library: Path, planar2_model: RobotModel) -> None:
    shared, alone = CompiledController.load(library), CompiledController.load(library)
    cycles, threads = 300, 4
    clock = iter(range(1, cycles * threads + 1))
    turn = threading.Lock()
    commands: list[np.ndarray] = []

    def work() -> None:
        for _ in range(cycles):
            with turn:  # time has to advance from call to call
                command = shared.step(Q, XDOT, free_space(planar2_model, float(next(clock))))
                commands.append(command.qdot)
            _ = shared.parameters, shared.counters, command.diagnostics.H

    workers = [threading.Thread(target=work) for _ in range(threads)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert shared.counters.status_count == {Status.SOLVED: cycles * threads}
    for time, found in enumerate(commands, start=1):
        expected = alone.step(Q, XDOT, free_space(planar2_model, float(time)))
        np.testing.assert_array_equal(found, expected.qdot)


def test_a_measurement_of_one_thread_never_mixes_with_that_of_another(
    library: Path, planar2_model: RobotModel
) -> None:
    """Without a lock around the whole cycle the arguments would be those of two callers."""
    shared, alone = CompiledController.load(library), CompiledController.load(library)
    for each in (shared, alone):
        each.set_parameters(qddot_limit=[1e20, 1e20])  # each cycle forgets the one before
    inputs = [(Q + 0.1 * k, XDOT * (k + 1)) for k in range(3)]
    expected = [alone.step(q, v, free_space(planar2_model, k + 1.0)).qdot for k, (q, v) in enumerate(inputs)]
    clock = iter(range(1, 100_000))
    wrong: list[object] = []

    def work(k: int) -> None:
        q, v = inputs[k]
        for _ in range(400):
            command = shared.step(q, v, free_space(planar2_model, float(next(clock))))
            if command.status is Status.SOLVED and not np.allclose(command.qdot, expected[k], atol=1e-9):
                wrong.append((k, command.qdot))

    workers = [threading.Thread(target=work, args=(k,)) for k in range(3)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert not wrong


def test_the_gil_is_free_during_a_cycle(library: Path) -> None:
    extension = next((library / "python").iterdir())
    assert b"PyEval_SaveThread" in extension.read_bytes()


def test_a_folder_without_a_controller_names_the_command(tmp_path: Path) -> None:
    with pytest.raises(ControllerError, match="holds no controller; `proxgen build -o"):
        CompiledController.load(tmp_path)


def test_parts_of_different_builds_are_refused(library: Path, tmp_path: Path) -> None:
    shutil.copytree(library, tmp_path / "mixed")
    manifest = tmp_path / "mixed" / "share" / "proxgen_planar2" / "manifest.json"
    content = json.loads(manifest.read_text())
    content["config_hash"] = "0" * 64
    manifest.write_text(json.dumps(content))
    with pytest.raises(ControllerError, match="of different builds; run `proxgen build`"):
        CompiledController.load(tmp_path / "mixed")


def test_an_extension_that_cannot_be_loaded_is_an_error_of_ours(library: Path, tmp_path: Path) -> None:
    shutil.copytree(library, tmp_path / "broken")
    extension = next((tmp_path / "broken" / "python").iterdir())
    extension.write_bytes(b"not a library")
    with pytest.raises(ControllerError, match="cannot be loaded"):
        CompiledController.load(tmp_path / "broken")


def test_proxgen_build_gives_a_controller_at_rest(
    planar2_config: Config, tmp_path: Path, nothing: Measurement
) -> None:
    controller = proxgen.build(planar2_config, tmp_path, backend="daqp")
    assert isinstance(controller, CompiledController) and controller.robot == "planar2"
    assert controller.step(Q, XDOT, nothing).status is Status.SOLVED
