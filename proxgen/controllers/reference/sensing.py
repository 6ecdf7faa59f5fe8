"""Step 2: from readings to obstacle points, with self-measurement removal and memory where they are on."""

from dataclasses import dataclass

import numpy as np

from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array, Measurement
from proxgen.controllers.reference.geometry import Capsules
from proxgen.controllers.reference.kinematics import Arm
from proxgen.controllers.reference.memory import PointMemory
from proxgen.controllers.reference.parameters import Parameters
from proxgen.controllers.reference.places import Places
from proxgen.controllers.reference.self_measurement import SelfMeasurement
from proxgen.model.robot_model import RobotModel


@dataclass(frozen=True)
class Seen:
    """What a cycle's measurement, and the memory, say of obstacles.

    Attributes:
        points: (P, 3) in the order of docs/method.md, world [m].
        self_readings: number of readings and switches that the arm itself explains.
        memory_points: how many of the points are remembered ones.
    """

    points: Array
    self_readings: int
    memory_points: int


class Eyes:
    """The skin, as the controller sees with it.

    Attributes:
        tof_limit: (S,) greatest reading of each range sensor [m]; such a reading means that nothing was seen.
    """

    def __init__(self, config: Config, model: RobotModel, capsules: Capsules) -> None:
        """Collect the sensors' places, once.

        Args:
            config: which additions are on.
            model: the arm with its sensors.
            capsules: its capsules.
        """
        switches, memory = model.capacitive_modules, config.skin.memory
        self._tof, self._switches = Places(model.tof_modules), Places(switches)
        virtual = [module.capacitive.virtual_distance for module in switches if module.capacitive]
        self._virtual = np.array(virtual)
        self.tof_limit = np.array([module.tof.range for module in model.tof_modules if module.tof])
        self._removal = SelfMeasurement(model, capsules) if config.skin.self_measurement.enabled else None
        self._memory = PointMemory(model, capsules, memory.capacity, memory.cone) if memory.enabled else None

    def reset(self) -> None:
        """Forget what was seen."""
        if self._memory is not None:
            self._memory.reset()

    def see(self, arm: Arm, measurement: Measurement, p: Parameters) -> Seen:
        """All obstacle points of a cycle.

        Args:
            arm: at its present position.
            measurement: of a cycle that has passed the checks of step 0.
            p: margins of the additions.
        """
        readings = np.asarray(measurement.tof_range, dtype=float)
        seen, closed = np.flatnonzero(readings < self.tof_limit), np.flatnonzero(measurement.capacitive)
        found = len(seen) + len(closed)
        if self._removal is not None:
            margin = p.self_measurement_margin
            seen = seen[~self._removal.of_ranges(arm, seen, readings[seen], margin)]
            closed = closed[~self._removal.of_switches(arm, closed, margin)]
        ranged = self._tof.points(arm, seen, readings[seen])
        given = np.reshape(np.asarray(measurement.points, dtype=float), (-1, 3))
        points = [ranged, self._switches.points(arm, closed, self._virtual[closed]), given]
        if self._memory is not None:
            self._memory.update(measurement.time, arm, readings, ranged, p)
            points.append(self._memory.points)
        remembered = len(points[-1]) if self._memory is not None else 0
        return Seen(np.concatenate(points), found - len(seen) - len(closed), remembered)
