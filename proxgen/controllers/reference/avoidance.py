"""From obstacle points to rows: nearest points, the laws (12)(13), the rows (4)(5) and (6)(7)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from proxgen.controllers.protocol import OFF, Array
from proxgen.controllers.reference.geometry import (
    NO_DIRECTION,
    SAME_DISTANCE,
    Capsules,
    closest_on_segments,
    first_of_nearest,
)
from proxgen.controllers.reference.kinematics import Arm
from proxgen.controllers.reference.parameters import Parameters

SMALLEST_ROW = 1e-6
"""A row with a smaller norm cannot be served by any joint and is off."""

NEAREST_WEIGHTED = 1e-3
"""Least distance in the weights (6), so that they stay finite [m]."""


@dataclass(frozen=True)
class Nearest:
    """Step 3: the nearest obstacle point of each capsule within d_influence.

    Attributes:
        distance: (L,) in the chosen reference [m]; inf where there is none.
        obstacle: (L, 3) the obstacle point h [m]; nan where there is none.
        closest: (L, 3) the point p of the capsule's axis [m]; nan where there is none.
        direction: (L, 3) d̂ from p to h; nan where there is none.
        inside: an obstacle point lies on an axis, so that there is no direction.
    """

    distance: Array
    obstacle: Array
    closest: Array
    direction: Array
    inside: bool


def nearest_points(arm: Arm, capsules: Capsules, points: Array, influence: float) -> Nearest:
    """The nearest of the obstacle points (P, 3) for each capsule; of points that are equally near the first.

    Args:
        arm: at its present position.
        capsules: L capsules.
        points: obstacle points, world [m].
        influence: d_influence, beyond which a point does not count [m].
    """
    count = len(capsules.body)
    if not len(points):
        nowhere = np.full((count, 3), np.nan)
        return Nearest(np.full(count, np.inf), nowhere, nowhere, nowhere, False)
    on_axis = closest_on_segments(points, *capsules.place(arm))
    offset = points - on_axis
    length = np.sqrt((offset * offset).sum(axis=2))
    reach = influence + capsules.reference_radius
    slots = np.arange(count)
    nearest = np.array([first_of_nearest(length[slot], reach[slot]) for slot in slots])
    least = length[slots, nearest]
    distance = least - capsules.reference_radius
    there = (least <= reach)[:, None]
    direction = offset[slots, nearest] / np.maximum(least, NO_DIRECTION)[:, None]
    return Nearest(
        distance=np.where(there[:, 0], distance, np.inf),
        obstacle=np.where(there, points[nearest], np.nan),
        closest=np.where(there, on_axis[slots, nearest], np.nan),
        direction=np.where(there, direction, np.nan),
        inside=bool((there[:, 0] & (least < NO_DIRECTION)).any()),
    )


def approach_speed(d: float, distances: tuple[float, float, float, float], p: Parameters) -> float:
    """ẋ_a(d) of (12)(13) [m/s]: approach above d_0u, dead zone to d_0l, repulsion that is full at d_r.

    Args:
        d: distance [m].
        distances: d_a, d_0u, d_0l, d_r [m].
        p: the two speeds.
    """
    d_a, d_0u, d_0l, d_r = distances
    if d > d_0u:
        return p.approach_speed * (d - d_0u) / (d_a - d_0u)
    if d > d_0l:
        return 0.0
    if d > d_r:
        return p.repulse_speed * (d_0l - d) / (d_0l - d_r)
    return p.repulse_speed


def approach_law(d: float, p: Parameters) -> float:
    """ẋ_a(d) of (12)(13) [m/s] with the thresholds (17)."""
    return approach_speed(d, (p.d_a, p.d_0u, p.d_0l, p.d_r), p)


def damper_law(d: float, p: Parameters) -> float:
    """ẋ_a(d) of the damper schedule [m/s]: one line through d_s, another slope below it, bounded by v_r."""
    if d > p.damper_safety:
        return p.approach_speed * (d - p.damper_safety) / (p.damper_influence - p.damper_safety)
    return max(p.damper_repulse_speed, p.damper_gain * (d - p.damper_safety))


LAWS = {"paper": approach_law, "damper": damper_law}
"""The law of each schedule."""


@dataclass(frozen=True)
class Thresholds:
    """What the schedule decides, besides the law.

    Attributes:
        influence: d_influence, beyond which an obstacle point does not count [m].
        on: d_on, beyond which there is no row [m].
        distant: rows beyond are dropped first: d_0u [m].
        critical: rows beyond are dropped last: d_r [m].
    """

    influence: float
    on: float
    distant: float
    critical: float


def thresholds(schedule: str, p: Parameters) -> Thresholds:
    """Distances of the schedule `paper` or `damper`, where d_s takes the place of d_0u and of d_r.

    A distance that is equal to a threshold is not beyond it.
    """
    paper, damper = (p.d_a, p.d_0u, p.d_r), (p.damper_influence, p.damper_safety, p.damper_safety)
    on, distant, critical = (d + SAME_DISTANCE for d in (paper if schedule == "paper" else damper))
    return Thresholds(max(on, p.d_active + SAME_DISTANCE), on, distant, critical)


@dataclass(frozen=True)
class Rows:
    """Step 4: one slot per capsule, then the active row if there is one, then the additions' rows; R in all.

    Attributes:
        A: (R, n); zeros where off.
        b: (R,) [m/s]; OFF where off.
        on: (R,) bool.
        approach_speed: (L,) the law at each distance [m/s]; inf where there is no obstacle point.
    """

    A: Array
    b: Array
    on: NDArray[np.bool_]
    approach_speed: Array


def rows(arm: Arm, capsules: Capsules, nearest: Nearest, schedule: str, active: bool, p: Parameters) -> Rows:
    """The rows (4)(5) of all capsules, and the active row (6)(7).

    Args:
        arm: at its present position.
        capsules: L capsules.
        nearest: their nearest obstacle points.
        schedule: `paper` or `damper`.
        active: whether the active row exists.
        p: distances and speeds.
    """
    law = LAWS[schedule]
    begin = thresholds(schedule, p).on
    count = len(capsules.body)
    candidates = np.zeros((count, arm.n))
    A, b = np.zeros((count + active, arm.n)), np.full(count + active, OFF)
    speeds = np.full(count, np.inf)
    for slot in np.flatnonzero(np.isfinite(nearest.distance)).tolist():
        distance = float(nearest.distance[slot])
        row = nearest.direction[slot] @ arm.point_jacobian(int(capsules.body[slot]), nearest.closest[slot])
        speeds[slot] = law(distance, p)
        candidates[slot] = row
        norm = float(np.linalg.norm(row))
        if distance <= begin and norm >= SMALLEST_ROW:
            A[slot], b[slot] = row, max(speeds[slot], -p.row_speed * norm)
    if active:
        J_c = active_row(candidates, nearest.distance, p.d_active)
        if np.linalg.norm(J_c) >= SMALLEST_ROW:
            A[count], b[count] = J_c, 0.0
    return Rows(A, b, b < OFF, speeds)


def active_row(candidates: Array, distance: Array, d_active: float) -> Array:
    """J_c = Σ w_k d̂_kᵀ J_pk (n,) of (6)(7), the negative gradient of the weighted sum of distances.

    w_k = (1/δ_k)/Σ(1/δ) over the capsules whose distance is at most d_active; zeros if there is none.

    Args:
        candidates: (L, n) rows d̂ᵀJ_p, also of slots that are off.
        distance: (L,) [m]; inf where there is no obstacle point.
        d_active: [m].
    """
    near = distance <= d_active + SAME_DISTANCE
    if not near.any():
        return np.zeros(candidates.shape[1])
    weights = 1.0 / np.maximum(distance[near], NEAREST_WEIGHTED)
    J_c: Array = (weights / weights.sum()) @ candidates[near]
    return J_c
