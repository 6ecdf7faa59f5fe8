"""From sensors and distances to rows, as expressions: (4), (5), (12), (13), slack weights."""

from typing import Any

import casadi as ca


def sensor_point(body_to_world: Any, position: Any, normal: Any, distance: Any) -> Any:
    """Obstacle point h = o + r n in the world (3, 1), for a sensor at `position` looking along `normal`.

    Args:
        body_to_world: SX (3, 4), [R | t].
        position: SX (3, 1), body frame [m].
        normal: SX (3, 1), body frame, unit.
        distance: range reading or virtual distance [m].
    """
    return ca.mtimes(body_to_world[:, :3], position + distance * normal) + body_to_world[:, 3]


def closest_point(point: Any, start: Any, end: Any) -> Any:
    """Point of the segment from `start` to `end` nearest to `point`, (3, 1); `start` if they are the same."""
    along = end - start
    length_squared = ca.fmax(ca.dot(along, along), 1e-300)
    parameter = ca.fmin(ca.fmax(ca.dot(point - start, along) / length_squared, 0), 1)
    return start + parameter * along


def approach_speed(
    distance: Any, d_a: Any, d_0u: Any, d_0l: Any, d_r: Any, approach: Any, repulse: Any
) -> Any:
    """Greatest approach speed ẋ_a [m/s] of the law (13), linear between its four thresholds (12)."""
    towards = approach * ca.fmax(distance - d_0u, 0) / (d_a - d_0u)
    away = repulse * ca.fmin(ca.fmax(d_0l - distance, 0) / (d_0l - d_r), 1)
    return towards + away


def damper_speed(distance: Any, influence: Any, safety: Any, approach: Any, gain: Any, repulse: Any) -> Any:
    """Greatest approach speed ẋ_a [m/s] of the damper schedule: one line above, one below d_s."""
    above = approach * ca.fmax(distance - safety, 0) / (influence - safety)
    below = ca.fmax(repulse, gain * ca.fmin(distance - safety, 0))
    return above + below


def slack_weight(distance: Any, d_a: Any, d_r: Any, weight: Any, minimum: Any, maximum: Any) -> Any:
    """ρ = weight · clip((d_a − d)/(d_a − d_r), minimum, maximum)²."""
    return weight * ca.fmin(ca.fmax((d_a - distance) / (d_a - d_r), minimum), maximum) ** 2
