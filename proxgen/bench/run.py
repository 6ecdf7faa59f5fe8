"""`proxgen bench`: record, replay from C with both back ends and from Python, and put it into numbers."""

import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from proxgen.bench.inputs import Inputs, crowded, record
from proxgen.bench.machine import describe_machine
from proxgen.bench.replay import BUILD_STAGES, STAGES, Replay, compile_replay, instructions_per_cycle, replay
from proxgen.bench.timing import timing_row
from proxgen.config.scene import Scene
from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.model import build_model

BACKENDS = ("daqp", "qpoases")

Progress = Callable[[int, int], None]
"""Called with the number of steps done and the number of all."""


@dataclass(frozen=True)
class Benchmark:
    """All that was measured in one run.

    Attributes:
        machine: what it was measured on, and with.
        results: one row per set of inputs, way of calling and stage.
        replays: the raw times behind them, for the plot.
    """

    machine: dict[str, str]
    results: tuple[dict[str, Any], ...]
    replays: tuple[Replay, ...]

    def to_json(self) -> dict[str, Any]:
        """The keys that other programs rely on: machine, results."""
        return {"machine": self.machine, "results": list(self.results)}


def run_benchmark(
    config: Config,
    scenes: Sequence[Scene],
    *,
    duration: float = 60.0,
    replays: int = 5,
    progress: Progress | None = None,
) -> Benchmark:
    """Measure a robot's compiled controller.

    Args:
        config: of the robot.
        scenes: whose closed loops are recorded, with the skin as the sensor.
        duration: of each of them [s].
        replays: how often each is replayed.
        progress: called after each step of the work.

    Returns:
        Times per cycle: raw (all replays of all cycles) and the best of the replays of each cycle, apart.

    Raises:
        BuildError: compiler or solver missing.
        SimulationError: a scene does not fit the arm.
    """
    model, rows, kept = build_model(config), [], []
    steps, done = 1 + len(scenes) + len(BACKENDS) * (len(scenes) + 1), 0

    def advance() -> None:
        nonlocal done
        done += 1
        if progress:
            progress(done, steps)

    with tempfile.TemporaryDirectory(prefix="proxgen-bench-") as name:
        work = Path(name)
        programs = {}
        for backend in BACKENDS:
            (work / backend).mkdir()
            programs[backend] = compile_replay(config, backend, work / backend)
        controllers = {key: CompiledController.load(work / key / "controller") for key in BACKENDS}
        advance()
        recorded = []
        for scene in scenes:
            recorded.append(record(config, model, controllers[BACKENDS[0]], scene, duration))
            advance()
        recorded.append(crowded(recorded[0], model, config.skin.max_points))
        for backend in BACKENDS:
            for inputs in recorded:
                measured = replay(programs[backend], inputs, backend, work / backend, replays)
                symbol = f"{config.robot.name}_step"
                count = instructions_per_cycle(programs[backend], inputs, symbol, work / backend)
                rows += _rows(measured, count)
                rows.append(_python_row(controllers[backend], inputs, backend))
                kept.append(measured)
                advance()
    return Benchmark(describe_machine(model), tuple(rows), tuple(kept))


def _rows(measured: Replay, instructions: float | None) -> list[dict[str, Any]]:
    """The results of one replay: whole cycles raw and best, the QP build, each stage."""
    heap = {"heap_allocations_per_cycle": measured.heap_allocations_per_cycle}
    whole = {**heap, "instructions_per_cycle": instructions, "worst_kkt_residual": measured.worst_residual}
    build = sum((measured.stages[stage] for stage in BUILD_STAGES), np.zeros(1))
    rows = [
        timing_row(f"{measured.name}: cycle, raw", measured.backend, measured.whole.ravel(), **whole),
        timing_row(
            f"{measured.name}: cycle, best of {len(measured.whole)}",
            measured.backend,
            measured.whole.min(axis=0),
            **whole,
        ),
        timing_row(f"{measured.name}: QP build, raw", measured.backend, build.ravel()),
    ]
    return rows + [
        timing_row(f"{measured.name}: {stage}, raw", measured.backend, measured.stages[stage].ravel())
        for stage in STAGES
    ]


def _python_row(controller: CompiledController, inputs: Inputs, backend: str) -> dict[str, Any]:
    """Times of `controller.step` from Python, one pass over the inputs."""
    controller.reset()
    times = np.empty(inputs.cycles)
    for index, (q, xdot, seen) in enumerate(zip(inputs.q, inputs.xdot, inputs.measurements, strict=True)):
        begin = time.perf_counter_ns()
        controller.step(q, xdot, seen)
        times[index] = (time.perf_counter_ns() - begin) * 1e-9
    return timing_row(f"{inputs.name}: cycle from Python, raw", backend, times)
