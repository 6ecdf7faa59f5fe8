"""`examples/embed/elsewhere`: the replay on this machine, and what is said where other tools lack."""

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scripts import ROOT, load_script, run_with_tools

from proxgen.bench.inputs import Inputs
from proxgen.builder import BuildResult
from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import Measurement

SCRIPT = ROOT / "examples" / "embed" / "elsewhere" / "run.py"
PACKAGES = [
    "gcc-aarch64-linux-gnu",
    "libc6-dev-arm64-cross",
    "qemu-user",
    "gcc-arm-none-eabi",
    "libnewlib-arm-none-eabi",
    "qemu-system-arm",
    "make",
]


@pytest.fixture(scope="module")
def elsewhere() -> ModuleType:
    """The script, as a module."""
    return load_script(SCRIPT)


def some_inputs(seed: int = 3) -> Inputs:
    """States around a posture, with readings and points from near to far."""
    rng, cycles = np.random.default_rng(seed), 60
    q = np.array([0.0, 0.5, 0.0, -1.5, 0.0, 1.0, 0.0]) + rng.uniform(-0.3, 0.3, (cycles, 7))
    seen = tuple(
        Measurement(
            time=0.02 * (i + 1),
            tof_range=np.where(rng.random(32) < 0.2, rng.uniform(0.1, 1.0, 32), 1.0),
            capacitive=rng.random(32) < 0.05,
            points=rng.uniform(-1.0, 1.0, (i % 4, 3)),
        )
        for i in range(cycles)
    )
    return Inputs("made up", q, rng.uniform(-0.2, 0.2, (cycles, 3)), seen)


def test_the_replay_commands_what_the_library_commands(
    elsewhere: ModuleType, iiwa7_daqp: BuildResult, tmp_path: Path
) -> None:
    inputs = some_inputs()
    folder = elsewhere.compile_replay("native", iiwa7_daqp.generated, tmp_path)
    output = elsewhere.replay("native", folder, inputs)
    controller = CompiledController.load(iiwa7_daqp.library_dir)
    steps = zip(inputs.q, inputs.xdot, inputs.measurements, strict=True)
    commands = [controller.step(q, xdot, seen) for q, xdot, seen in steps]
    assert np.array_equal(output.qdot, [command.qdot for command in commands])
    assert np.array_equal(output.status, [command.status for command in commands])
    assert len(set(output.status)) > 1
    assert 0.0 < np.abs(output.same - output.qdot).max() < 1e-10, "another sine is not linked, or a wrong one"


def test_differences_and_costs_are_found(elsewhere: ModuleType) -> None:
    qdot, status, few = np.zeros((5, 7)), np.zeros(5), np.full(5, 20_000.0)
    right = elsewhere.Output(status, few, qdot, 1006.0, 1000.0, qdot)
    found = elsewhere.problems
    assert found("gap", right, {"cortex-m7": right}) == []
    moved = elsewhere.Output(status, few, qdot + 2e-11, 1006.0, 1000.0, qdot)
    assert "commands differ by 2.0e-11" in found("gap", right, {"cortex-m7": moved})[0]
    unlike = elsewhere.Output(status, few, qdot, 1006.0, 1000.0, qdot + 1e-300)
    assert "differ with the same sine" in found("gap", right, {"cortex-m7": unlike})[0]
    other = elsewhere.Output(status + 1, few, qdot, 1006.0, 1000.0, qdot)
    assert "other statuses" in found("gap", right, {"cortex-m7": other})[0]
    slow = elsewhere.Output(status, few * 2, qdot, 1006.0, 1000.0, qdot)
    assert "40000 instructions per cycle" in found("gap", right, {"cortex-m7": slow})[0]
    miscounted = elsewhere.Output(status, few, qdot, 1900.0, 1000.0, qdot)
    assert "counted as 1900" in found("gap", right, {"cortex-m7": miscounted})[0]


def test_what_is_missing_is_named_by_its_package(tmp_path: Path) -> None:
    done = run_with_tools(SCRIPT, tmp_path)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].split() == ["apt-get", "install", *PACKAGES]
    assert "Traceback" not in done.stderr


def test_continuous_integration_installs_it() -> None:
    installed = (ROOT / ".ci" / "packages").read_text().split()
    assert set(PACKAGES) - {"make"} <= set(installed)


def test_a_compiler_without_its_library_is_not_enough(tmp_path: Path) -> None:
    for name in ("arm-none-eabi-gcc", "qemu-system-arm", "qemu-aarch64", "make"):
        (tmp_path / name).write_text("#!/bin/sh\necho libm.a\n")
        (tmp_path / name).chmod(0o755)
    done = run_with_tools(SCRIPT, tmp_path)
    expected = ["gcc-aarch64-linux-gnu", "libc6-dev-arm64-cross", "libnewlib-arm-none-eabi"]
    assert done.stderr.splitlines()[-1].split()[2:] == expected
