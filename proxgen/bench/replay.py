"""Compiles `runtime/bench/replay.c` with a robot's code, runs it, and reads its times."""

import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from proxgen.bench.inputs import Inputs
from proxgen.builder import build
from proxgen.builder.program import compile_program
from proxgen.builder.sources import runtime_directory
from proxgen.builder.toolchain import run
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array
from proxgen.errors import BuildError

BACKENDS = {"daqp": "DAQP", "qpoases": "qpOASES"}
"""How the QP solvers write themselves."""

STAGES = ("input", "bounds", "kinematics", "distances", "rows", "objective", "solve", "certificate")
"""As in replay.c; `solve` is the whole ladder with its certificates, `certificate` one of them alone."""

BUILD_STAGES = STAGES[:6]
"""What comes before the solver: the QP build."""


@dataclass(frozen=True)
class Replay:
    """Times of one set of inputs with one back end.

    Attributes:
        name: of the inputs.
        backend: QP solver.
        whole: (replays, cycles) time of each call of step [s], raw.
        stages: per stage, (replays, cycles) [s], raw; without the time that reading the clock takes.
        heap_allocations_per_cycle: mean over all cycles of `whole`.
        clock: least time between two readings of the clock [s]; it is in `whole`.
        worst_residual: greatest KKT residual of a success.
        statuses: (cycles,).
    """

    name: str
    backend: str
    whole: Array
    stages: dict[str, Array]
    heap_allocations_per_cycle: float
    clock: float
    worst_residual: float
    statuses: NDArray[np.int64]


def compile_replay(config: Config, backend: str, directory: Path) -> Path:
    """Compile the replaying program for a robot with one back end, with the flags of the product.

    Args:
        config: of the robot.
        backend: `qpoases` or `daqp`.
        directory: where everything goes; made if missing.

    Returns:
        The executable.

    Raises:
        BuildError: the compiler refuses, or something is missing.
    """
    built = build(config, directory / "controller", backend)
    main = runtime_directory() / "bench" / "replay.c"
    return compile_program(main, built.generated, backend, directory / "replay")


def replay(program: Path, inputs: Inputs, backend: str, directory: Path, replays: int) -> Replay:
    """Run the program over recorded inputs.

    Args:
        program: from `compile_replay`.
        inputs: what it is to replay.
        backend: QP solver, for the result.
        directory: for its files.
        replays: how often.

    Raises:
        BuildError: it fails.
    """
    source, target = directory / "inputs.bin", directory / "times.bin"
    inputs.save(source)
    run([str(program), str(source), str(target), str(replays)], "the replay failed")
    values = np.fromfile(target)
    shape, each = (replays, inputs.cycles), replays * inputs.cycles
    if len(values) != 3 + (1 + len(STAGES)) * each + inputs.cycles:
        raise BuildError(f"the replay wrote {len(values)} numbers, which fit no {replays} replays")
    heap, clock, worst = values[:3]
    blocks = values[3 : 3 + (1 + len(STAGES)) * each].reshape(1 + len(STAGES), *shape)
    return Replay(
        name=inputs.name,
        backend=backend,
        whole=blocks[0],
        stages={name: np.maximum(block - clock, 0.0) for name, block in zip(STAGES, blocks[1:], strict=True)},
        heap_allocations_per_cycle=heap / each,
        clock=clock,
        worst_residual=worst,
        statuses=values[-inputs.cycles :].astype(np.int64),
    )


def instructions_per_cycle(
    program: Path, inputs: Inputs, symbol: str, directory: Path, cycles: int = 300
) -> float | None:
    """Instructions of the step function per cycle, counted by callgrind; None where valgrind is missing.

    Args:
        program: from `compile_replay`.
        inputs: of which the first cycles are replayed, once.
        symbol: name of the step function.
        directory: for its files.
        cycles: how many.
    """
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        return None
    few = Inputs(inputs.name, inputs.q[:cycles], inputs.xdot[:cycles], inputs.measurements[:cycles])
    source, counts = directory / "few.bin", directory / "callgrind.out"
    few.save(source)
    options = ["--tool=callgrind", f"--toggle-collect={symbol}", f"--callgrind-out-file={counts}"]
    run(
        [valgrind, *options, str(program), str(source), str(directory / "few_times.bin"), "1"],
        "valgrind failed",
    )
    totals = [
        line.split()[1]
        for line in counts.read_text().splitlines()
        if line.startswith(("totals:", "summary:"))
    ]
    return float(totals[-1]) / few.cycles
