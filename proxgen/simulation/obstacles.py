"""The obstacles of a scene: where each is at any time, and which of its points is nearest to the arm."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, Self, get_args

import numpy as np
from numpy.typing import NDArray

from proxgen.simulation.geometry import (
    Nearest,
    point_to_box,
    point_to_capsule,
    point_to_sphere,
    segment_to_box,
    segment_to_capsule,
    segment_to_sphere,
)

Array = NDArray[np.float64]
Shape = Literal["box", "sphere", "capsule"]


@dataclass(frozen=True)
class Motion:
    """To and fro along a line, in closed form: out, hold, back, rest until the period ends.

    Attributes:
        direction: (3,) unit vector, world.
        distance: how far out [m].
        speed: of both ways [m/s].
        hold: time spent at the far end [s].
        period: time after which it begins again [s].
        phase: how far into its period the motion is at time 0 [s].
    """

    direction: Array
    distance: float
    speed: float
    hold: float
    period: float
    phase: float

    def displacement(self, time: float) -> Array:
        """Displacement from the resting place at `time` [s], (3,) [m]."""
        clock = (time + self.phase) % self.period
        way = self.distance / self.speed
        back = clock - way - self.hold
        if clock < way:
            travelled = self.speed * clock
        elif back < 0.0:
            travelled = self.distance
        else:
            travelled = max(self.distance - self.speed * back, 0.0)
        return travelled * self.direction


@dataclass(frozen=True)
class Obstacle:
    """A convex solid that may move along a line.

    Attributes:
        name: as in the scene.
        shape: box, sphere or capsule (its axis is the z axis of its frame).
        half_size: (3,) of a box, half of its edges x, y, z; zeros otherwise [m].
        radius: of a sphere or a capsule [m]; 0 for a box.
        length: of a capsule's axis, without the caps [m]; 0 otherwise.
        position: (3,) centre at rest, world [m].
        rotation: (3, 3) from its frame to the world.
        motion: None if it stands still.
    """

    name: str
    shape: Shape
    half_size: Array
    radius: float
    length: float
    position: Array
    rotation: Array
    motion: Motion | None = None

    def position_at(self, time: float) -> Array:
        """Centre at `time` [s], (3,) [m]."""
        return self.position if self.motion is None else self.position + self.motion.displacement(time)

    def to_plain(self) -> dict[str, Any]:
        """As texts, numbers and lists, for a log."""
        plain: dict[str, Any] = {
            "name": self.name,
            "shape": self.shape,
            "half_size": self.half_size.tolist(),
            "radius": self.radius,
            "length": self.length,
            "position": self.position.tolist(),
            "rotation": self.rotation.tolist(),
            "motion": None,
        }
        if self.motion is not None:
            plain["motion"] = vars(self.motion) | {"direction": self.motion.direction.tolist()}
        return plain

    @classmethod
    def from_plain(cls, plain: dict[str, Any]) -> Self:
        """What `to_plain` gave, as an obstacle again."""
        motion = plain["motion"]
        arrays = {name: np.array(plain[name], dtype=float) for name in ("half_size", "position", "rotation")}
        again = None
        if motion is not None:
            again = Motion(**motion | {"direction": np.array(motion["direction"], dtype=float)})
        return cls(**plain | arrays | {"motion": again})


class ObstacleField:
    """All obstacles of a scene, asked for nearest points in one go per shape.

    Attributes:
        obstacles: in the order of the scene; all results are in this order.
    """

    def __init__(self, obstacles: Sequence[Obstacle]) -> None:
        """Sort the obstacles by shape, so that each shape is one array computation."""
        self.obstacles = tuple(obstacles)
        self._moving = [i for i, obstacle in enumerate(self.obstacles) if obstacle.motion is not None]
        self._rest = np.array([o.position for o in self.obstacles], dtype=float).reshape(-1, 3)
        self._rotation = np.array([o.rotation for o in self.obstacles], dtype=float).reshape(-1, 3, 3)
        self._half_size = np.array([o.half_size for o in self.obstacles], dtype=float).reshape(-1, 3)
        self._radius = np.array([o.radius for o in self.obstacles], dtype=float)
        self._half_axis = (
            0.5 * np.array([o.length for o in self.obstacles])[:, None] * self._rotation[:, :, 2]
        )
        self._of_shape = {
            shape: np.array([i for i, o in enumerate(self.obstacles) if o.shape == shape], dtype=np.intp)
            for shape in get_args(Shape)
        }

    def __len__(self) -> int:
        return len(self.obstacles)

    def positions(self, time: float) -> Array:
        """Centres of all obstacles at `time` [s], (O, 3) [m]."""
        if not self._moving:
            return self._rest
        positions = self._rest.copy()
        for index in self._moving:
            positions[index] = self.obstacles[index].position_at(time)
        return positions

    def near_points(self, time: float, points: Array) -> Nearest:
        """Nearest point of every obstacle to every point.

        Args:
            time: [s].
            points: (P, 3), world [m].

        Returns:
            Points (P, O, 3) in the world, and signed distances (P, O).
        """
        return self._near(time, points, points)

    def near_segments(self, time: float, starts: Array, ends: Array) -> Nearest:
        """Nearest point of every obstacle to every segment, such as the capsules' axes.

        Args:
            time: [s].
            starts: (L, 3), world [m].
            ends: (L, 3), world [m].

        Returns:
            Points (L, O, 3) in the world (on the axis itself where it enters the obstacle), and signed
            distances (L, O) from the segment to the obstacle's surface.
        """
        return self._near(time, starts, ends)

    def _near(self, time: float, starts: Array, ends: Array) -> Nearest:
        count = len(starts)
        points, distance = np.empty((count, len(self), 3)), np.empty((count, len(self)))
        centres = self.positions(time)
        for shape, indices in self._of_shape.items():
            if len(indices):
                near = self._near_shape(shape, indices, centres[indices], starts, ends)
                points[:, indices] = near.point.reshape(count, len(indices), 3)
                distance[:, indices] = near.distance.reshape(count, len(indices))
        return Nearest(points, distance)

    def _near_shape(
        self, shape: str, indices: NDArray[np.intp], centres: Array, starts: Array, ends: Array
    ) -> Nearest:
        """Nearest points of the obstacles of one shape: points if `starts` is `ends`, else segments."""
        pointwise, radii = starts is ends, self._radius[indices]
        starts, ends = starts[:, None], ends[:, None]
        if shape == "sphere":
            if pointwise:
                return point_to_sphere(starts, centres, radii)
            return segment_to_sphere(starts, ends, centres, radii)
        if shape == "capsule":
            axis = (centres - self._half_axis[indices], centres + self._half_axis[indices])
            if pointwise:
                return point_to_capsule(starts, *axis, radii)
            return segment_to_capsule(starts, ends, *axis, radii)
        rotation = self._rotation[indices]
        local = (_into_frames(starts - centres, rotation), _into_frames(ends - centres, rotation))
        if pointwise:
            near = point_to_box(local[0], self._half_size[indices])
        else:
            near = segment_to_box(*local, np.broadcast_to(self._half_size[indices], local[0].shape))
        world = np.einsum("oij,poj->poi", rotation, near.point) + centres
        return Nearest(world, near.distance)


def _into_frames(offsets: Array, rotation: Array) -> Array:
    """Offsets (P, O, 3) from each obstacle's centre, turned into its frame."""
    turned: Array = np.einsum("oji,poj->poi", rotation, offsets)
    return turned
