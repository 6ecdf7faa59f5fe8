"""RobotModel: what both controllers know of the arm. Plain data and numeric kinematics, nothing symbolic.

Frames and conventions: the world is the URDF's root link; `q` always has one entry per *controlled* joint,
`n` in all. A continuous joint is one angle, although Pinocchio holds it as cosine and sine; a mimic joint has
no entry of its own but follows one. A *body* is a Pinocchio joint index: 0 is the fixed base, i > 0 is what
moves with Pinocchio's joint i. Everything attached to the arm is given in the frame of its body, so that body
poses are all that changes from cycle to cycle.
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
class SelfPointModel:
    """A point, or a ball, that the arm carries and that its other links must not touch.

    Attributes:
        name: as in the configuration.
        body: Pinocchio joint index that carries it; 0 is the base.
        position: (3,), body frame [m].
        radius: of the ball; 0 for a point [m].
        capsules: (L,) whether each capsule is a pair with it: neither on the same body nor excluded.
    """

    name: str
    body: int
    position: Array
    radius: float
    capsules: tuple[bool, ...]


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
class Drive:
    """How a Pinocchio joint follows a controlled one: position = ratio * q[index] + offset.

    Attributes:
        index: which entry of q; for a joint that is not a mimic joint, its own.
        ratio: 1 for a joint that is not a mimic joint.
        offset: [rad or m].
        prismatic: the joint translates along `axis`; otherwise it rotates about it.
        axis: unit vector (3,), in the joint's frame.
    """

    index: int
    ratio: float
    offset: float
    prismatic: bool
    axis: Array


@dataclass(frozen=True)
class RobotModel:
    """The controlled chain: n joints from base to tool, capsules, sensors, limits.

    Attributes:
        name: robot name, prefix of all generated symbols.
        pin_model: reduced Pinocchio model of the chain. Rotation entries below 1e-11 are exactly 0 (angles
            such as 1.57079632679 leave them, and each costs operations in every cycle).
        drives: one per Pinocchio joint (joint i has drives[i - 1]).
        joint_names: (n,), base to tool.
        tool_body: body that carries the tool.
        tool_in_body: 4x4 homogeneous transform of the task point frame in its body.
        task_rows: (m,) names of the rows of J, a subset of `ROWS_OF_KIND[task.kind]`, in that order.
        task_frame: (3, 3) tool-frame directions (columns) about which rx, ry are counted by a pointing task;
            None if rx, ry, rz are about the world's axes.
        q_lower: (n,) [rad or m]; -1e20 where unlimited.
        q_upper: (n,) [rad or m]; 1e20 where unlimited.
        qdot_limit: (n,) [rad/s or m/s].
        qddot_limit: (n,) [rad/s^2 or m/s^2]; 1e20 where unlimited.
        capsules: one per avoiding link; rows of (5) in this order.
        modules: all sensor modules, cuff by cuff, ring by ring.
        self_points: of self-collision; none: there is no such thing.
    """

    name: str
    pin_model: Any
    drives: tuple[Drive, ...]
    joint_names: tuple[str, ...]
    tool_body: int
    tool_in_body: Array
    task_rows: tuple[str, ...]
    task_frame: Array | None
    q_lower: Array
    q_upper: Array
    qdot_limit: Array
    qddot_limit: Array
    capsules: tuple[CapsuleModel, ...]
    modules: tuple[SensorModule, ...]
    self_points: tuple[SelfPointModel, ...] = ()

    @property
    def n(self) -> int:
        """Number of controlled joints."""
        return len(self.joint_names)

    @property
    def m(self) -> int:
        """Number of task rows."""
        return len(self.task_rows)

    @property
    def prismatic(self) -> tuple[bool, ...]:
        """(n,) whether each controlled joint slides."""
        names = list(self.pin_model.names)
        return tuple(self.drives[names.index(name) - 1].prismatic for name in self.joint_names)

    @property
    def transmission(self) -> Array:
        """(pin.nv, n): Pinocchio's velocities from q̇; the identity unless there are mimic joints.

        A Jacobian J_pin of Pinocchio becomes J_pin @ transmission.
        """
        matrix = np.zeros((len(self.drives), self.n))
        for row, drive in enumerate(self.drives):
            matrix[row, drive.index] = drive.ratio
        return matrix

    @property
    def tof_modules(self) -> tuple[SensorModule, ...]:
        """The modules with a range sensor; `Measurement.tof_range` is in this order."""
        return tuple(module for module in self.modules if module.tof is not None)

    @property
    def capacitive_modules(self) -> tuple[SensorModule, ...]:
        """The modules with a switch; `Measurement.capacitive` is in this order."""
        return tuple(module for module in self.modules if module.capacitive is not None)
