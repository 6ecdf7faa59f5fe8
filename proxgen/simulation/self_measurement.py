"""Which readings show the arm itself: what the skin's electronics work out from joint positions and capsules.

The arm's own capsules, made thicker by a margin, are compared with what was read; a reading that they explain
is discarded. The margin covers noise and the difference between capsules and links.
"""

import numpy as np
from numpy.typing import NDArray

from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.geometry import dot, norm, point_to_capsule, ray_to_capsule

Array = NDArray[np.float64]

MARGIN = 0.03
"""By how much capsules are made thicker [m]."""


class SelfMeasurement:
    """Tells readings of the arm itself from readings of obstacles.

    A sensor never sees the body that carries it, and anything behind another link is hidden by that link.
    """

    def __init__(self, arm: ArmGeometry, margin: float = MARGIN) -> None:
        """Expect the capsules of `arm`, thicker by `margin` [m]."""
        self._arm = arm
        self._radius = arm.radius + margin

    def of_ranges(
        self, poses: Array, origins: Array, directions: Array, carriers: NDArray[np.intp], readings: Array
    ) -> NDArray[np.bool_]:
        """Which range readings the arm itself explains.

        Args:
            poses: of the bodies when the reading was taken, (B, 4, 4).
            origins: of each sensor's rays, (K, R, 3), world [m].
            directions: of the rays, (K, R, 3), unit vectors.
            carriers: (K,) body that carries each sensor.
            readings: (K,) [m].

        Returns:
            (K,) True where some ray meets a thicker capsule no further than the reading.
        """
        starts, ends = self._arm.axes(poses)
        distance = ray_to_capsule(origins[:, :, None], directions[:, :, None], starts, ends, self._radius)
        distance[np.broadcast_to(self._carried(carriers)[:, None], distance.shape)] = np.inf
        return np.asarray(distance.min(axis=(1, 2)) <= readings)

    def of_switches(
        self,
        poses: Array,
        positions: Array,
        normals: Array,
        carriers: NDArray[np.intp],
        trigger: Array,
        cosine: Array,
    ) -> NDArray[np.bool_]:
        """Which switches the arm itself may close.

        Args:
            poses: of the bodies when the sample was taken, (B, 4, 4).
            positions: of the switches, (K, 3), world [m].
            normals: (K, 3), unit vectors.
            carriers: (K,) body that carries each switch.
            trigger: (K, 1) distance at which it closes [m].
            cosine: (K, 1) of half its cone.

        Returns:
            (K,) True where the nearest point of a thicker capsule is within trigger distance and cone.
        """
        starts, ends = self._arm.axes(poses)
        near = point_to_capsule(positions[:, None], starts, ends, self._radius)
        offset = near.point - positions[:, None]
        length = norm(offset)
        sees = (length <= trigger) & (dot(offset, normals[:, None]) >= cosine * length)
        return np.asarray((sees & ~self._carried(carriers)).any(axis=1))

    def _carried(self, carriers: NDArray[np.intp]) -> NDArray[np.bool_]:
        """(K, L) True where the capsule is part of the body that carries the sensor."""
        return np.asarray(carriers[:, None] == self._arm.body[None])
