"""How the time of a cycle grows with the arm: joints, sensors, capsules, one at a time."""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from proxgen.bench.arms import Size, made_up_inputs, write_arm
from proxgen.bench.machine import describe_machine
from proxgen.bench.replay import BUILD_STAGES, Replay, compile_replay, replay
from proxgen.bench.timing import timing_row
from proxgen.controllers.protocol import Array
from proxgen.model import build_model

SWEEPS: dict[str, tuple[int, ...]] = {
    "joints": (2, 3, 4, 6, 7, 8, 10, 12),
    "sensors": (8, 16, 32, 64, 128, 256, 512),
    "capsules": (1, 2, 3, 5, 7),
}
"""What is varied, while the rest is as in `Size`."""

PARTS = ("cycle", "QP build", "kinematics", "distances", "solve")

Progress = Callable[[int, int], None]
"""Called with the number of steps done and the number of all."""


@dataclass(frozen=True)
class Scaling:
    """Times of arms of several sizes.

    Attributes:
        machine: what it was measured on, and with.
        results: one row per sweep, value and part of the cycle.
        sweeps: per sweep, the values and, per part, the median times [µs].
    """

    machine: dict[str, str]
    results: tuple[dict[str, Any], ...]
    sweeps: dict[str, dict[str, list[float]]]

    @property
    def per_sensor(self) -> tuple[float, float]:
        """Slope of the distance stage over the sensors [ns], and how much a straight line explains (R²)."""
        sweep = self.sweeps["sensors"]
        return straight_line(sweep["value"], np.array(sweep["distances"]) * 1e3)

    def to_json(self) -> dict[str, Any]:
        """The keys of every benchmark, and the curves."""
        slope, explained = self.per_sensor
        line = {"ns_per_sensor": slope, "explained_by_a_line": explained}
        return {
            "machine": self.machine,
            "results": list(self.results),
            "scaling": self.sweeps,
            "distance_stage": line,
        }


def straight_line(x: Sequence[float], y: Array) -> tuple[float, float]:
    """Slope of the straight line of least squares, and the share of the variance that it explains (R²)."""
    slope, offset = np.polyfit(np.asarray(x, dtype=float), y, 1)
    rest = y - (slope * np.asarray(x) + offset)
    return float(slope), float(1.0 - rest.var() / y.var())


def run_scaling(
    sweeps: Mapping[str, Sequence[int]] = SWEEPS,
    *,
    cycles: int = 2000,
    replays: int = 5,
    progress: Progress | None = None,
) -> Scaling:
    """Generate, compile and time controllers of made-up arms, with the DAQP back end.

    Args:
        sweeps: values per quantity: joints, sensors, capsules.
        cycles: made-up cycles per arm.
        replays: how often each is replayed.
        progress: called after each arm.

    Raises:
        BuildError: compiler or solver missing.
    """
    wanted = [(name, value, replace(Size(), **{name: value})) for name in sweeps for value in sweeps[name]]
    measured: dict[Size, Replay] = {}
    sizes = list(dict.fromkeys(size for _, _, size in wanted))
    with tempfile.TemporaryDirectory(prefix="proxgen-scaling-") as folder:
        for done, size in enumerate(sizes, start=1):
            config = write_arm(size, Path(folder))
            model, work = build_model(config), Path(folder) / _folder(size)
            work.mkdir()
            inputs = made_up_inputs(model, cycles)
            measured[size] = replay(compile_replay(config, "daqp", work), inputs, "daqp", work, replays)
            if progress:
                progress(done, len(sizes))
        machine = describe_machine(model)
    machine["robot"] = "arms of 1.2 m; 7 joints, 32 modules and 3 capsules where not said otherwise"
    rows = []
    curves: dict[str, dict[str, list[float]]] = {
        name: {part: [] for part in ("value", *PARTS)} for name in sweeps
    }
    for name, value, size in wanted:
        curves[name]["value"].append(float(value))
        for part, times in _parts(measured[size]).items():
            rows.append(timing_row(f"{value} {name}: {part}, raw", "daqp", times))
            curves[name][part].append(rows[-1]["p50_us"])
    return Scaling(machine, tuple(rows), curves)


def _folder(size: Size) -> str:
    """Name of an arm's folder."""
    return f"{size.joints}-{size.sensors}-{size.capsules}"


def _parts(measured: Replay) -> dict[str, Array]:
    """Raw times per part of the cycle."""
    build = sum((measured.stages[stage] for stage in BUILD_STAGES), np.zeros(1))
    stages = {part: measured.stages[part].ravel() for part in PARTS[2:]}
    return {"cycle": measured.whole.ravel(), "QP build": build.ravel(), **stages}
