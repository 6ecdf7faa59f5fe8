"""What several figures derive from a log: labels, least distances, legs between targets, units."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from proxgen.controllers.protocol import Status
from proxgen.model.robot_model import CapsuleModel, RobotModel
from proxgen.report import style
from proxgen.simulation.log import RolloutLog

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Leg:
    """The way from one target to the next: cycles `first` to `last`, both included."""

    first: int
    last: int


def label(log: RolloutLog) -> str:
    """Which run it is, in a few words: scene, controller, sensing."""
    meta = log.meta
    backend = "" if meta["backend"] == "none" else f" ({meta['backend']})"
    return f"{meta['scene']}, {meta['controller']}{backend}, {meta['sensing']} sensing"


def spoken(name: str) -> str:
    """A name of the configuration as a figure shows it: `upper_arm` is the upper arm."""
    return name.replace("_", " ")


def time_span(log: RolloutLog) -> tuple[float, float]:
    """Begin of the first and end of the last cycle [s]."""
    return float(log.time[0]), float(log.time[-1]) + float(log.meta["period"])


def microseconds(value: float) -> str:
    """A time with three digits, never with an exponent."""
    digits = max(2 - math.floor(math.log10(value)), 0) if value > 0.0 else 0
    return f"{value:.{digits}f} µs"


def least_distance(log: RolloutLog) -> Array:
    """(T,) true distance of the nearest link, in the configured reference [m]; inf without an obstacle."""
    least: Array = log.reference_distance().min(axis=1, initial=np.inf)
    return least


def legs(log: RolloutLog) -> list[Leg]:
    """Stretches of cycles in which one target is pursued; the last one may end short of its target."""
    swaps = np.flatnonzero(np.diff(log.targets_reached)) + 1
    starts = [0, *swaps.tolist()]
    ends = [*(swaps - 1).tolist(), log.cycles - 1]
    return [Leg(first, last) for first, last in zip(starts, ends, strict=True)]


def typical_leg(log: RolloutLog) -> Leg:
    """The last leg that led from one target to another one; the whole run if there is none."""
    complete = legs(log)[1:-1]
    return complete[-1] if complete else Leg(0, log.cycles - 1)


def spread(leg: Leg, log: RolloutLog, count: int) -> list[int]:
    """Cycles of a leg that divide the tool's path into equal lengths, both ends included."""
    path = log.tool_position[leg.first : leg.last + 1]
    travelled = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    wanted = np.linspace(0.0, travelled[-1], count)
    return sorted({leg.first + int(np.searchsorted(travelled, way)) for way in wanted})


def joint_units(log: RolloutLog, model: RobotModel | None) -> list[str]:
    """`rad` or `m` per joint; without a model all joints count as revolute."""
    units = ["rad"] * len(log.meta["joint_names"])
    if model is not None:
        for drive in model.drives:
            units[drive.index] = "m" if drive.prismatic else "rad"
    return units


@dataclass(frozen=True)
class Zone:
    """Distances in which the controller does one thing: from `begin` [m] downwards to the next zone."""

    begin: float
    symbol: str
    meaning: str
    shade: str


def zones(log: RolloutLog) -> list[Zone]:
    """The zones of the approach law that was in force, (13) or the damper schedule, from far to near."""
    thresholds = log.meta["thresholds"]
    if log.meta["schedule"] == "damper":
        return [
            Zone(thresholds["damper_influence"], "$d_i$", "approach limited", style.APPROACH),
            Zone(thresholds["damper_safety"], "$d_s$", "repulsed", style.ALARM),
        ]
    return [
        Zone(thresholds["d_a"], "$d_a$", "approach limited", style.APPROACH),
        Zone(thresholds["d_0u"], "$d_{0u}$", "no approach", style.STANDSTILL),
        Zone(thresholds["d_0l"], "$d_{0l}$", "repulsed", style.REPULSION),
        Zone(thresholds["d_r"], "$d_r$", "full repulsion", style.ALARM),
    ]


def status_spans(log: RolloutLog) -> dict[Status, list[tuple[float, float]]]:
    """Per status that occurs, by severity: stretches of time as (begin, length) [s]."""
    edges = np.concatenate([[0], np.flatnonzero(np.diff(log.status)) + 1, [log.cycles]])
    times = np.append(log.time, time_span(log)[1])
    spans: dict[Status, list[tuple[float, float]]] = {}
    for first, after in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        begin, end = float(times[first]), float(times[after])
        spans.setdefault(Status(int(log.status[first])), []).append((begin, end - begin))
    return dict(sorted(spans.items()))


def with_pedestal(model: RobotModel) -> RobotModel:
    """The arm as it is drawn: with a column from the floor to the first joint, which no capsule covers."""
    foot = np.zeros(3)
    first = np.array(model.pin_model.jointPlacements[1].translation)
    if float(np.linalg.norm(first)) < 0.05:
        return model
    radius = 0.9 * min(capsule.radius for capsule in model.capsules)
    pedestal = CapsuleModel("pedestal", 0, foot, first, radius, radius)
    return replace(model, capsules=(pedestal, *model.capsules))
