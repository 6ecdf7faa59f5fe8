"""URDF and configuration to RobotModel: the arm as numbers, shared by both controllers."""

from proxgen.model.build import build_model
from proxgen.model.robot_model import CapsuleModel, RobotModel, SensorModule

__all__ = ["CapsuleModel", "RobotModel", "SensorModule", "build_model"]
