"""RobotModel: what both controllers know of the arm. Plain data and numeric kinematics, nothing symbolic.

Frames and conventions: the world is the URDF's root link; `q` always has one entry per joint, `n` in all
(a continuous joint is one angle, although Pinocchio holds it as cosine and sine). A *body* is a Pinocchio
joint index: 0 is the fixed base, i > 0 moves with joint i - 1. Everything attached to the arm is given in
the frame of its body, so that body poses are all that changes from cycle to cycle.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from proxgen.config.schema import Capacitive, TimeOfFlight

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CapsuleModel:
    """A link's capsule in its body frame.

    Attributes:
        name: as in the configuration.
        body: Pinocchio joint index that carries it; 0 is the base.
        start: one end of the axis, (3,), body frame [m].
        end: the other end, (3,), body frame [m].
        radius: [m].
        reference_radius: subtracted from the distance to the axis: 0 for `axis`, `radius` for `surface` [m].
    """

    name: str
    body: int
    start: Array
    end: Array
    radius: float
    reference_radius: float


@dataclass(frozen=True)
class SensorModule:
    """One module of a cuff: its place and direction, and the sensors that it holds.

    Attributes:
        name: `cuff.ring.index`, each counted from 0.
        body: Pinocchio joint index that carries it.
        position: (3,), body frame [m].
        normal: measuring direction, unit vector (3,), body frame.
        tof: the range sensor, or None.
        capacitive: the switch, or None.
    """

    name: str
    body: int
    position: Array
    normal: Array
    tof: TimeOfFlight | None
    capacitive: Capacitive | None


@dataclass(frozen=True)
class RobotModel:
    """The controlled chain: n joints from base to tool, capsules, sensors, limits.

    Attributes:
        name: robot name, prefix of all generated symbols.
        pin_model: reduced Pinocchio model (only the n controlled joints), its placements snapped: entries
            that are within 1e-11 of -1, 0, 1 or a multiple of 1/2 are that number exactly.
        joint_names: (n,), base to tool.
        tool_body: body that carries the tool.
        tool_in_body: 4x4 homogeneous transform of the task point frame in its body.
        q_lower: (n,) [rad or m]; -1e20 where unlimited.
        q_upper: (n,) [rad or m]; 1e20 where unlimited.
        qdot_limit: (n,) [rad/s or m/s].
        qddot_limit: (n,) [rad/s^2 or m/s^2]; 1e20 where unlimited.
        capsules: one per avoiding link; rows of (5) in this order.
        modules: all sensor modules, cuff by cuff, ring by ring.
    """

    name: str
    pin_model: Any
    joint_names: tuple[str, ...]
    tool_body: int
    tool_in_body: Array
    q_lower: Array
    q_upper: Array
    qdot_limit: Array
    qddot_limit: Array
    capsules: tuple[CapsuleModel, ...]
    modules: tuple[SensorModule, ...]

    @property
    def n(self) -> int:
        """Number of controlled joints."""
        return len(self.joint_names)

    @property
    def tof_modules(self) -> tuple[SensorModule, ...]:
        """The modules with a range sensor; `Measurement.tof_range` is in this order."""
        return tuple(module for module in self.modules if module.tof is not None)

    @property
    def capacitive_modules(self) -> tuple[SensorModule, ...]:
        """The modules with a switch; `Measurement.capacitive` is in this order."""
        return tuple(module for module in self.modules if module.capacitive is not None)
