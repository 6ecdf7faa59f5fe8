"""`proxgen bench`: record, replay from C with both back ends and from Python, and put it into numbers."""

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from proxgen.bench.inputs import Inputs, crowded, record
from proxgen.bench.machine import describe_machine
from proxgen.bench.replay import BUILD_STAGES, STAGES, Replay, compile_replay, instructions_per_cycle, replay
from proxgen.bench.timing import time_steps, timing_row
from proxgen.config.scene import Scene
from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.errors import GenerateError
from proxgen.model import RobotModel, build_model

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
    also: Sequence[Config] = (),
    duration: float = 60.0,
    replays: int = 5,
    progress: Progress | None = None,
) -> Benchmark:
    """Measure a robot's compiled controller.

    Args:
        config: of the robot.
        scenes: whose closed loops are recorded, with the skin as the sensor.
        also: other configurations of this robot, which get the same inputs over DAQP.
        duration: of each of them [s].
        replays: how often each is replayed.
        progress: called after each step of the work.

    Returns:
        Times per cycle: raw (all replays of all cycles) and the best of the replays of each cycle, apart.

    Raises:
        BuildError: compiler or solver missing.
        GenerateError: one of `also` has other joints or sensors.
        SimulationError: a scene does not fit the arm.
    """
    model = build_model(config)
    rows: list[dict[str, Any]] = []
    kept: list[Replay] = []
    for other in also:
        _check_same_inputs(model, other)
    steps, done = 1 + len(scenes) + (len(BACKENDS) + len(also)) * (len(scenes) + 1), 0

    def advance() -> None:
        nonlocal done
        done += 1
        if progress:
            progress(done, steps)

    with tempfile.TemporaryDirectory(prefix="proxgen-bench-") as name:
        work = Path(name)
        subjects = [
            _Subject(config, "", BACKENDS[0], work / "0"),
            *(
                _Subject(other, f", {other.robot.name}", BACKENDS[0], work / other.robot.name)
                for other in also
            ),
            _Subject(config, "", BACKENDS[1], work / "1"),
        ]
        controller = subjects[0].controller
        advance()
        recorded = []
        for scene in scenes:
            recorded.append(record(config, model, controller, scene, duration))
            advance()
        recorded.append(crowded(recorded[0], model, config.skin.max_points))
        for subject in subjects:
            for inputs in recorded:
                measured, found = subject.measure(inputs, replays)
                rows += found
                kept.append(measured)
                advance()
    return Benchmark(describe_machine(model), tuple(rows), tuple(kept))


class _Subject:
    """A configuration with a back end, compiled for replays and for Python."""

    def __init__(self, config: Config, label: str, backend: str, folder: Path) -> None:
        """Compile both; `label` follows the names of the recordings."""
        folder.mkdir()
        self._label, self._backend, self._folder = label, backend, folder
        self._symbol = f"{config.robot.name}_step"
        self._program = compile_replay(config, backend, folder)
        self.controller = CompiledController.load(folder / "controller")

    def measure(self, inputs: Inputs, replays: int) -> tuple[Replay, list[dict[str, Any]]]:
        """Replay one recording from C, under callgrind, and from Python."""
        named = replace(inputs, name=inputs.name + self._label)
        measured = replay(self._program, named, self._backend, self._folder, replays)
        count = instructions_per_cycle(self._program, named, self._symbol, self._folder)
        rows = [*_rows(measured, count), *_python_rows(self.controller, named, self._backend)]
        return measured, rows


def _check_same_inputs(model: RobotModel, other: Config) -> None:
    """Refuse a configuration whose controller takes other inputs than those that are recorded."""
    theirs = build_model(other)
    for what, one, two in (
        ("joints", model.joint_names, theirs.joint_names),
        ("task rows", model.task_rows, theirs.task_rows),
        ("range sensors", len(model.tof_modules), len(theirs.tof_modules)),
        ("switches", len(model.capacitive_modules), len(theirs.capacitive_modules)),
    ):
        if one != two:
            raise GenerateError(f"{other.robot.name} has other {what} than the inputs are recorded for")


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


def _python_rows(controller: CompiledController, inputs: Inputs, backend: str) -> list[dict[str, Any]]:
    """Times of `controller.step` from Python, one pass over the inputs each.

    Arrays that come from memory instead of the cache cost a cycle more than all of its work in C. A control
    loop has just made them; who replays a recording has not. Both are told.
    """
    ways = {"raw": inputs.just_made(), "recorded arrays, raw": inputs.recorded()}
    return [
        timing_row(f"{inputs.name}: cycle from Python, {way}", backend, time_steps(controller, cycles))
        for way, cycles in ways.items()
    ]
