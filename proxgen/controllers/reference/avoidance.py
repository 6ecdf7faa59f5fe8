"""From readings to rows: obstacle points, nearest points, the laws (12)(13), the rows (4)(5) and (6)(7)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from proxgen.controllers.protocol import OFF, Array, Measurement
from proxgen.controllers.reference.kinematics import Arm
from proxgen.controllers.reference.parameters import Parameters
from proxgen.model.robot_model import RobotModel, SensorModule

SAME_DISTANCE = 1e-9
"""Distances that differ by no more are equal, to each other and to a threshold [m]."""

NO_DIRECTION = 1e-6
"""An obstacle point nearer than this to a capsule's axis has no direction to leave it [m]."""

SMALLEST_ROW = 1e-6
"""A row with a smaller norm cannot be served by any joint and is off."""

NEAREST_WEIGHTED = 1e-3
"""Least distance in the weights (6), so that they stay finite [m]."""


class SensorPoints:
    """Step 2: the obstacle points that the skin sees."""

    def __init__(self, model: RobotModel) -> None:
        """Collect the sensors' places, once."""
        switches = model.capacitive_modules
        self._tof = _Places(model.tof_modules)
        self._capacitive = _Places(switches)
        self._virtual = np.array(
            [module.capacitive.virtual_distance for module in switches if module.capacitive]
        )
        self.tof_limit = np.array([module.tof.range for module in model.tof_modules if module.tof])
        """(S,) greatest reading of each range sensor [m]; such a reading means that nothing was seen."""

    def see(self, arm: Arm, measurement: Measurement) -> Array:
        """All obstacle points in the order of docs/method.md, (P, 3), world [m]."""
        readings = np.asarray(measurement.tof_range, dtype=float)
        seen = np.flatnonzero(readings < self.tof_limit)
        closed = np.flatnonzero(measurement.capacitive)
        return np.concatenate(
            (
                self._tof.points(arm, seen, readings[seen]),
                self._capacitive.points(arm, closed, self._virtual[closed]),
                np.reshape(np.asarray(measurement.points, dtype=float), (-1, 3)),
            )
        )


class _Places:
    """Where sensors sit and look, in their bodies' frames."""

    def __init__(self, modules: Sequence[SensorModule]) -> None:
        self.body = np.array([module.body for module in modules], dtype=int)
        self.position = np.array([module.position for module in modules]).reshape(-1, 3)
        self.normal = np.array([module.normal for module in modules]).reshape(-1, 3)

    def points(self, arm: Arm, which: NDArray[np.intp], reach: Array) -> Array:
        """Points h = o + r n (K, 3) in the world, of the sensors `which` (K,) at distances `reach` (K,)."""
        return arm.in_world(self.body[which], self.position[which] + reach[:, None] * self.normal[which])


class Capsules:
    """The capsules of an arm as arrays, in their bodies' frames.

    Attributes:
        body: (L,) Pinocchio joint indices.
        start: (L, 3) one end of each axis [m].
        end: (L, 3) the other one [m].
        reference_radius: (L,) subtracted from the distance to the axis [m].
    """

    def __init__(self, model: RobotModel) -> None:
        """Collect them, once."""
        self.body = np.array([capsule.body for capsule in model.capsules], dtype=np.intp)
        self.start = np.array([capsule.start for capsule in model.capsules])
        self.end = np.array([capsule.end for capsule in model.capsules])
        self.reference_radius = np.array([capsule.reference_radius for capsule in model.capsules])


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


def closest_on_segments(points: Array, start: Array, end: Array) -> Array:
    """Closest points p (L, P, 3) of L segments to P points h: p = a + t (b - a).

    t = clamp((h - a)·(b - a)/‖b - a‖², 0, 1), and 0 for a sphere, a = b.

    Args:
        points: h (P, 3).
        start: a (L, 3).
        end: b (L, 3).
    """
    along = end - start
    square = (along * along).sum(axis=1)
    projected = points @ along.T - (start * along).sum(axis=1)
    t = np.minimum(np.maximum(projected / np.where(square > 0.0, square, 1.0), 0.0), 1.0)
    closest: Array = start[:, None] + t.T[:, :, None] * along[:, None]
    return closest


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
    start, end = arm.in_world(capsules.body, capsules.start), arm.in_world(capsules.body, capsules.end)
    on_axis = closest_on_segments(points, start, end)
    offset = points - on_axis
    length = np.sqrt((offset * offset).sum(axis=2))
    reach = influence + capsules.reference_radius
    slots = np.arange(count)
    nearest = np.array([_first_of_nearest(length[slot], reach[slot]) for slot in slots])
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


def _first_of_nearest(length: Array, reach: float) -> int:
    """Index of the point that is kept of points at distances (P,), offered one after the other."""
    within = np.where(length <= reach, length, np.inf)
    kept = 0
    for index in np.flatnonzero(within < np.minimum.accumulate(np.append(np.inf, within[:-1]))).tolist():
        if within[index] < within[kept] - SAME_DISTANCE:
            kept = index
    return kept


def approach_law(d: float, p: Parameters) -> float:
    """ẋ_a(d) of (12)(13) [m/s]: approach above d_0u, dead zone to d_0l, repulsion that is full at d_r."""
    if d > p.d_0u:
        return p.approach_speed * (d - p.d_0u) / (p.d_a - p.d_0u)
    if d > p.d_0l:
        return 0.0
    if d > p.d_r:
        return p.repulse_speed * (p.d_0l - d) / (p.d_0l - p.d_r)
    return p.repulse_speed


def damper_law(d: float, p: Parameters) -> float:
    """ẋ_a(d) of the damper schedule [m/s]: one line through d_s, another slope below it, bounded by v_r."""
    if d > p.damper_safety:
        return p.approach_speed * (d - p.damper_safety) / (p.damper_influence - p.damper_safety)
    return max(p.damper_repulse_speed, p.damper_gain * (d - p.damper_safety))


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
    """Step 4: one slot per capsule, then the active row if there is one; R in all.

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
    law = approach_law if schedule == "paper" else damper_law
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
