"""Where capsules are, how far points are from them, and which distance is the least."""

import numpy as np

from proxgen.controllers.protocol import Array
from proxgen.controllers.reference.kinematics import Arm
from proxgen.model.robot_model import RobotModel

SAME_DISTANCE = 1e-9
"""Distances that differ by no more are equal, to each other and to a threshold [m]."""

NO_DIRECTION = 1e-6
"""An obstacle point nearer than this to a capsule's axis has no direction to leave it [m]."""


class Capsules:
    """The capsules of an arm as arrays, in their bodies' frames.

    Attributes:
        body: (L,) Pinocchio joint indices.
        start: (L, 3) one end of each axis [m].
        end: (L, 3) the other one [m].
        radius: (L,) [m].
        reference_radius: (L,) subtracted from the distance to the axis [m].
    """

    def __init__(self, model: RobotModel) -> None:
        """Collect them, once."""
        self.body = np.array([capsule.body for capsule in model.capsules], dtype=np.intp)
        self.start = np.array([capsule.start for capsule in model.capsules])
        self.end = np.array([capsule.end for capsule in model.capsules])
        self.radius = np.array([capsule.radius for capsule in model.capsules])
        self.reference_radius = np.array([capsule.reference_radius for capsule in model.capsules])

    def place(self, arm: Arm) -> tuple[Array, Array]:
        """Start and end (L, 3) of every axis in the world [m]."""
        return arm.in_world(self.body, self.start), arm.in_world(self.body, self.end)

    def surface_distance(self, arm: Arm, points: Array) -> Array:
        """Distances (L, P) of points (P, 3) in the world from the capsules' surfaces; negative inside [m]."""
        offset = points - closest_on_segments(points, *self.place(arm))
        distance: Array = np.sqrt((offset * offset).sum(axis=2)) - self.radius[:, None]
        return distance


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


def first_of_nearest(length: Array, reach: float) -> int:
    """Index of the point that is kept of points at distances (P,), offered one after the other."""
    within = np.where(length <= reach, length, np.inf)
    kept = 0
    for index in np.flatnonzero(within < np.minimum.accumulate(np.append(np.inf, within[:-1]))).tolist():
        if within[index] < within[kept] - SAME_DISTANCE:
            kept = index
    return kept


def first_within(distance: Array, limit: float) -> int | None:
    """Index of the nearest of distances (K,) that is at most `limit`, the first of equals; None: none is."""
    reach = limit + SAME_DISTANCE
    kept = first_of_nearest(distance, reach) if len(distance) else 0
    return kept if len(distance) and distance[kept] <= reach else None
