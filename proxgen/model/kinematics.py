"""Numeric kinematics of a RobotModel, by Pinocchio. Shared by the reference, the simulation and the tests."""

import numpy as np
import pinocchio as pin

from proxgen.model.robot_model import Array, RobotModel


def to_pin(model: RobotModel, q: Array) -> Array:
    """Joint positions as Pinocchio holds them: a continuous joint becomes cosine and sine.

    Args:
        model: the arm.
        q: (n,) controlled joints [rad or m].

    Returns:
        (nq,) configuration vector of `model.pin_model`, mimic joints included.
    """
    configuration = np.empty(model.pin_model.nq)
    for joint, drive in zip(list(model.pin_model.joints)[1:], model.drives, strict=True):
        position = drive.ratio * q[drive.index] + drive.offset
        if joint.nq == 2:
            configuration[joint.idx_q : joint.idx_q + 2] = np.cos(position), np.sin(position)
        else:
            configuration[joint.idx_q] = position
    return configuration


def body_poses(model: RobotModel, q: Array, data: pin.Data | None = None) -> list[Array]:
    """Poses of all bodies in the world.

    Args:
        model: the arm.
        q: (n,) controlled joints [rad or m].
        data: Pinocchio's scratch memory, to save its allocation in a loop.

    Returns:
        One 4x4 homogeneous transform per Pinocchio joint; index 0 is the base (identity).
    """
    data = model.pin_model.createData() if data is None else data
    pin.forwardKinematics(model.pin_model, data, to_pin(model, q))
    return [np.array(placement.homogeneous) for placement in data.oMi]


def tool_pose(model: RobotModel, q: Array, data: pin.Data | None = None) -> Array:
    """Pose of the task point in the world, 4x4: body pose times `tool_in_body`."""
    pose: Array = body_poses(model, q, data)[model.tool_body] @ model.tool_in_body
    return pose
