"""What the controller is told: the readings of the skin, or ideal obstacle points."""

from collections.abc import Sequence
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from proxgen.config.schema import Capacitive, TimeOfFlight
from proxgen.controllers.protocol import Measurement
from proxgen.errors import SimulationError, unknown_name
from proxgen.model.frames import axis_basis
from proxgen.model.robot_model import SensorModule
from proxgen.simulation.arm import ArmGeometry, SensorFrame
from proxgen.simulation.geometry import dot, norm
from proxgen.simulation.obstacles import ObstacleField
from proxgen.simulation.plant import JointHistory
from proxgen.simulation.sampling import SampledGroup, Timing
from proxgen.simulation.self_measurement import SelfMeasurement
from proxgen.simulation.world import World

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Mode = Literal["skin", "ideal"]


class Sensing(Protocol):
    """Something that measures in every cycle."""

    def measure(self, time: float, history: JointHistory) -> Measurement:
        """What is known of the obstacles at `time` [s], given where the joints were."""

    def close(self) -> None:
        """Release what the sensors hold."""


class IdealSensing:
    """Exact points: for every capsule's axis and every obstacle the obstacle's nearest point."""

    def __init__(self, field: ObstacleField, arm: ArmGeometry, max_points: int) -> None:
        """Measure `field` against `arm`; of more than `max_points` points the nearest are kept."""
        self._field, self._arm, self._max_points = field, arm, max_points
        self._silent = np.array([_tof(module).range for module in arm.model.tof_modules], dtype=float)
        self._open = np.zeros(len(arm.model.capacitive_modules), dtype=bool)

    def measure(self, time: float, history: JointHistory) -> Measurement:
        """The nearest points as `Measurement.points`, fresh; the skin's own sensors see nothing."""
        near = self._field.near_segments(time, *self._arm.axes(self._arm.poses(history.at(time))))
        points, distance = near.point.reshape(-1, 3), near.distance.ravel()
        if len(points) > self._max_points:
            points = points[np.sort(np.argsort(distance, kind="stable")[: self._max_points])]
        return Measurement(time, self._silent.copy(), self._open.copy(), points=points)

    def close(self) -> None:
        """Nothing is held."""


class SkinSensing:
    """The cuffs' range sensors and switches, each sampled at its own rate and held between its samples."""

    def __init__(
        self,
        field: ObstacleField,
        arm: ArmGeometry,
        *,
        seed: int,
        arm_in_rays: bool = False,
        discard_own: bool = True,
        gui: bool = False,
    ) -> None:
        """Put the sensors of `arm` into a world with `field`.

        Args:
            field: the obstacles.
            arm: the arm with its sensor modules.
            seed: of noise and dropouts.
            arm_in_rays: sensors see the arm too.
            discard_own: the skin discards such readings (`SelfMeasurement`); else the controller has to.
            gui: show the world in a window.
        """
        self._field, self._arm = field, arm
        self._world = World(field, arm, arm_in_rays=arm_in_rays, gui=gui)
        self._own = SelfMeasurement(arm) if arm_in_rays and discard_own else None
        self._raw = SelfMeasurement(arm, margin=0.0) if arm_in_rays and not discard_own else None
        ranging, switches = arm.model.tof_modules, arm.model.capacitive_modules
        self._ranging, self._switches = _RangeSensors(ranging), _Switches(switches)
        tof_seed, switch_seed = np.random.SeedSequence(seed).spawn(2)
        self._tof_groups = _groups([_tof_timing(_tof(module)) for module in ranging], tof_seed)
        self._switch_groups = _groups(
            [_switch_timing(_capacitive(module)) for module in switches], switch_seed
        )
        self._poses: dict[float, Array] = {}

    def measure(self, time: float, history: JointHistory) -> Measurement:
        """Readings that have arrived by `time` [s], and their ages."""
        self._poses.clear()

        def read_ranges(sampled: float, indices: Indices, noise: Array) -> Array:
            return self._read_ranges(sampled, self._poses_at(sampled, history), indices, noise)

        def read_switches(sampled: float, indices: Indices, noise: Array) -> Array:
            return self._read_switches(sampled, self._poses_at(sampled, history), indices)

        tof_range, tof_age = np.empty(len(self._ranging.range)), np.empty(len(self._ranging.range))
        for group in self._tof_groups:
            tof_range[group.indices], tof_age[group.indices] = group.update(time, read_ranges)
        closed, age = np.empty(len(self._switches.trigger)), np.empty(len(self._switches.trigger))
        for group in self._switch_groups:
            closed[group.indices], age[group.indices] = group.update(time, read_switches)
        return Measurement(time, tof_range, closed > 0.5, tof_age, age)

    def close(self) -> None:
        """Close the world."""
        self._world.close()

    def _poses_at(self, time: float, history: JointHistory) -> Array:
        """Body poses at a sampling time, computed once per cycle."""
        if time not in self._poses:
            self._poses[time] = self._arm.poses(history.at(time))
        return self._poses[time]

    def _read_ranges(self, time: float, poses: Array, indices: Indices, noise: Array) -> Array:
        """Range readings: the least of a sensor's rays, with noise, put on its axis [m]."""
        sensors, furthest = self._ranging, self._ranging.range[indices]
        origins, directions = sensors.rays(poses, indices)
        self._world.place(time, poses)
        ends = origins + furthest[:, None, None] * directions
        carriers = np.repeat(sensors.frame.body[indices], sensors.RAYS)
        fractions = self._world.rays(origins.reshape(-1, 3), ends.reshape(-1, 3), carriers)
        seen = furthest * fractions.reshape(len(indices), sensors.RAYS).min(axis=1)
        readings = np.where(seen < furthest, np.clip(seen + noise, 0.0, furthest), furthest)
        if self._own is not None:
            own = self._own.of_ranges(poses, origins, directions, sensors.frame.body[indices], readings)
            readings = np.where(own, furthest, readings)
        return readings

    def _read_switches(self, time: float, poses: Array, indices: Indices) -> Array:
        """1 where something's nearest point is within trigger distance and cone, else 0."""
        switches = self._switches
        positions, normals = switches.frame.place(poses, indices)
        near = self._field.near_points(time, positions)
        offset = near.point - positions[:, None]
        length = norm(offset)
        trigger, cosine = switches.trigger[indices, None], switches.cosine[indices, None]
        in_cone = dot(offset, normals[:, None]) >= cosine * length
        closed = ((length <= trigger) & in_cone).any(axis=1)
        carriers = switches.frame.body[indices]
        if self._own is not None:
            closed &= ~self._own.of_switches(poses, positions, normals, carriers, trigger, cosine)
        if self._raw is not None:
            closed |= self._raw.of_switches(poses, positions, normals, carriers, trigger, cosine)
        return closed.astype(float)


class _RangeSensors:
    """Rays of the time-of-flight sensors: the axis, and four at half the cone around it."""

    RAYS = 5

    def __init__(self, modules: Sequence[SensorModule]) -> None:
        self.frame = SensorFrame(modules)
        self.range = np.array([_tof(module).range for module in modules], dtype=float)
        self._directions = np.array([_cone_rays(m.normal, _tof(m).cone) for m in modules], dtype=float)

    def rays(self, poses: Array, indices: Indices) -> tuple[Array, Array]:
        """Origins and unit directions in the world, each (K, 5, 3), of the sensors with the given indices."""
        positions, _ = self.frame.place(poses, indices)
        rotations = poses[self.frame.body[indices], :3, :3]
        directions = np.einsum("kij,krj->kri", rotations, self._directions[indices])
        return np.broadcast_to(positions[:, None], directions.shape), directions


class _Switches:
    """The capacitive switches: near, wide and binary."""

    def __init__(self, modules: Sequence[SensorModule]) -> None:
        self.frame = SensorFrame(modules)
        self.trigger = np.array([_capacitive(module).trigger for module in modules], dtype=float)
        self.cosine = np.array([np.cos(0.5 * _capacitive(module).cone) for module in modules], dtype=float)


def _tof(module: SensorModule) -> TimeOfFlight:
    """The range sensor of a module that has one."""
    assert module.tof is not None
    return module.tof


def _capacitive(module: SensorModule) -> Capacitive:
    """The switch of a module that has one."""
    assert module.capacitive is not None
    return module.capacitive


def _cone_rays(normal: Array, cone: float) -> Array:
    """Unit vectors (5, 3): the normal, and four at half of the opening angle `cone` [rad] around it."""
    basis, half = axis_basis(normal), 0.5 * cone
    around = [(0.0, 0.0), (half, 0.0), (half, 0.5 * np.pi), (half, np.pi), (half, 1.5 * np.pi)]
    return np.array(
        [basis @ [np.sin(a) * np.cos(turn), np.sin(a) * np.sin(turn), np.cos(a)] for a, turn in around]
    )


def _tof_timing(tof: TimeOfFlight) -> Timing:
    return Timing(tof.rate, tof.latency, tof.dropout, tof.noise)


def _switch_timing(switch: Capacitive) -> Timing:
    return Timing(switch.rate, switch.latency, switch.dropout)


def _groups(timings: Sequence[Timing], seed: np.random.SeedSequence) -> list[SampledGroup]:
    """Sensors that sample alike, group by group, each with luck of its own."""
    distinct = list(dict.fromkeys(timings))
    return [
        SampledGroup(np.flatnonzero([own == timing for own in timings]), timing, group_seed)
        for timing, group_seed in zip(distinct, seed.spawn(len(distinct)), strict=True)
    ]


def open_sensing(
    mode: str,
    field: ObstacleField,
    arm: ArmGeometry,
    *,
    max_points: int,
    seed: int,
    arm_in_rays: bool = False,
    discard_own: bool = True,
    gui: bool = False,
) -> Sensing:
    """The sensing of the given `mode`, `skin` or `ideal`; the rest as for `SkinSensing`.

    Raises:
        SimulationError: unknown mode, or no world.
    """
    if mode == "ideal":
        return IdealSensing(field, arm, max_points)
    if mode == "skin":
        return SkinSensing(field, arm, seed=seed, arm_in_rays=arm_in_rays, discard_own=discard_own, gui=gui)
    raise SimulationError(unknown_name("sensing", mode, ("skin", "ideal")))
