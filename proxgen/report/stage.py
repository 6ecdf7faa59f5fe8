"""A run on a stage: any of its cycles as a picture, and what is to be marked in it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from proxgen.model.robot_model import RobotModel
from proxgen.report.derive import Zone, with_pedestal, zones
from proxgen.report.outlines import box_corners
from proxgen.report.path import centres, obstacles_of
from proxgen.simulation.arm import ArmGeometry, SensorFrame
from proxgen.simulation.log import RolloutLog
from proxgen.simulation.obstacles import ObstacleField
from proxgen.simulation.world import Camera, Closing, Shot, World

Array = NDArray[np.float64]

_POSTURES = 40
"""Moments of a run at which the arm has to fit into the picture."""


@dataclass(frozen=True)
class Gap:
    """The way from a link to its nearest obstacle, and the zone of the approach law that it is in.

    Attributes:
        link: (3,) its end on the arm: on the capsule's axis or surface, as distances are measured [m].
        obstacle: (3,) its end on the obstacle [m].
        distance: its length [m].
        zone: of the approach law.
    """

    link: Array
    obstacle: Array
    distance: float
    zone: Zone


@dataclass(frozen=True)
class Modules:
    """The skin's modules at one moment.

    Attributes:
        position: (S, 3) world [m].
        normal: (S, 3) world.
        near: (S,) the range sensor sees something nearer than the approach law begins.
        closed: (S,) the switch is closed.
    """

    position: Array
    normal: Array
    near: NDArray[np.bool_]
    closed: NDArray[np.bool_]


class Stage(Closing):
    """A world with the obstacles of a log, the arm that ran, and a camera that sees them all.

    Attributes:
        log: the run.
        camera: with which pictures are taken.
    """

    def __init__(self, log: RolloutLog, model: RobotModel, camera: Camera) -> None:
        """Set up the scene.

        Args:
            log: the run.
            model: the arm that ran.
            camera: where pictures are taken from.
        """
        self.log = log
        self._arm, self._drawn = ArmGeometry(model), ArmGeometry(with_pedestal(model))
        self._skin, self._frame = model.modules, SensorFrame(model.modules)
        self._field = ObstacleField(obstacles_of(log))
        self.camera = camera
        self._world = World(self._field, self._drawn)

    def close(self) -> None:
        """Release the world; closing twice does nothing."""
        self._world.close()

    def shoot(self, cycle: int, enlarged: float = 1.0) -> Shot:
        """Arm, obstacles and targets as they were in a cycle, with a multiple of the camera's pixels."""
        return self._world.shoot(
            float(self.log.time[cycle]),
            self._drawn.poses(self.log.q[cycle]),
            camera=self.camera.enlarged(enlarged),
            targets=np.array(self.log.meta["targets"]).reshape(-1, 3),
        )

    def gaps(self, cycle: int) -> list[Gap]:
        """The ways from links to obstacles that are short enough for the approach law, the shortest last."""
        if not len(self._field):
            return []
        starts, ends = self._arm.axes(self._arm.poses(self.log.q[cycle]))
        near = self._field.near_segments(float(self.log.time[cycle]), starts, ends)
        surface = self.log.meta["distance_reference"] == "surface"
        found = []
        for index, distances in enumerate(near.distance):
            nearest = int(distances.argmin())
            point = near.point[index, nearest]
            axis = _closest(point, starts[index], ends[index])
            distance = float(distances[nearest])
            if surface:
                axis = axis + self._arm.radius[index] * (point - axis) / max(distance, 1e-9)
                distance -= float(self._arm.radius[index])
            zone = zone_of(self.log, distance)
            if zone is not None:
                found.append(Gap(axis, point, distance, zone))
        return sorted(found, key=lambda gap: -gap.distance)

    def modules(self, cycle: int) -> Modules:
        """The skin and what it felt in a cycle, as far as it took part."""
        count = len(self._skin)
        position, normal = self._frame.place(self._arm.poses(self.log.q[cycle]), np.arange(count))
        near, closed = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        if self.log.meta["sensing"] == "skin":
            begin = zones(self.log)[0].begin
            ranged = [index for index, module in enumerate(self._skin) if module.tof is not None]
            switches = [index for index, module in enumerate(self._skin) if module.capacitive is not None]
            # A sensor that sees nothing reports its range, which may be short.
            ranges = [module.tof.range for module in self._skin if module.tof is not None]
            near[ranged] = self.log.tof_range[cycle] < np.minimum(begin, ranges)
            closed[switches] = self.log.capacitive[cycle]
        return Modules(position, normal, near, closed)


def zone_of(log: RolloutLog, distance: float) -> Zone | None:
    """The zone of the approach law that a distance [m] lies in; None beyond all."""
    inside = [zone for zone in zones(log) if distance <= zone.begin]
    return inside[-1] if inside else None


def fitting_camera(
    log: RolloutLog, model: RobotModel, width: int, height: int, cycles: tuple[int, int] | None = None
) -> Camera:
    """A camera that sees all obstacles on all of their ways, all targets, and the arm as it moves.

    Args:
        log: the run.
        model: the arm that ran.
        width: of the picture [pixels].
        height: of the picture [pixels].
        cycles: first and last one in which the arm has to fit into the picture; by default the whole run.
    """
    arm = ArmGeometry(with_pedestal(model))
    points = [np.array(log.meta["targets"]).reshape(-1, 3)]
    for obstacle in obstacles_of(log):
        reach = obstacle.radius + 0.5 * obstacle.length
        for centre in centres(obstacle):
            points.append(box_corners(obstacle, centre) if reach == 0.0 else _around(centre[None], reach))
    first, last = cycles or (0, log.cycles - 1)
    for cycle in np.linspace(first, last, min(_POSTURES, last - first + 1)).astype(int):
        for ends in arm.axes(arm.poses(log.q[cycle])):
            points += [_around(ends[[index]], float(radius)) for index, radius in enumerate(arm.radius)]
    return Camera(width=width, height=height).fitted(np.concatenate(points))


def _around(points: Array, reach: float) -> Array:
    """Points (6 K, 3) to all sides of points (K, 3) [m]."""
    steps = reach * np.concatenate([np.eye(3), -np.eye(3)])
    around: Array = (points[:, None] + steps).reshape(-1, 3)
    return around


def _closest(point: Array, start: Array, end: Array) -> Array:
    """The point of a segment that is nearest to a point, (3,)."""
    way = end - start
    square = float(way @ way)
    fraction = 0.0 if square == 0.0 else float(np.clip((point - start) @ way / square, 0.0, 1.0))
    closest: Array = start + fraction * way
    return closest
