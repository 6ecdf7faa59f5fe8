"""What solids look like in a drawing: outlines of boxes, spheres and capsules along an axis, or in space.

Outlines are exact for boxes (hull of the corners) and polygons of many sides for round solids. All in metres.
"""

import numpy as np
from numpy.typing import NDArray

from proxgen.simulation.obstacles import Obstacle

Array = NDArray[np.float64]

_SIDES = 48
_CIRCLE = np.stack(
    [
        np.cos(np.linspace(0, 2 * np.pi, _SIDES, endpoint=False)),
        np.sin(np.linspace(0, 2 * np.pi, _SIDES, endpoint=False)),
    ],
    axis=1,
)
_BOX_FACES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
_CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


def convex_hull(points: Array) -> Array:
    """Corners of the convex hull of points (K, 2), counter-clockwise, (H, 2)."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    if len(ordered) < 3:
        return np.array(ordered)
    lower, upper = _half_hull(ordered), _half_hull(ordered[::-1])
    return np.array(lower[:-1] + upper[:-1])


def _half_hull(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Andrew's monotone chain over sorted points: the corners below them."""
    chain: list[tuple[float, float]] = []
    for x, y in points:
        while len(chain) >= 2:
            (ax, ay), (bx, by) = chain[-2], chain[-1]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                break
            chain.pop()
        chain.append((x, y))
    return chain


def capsule_outline(start: Array, end: Array, radius: float) -> Array:
    """Outline of a capsule whose axis ends are (2,) in the drawing plane, (H, 2)."""
    return convex_hull(np.concatenate([start + radius * _CIRCLE, end + radius * _CIRCLE]))


def box_corners(obstacle: Obstacle, centre: Array) -> Array:
    """The eight corners of a box in the world, (8, 3)."""
    corners: Array = centre + (_CORNERS * obstacle.half_size) @ obstacle.rotation.T
    return corners


def box_faces(obstacle: Obstacle, centre: Array) -> list[Array]:
    """The six faces of a box in the world, each (4, 3)."""
    corners = box_corners(obstacle, centre)
    return [corners[list(face)] for face in _BOX_FACES]


def obstacle_outline(obstacle: Obstacle, centre: Array, axes: tuple[int, int]) -> Array:
    """Outline of an obstacle at a centre (3,), seen along the axis that is not in `axes`, (H, 2)."""
    plane = list(axes)
    if obstacle.shape == "box":
        return convex_hull(box_corners(obstacle, centre)[:, plane])
    half_axis = 0.5 * obstacle.length * obstacle.rotation[:, 2]
    return capsule_outline((centre - half_axis)[plane], (centre + half_axis)[plane], obstacle.radius)


def round_surface(obstacle: Obstacle, centre: Array) -> tuple[Array, Array, Array]:
    """Grids x, y, z of the surface of a sphere or capsule in the world, for a drawing in space."""
    turn, rise = np.meshgrid(np.linspace(0, 2 * np.pi, 25), np.linspace(-np.pi / 2, np.pi / 2, 14))
    unit = np.stack([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)], axis=-1)
    local = obstacle.radius * unit
    local[..., 2] += 0.5 * obstacle.length * np.sign(rise)
    world = local @ obstacle.rotation.T + centre
    return world[..., 0], world[..., 1], world[..., 2]
