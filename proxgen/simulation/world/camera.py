"""A pinhole camera: where it stands, what it sees where, and what lies behind something."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NEAR, FAR = 0.05, 20.0
"""Nothing nearer or farther than this is seen [m]."""


@dataclass(frozen=True)
class Camera:
    """Where a picture is taken from.

    Attributes:
        target: the point in the middle of the picture [m].
        distance: from the target [m].
        yaw: about z, 0 looks along y [deg].
        pitch: negative looks down [deg].
        width: [pixels].
        height: [pixels].
        field_of_view: vertical [deg].
    """

    target: tuple[float, float, float] = (0.3, 0.0, 0.45)
    distance: float = 1.9
    yaw: float = 62.0
    pitch: float = -16.0
    width: int = 640
    height: int = 480
    field_of_view: float = 45.0

    @property
    def axes(self) -> Array:
        """Unit vectors to the right, up and forward, as rows (3, 3), world."""
        yaw, pitch = np.radians(self.yaw), np.radians(self.pitch)
        forward = np.array([-np.sin(yaw) * np.cos(pitch), np.cos(yaw) * np.cos(pitch), np.sin(pitch)])
        right = np.array([np.cos(yaw), np.sin(yaw), 0.0])
        return np.stack([right, np.cross(right, forward), forward])

    @property
    def focal_length(self) -> float:
        """How many pixels a metre takes at a distance of one metre."""
        return float(0.5 * self.height / np.tan(0.5 * np.radians(self.field_of_view)))

    def project(self, points: Array) -> tuple[Array, Array]:
        """Where points (K, 3) of the world appear.

        Returns:
            Pixels (K, 2) to the right and down from the upper left corner, and depths (K,) along the line of
            sight [m].
        """
        local = (points - np.array(self.target)) @ self.axes.T
        depth = local[:, 2] + self.distance
        middle = 0.5 * np.array([self.width, self.height])
        return middle + self.focal_length * local[:, :2] / depth[:, None] * [1.0, -1.0], depth

    def fitted(self, points: Array, margin: float = 0.07) -> Self:
        """The same view from where points (K, 3) fill the picture, but for a margin (part of its size)."""
        local = (points - np.array(self.target)) @ self.axes.T
        half = (0.5 - margin) * np.array([self.width, self.height]) / self.focal_length
        centre = 0.5 * (local.min(axis=0) + local.max(axis=0))
        # A shift sideways changes which points decide, as near ones look larger: a few rounds settle it.
        for _ in range(60):
            offset = local - centre
            distance = float((np.abs(offset[:, :2]) / half - offset[:, 2:]).max())
            depth = offset[:, 2:] + distance
            seen = offset[:, :2] / depth
            centre[:2] += 0.5 * (seen.min(axis=0) + seen.max(axis=0)) * depth.min()
        middle = np.array(self.target) + centre @ self.axes
        return replace(self, target=(float(middle[0]), float(middle[1]), float(middle[2])), distance=distance)

    def enlarged(self, factor: float) -> Self:
        """The same picture with more pixels."""
        return replace(self, width=round(self.width * factor), height=round(self.height * factor))


@dataclass(frozen=True)
class Shot:
    """A picture that knows how far away everything in it is.

    Attributes:
        pixels: (height, width, 3) RGB.
        depth: (height, width) along the line of sight [m].
        camera: it was taken with.
    """

    pixels: NDArray[np.uint8]
    depth: Array
    camera: Camera

    def hidden(self, points: Array, tolerance: float = 0.01) -> NDArray[np.bool_]:
        """(K,) whether points (K, 3) of the world lie behind something by more than the tolerance [m]."""
        places, depth = self.camera.project(points)
        column, row = np.floor(places).astype(int).T
        inside = (row >= 0) & (row < self.camera.height) & (column >= 0) & (column < self.camera.width)
        before = np.full(len(points), np.inf)
        before[inside] = self.depth[row[inside], column[inside]]
        return np.asarray(depth > before + tolerance)
