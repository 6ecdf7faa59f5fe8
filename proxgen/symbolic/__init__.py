"""RobotModel to Program: kinematics, rows, objective and bounds as CasADi expressions."""

from proxgen.symbolic.program_builder import build_program

__all__ = ["build_program"]
