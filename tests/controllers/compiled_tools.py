"""What the tests of the compiled controller share."""

import numpy as np

from proxgen.controllers.protocol import Measurement
from proxgen.model import RobotModel

Q = np.array([0.4, 0.9])
XDOT = np.array([0.05, -0.02])


def free_space(model: RobotModel, time: float = 1.0, points: np.ndarray | None = None) -> Measurement:
    """A measurement in which nothing is near but `points`."""
    ranges = np.array([module.tof.range for module in model.tof_modules if module.tof])
    closed = np.zeros(len(model.capacitive_modules), dtype=bool)
    return Measurement(time, ranges, closed, points=np.empty((0, 3)) if points is None else points)
