import json
import shutil
import threading
from pathlib import Path

import numpy as np
import pytest
from compiled_tools import XDOT, Q, free_space

import proxgen
from proxgen.builder import build
from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import Measurement, Status
from proxgen.errors import ControllerError
from proxgen.model import RobotModel


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
    from_file = proxgen.build(str(planar2_config.source), tmp_path, backend="daqp")
    assert from_file.manifest == controller.manifest
