"""Rotations as pybullet wants them."""

import numpy as np
from numpy.typing import NDArray


def quaternion(rotation: NDArray[np.float64]) -> list[float]:
    """Components x, y, z, w of a rotation matrix, by the largest of the four (no division by a small one)."""
    m = rotation
    trace = 1.0 + m[0, 0] + m[1, 1] + m[2, 2]
    squares = [trace] + [1.0 + 2.0 * m[i, i] - np.trace(m) for i in range(3)]
    largest = int(np.argmax(squares))
    if largest == 0:
        xyzw = [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], trace]
    else:
        i = largest - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        xyzw = [0.0, 0.0, 0.0, m[k, j] - m[j, k]]
        xyzw[i], xyzw[j], xyzw[k] = squares[largest], m[j, i] + m[i, j], m[k, i] + m[i, k]
    unit = np.array(xyzw) / np.linalg.norm(xyzw)
    return [float(component) for component in unit]
