"""Self-measurement removal: which readings show the arm itself (docs/method.md)."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from proxgen.controllers.protocol import Array
from proxgen.controllers.reference.geometry import SAME_DISTANCE, Capsules, closest_on_segments
from proxgen.controllers.reference.kinematics import Arm
from proxgen.controllers.reference.places import Places
from proxgen.controllers.reference.tangents import basis_of
from proxgen.model.robot_model import RobotModel, SensorModule

Mask = NDArray[np.bool_]


class SelfMeasurement:
    """Tells what sensors read of the arm itself."""

    def __init__(self, model: RobotModel, capsules: Capsules) -> None:
        """Work out the rays of the range sensors, and which capsules each sensor may see.

        Args:
            model: the arm with its sensors.
            capsules: its capsules.
        """
        ranging, switches = model.tof_modules, model.capacitive_modules
        self._capsules = capsules
        self._tof, self._switches = Places(ranging), Places(switches)
        self._rays = np.array([rays(module) for module in ranging]).reshape(-1, 5, 3)
        self._tof_sees = _others(ranging, capsules)
        self._switch_sees = _others(switches, capsules)
        cells = [module.capacitive for module in switches if module.capacitive]
        self._trigger = np.array([cell.trigger for cell in cells])
        self._cosine = np.cos([0.5 * cell.cone for cell in cells])

    def of_ranges(self, arm: Arm, which: NDArray[np.intp], readings: Array, margin: float) -> Mask:
        """Which readings are explained by the arm: a place that they may come from lies in a thicker capsule.

        Args:
            arm: at its present position.
            which: (K,) range sensors.
            readings: (K,) what they read [m].
            margin: by which capsules are thicker [m].
        """
        local = self._tof.position[which, None] + readings[:, None, None] * self._rays[which]
        bodies = np.repeat(self._tof.body[which], 5)
        inside = self._capsules.surface_distance(arm, arm.in_world(bodies, local.reshape(-1, 3)))
        hit = np.any((inside <= margin + SAME_DISTANCE).reshape(len(inside), len(which), 5), axis=2)
        return _any_seen(hit, self._tof_sees[which])

    def of_switches(self, arm: Arm, which: NDArray[np.intp], margin: float) -> Mask:
        """Which of the switches (K,) the arm may have closed: a thicker capsule is within reach and cone."""
        origin = self._switches.points(arm, which, np.zeros(len(which)))
        normal = self._switches.normals(arm, which)
        offset = closest_on_segments(origin, *self._capsules.place(arm)) - origin
        length = np.sqrt((offset * offset).sum(axis=2))
        gap = length - self._capsules.radius[:, None] - margin
        in_cone = (offset * normal).sum(axis=2) >= self._cosine[which] * length - SAME_DISTANCE
        near = gap <= self._trigger[which] + SAME_DISTANCE
        return _any_seen((gap <= SAME_DISTANCE) | (near & in_cone), self._switch_sees[which])


def _any_seen(hit: Any, sees: Mask) -> Mask:
    """(K,) whether any of the capsules that are hit (L, K) is one that the sensor may see (K, L)."""
    found: Mask = np.any(hit & sees.T, axis=0)
    return found


def rays(module: SensorModule) -> Array:
    """Rays of a range sensor (5, 3), body frame: the normal, and four at half of its opening angle."""
    assert module.tof is not None
    basis, half = basis_of(module.normal), 0.5 * module.tof.cone
    around = [
        np.sin(half) * (np.cos(turn) * basis.first + np.sin(turn) * basis.second) + np.cos(half) * basis.third
        for turn in (0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi)
    ]
    return np.array([module.normal, *around])


def _others(modules: Sequence[SensorModule], capsules: Capsules) -> Mask:
    """(S, L) whether each capsule is on another body than the sensor."""
    bodies = np.array([module.body for module in modules], dtype=int)
    others: Mask = bodies[:, None] != capsules.body
    return others
