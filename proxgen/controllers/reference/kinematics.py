"""Where the arm is and how it moves: poses, the task Jacobian J of (1)(2), the point Jacobians J_p of (4)(5).

All Jacobians are Pinocchio's, in the world's directions (LOCAL_WORLD_ALIGNED), shifted to the point.
"""

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from proxgen.controllers.protocol import Array
from proxgen.model.kinematics import to_pin
from proxgen.model.robot_model import RobotModel

_LINEAR = {"x": 0, "y": 1, "z": 2}
_ANGULAR = {"rx": 0, "ry": 1, "rz": 2}


class Arm:
    """The arm at one joint position.

    Attributes:
        n: number of joints.
        rotations: (B, 3, 3) from body to world; B = Pinocchio joints and the base (index 0).
        origins: (B, 3) of the bodies' frames, world [m].
    """

    def __init__(self, model: RobotModel) -> None:
        """Take Pinocchio's scratch memory for `model`; call `move_to` before anything else."""
        self.n = model.n
        self._model = model
        self._pin_model = model.pin_model
        self._data = model.pin_model.createData()
        self._transmission = model.transmission
        self._offset = np.array([drive.offset for drive in model.drives])
        self.rotations = np.zeros((model.pin_model.njoints, 3, 3))
        self.origins = np.zeros((model.pin_model.njoints, 3))

    def move_to(self, q: Array) -> None:
        """Compute poses and joint Jacobians at q, (n,) [rad or m]."""
        one_entry_each = self._pin_model.nq == self._pin_model.nv
        moved = self._transmission @ q + self._offset if one_entry_each else to_pin(self._model, q)
        pin.computeJointJacobians(self._pin_model, self._data, moved)
        for body, placement in enumerate(self._data.oMi):
            self.rotations[body] = placement.rotation
            self.origins[body] = placement.translation

    def in_world(self, bodies: NDArray[np.intp], points: Array) -> Array:
        """Points (K, 3), each given in the frame of its body (K,), in the world [m]."""
        world: Array = (self.rotations[bodies] @ points[:, :, None])[:, :, 0] + self.origins[bodies]
        return world

    def body_jacobian(self, body: int) -> Array:
        """Linear velocity of the body's origin and angular velocity of the body, (6, n), world directions."""
        if body == 0:
            return np.zeros((6, self.n))
        frame = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        jacobian = pin.getJointJacobian(self._pin_model, self._data, body, frame)
        # Of an arm with one joint it comes as a vector.
        with_mimics: Array = jacobian.reshape(6, -1) @ self._transmission
        return with_mimics

    def point_jacobian(self, body: int, point: Array) -> Array:
        """J_p (3, n) of a world point that is fixed on a body: v_p = v_o + ω × (p - o) (4)."""
        jacobian = self.body_jacobian(body)
        x, y, z = point - self.origins[body]
        arm_cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        shifted: Array = jacobian[:3] - arm_cross @ jacobian[3:]
        return shifted

    def task_jacobian(self) -> Array:
        """J (m, n): the selected rows of the tool's linear and angular velocity (1)(2).

        Angular rows are about the world's axes, those of a pointing task about the first two directions of
        `task_frame`, which turn with the tool.
        """
        model, body = self._model, self._model.tool_body
        tool = self.rotations[body] @ model.tool_in_body[:3, 3] + self.origins[body]
        linear = self.point_jacobian(body, tool)
        angular = self.body_jacobian(body)[3:]
        if model.task_frame is not None:
            directions = self.rotations[body] @ model.tool_in_body[:3, :3] @ model.task_frame
            angular = directions.T @ angular
        rows = [linear[_LINEAR[row]] if row in _LINEAR else angular[_ANGULAR[row]] for row in model.task_rows]
        return np.array(rows)
