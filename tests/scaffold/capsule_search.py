"""Another way to the least capsule, for comparison: many random ones, improved by random changes for long."""

import numpy as np
from numpy.typing import NDArray

from proxgen.scaffold.fit import FittedCapsule

Array = NDArray[np.float64]


def excess(points: Array, capsule: FittedCapsule) -> float:
    """How far the furthest point lies outside [m]; negative if all are inside."""
    ends = np.array([capsule.start, capsule.end])[None]
    return float(_radii(points, ends)[0] - capsule.radius)


def long_search(points: Array, seed: int, population: int = 60, rounds: int = 500) -> float:
    """Volume of the least capsule that a random search finds [m^3].

    Every axis of a population is changed a little at random; if its capsule gets smaller the change is kept,
    and later changes are larger, else smaller.
    """
    rng = np.random.default_rng(seed)
    points = _extremes(points)
    low, high = points.min(axis=0), points.max(axis=0)
    axes = rng.uniform(low, high, (population, 2, 3))
    volumes = _volumes(points, axes)
    steps = np.full(population, 0.2 * float((high - low).max()))
    for _ in range(rounds):
        tried = axes + steps[:, None, None] * rng.normal(size=axes.shape)
        tried_volumes = _volumes(points, tried)
        better = tried_volumes < volumes
        axes[better], volumes[better] = tried[better], tried_volumes[better]
        steps = np.clip(steps * np.where(better, 1.6, 0.9), 1e-9, None)
    return float(volumes.min())


def _extremes(points: Array) -> Array:
    """Points that reach furthest in some of many directions: the search then is for a lower bound."""
    directions = np.random.default_rng(0).normal(size=(600, 3))
    extremes: Array = points[np.unique(np.argmax(points @ directions.T, axis=0))]
    return extremes


def _volumes(points: Array, axes: Array) -> Array:
    """Volumes (A,) of the capsules around axes (A, 2, 3) that just contain the points."""
    radii = _radii(points, axes)
    lengths = np.linalg.norm(axes[:, 1] - axes[:, 0], axis=1)
    volumes: Array = np.pi * radii**2 * (lengths + 4.0 / 3.0 * radii)
    return volumes


def _radii(points: Array, axes: Array) -> Array:
    """Greatest distance (A,) of the points (k, 3) to each axis (A, 2, 3)."""
    along = axes[:, 1] - axes[:, 0]
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    offset = points[None] - axes[:, None, 0]
    fraction = np.clip((offset * along[:, None]).sum(axis=2) / square[:, None], 0.0, 1.0)
    radii: Array = np.linalg.norm(offset - fraction[:, :, None] * along[:, None], axis=2).max(axis=1)
    return radii
