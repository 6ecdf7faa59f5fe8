"""What every controller is: `step(q, xdot, measurement) -> Command`. Shared by compiled and reference.

Plain data only; imports nothing of the symbolic or the generated side.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

OFF = 1e20
"""Stands for infinity in bounds: a row that is off has ubA = OFF, and lbA is -OFF always."""


class Status(IntEnum):
    """How a cycle ended. The numbers are those of `pg_status_t` in `runtime/include/proxgen/types.h`."""

    SOLVED = 0
    REDUCED_ACTIVE = 1
    REDUCED_DISTANT = 2
    REDUCED_REPULSION = 3
    REDUCED_CRITICAL = 4
    STOPPED_INFEASIBLE = 8
    STOPPED_SOLVER = 9
    FAULT_NOT_FINITE = 16
    FAULT_JOINT_LIMIT = 17
    FAULT_READING = 18
    FAULT_STALE = 19
    FAULT_TIME = 20
    FAULT_DEADLINE = 21
    FAULT_OBSTACLE_INSIDE = 22

    @property
    def success(self) -> bool:
        """True if q̇ solves a QP and was certified."""
        return self < Status.STOPPED_INFEASIBLE

    @property
    def fault(self) -> bool:
        """True if the input was refused and the arm brakes to a stop."""
        return self >= Status.FAULT_NOT_FINITE


@dataclass(frozen=True, slots=True)
class Measurement:
    """What the skin, and other sources, saw.

    Attributes:
        time: of the cycle, on a monotonic clock [s].
        tof_range: (S,) distance per range sensor, 0 to its range; equal to the range: nothing seen [m].
        capacitive: (C,) bool, switch closed.
        tof_age: (S,) age of each reading [s], or None: all fresh.
        capacitive_age: (C,) age of each sample [s], or None: all fresh.
        points: (P, 3) further obstacle points, world frame [m].
    """

    time: float
    tof_range: Array
    capacitive: NDArray[np.bool_]
    tof_age: Array | None = None
    capacitive_age: Array | None = None
    points: Array = field(default_factory=lambda: np.empty((0, 3)))


@dataclass(frozen=True)
class Diagnostics:
    """The QP of the cycle and how it was decided. R = rows, in the order of docs/method.md.

    Matrices are those of stage 0 (all rows); the rows that were dropped or raised follow from the status.

    Attributes:
        H: (n, n), without slack columns.
        g: (n,).
        A: (R, n); the content of a row that is off means nothing.
        ubA: (R,); OFF where the row is off. lbA is -OFF always.
        lb: (n,) [rad/s].
        ub: (n,) [rad/s].
        row_on: (R,) bool, the rows of stage 0.
        distance: (L,) nearest distance per capsule in the chosen reference [m]; inf beyond influence.
        nearest_point: (L, 3) obstacle point that it belongs to, world [m]; nan where there is none.
        approach_speed: (L,) law (13) at that distance, before the row-speed floor [m/s]; inf where none.
        manipulability: w of (14).
        damping: lambda of (15) with the floor.
        slack: (R,) how far each soft row was exceeded; zeros in staged mode.
        kkt_residual: greatest residual of the certificate; nan if nothing was solved.
        iterations: working-set changes in this cycle, all stages.
        solves: QPs solved in this cycle, all stages and second chances.
        second_chances: solves whose first answer failed the certificate.
        self_readings: readings and switches that the arm itself explains; 0 without self-measurement removal.
        memory_points: used slots of the memory; 0 without one.
        self_distance: (L,) to the nearest self-collision point [m]; inf: none within self_d_a; (0,) without.
        circulating: whether the task velocity is that of circulation.
        tangent: (3,) direction of circulation; (0,) without it.
    """

    H: Array
    g: Array
    A: Array
    ubA: Array
    lb: Array
    ub: Array
    row_on: NDArray[np.bool_]
    distance: Array
    nearest_point: Array
    approach_speed: Array
    manipulability: float
    damping: float
    slack: Array
    kkt_residual: float
    iterations: int
    solves: int
    second_chances: int
    self_readings: int = field(default_factory=int)
    memory_points: int = field(default_factory=int)
    self_distance: Array = field(default_factory=lambda: np.empty(0))
    circulating: bool = field(default_factory=bool)
    tangent: Array = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True, slots=True)
class Command:
    """What a cycle decided.

    Attributes:
        qdot: (n,) joint velocity, always finite and within its bounds [rad/s].
        status: how it was found.
        diagnostics: the QP behind it.
    """

    qdot: Array
    status: Status
    diagnostics: Diagnostics


class Controller(Protocol):
    """A reactive controller; with the state of docs/method.md between cycles."""

    @property
    def parameters(self) -> Mapping[str, float | Array]:
        """All run-time parameters by name (see `docs/method.md`, table of parameters)."""

    def set_parameters(self, **values: Any) -> None:
        """Change parameters by name; refuses (ControllerError) a value out of range and then changes none."""

    def reset(self) -> None:
        """Forget the previous velocity, the previous time, the warm start, and what additions remember."""

    def step(self, q: Array, xdot: Array, measurement: Measurement) -> Command:
        """One control cycle: joint positions (n,), task velocity (m,) and a measurement to a velocity."""
