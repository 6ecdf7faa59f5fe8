"""Joints that are held where the URDF says that they cannot be."""

from proxgen.config.schema import Config
from proxgen.errors import Problem
from proxgen.model.urdf import read_urdf

_ROUNDING = 1e-6


def held_outside(config: Config) -> list[Problem]:
    """A doubt for each joint of `robot.locked_joints` that is held outside its limits in the URDF.

    Args:
        config: one from which a model was built.

    Returns:
        In the file's order. Limits that leave no room, which some URDFs write as placeholders, are none.
    """
    limits, doubts = read_urdf(config.urdf_path).limits, []
    for name, position in config.robot.locked_joints.items():
        lower, upper = limits[name].lower, limits[name].upper
        if lower is None or upper is None or lower >= upper:
            continue
        if not lower - _ROUNDING <= position <= upper + _ROUNDING:
            message = (
                f"joint '{name}' is held at {position:.6g}, outside its limits {lower:.6g} to {upper:.6g}"
            )
            doubts.append(config.problem(f"robot.locked_joints.{name}", message))
    return doubts
