"""Symbolic kinematics by walking Pinocchio's placements into CasADi SX.

Constants that are exactly 0 or 1 fold away as the expressions are built, so an arm whose axes are along its
frames' axes costs only what its geometry needs.
"""

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from proxgen.model import RobotModel
from proxgen.model.robot_model import Array, Drive


@dataclass(frozen=True)
class Pose:
    """A symbolic pose: `rotation` (3, 3) and `translation` (3, 1), both SX."""

    rotation: Any
    translation: Any

    def __matmul__(self, other: "Pose") -> "Pose":
        """This pose followed by another one given in it."""
        return Pose(
            ca.mtimes(self.rotation, other.rotation),
            ca.mtimes(self.rotation, other.translation) + self.translation,
        )

    def row_major(self) -> Any:
        """(3, 4) matrix [R | t]."""
        return ca.horzcat(self.rotation, self.translation)


@dataclass(frozen=True)
class Kinematics:
    """Symbolic kinematics of an arm at q.

    Attributes:
        poses: of every Pinocchio joint; index 0 is the base.
        axes: unit axis of every joint in the world, (3, 1) each; joint i at i - 1.
        origins: a point on that axis, (3, 1) each [m].
        tool: pose of the task point.
        jacobian: task Jacobian J, (m, n).
    """

    poses: tuple[Pose, ...]
    axes: tuple[Any, ...]
    origins: tuple[Any, ...]
    tool: Pose
    jacobian: Any


def constant_pose(homogeneous: Array) -> Pose:
    """A pose of numbers; zeros stay structural, so that they cost nothing."""
    return Pose(ca.sparsify(ca.SX(ca.DM(homogeneous[:3, :3]))), ca.sparsify(ca.SX(ca.DM(homogeneous[:3, 3]))))


def joint_motion(drive: Drive, position: Any) -> Pose:
    """Pose of a joint's moving frame in its resting frame (Rodrigues' formula for a rotation)."""
    axis = ca.sparsify(ca.SX(ca.DM(drive.axis)))
    if drive.prismatic:
        return Pose(ca.SX.eye(3), axis * position)
    cross = ca.sparsify(ca.SX(ca.DM(_cross_matrix(drive.axis))))
    outer = ca.sparsify(ca.SX(ca.DM(np.outer(drive.axis, drive.axis))))
    rotation = outer + ca.cos(position) * (ca.SX.eye(3) - outer) + ca.sin(position) * cross
    return Pose(ca.sparsify(rotation), ca.SX(3, 1))


def _cross_matrix(axis: Array) -> Array:
    """The matrix that multiplies as the cross product with `axis`."""
    x, y, z = axis
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def point_jacobian(
    model: RobotModel, axes: tuple[Any, ...], origins: tuple[Any, ...], body: int, point: Any
) -> Any:
    """Position Jacobian J_p (3, n) of a world point that is fixed on a body (4).

    Column j is z_j x (p - o_j) for a revolute joint and z_j for a prismatic one; joints that do not move the
    body give structural zeros. A mimic joint adds its ratio's share to the joint that it follows.
    """
    return _moved_by(model, axes, origins, _supports(model, body), point)


def relative_jacobian(
    model: RobotModel,
    axes: tuple[Any, ...],
    origins: tuple[Any, ...],
    bodies: tuple[int, int],
    points: tuple[Any, Any],
) -> Any:
    """J_p - J_h (3, n) along the line through two world points p and h, each fixed on its body.

    Joints that move both are left out: their share z x (p - h) is normal to p - h, and only the component
    along it is of use.
    """
    own, others = (_supports(model, body) for body in bodies)
    towards = _moved_by(model, axes, origins, [i for i in own if i not in others], points[0])
    return towards - _moved_by(model, axes, origins, [i for i in others if i not in own], points[1])


def _moved_by(
    model: RobotModel, axes: tuple[Any, ...], origins: tuple[Any, ...], joints: list[int], point: Any
) -> Any:
    """Position Jacobian (3, n) of a point that some joints (from 0) move."""
    jacobian = ca.SX(3, model.n)
    for index in joints:
        drive = model.drives[index]
        column = axes[index] if drive.prismatic else ca.cross(axes[index], point - origins[index])
        jacobian[:, drive.index] += drive.ratio * column
    return jacobian


def rotation_jacobian(model: RobotModel, axes: tuple[Any, ...], body: int) -> Any:
    """Angular velocity Jacobian (3, n) of a body, world frame."""
    jacobian = ca.SX(3, model.n)
    for index in _supports(model, body):
        drive = model.drives[index]
        if not drive.prismatic:
            jacobian[:, drive.index] += drive.ratio * axes[index]
    return jacobian


def _supports(model: RobotModel, body: int) -> list[int]:
    """Indices (from 0) of the joints that move a body."""
    return [int(joint) - 1 for joint in model.pin_model.supports[body] if joint > 0]


def kinematics(model: RobotModel, q: Any) -> Kinematics:
    """Walk the chain once.

    Args:
        model: the arm.
        q: SX (n, 1) [rad or m].

    Returns:
        Poses, joint axes and origins, tool pose and task Jacobian, all in the world frame.
    """
    poses = [Pose(ca.SX.eye(3), ca.SX(3, 1))]
    axes, origins = [], []
    for index, drive in enumerate(model.drives, start=1):
        placement = constant_pose(model.pin_model.jointPlacements[index].homogeneous)
        resting = poses[model.pin_model.parents[index]] @ placement
        poses.append(resting @ joint_motion(drive, drive.ratio * q[drive.index] + drive.offset))
        axes.append(ca.mtimes(resting.rotation, ca.sparsify(ca.SX(ca.DM(drive.axis)))))
        origins.append(resting.translation)
    tool = poses[model.tool_body] @ constant_pose(model.tool_in_body)
    jacobian = task_jacobian(model, tuple(axes), tuple(origins), tool)
    return Kinematics(tuple(poses), tuple(axes), tuple(origins), tool, jacobian)


def task_jacobian(model: RobotModel, axes: tuple[Any, ...], origins: tuple[Any, ...], tool: Pose) -> Any:
    """Task Jacobian J (m, n): the selected rows of the tool's linear and angular velocity (1)."""
    angular = rotation_jacobian(model, axes, model.tool_body)
    if model.task_frame is not None:
        directions = ca.mtimes(tool.rotation, ca.sparsify(ca.SX(ca.DM(model.task_frame))))
        angular = ca.mtimes(directions.T, angular)
    linear = point_jacobian(model, axes, origins, model.tool_body, tool.translation)
    rows = {name: linear[i, :] for i, name in enumerate(("x", "y", "z"))}
    rows |= {name: angular[i, :] for i, name in enumerate(("rx", "ry", "rz"))}
    return ca.vertcat(*[rows[name] for name in model.task_rows])
