"""A model of the robot's control cabinet: commands arrive late, and are followed within limits.

The cabinet interpolates the velocity commands of the control rate for its own, faster servo cycle. It bounds
acceleration and jerk; the `ruckig` library gives the time-optimal profile from the present velocity and
acceleration to the commanded velocity, for every joint by itself.
"""

from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from proxgen.errors import SimulationError

Array = NDArray[np.float64]

_ROUNDING = 1e-9


@dataclass(frozen=True)
class Cabinet:
    """What the cabinet does to commands.

    Attributes:
        latency: from the controller's decision to the first effect [s].
        acceleration: bound of each joint's acceleration [rad/s^2 or m/s^2].
        jerk: bound of each joint's jerk [rad/s^3 or m/s^3].
        position_gain: of the servo loop that corrects what the motors drift from the profile [1/s].
    """

    latency: float = 0.01
    acceleration: float = 10.0
    jerk: float = 200.0
    position_gain: float = 50.0

    def __post_init__(self) -> None:
        """Refuse what no cabinet can have."""
        if not (
            self.latency >= 0.0 and self.acceleration > 0.0 and self.jerk > 0.0 and self.position_gain >= 0.0
        ):
            raise SimulationError(
                f"a cabinet needs latency >= 0, acceleration > 0, jerk > 0, gain >= 0, not {self}"
            )


class Interpolator:
    """The profile that the servo cycle follows: joint positions and velocities over time."""

    def __init__(self, cabinet: Cabinet, q: Array) -> None:
        """Rest at q (n,) at time 0."""
        from ruckig import ControlInterface, InputParameter, Ruckig, Trajectory

        count = len(q)
        self._cabinet = cabinet
        self._planner: Any = Ruckig(count)
        self._input: Any = InputParameter(count)
        self._input.control_interface = ControlInterface.Velocity
        self._input.target_acceleration = [0.0] * count
        self._input.max_acceleration = [cabinet.acceleration] * count
        self._input.max_jerk = [cabinet.jerk] * count
        self._profile: Any = Trajectory(count)
        self._begin = 0.0
        self._pending: deque[tuple[float, Array]] = deque()
        self._plan(0.0, (list(q), [0.0] * count, [0.0] * count), np.zeros(count))

    def command(self, time: float, qdot: Array) -> None:
        """A command q̇ (n,) that leaves the controller at `time` [s]; it takes effect `latency` later."""
        self._pending.append((time + self._cabinet.latency, np.array(qdot, dtype=float)))

    def at(self, time: float) -> tuple[Array, Array]:
        """Joint positions and velocities (n,), (n,) of the profile at `time` [s], which must not go back."""
        while self._pending and self._pending[0][0] <= time + _ROUNDING:
            arrival, qdot = self._pending.popleft()
            self._plan(arrival, self._profile.at_time(max(arrival - self._begin, 0.0)), qdot)
        position, velocity, _ = self._profile.at_time(time - self._begin)
        return np.array(position), np.array(velocity)

    def _plan(self, time: float, state: tuple[list[float], list[float], list[float]], qdot: Array) -> None:
        """A new profile from `time` on."""
        self._input.current_position, self._input.current_velocity, self._input.current_acceleration = state
        self._input.target_velocity = qdot.tolist()
        result = self._planner.calculate(self._input, self._profile)
        if int(result) < 0:
            raise SimulationError(f"the cabinet finds no profile to the velocity {qdot.tolist()} ({result})")
        self._begin = time
