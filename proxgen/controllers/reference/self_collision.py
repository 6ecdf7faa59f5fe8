"""Self-collision: points that the arm carries are obstacles for its other links (docs/method.md)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from proxgen.controllers.protocol import OFF, Array
from proxgen.controllers.reference.avoidance import SMALLEST_ROW, approach_speed
from proxgen.controllers.reference.geometry import (
    NO_DIRECTION,
    SAME_DISTANCE,
    Capsules,
    closest_on_segments,
    first_within,
)
from proxgen.controllers.reference.kinematics import Arm
from proxgen.controllers.reference.parameters import Parameters
from proxgen.model.robot_model import RobotModel


@dataclass(frozen=True)
class NearestSelf:
    """The nearest self-collision point of each capsule within self_d_a.

    Attributes:
        distance: (L,) between the surfaces [m]; inf where there is none.
        closest: (L, 3) the point p of the capsule's axis [m].
        point: (L, 3) the point h [m].
        direction: (L, 3) d̂ from p to h.
        carrier: (L,) body that carries h.
        inside: such a point lies on an axis, so that there is no direction.
    """

    distance: Array
    closest: Array
    point: Array
    direction: Array
    carrier: NDArray[np.intp]
    inside: bool


class SelfPoints:
    """The points of self-collision."""

    def __init__(self, model: RobotModel) -> None:
        """Collect them, once; there is at least one."""
        points = model.self_points
        self._body = np.array([point.body for point in points], dtype=np.intp)
        self._position = np.array([point.position for point in points])
        self._radius = np.array([point.radius for point in points])
        self._paired = np.array([point.capsules for point in points]).T

    def nearest(self, arm: Arm, capsules: Capsules, reach: float) -> NearestSelf:
        """For each of the L capsules the nearest of the points that are paired with it, the first of equals.

        Args:
            arm: at its present position.
            capsules: its capsules.
            reach: self_d_a, beyond which a point does not count [m].
        """
        points = arm.in_world(self._body, self._position)
        on_axis = closest_on_segments(points, *capsules.place(arm))
        offset = points - on_axis
        length = np.sqrt((offset * offset).sum(axis=2))
        distance = np.where(self._paired, length - capsules.radius[:, None] - self._radius, np.inf)
        found = [first_within(row, reach) for row in distance]
        kept = np.array([0 if index is None else index for index in found])
        there, slots = np.array([index is not None for index in found]), np.arange(len(found))
        least = length[slots, kept]
        return NearestSelf(
            distance=np.where(there, distance[slots, kept], np.inf),
            closest=on_axis[slots, kept],
            point=points[kept],
            direction=offset[slots, kept] / np.maximum(least, NO_DIRECTION)[:, None],
            carrier=self._body[kept],
            inside=bool((there & (least < NO_DIRECTION)).any()),
        )


def self_rows(arm: Arm, capsules: Capsules, near_self: NearestSelf, p: Parameters) -> tuple[Array, Array]:
    """Rows d̂ᵀ(J_p - J_h) q̇ ≤ b, one slot per capsule.

    Args:
        arm: at its present position.
        capsules: L capsules.
        near_self: their nearest self-collision points.
        p: distances and speeds.

    Returns:
        A (L, n), zeros where off, and b (L,), OFF where off [m/s].
    """
    A, b = np.zeros((len(near_self.distance), arm.n)), np.full(len(near_self.distance), OFF)
    for slot in np.flatnonzero(np.isfinite(near_self.distance)).tolist():
        link = arm.point_jacobian(int(capsules.body[slot]), near_self.closest[slot])
        carried = arm.point_jacobian(int(near_self.carrier[slot]), near_self.point[slot])
        row = near_self.direction[slot] @ (link - carried)
        norm = float(np.linalg.norm(row))
        if norm >= SMALLEST_ROW:
            A[slot], b[slot] = row, max(self_speed(float(near_self.distance[slot]), p), -p.row_speed * norm)
    return A, b


def self_speed(d: float, p: Parameters) -> float:
    """Law (13) with the thresholds of self-collision [m/s]."""
    return approach_speed(d, (p.self_d_a, p.self_d_0u, p.self_d_0l, p.self_d_r), p)


def self_limits(p: Parameters) -> tuple[float, float]:
    """Distances beyond which a self-collision row is distant, and not critical [m]."""
    return p.self_d_0u + SAME_DISTANCE, p.self_d_r + SAME_DISTANCE
