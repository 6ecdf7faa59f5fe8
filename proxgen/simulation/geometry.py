"""Exact nearest points between convex solids and the points and segments of the arm.

All functions work on many pairs at once: arrays broadcast over leading dimensions, the last dimension is
x, y, z [m]. "Nearest point" is that of the obstacle as a *solid*: for a point or axis inside it, that point
itself. Signed distances are negative inside, by the depth at the deepest point.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_TINY = 1e-300
_EXCESS_ROUNDING = 1e-13
"""An excess over a box below this is rounding [m]."""


class Nearest(NamedTuple):
    """Nearest points of solids.

    Attributes:
        point: (..., 3), of the solid [m].
        distance: (...,), signed: negative inside the solid [m].
    """

    point: Array
    distance: Array


def dot(a: Array, b: Array) -> Array:
    """Scalar product over the last dimension."""
    product: Array = np.einsum("...i,...i->...", a, b)
    return product


def norm(a: Array) -> Array:
    """Length over the last dimension."""
    return np.sqrt(dot(a, a))


def along_segment(points: Array, starts: Array, ends: Array) -> Array:
    """Parameter t in [0, 1] of the point of each segment that is nearest to a given point.

    Args:
        points: (..., 3) [m].
        starts: (..., 3), t = 0 [m].
        ends: (..., 3), t = 1 [m]; a segment of length 0 is a point (t = 0).

    Returns:
        (...,) t.
    """
    direction = ends - starts
    t = dot(points - starts, direction) / np.maximum(dot(direction, direction), _TINY)
    return np.minimum(np.maximum(t, 0.0), 1.0)


def _round_solid(centres: Array, radii: Array, points: Array) -> Nearest:
    """Nearest points of balls around `centres` to `points`."""
    offset = points - centres
    length = norm(offset)
    factor = np.where(length > radii, radii / np.maximum(length, _TINY), 1.0)
    return Nearest(centres + factor[..., None] * offset, length - radii)


def point_to_sphere(points: Array, centres: Array, radii: Array) -> Nearest:
    """Nearest points of spheres of `radii` (...,) around `centres` (..., 3) to `points` (..., 3)."""
    return _round_solid(centres, radii, points)


def point_to_capsule(points: Array, starts: Array, ends: Array, radii: Array) -> Nearest:
    """Nearest points of capsules (axes from `starts` to `ends`, `radii`) to `points`."""
    t = along_segment(points, starts, ends)
    return _round_solid(starts + t[..., None] * (ends - starts), radii, points)


def point_to_box(points: Array, half_sizes: Array) -> Nearest:
    """Nearest points of boxes centred in the origin, parallel to the axes, to `points` in the box's frame."""
    excess = np.abs(points) - half_sizes
    inside = np.minimum(excess.max(axis=-1), 0.0)
    return Nearest(np.clip(points, -half_sizes, half_sizes), norm(np.maximum(excess, 0.0)) + inside)


def ray_to_capsule(origins: Array, directions: Array, starts: Array, ends: Array, radii: Array) -> Array:
    """Distance along rays to capsules: to the nearer of the open cylinder and the two end balls.

    Args:
        origins: (..., 3) [m].
        directions: (..., 3), unit vectors.
        starts: (..., 3) of the capsules' axes [m].
        ends: (..., 3) [m].
        radii: (...,) [m].

    Returns:
        (...,) distance [m]; 0 for an origin inside, inf for a miss.
    """
    axis, offset = ends - starts, origins - starts
    length = dot(axis, axis)
    along_axis, along_offset = dot(axis, directions), dot(axis, offset)
    a = length - along_axis**2
    b = length * dot(directions, offset) - along_offset * along_axis
    c = length * (dot(offset, offset) - radii**2) - along_offset**2
    discriminant = b * b - a * c
    hits = (a > 1e-12 * np.maximum(length, _TINY)) & (discriminant >= 0.0)
    root = np.sqrt(np.where(hits, discriminant, 0.0))
    cylinder = np.where(hits, (-b - root) / np.where(hits, a, 1.0), np.inf)
    height = along_offset + np.where(hits, cylinder, 0.0) * along_axis
    valid = hits & (height >= 0.0) & (height <= length) & (cylinder >= 0.0)
    distance = np.where(valid, cylinder, np.inf)
    for centres in (starts, ends):
        distance = np.minimum(distance, _ray_to_ball(origins - centres, directions, radii))
    inside: Array = np.where(point_to_capsule(origins, starts, ends, radii).distance <= 0.0, 0.0, distance)
    return inside


def _ray_to_ball(offset: Array, directions: Array, radii: Array) -> Array:
    """Distance along rays from outside to balls; `offset` is from the centre to the origin."""
    b, c = dot(offset, directions), dot(offset, offset) - radii**2
    discriminant = b * b - c
    root = np.sqrt(np.maximum(discriminant, 0.0))
    return np.where((discriminant >= 0.0) & (-b - root >= 0.0), -b - root, np.inf)


def segment_to_sphere(starts: Array, ends: Array, centres: Array, radii: Array) -> Nearest:
    """Nearest points of spheres to segments; distance from the segment to the sphere's surface."""
    t = along_segment(centres, starts, ends)
    return _round_solid(centres, radii, starts + t[..., None] * (ends - starts))


def segment_to_capsule(
    starts: Array, ends: Array, axis_starts: Array, axis_ends: Array, radii: Array
) -> Nearest:
    """Nearest points of capsules to segments; distance from the segment to the capsule's surface."""
    s, t = between_segments(starts, ends, axis_starts, axis_ends)
    own = starts + s[..., None] * (ends - starts)
    other = axis_starts + t[..., None] * (axis_ends - axis_starts)
    return _round_solid(other, radii, own)


def between_segments(
    starts: Array, ends: Array, other_starts: Array, other_ends: Array
) -> tuple[Array, Array]:
    """Parameters of the nearest points of two segments.

    The minimum is either between the interiors (the solution of a 2x2 system) or at one of the four ends;
    all five candidates are evaluated and the best is kept, which stays exact for parallel segments.

    Args:
        starts: (..., 3) of the first segment.
        ends: (..., 3).
        other_starts: (..., 3) of the second segment.
        other_ends: (..., 3).

    Returns:
        (s, t), each (...,) in [0, 1], along the first and the second segment.
    """
    u, v, w = ends - starts, other_ends - other_starts, starts - other_starts
    a, b, c, d, e = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    determinant = a * c - b * b
    safe = np.where(determinant > 1e-12 * a * c, determinant, 1.0)
    inner = determinant > 1e-12 * a * c
    s_inner = np.where(inner, np.clip((b * e - c * d) / safe, 0.0, 1.0), 0.0)
    t_inner = np.where(inner, np.clip((a * e - b * d) / safe, 0.0, 1.0), 0.0)
    zero, one = np.zeros_like(a), np.ones_like(a)
    s = np.stack(
        [
            s_inner,
            zero,
            one,
            along_segment(other_starts, starts, ends),
            along_segment(other_ends, starts, ends),
        ]
    )
    t = np.stack(
        [
            t_inner,
            along_segment(starts, other_starts, other_ends),
            along_segment(ends, other_starts, other_ends),
            zero,
            one,
        ]
    )
    gap = norm(w + s[..., None] * u - t[..., None] * v)
    best = np.argmin(gap, axis=0)[None]
    return np.take_along_axis(s, best, 0)[0], np.take_along_axis(t, best, 0)[0]


def segment_to_box(starts: Array, ends: Array, half_sizes: Array) -> Nearest:
    """Nearest points of boxes centred in the origin, parallel to the axes, to segments in the box's frame.

    Half the derivative of the squared distance along the segment, g(t) = sum_i d_i e_i(t) with e the excess
    over the box, is continuous, piecewise linear and never falls; its kinks are where the segment crosses the
    planes of the six faces. Its root between two neighbouring kinks is exact.

    Args:
        starts: (..., 3) [m].
        ends: (..., 3) [m].
        half_sizes: (..., 3) [m].

    Returns:
        Nearest points in the box's frame, and signed distances of the segments. If the minimum is attained on
        a whole stretch of the segment (parallel to a face), its middle is taken.
    """
    shape = starts.shape
    starts, ends, half_sizes = starts.reshape(-1, 3), ends.reshape(-1, 3), half_sizes.reshape(-1, 3)
    direction = ends - starts
    t = _kinks(starts, direction, half_sizes)
    lower, upper = _root(t, _half_slope(starts, direction, half_sizes, t))
    points = starts + (0.5 * (lower + upper))[:, None] * direction
    nearest = np.minimum(np.maximum(points, -half_sizes), half_sizes)
    distance = norm(points - nearest)
    inside = distance < 1e-12
    if inside.any():
        distance[inside] = -_depth(starts[inside], direction[inside], half_sizes[inside])
    return Nearest(nearest.reshape(shape), distance.reshape(shape[:-1]))


def _kinks(starts: Array, direction: Array, half_sizes: Array) -> Array:
    """Ends of the segments and where they cross the planes of the faces, (K, 8), rising, in [0, 1]."""
    steep = np.abs(direction) > 1e-15
    step = np.where(steep, direction, 1.0)
    t = np.zeros((len(starts), 8))
    t[:, 0:3] = np.where(steep, (half_sizes - starts) / step, 0.0)
    t[:, 3:6] = np.where(steep, (-half_sizes - starts) / step, 0.0)
    t[:, 7] = 1.0
    t = np.minimum(np.maximum(t, 0.0), 1.0)
    t.sort(axis=1)
    return t


def _half_slope(starts: Array, direction: Array, half_sizes: Array, t: Array) -> Array:
    """Slope g at every t (K, T): half the derivative of the squared distance to the box."""
    points = starts[:, None] + t[..., None] * direction[:, None]
    half = half_sizes[:, None]
    excess = points - np.minimum(np.maximum(points, -half), half)
    slope: Array = (excess @ direction[:, :, None])[..., 0]
    rounding = _EXCESS_ROUNDING * norm(direction)[:, None]  # else a flat stretch would end at its own noise
    slope[np.abs(slope) <= rounding] = 0.0
    return slope


def _root(t: Array, slope: Array) -> tuple[Array, Array]:
    """Where a rising, piecewise linear function reaches 0 and where it leaves it; an end if it never does."""
    rows, last = np.arange(len(t)), t.shape[1] - 1
    count = np.stack([(slope < 0.0).sum(axis=1), (slope <= 0.0).sum(axis=1)])
    left = np.minimum(np.maximum(count - 1, 0), last - 1)
    t0, g0 = t[rows, left], slope[rows, left]
    rise = slope[rows, left + 1] - g0
    fraction = np.minimum(np.maximum(-g0 / np.where(rise > 0.0, rise, 1.0), 0.0), 1.0)
    between = t0 + fraction * (t[rows, left + 1] - t0)
    lower, upper = np.where(count == 0, t[:, 0], np.where(count == last + 1, t[:, last], between))
    return lower, upper


def _depth(starts: Array, direction: Array, half_sizes: Array) -> Array:
    """How deep the deepest point of each segment lies: max over t of the least distance to the six faces.

    The least of six linear functions of t is concave; its maximum is at an end or where two of them meet.
    """
    constant = np.concatenate([half_sizes - starts, half_sizes + starts], axis=1)  # (K, 6)
    rate = np.concatenate([-direction, direction], axis=1)
    one, two = np.triu_indices(6, 1)
    difference = rate[:, one] - rate[:, two]
    meets = np.abs(difference) > 1e-15
    t = np.where(meets, (constant[:, two] - constant[:, one]) / np.where(meets, difference, 1.0), 0.0)
    limits = np.broadcast_to(np.array([0.0, 1.0]), (len(t), 2))
    t = np.concatenate([limits, np.clip(t, 0.0, 1.0)], axis=1)
    least = (constant[:, None] + t[..., None] * rate[:, None]).min(axis=-1)
    depth: Array = least.max(axis=1)
    return np.maximum(depth, 0.0)
