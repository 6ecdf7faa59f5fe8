"""Memory of seen points: what a range sensor saw stays an obstacle for a while (docs/method.md)."""

import numpy as np

from proxgen.controllers.protocol import Array
from proxgen.controllers.reference.geometry import SAME_DISTANCE, Capsules, first_within
from proxgen.controllers.reference.kinematics import Arm
from proxgen.controllers.reference.parameters import Parameters
from proxgen.controllers.reference.places import Places
from proxgen.model.robot_model import RobotModel


class PointMemory:
    """Slots with points and the times at which they were last seen."""

    def __init__(self, model: RobotModel, capsules: Capsules, capacity: int, cone: float) -> None:
        """All slots are free.

        Args:
            model: the arm with its range sensors.
            capsules: its capsules.
            capacity: number of slots.
            cone: part of a sensor's opening angle in which it is believed to see through.
        """
        self._capsules, self._capacity = capsules, capacity
        self._places = Places(model.tof_modules)
        self._cosine = np.cos([0.5 * cone * module.tof.cone for module in model.tof_modules if module.tof])
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._point = np.zeros((self._capacity, 3))
        self._time = np.zeros(self._capacity)
        self._used = np.zeros(self._capacity, dtype=bool)

    @property
    def points(self) -> Array:
        """The points of the used slots in their order, (K, 3), world [m]."""
        remembered: Array = self._point[self._used]
        return remembered

    def update(self, time: float, arm: Arm, readings: Array, seen: Array, p: Parameters) -> None:
        """Forget what is old or seen through, and store what is seen.

        Args:
            time: of the cycle [s].
            arm: at its present position.
            readings: (S,) of all range sensors [m].
            seen: points (K, 3) that range sensors gave in this cycle, in their order, world [m].
            p: distances and the age.
        """
        self._used &= time - self._time <= p.memory_age
        self._used &= (self._capsules.surface_distance(arm, self._point) > SAME_DISTANCE).all(axis=0)
        self._see_through(arm, readings, p.memory_margin)
        for point in self._near(arm, seen, p.memory_reach):
            self._store(point, time, p.memory_merge)

    def _see_through(self, arm: Arm, readings: Array, margin: float) -> None:
        """Free the slots of points that some sensor sees through."""
        every = np.arange(len(readings))
        offset = self._point - self._places.points(arm, every, np.zeros(len(readings)))[:, None]
        length = np.sqrt((offset * offset).sum(axis=2))
        along = (offset * self._places.normals(arm, every)[:, None]).sum(axis=2)
        nearer = length < readings[:, None] - margin - SAME_DISTANCE
        in_cone = along >= self._cosine[:, None] * length - SAME_DISTANCE
        self._used &= ~(nearer & in_cone).any(axis=0)

    def _near(self, arm: Arm, points: Array, reach: float) -> Array:
        """Those of the points (K, 3) that are within reach of some capsule's axis."""
        distance = self._capsules.surface_distance(arm, points) + self._capsules.radius[:, None]
        near: Array = points[(distance <= reach + SAME_DISTANCE).any(axis=0)]
        return near

    def _store(self, point: Array, time: float, merge: float) -> None:
        """Put a point (3,) into the slot of the nearest one, a free one, or that of the oldest."""
        offset = self._point - point
        distance = np.where(self._used, np.sqrt((offset * offset).sum(axis=1)), np.inf)
        slot = first_within(distance, merge)
        if slot is None:
            slot = int(np.argmin(np.where(self._used, self._time, -np.inf)))
        self._point[slot], self._time[slot], self._used[slot] = point, time, True
