"""Small frame geometry that several rooms must agree on."""

import numpy as np

from proxgen.model.robot_model import Array

SNAP = 1e-11
"""Rotation entries smaller than this are rounding of the URDF's decimals, and are set to zero."""

CLOSE_TO_X = 0.9 - 1e-9
"""Part of x in a unit vector from which on x is nearly parallel to it; rounding must not decide at 0.9."""


def axis_basis(axis: Array) -> Array:
    """Right-handed frame whose third column is along `axis`.

    The first column is the x axis made normal to `axis` (the y axis if x is nearly parallel). A cuff counts
    its modules' angles from it; a pointing task has its two rotational rows about the first two columns.

    Args:
        axis: (3,), any length but zero.

    Returns:
        (3, 3) rotation matrix.
    """
    third = axis / np.linalg.norm(axis)
    seed = np.array([1.0, 0.0, 0.0]) if abs(third[0]) < CLOSE_TO_X else np.array([0.0, 1.0, 0.0])
    first = seed - (seed @ third) * third
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(third, first), third])


def roll_pitch_yaw(rotation: Array) -> Array:
    """Angles (3,) about the world's x, then y, then z, that make a rotation matrix [rad].

    Where x is turned onto z or -z, roll and yaw turn about the same axis: then the roll is 0.
    """
    level = float(np.hypot(rotation[0, 0], rotation[1, 0]))
    pitch = np.arctan2(-rotation[2, 0], level)
    if level < 1e-9:
        return np.array([0.0, pitch, np.arctan2(-rotation[0, 1], rotation[1, 1])])
    return np.array(
        [
            np.arctan2(rotation[2, 1], rotation[2, 2]),
            pitch,
            np.arctan2(rotation[1, 0], rotation[0, 0]),
        ]
    )


def snapped(rotation: Array) -> Array:
    """A rotation matrix without the off-zeros below `SNAP`, orthonormal to rounding error again.

    Orthonormal it must be: with columns that are 1e-11 too long, two right ways to compute a Jacobian differ
    by as much.
    """
    zero = np.abs(rotation) < SNAP
    if not rotation[zero].any():
        return np.array(rotation)
    clean: Array = np.where(zero, 0.0, rotation)
    for _ in range(2):  # Newton's iteration for the nearest rotation; two steps go far beyond rounding error
        clean = np.where(zero, 0.0, 1.5 * clean - 0.5 * _product(clean, _product(clean.T, clean)))
    # Zeros that do not go together, as one entry of a pair lies just above SNAP: leave the matrix as it is.
    return clean if np.abs(_product(clean.T, clean) - np.eye(3)).max() < 4e-15 else np.array(rotation)


def _product(left: Array, right: Array) -> Array:
    """Product of two small matrices, summed in one order on every machine: generated code depends on it."""
    product: Array = (left[:, :, None] * right[None]).sum(axis=1)
    return product
