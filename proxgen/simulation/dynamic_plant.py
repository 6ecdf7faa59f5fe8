"""The dynamic plant: a pybullet arm with velocity motors behind a model of the control cabinet."""

import numpy as np
from numpy.typing import NDArray

from proxgen.model.robot_model import RobotModel
from proxgen.simulation.cabinet import Cabinet, Interpolator
from proxgen.simulation.world import DynamicArm

Array = NDArray[np.float64]

SERVO_PERIOD = 1e-3
"""Time step of servo loop and physics [s]."""


class DynamicPlant:
    """Commands reach the motors late, smoothed by the cabinet; the arm has masses and limited motors."""

    name = "dynamic"

    def __init__(self, model: RobotModel, cabinet: Cabinet | None = None) -> None:
        """Build the arm; it rests at zero until `reset`.

        Args:
            model: the arm, with the masses and effort limits of its URDF.
            cabinet: latency and limits.
        """
        self.cabinet = cabinet or Cabinet()
        self._arm = DynamicArm(model, SERVO_PERIOD)
        self.reset(np.zeros(model.n))

    @property
    def q(self) -> Array:
        """(n,) joint positions now [rad or m]."""
        return self._q

    def reset(self, q: Array) -> None:
        """Stand still at q (n,), with no command on its way."""
        self._q = np.array(q, dtype=float)
        self._arm.reset(self._q)
        self._ticks = 0
        self._profile = Interpolator(self.cabinet, self._q)

    def advance(self, qdot: Array, duration: float) -> list[tuple[float, Array]]:
        """Send q̇ (n,) to the cabinet and let `duration` [s] pass, in whole servo periods.

        Returns:
            Pairs (time since the call [s], joint positions (n,)), one per servo period.
        """
        count = max(round(duration / SERVO_PERIOD), 1)
        self._profile.command(self._ticks * SERVO_PERIOD, qdot)
        states = []
        for step in range(1, count + 1):
            wanted, speed = self._profile.at((self._ticks + step) * SERVO_PERIOD)
            motors = speed + self.cabinet.position_gain * (wanted - speed * SERVO_PERIOD - self._q)
            self._q = self._arm.step(motors)
            states.append((duration * step / count, self._q))
        self._ticks += count
        return states

    def close(self) -> None:
        """Release the physics."""
        self._arm.close()
