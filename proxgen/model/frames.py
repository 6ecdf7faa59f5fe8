"""Small frame geometry that several rooms must agree on."""

import numpy as np

from proxgen.model.robot_model import Array


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
    seed = np.array([1.0, 0.0, 0.0]) if abs(third[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    first = seed - (seed @ third) * third
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(third, first), third])
