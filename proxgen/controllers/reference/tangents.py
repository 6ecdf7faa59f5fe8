"""Directions along an obstacle, and which of them is best."""

from typing import NamedTuple

import numpy as np

from proxgen.controllers.protocol import Array

COUNT = 24
"""Number of tangents that are tried."""

BETTER = 1e-9
"""A score has to be greater by more than this to be better."""

LEAST_VELOCITY = 1e-9
"""A slower task velocity has no direction [m/s]."""

CLOSE_TO_X = 0.9 - 1e-9
"""Part of x in a unit vector from which on its basis begins with y."""

_LINEAR = ("x", "y", "z")


class Basis(NamedTuple):
    """Right-handed, unit vectors (3,); the third is the direction that it is a basis of."""

    first: Array
    second: Array
    third: Array


def basis_of(direction: Array) -> Basis:
    """Basis of a unit vector (3,): first the x axis made normal to it; the y axis where x is close to it."""
    seed = np.array([1.0, 0.0, 0.0]) if abs(direction[0]) < CLOSE_TO_X else np.array([0.0, 1.0, 0.0])
    first = seed - (seed @ direction) * direction
    first = first / np.linalg.norm(first)
    return Basis(first, np.cross(direction, first), direction)


def tangents_of(direction: Array) -> Array:
    """Candidates c_i = cos(2πi/24) e₁ + sin(2πi/24) e₂, (24, 3), of a unit vector (3,)."""
    basis, angle = basis_of(direction), 2.0 * np.pi * np.arange(COUNT) / COUNT
    candidates: Array = np.outer(np.cos(angle), basis.first) + np.outer(np.sin(angle), basis.second)
    return candidates


def first_of_best(scores: Array) -> int:
    """Index of the candidate that is kept of scores (K,), offered one after the other."""
    best = 0
    for index, score in enumerate(scores.tolist()):
        if score > scores[best] + BETTER:
            best = index
    return best


class LinearTask:
    """The rows x, y, z among the task's rows.

    Attributes:
        axes: which of x, y, z the task has, as indices.
        rows: where each of them is among the rows of the task.
    """

    def __init__(self, task_rows: tuple[str, ...]) -> None:
        """Find them."""
        self.axes = [axis for axis, row in enumerate(_LINEAR) if row in task_rows]
        self.rows = [task_rows.index(_LINEAR[axis]) for axis in self.axes]

    def velocity(self, xdot: Array) -> Array:
        """ẋ_lin (3,) of a task velocity (m,); 0 for rows that the task lacks."""
        linear = np.zeros(3)
        linear[self.axes] = xdot[self.rows]
        return linear

    def only(self, vectors: Array) -> Array:
        """Vectors (..., 3) with 0 for rows that the task lacks."""
        kept = np.zeros_like(vectors)
        kept[..., self.axes] = vectors[..., self.axes]
        return kept


def unit_or_zero(vector: Array, least: float) -> Array:
    """The vector (3,) made to length 1; 0 if it is shorter than `least`."""
    length = float(np.linalg.norm(vector))
    return np.zeros(3) if length < least else vector / length
