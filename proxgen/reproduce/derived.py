"""Numbers that the paper's sentences are about, beside those of `RolloutLog.summary`."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from proxgen.config.schema import Config
from proxgen.simulation.log import RolloutLog

Array = NDArray[np.float64]

LAST = 10.0
"""How much of the end of a run decides whether the arm is stuck [s]."""


def derived_numbers(log: RolloutLog, config: Config) -> dict[str, Any]:
    """What is computed from a log, JSON types only.

    Args:
        log: of one run.
        config: of the robot that ran.

    Returns:
        time_below_d0l_fraction: of the cycles with some link nearer than d_0l.
        link_below_dr_fraction: the same with d_r, link by link, by the capsule's name.
        start_manipulability: w of (14) in the first cycle.
        escape_time_s: until the manipulability (14) is first at least w_0; the whole duration if never.
        mean_abs_dqdot_seen, mean_abs_dqdot_clear: change of the command per cycle while some link has an
            obstacle within d_a, and while none has [rad/s]; null if that never was.
        mean_abs_dqdot_switching, mean_abs_dqdot_steady: the same in cycles in which an obstacle comes within
            d_a of some link, or leaves it, as far as the arm knows, and in all others [rad/s].
        sudden_obstacles: how often an obstacle is first seen nearer than d_0u, though nothing was within d_a
            of that link in the cycle before.
        path_per_straight: length of the tool's path from the first target reached to the last one, in units
            of the straight way; null if there are not two.
        deflection_m: greatest distance of the tool from the straight line between the targets, after the
            first one is reached [m]; null if none is.
        passes_between: how often the tool crosses between two boxes one above the other.
        last_motion_m: length of the tool's path in the last 10 s [m].
        mean_abs_joint_jump: mean change of a joint's mean velocity from cycle to cycle [rad/s]: what the arm
            does, not what it is told.
        mean_cycle_us: mean time of one `controller.step` [us].
    """
    thresholds = log.meta["thresholds"]
    distances = log.reference_distance()
    below = (distances < thresholds["d_r"]).mean(axis=0)
    capsules = log.meta["capsule_names"]
    change, known = np.abs(log.dqdot()).mean(axis=1), log.controller_distance <= thresholds["d_a"]
    switching = np.diff(known, axis=0, prepend=False).any(axis=1)
    return {
        "time_below_d0l_fraction": float((distances < thresholds["d_0l"]).any(axis=1).mean()),
        "link_below_dr_fraction": dict(zip(capsules, below.tolist(), strict=True)),
        "start_manipulability": float(log.manipulability[0]),
        "escape_time_s": _escape_time(log, config.damping.threshold),
        "mean_abs_dqdot_seen": _mean_of(change, known.any(axis=1)),
        "mean_abs_dqdot_clear": _mean_of(change, ~known.any(axis=1)),
        "mean_abs_dqdot_switching": _mean_of(change, switching),
        "mean_abs_dqdot_steady": _mean_of(change, ~switching),
        "sudden_obstacles": _sudden(log.controller_distance, thresholds["d_a"], thresholds["d_0u"]),
        "path_per_straight": _path_per_straight(log),
        "deflection_m": _deflection(log),
        "passes_between": _passes_between(log),
        "last_motion_m": _length(log.tool_position[-max(round(LAST / log.meta["period"]), 2) :]),
        "mean_abs_joint_jump": _joint_jump(log),
        "mean_cycle_us": float(log.cycle_us.mean()),
    }


def _mean_of(values: Array, chosen: NDArray[np.bool_]) -> float | None:
    """Mean of the chosen values; None if there is none."""
    return float(values[chosen].mean()) if chosen.any() else None


def _escape_time(log: RolloutLog, threshold: float) -> float:
    """Time at which the arm first is regular."""
    regular = np.flatnonzero(log.manipulability >= threshold)
    return float(log.time[regular[0]]) if regular.size else log.cycles * float(log.meta["period"])


def _sudden(seen: Array, far: float, near: float) -> int:
    """Steps of one cycle from nothing within `far` to something within `near`, over all links."""
    before, after = seen[:-1], seen[1:]
    return int(((before > far) & (after < near)).sum())


def _path_per_straight(log: RolloutLog) -> float | None:
    """Length of the tool's path per straight way, between the first and the last target reached."""
    reached = np.flatnonzero(np.diff(log.targets_reached)) + 1
    if len(reached) < 2:
        return None
    ways = log.target_position[reached[:-1]] - log.tool_position[reached[:-1]]
    return _length(log.tool_position[reached[0] : reached[-1] + 1]) / float(_norm(ways).sum())


def _deflection(log: RolloutLog) -> float | None:
    """Greatest distance from the line through the first two targets, once one of them is reached."""
    targets, path = np.array(log.meta["targets"]), log.tool_position[log.targets_reached > 0]
    if len(targets) < 2 or not len(path):
        return None
    along = (targets[1] - targets[0]) / _norm(targets[1] - targets[0])
    offset = path - targets[0]
    return float(_norm(offset - np.outer(offset @ along, along)).max())


def _passes_between(log: RolloutLog) -> int:
    """Crossings of the middle plane of two boxes, one above the other, in the space between them."""
    boxes = [obstacle for obstacle in log.meta["obstacles"] if obstacle["shape"] == "box"]
    if len(boxes) != 2:
        return 0
    lower, upper = sorted(boxes, key=lambda box: box["position"][2])
    x, plane, _ = lower["position"]
    low = lower["position"][2] + lower["half_size"][2]
    high = upper["position"][2] - upper["half_size"][2]
    path = log.tool_position
    side = path[:, 1] >= plane
    crossing = np.flatnonzero(side[1:] != side[:-1]) + 1
    between = (np.abs(path[:, 0] - x) <= lower["half_size"][0]) & (path[:, 2] > low) & (path[:, 2] < high)
    return int(between[crossing].sum())


def _joint_jump(log: RolloutLog) -> float:
    """Mean second difference of the joint positions, as a change of velocity."""
    if log.cycles < 3:
        return 0.0
    return float(np.abs(np.diff(log.q, n=2, axis=0)).mean() / log.meta["period"])


def _length(path: Array) -> float:
    """Length of a polygon (T, 3)."""
    return float(_norm(np.diff(path, axis=0)).sum())


def _norm(vectors: Array) -> Array:
    """Lengths of vectors along the last axis."""
    return np.asarray(np.linalg.norm(vectors, axis=-1))
