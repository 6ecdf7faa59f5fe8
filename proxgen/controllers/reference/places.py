"""Where sensors sit and look."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from proxgen.controllers.protocol import Array
from proxgen.controllers.reference.kinematics import Arm
from proxgen.model.robot_model import SensorModule


class Places:
    """Where sensors sit and look, in their bodies' frames.

    Attributes:
        body: (S,) Pinocchio joint indices.
        position: (S, 3) [m].
        normal: (S, 3) unit vectors.
    """

    def __init__(self, modules: Sequence[SensorModule]) -> None:
        """Collect them, once."""
        self.body = np.array([module.body for module in modules], dtype=int)
        self.position = np.array([module.position for module in modules]).reshape(-1, 3)
        self.normal = np.array([module.normal for module in modules]).reshape(-1, 3)

    def points(self, arm: Arm, which: NDArray[np.intp], reach: Array) -> Array:
        """Points h = o + r n (K, 3) in the world, of the sensors `which` (K,) at distances `reach` (K,)."""
        return arm.in_world(self.body[which], self.position[which] + reach[:, None] * self.normal[which])

    def normals(self, arm: Arm, which: NDArray[np.intp]) -> Array:
        """Normals n (K, 3) in the world, of the sensors `which` (K,)."""
        turned: Array = (arm.rotations[self.body[which]] @ self.normal[which][:, :, None])[:, :, 0]
        return turned
