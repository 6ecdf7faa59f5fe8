"""Where the arm's capsules and sensors are: body-frame tables turned into arrays in the world."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from proxgen.model.kinematics import body_poses
from proxgen.model.robot_model import RobotModel, SensorModule

Array = NDArray[np.float64]


class SensorFrame:
    """Places and directions of some sensor modules.

    Attributes:
        body: (S,) body that carries each module.
    """

    def __init__(self, modules: Sequence[SensorModule]) -> None:
        """Keep the tables of `modules` as arrays."""
        self.body = np.array([module.body for module in modules], dtype=np.intp)
        self._position = np.array([module.position for module in modules], dtype=float).reshape(-1, 3)
        self._normal = np.array([module.normal for module in modules], dtype=float).reshape(-1, 3)

    def place(self, poses: Array, indices: NDArray[np.intp]) -> tuple[Array, Array]:
        """Positions (K, 3) [m] and normals (K, 3) in the world of some modules, from body poses (B, 4, 4)."""
        carried = poses[self.body[indices]]
        return transform(carried, self._position[indices]), rotate(carried, self._normal[indices])


class ArmGeometry:
    """The arm as capsules, in the world, for any joint position.

    Attributes:
        model: the arm.
        body: (L,) body that carries each capsule.
        radius: (L,) of each capsule [m].
    """

    def __init__(self, model: RobotModel) -> None:
        """Keep the capsule table of `model` as arrays."""
        self.model = model
        self.body = np.array([capsule.body for capsule in model.capsules], dtype=np.intp)
        self.radius = np.array([capsule.radius for capsule in model.capsules], dtype=float)
        self._start = np.array([capsule.start for capsule in model.capsules], dtype=float).reshape(-1, 3)
        self._end = np.array([capsule.end for capsule in model.capsules], dtype=float).reshape(-1, 3)
        self._data = model.pin_model.createData()
        self._last: tuple[Array, Array] | None = None

    def poses(self, q: Array) -> Array:
        """Poses of all bodies at joint positions q (n,): (B, 4, 4), body 0 is the base; not to be changed.

        The last ones are kept: loop, sensors and distances mostly ask for the same q in a cycle.
        """
        if self._last is None or not np.array_equal(self._last[0], q):
            self._last = (q.copy(), np.array(body_poses(self.model, q, self._data)))
        return self._last[1]

    def axes(self, poses: Array) -> tuple[Array, Array]:
        """Start and end of every capsule's axis in the world, each (L, 3) [m]."""
        carried = poses[self.body]
        return transform(carried, self._start), transform(carried, self._end)

    def tool(self, poses: Array) -> Array:
        """Pose of the task point, 4x4."""
        pose: Array = poses[self.model.tool_body] @ self.model.tool_in_body
        return pose


def rotate(poses: Array, vectors: Array) -> Array:
    """Turn vectors (K, 3) by the rotations of poses (K, 4, 4)."""
    turned: Array = (poses[:, :3, :3] @ vectors[:, :, None])[:, :, 0]
    return turned


def transform(poses: Array, points: Array) -> Array:
    """Points (K, 3) from body frames with poses (K, 4, 4) to the world."""
    return rotate(poses, points) + poses[:, :3, 3]
