"""Meshes of round solids: pybullet's own are drawn with a dozen sides."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SIDES = 40
_RINGS = 10


@dataclass(frozen=True)
class Mesh:
    """Triangles with a normal at every corner, which makes them look smooth.

    Attributes:
        vertices: (K, 3) [m].
        normals: (K, 3).
        triangles: (F, 3) numbers of vertices, counter-clockwise from outside.
    """

    vertices: Array
    normals: Array
    triangles: NDArray[np.int64]


def round_mesh(radius: float, length: float) -> Mesh:
    """A capsule whose axis is the z axis, `length` long without its caps; a sphere if that is 0 [m]."""
    rise = np.concatenate([np.linspace(-0.5, 0.0, _RINGS), np.linspace(0.0, 0.5, _RINGS)]) * np.pi
    turn = np.linspace(0.0, 2.0 * np.pi, _SIDES, endpoint=False)
    up, around = np.meshgrid(rise, turn, indexing="ij")
    normals = np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)], axis=-1)
    vertices = radius * normals
    vertices[:_RINGS, :, 2] -= 0.5 * length
    vertices[_RINGS:, :, 2] += 0.5 * length
    return Mesh(vertices.reshape(-1, 3), normals.reshape(-1, 3), _strips(2 * _RINGS))


def disc_mesh(radius: float) -> Mesh:
    """A disc in the x-y plane that looks up [m]."""
    turn = np.linspace(0.0, 2.0 * np.pi, 4 * _SIDES, endpoint=False)
    rim = radius * np.stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)], axis=1)
    count = len(rim)
    corners = np.arange(count)
    triangles = np.stack([np.full(count, count), corners, (corners + 1) % count], axis=1)
    vertices = np.concatenate([rim, np.zeros((1, 3))])
    return Mesh(vertices, np.tile([0.0, 0.0, 1.0], (count + 1, 1)), triangles)


def _strips(rings: int) -> NDArray[np.int64]:
    """Triangles between neighbouring rings of `_SIDES` vertices."""
    ring, side = (grid.ravel() for grid in np.meshgrid(np.arange(rings - 1), np.arange(_SIDES)))
    here, right = ring * _SIDES + side, ring * _SIDES + (side + 1) % _SIDES
    first = np.stack([here, right, right + _SIDES], axis=1)
    second = np.stack([here, right + _SIDES, here + _SIDES], axis=1)
    return np.concatenate([first, second])
