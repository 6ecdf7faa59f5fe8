"""The moving arm, as the controller finds it: what becomes of a velocity command."""

from bisect import bisect_right
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class JointHistory:
    """Where the joints were: sensors sample between the control cycles, and some readings arrive late."""

    def __init__(self, q: Array) -> None:
        """The arm has stood at q (n,) for ever."""
        self._times = [0.0]
        self._positions = [np.array(q, dtype=float)]

    @property
    def time(self) -> float:
        """Latest time that is known [s]."""
        return self._times[-1]

    @property
    def q(self) -> Array:
        """(n,) joint positions at the latest time."""
        return self._positions[-1]

    def append(self, time: float, q: Array) -> None:
        """Add the joint positions q (n,) at a later time [s]."""
        self._times.append(time)
        self._positions.append(np.array(q, dtype=float))

    def at(self, time: float) -> Array:
        """Joint positions (n,) at `time` [s], interpolated; at rest before the start."""
        index = bisect_right(self._times, time)
        if index == 0:
            return self._positions[0]
        if index == len(self._times):
            return self._positions[-1]
        before, after = self._times[index - 1], self._times[index]
        fraction = (time - before) / (after - before)
        between: Array = (1.0 - fraction) * self._positions[index - 1] + fraction * self._positions[index]
        return between


class Plant(Protocol):
    """An arm that takes joint velocities.

    Attributes:
        name: as a log calls it.
    """

    name: str

    @property
    def q(self) -> Array:
        """(n,) joint positions now [rad or m]."""

    def reset(self, q: Array) -> None:
        """Stand still at q (n,)."""

    def advance(self, qdot: Array, duration: float) -> list[tuple[float, Array]]:
        """Command q̇ (n,) and let `duration` [s] pass.

        Returns:
            Pairs (time since the call [s], joint positions (n,)), the last one at `duration`; between them
            the motion is close to linear.
        """

    def close(self) -> None:
        """Release what the plant holds."""


class KinematicPlant:
    """Follows every command at once and exactly: q <- q + q̇ dt."""

    name = "kinematic"

    def __init__(self, q: Array) -> None:
        """Stand still at q (n,)."""
        self._q = np.array(q, dtype=float)

    @property
    def q(self) -> Array:
        """(n,) joint positions now [rad or m]."""
        return self._q

    def reset(self, q: Array) -> None:
        """Stand still at q (n,)."""
        self._q = np.array(q, dtype=float)

    def advance(self, qdot: Array, duration: float) -> list[tuple[float, Array]]:
        """Integrate q̇ (n,) over `duration` [s]; one pair."""
        self._q = self._q + qdot * duration
        return [(duration, self._q)]

    def close(self) -> None:
        """Nothing is held."""
