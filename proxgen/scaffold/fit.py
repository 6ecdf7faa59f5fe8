"""The least capsule around a cloud of points.

A capsule is two ends a, b and a radius R. With R as small as the cloud allows, its volume

    V(a, b) = pi R^2 ||b - a|| + 4/3 pi R^3,    R(a, b) = max_i (distance of point i to the segment + r_i)

is a function of six numbers, smooth but for the maximum. It is brought down by a composite method: all
distances are linearised at the present capsule, and the best step of the linearised problem, kept short by a
quadratic term, is a small QP; the step counts only if V really falls. Starts come from a search over axis
directions. On the links of eleven arms the result equals the best of hundreds of other starts to 1e-5.
"""

import math
from dataclasses import dataclass

import numpy as np
import quadprog
from numpy.typing import NDArray

from proxgen.model.frames import axis_basis
from proxgen.model.robot_model import Array
from proxgen.scaffold.shapes import Cloud, merged

_SUPPORTS = 250
_DIRECTIONS = 250
_STARTS = 8
_STEPS = 80
_GROWTH = (1.0, 1.05, 1.12, 1.2, 1.35)
"""Radii that a start tries, relative to the least one around its axis: more radius, less length."""


@dataclass(frozen=True)
class FittedCapsule:
    """A capsule around a cloud, in the cloud's frame.

    Attributes:
        start: (3,) [m].
        end: (3,) [m]; equal to the start for a sphere.
        radius: [m].
    """

    start: Array
    end: Array
    radius: float

    @property
    def length(self) -> float:
        """Length of the axis [m]."""
        return float(np.linalg.norm(self.end - self.start))

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return math.pi * self.radius**2 * (self.length + 4.0 / 3.0 * self.radius)


def fit_capsule(cloud: Cloud) -> FittedCapsule:
    """The least capsule that contains every ball of the cloud.

    Args:
        cloud: at least one ball.

    Returns:
        The best that a search over directions and a descent from each good one find. The same cloud always
        gives the same capsule.
    """
    outer = _extremes(cloud)
    found = [_descend(outer, start) for start in _starts(outer)[:_STARTS]]
    best = min(found, key=lambda capsule: capsule.volume)
    while (outside := _outside(cloud, best)).any():
        # Extreme points in many directions are not all corners of the hull: add those that were missed.
        outer = merged([outer, Cloud(cloud.points[outside], cloud.radii[outside])])
        best = _descend(outer, enclosing(outer, best.start, best.end))
    return enclosing(cloud, best.start, best.end)


def enclosing(cloud: Cloud, start: Array, end: Array) -> FittedCapsule:
    """The capsule around a given axis that just contains the cloud."""
    return FittedCapsule(start, end, float(_reach(cloud, start, end)[0].max()))


def _outside(cloud: Cloud, capsule: FittedCapsule) -> NDArray[np.bool_]:
    """Which balls stick out by more than rounding error, (k,); of very many the worst."""
    excess = _reach(cloud, capsule.start, capsule.end)[0] - capsule.radius
    limit = max(1e-9 * capsule.radius, float(np.sort(excess)[-min(200, len(excess))]))
    return np.asarray((excess > 1e-9 * capsule.radius) & (excess >= limit))


def _reach(cloud: Cloud, start: Array, end: Array) -> tuple[Array, Array, Array]:
    """Per ball: radius that just contains it (k,), where along the axis (k,), offset from there (k, 3)."""
    axis = end - start
    square = float(axis @ axis)
    fraction = np.zeros(len(cloud.points))
    if square > 0.0:
        fraction = np.clip((cloud.points - start) @ axis / square, 0.0, 1.0)
    offset = cloud.points - start - fraction[:, None] * axis
    return np.linalg.norm(offset, axis=1) + cloud.radii, fraction, offset


def _hemisphere(count: int) -> Array:
    """Directions spread evenly over half of the unit sphere, (count, 3)."""
    index = np.arange(count) + 0.5
    height, angle = 1.0 - index / count, index * math.pi * (3.0 - math.sqrt(5.0))
    ring = np.sqrt(1.0 - height**2)
    return np.column_stack([ring * np.cos(angle), ring * np.sin(angle), height])


def _extremes(cloud: Cloud) -> Cloud:
    """The balls that reach furthest in some of many directions: nearly all that matter, and few."""
    half, found = _hemisphere(_SUPPORTS), set()
    for directions in np.array_split(np.vstack([half, -half]), 10):
        found |= set(np.argmax(directions @ cloud.points.T + cloud.radii, axis=1).tolist())
    chosen = sorted(found)
    return Cloud(cloud.points[chosen], cloud.radii[chosen])


def _starts(cloud: Cloud) -> list[FittedCapsule]:
    """Capsules along many directions, axis through the middle of the cloud, best first."""
    centred = cloud.points - cloud.points.mean(axis=0)
    principal = np.linalg.svd(centred, full_matrices=False)[2]
    capsules = []
    for direction in np.vstack([principal, _hemisphere(_DIRECTIONS)]):
        basis = axis_basis(direction)
        across = cloud.points @ basis[:, :2]
        middle = 0.5 * ((across + cloud.radii[:, None]).max(0) + (across - cloud.radii[:, None]).min(0))
        along = cloud.points @ basis[:, 2]
        distance = np.linalg.norm(across - middle, axis=1)
        least = float((distance + cloud.radii).max())
        for growth in _GROWTH:
            low, high = _interval(along, distance, growth * least - cloud.radii)
            ends = (basis @ np.array([*middle, height]) for height in (low, high))
            capsules.append(enclosing(cloud, *ends))
    return sorted(capsules, key=lambda capsule: capsule.volume)


def _interval(along: Array, distance: Array, room: Array) -> tuple[float, float]:
    """The shortest axis from low to high that leaves each ball `room` (k,) within the caps."""
    cap = np.sqrt(np.maximum(room**2 - distance**2, 0.0))
    low, high = float((along + cap).min()), float((along - cap).max())
    return (low, high) if low < high else (0.5 * (low + high),) * 2


def _descend(cloud: Cloud, capsule: FittedCapsule) -> FittedCapsule:
    """Follow the composite method from a capsule until the volume falls no more."""
    size, stiffness = capsule.radius, 1.0
    if size <= 1e-9 * capsule.length:
        return capsule  # around a line or a point: nothing to gain
    for _ in range(_STEPS):
        step = _step(cloud, capsule, stiffness / size)
        tried = enclosing(cloud, capsule.start + step[:3], capsule.end + step[3:6])
        gain = 1.0 - tried.volume / max(capsule.volume, 1e-300)
        if gain > 0.0:
            capsule, stiffness = tried, max(stiffness / 3.0, 1e-3)
        else:
            stiffness *= 4.0
        if 0.0 <= gain < 1e-9 or stiffness > 1e6:
            break
    return capsule


def _step(cloud: Cloud, capsule: FittedCapsule, stiffness: float) -> Array:
    """Best change of (start, end, R) of the linearised problem, (7,), by a QP."""
    reach, fraction, offset = _reach(cloud, capsule.start, capsule.end)
    near = reach > 0.75 * capsule.radius
    outward = offset[near] / np.maximum(np.linalg.norm(offset[near], axis=1), 1e-12)[:, None]
    share = fraction[near, None]
    # reach_i - (1 - s_i) u_i . da - s_i u_i . db <= R + dR
    rows = np.column_stack([(1.0 - share) * outward, share * outward, np.ones(int(near.sum()))])
    axis, length, radius = capsule.end - capsule.start, capsule.length, capsule.radius
    pull = math.pi * radius**2 * axis / max(length, 1e-12)
    gradient = np.array([*-pull, *pull, 2.0 * math.pi * radius * (length + 2.0 * radius)])
    gradient /= np.linalg.norm(gradient)
    return np.array(
        quadprog.solve_qp(stiffness * np.eye(7), -gradient, rows.T, reach[near] - radius)[0], dtype=float
    )
