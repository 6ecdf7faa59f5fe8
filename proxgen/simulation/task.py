"""From a target to the task velocity: a proportional law with bounded speed; the swap when it is reached."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from proxgen.config.schema import Task
from proxgen.errors import SimulationError
from proxgen.model.robot_model import RobotModel

Array = NDArray[np.float64]

_LINEAR = ("x", "y", "z")
_ANGULAR = ("rx", "ry", "rz")


@dataclass(frozen=True)
class Target:
    """Where the tool is to go.

    Attributes:
        position: (3,), world [m].
        rotation: (3, 3) from the tool frame to the world; None: as the tool is at the start.
        time: when to be there [s], if the targets are a trajectory; else None.
    """

    position: Array
    rotation: Array | None = None
    time: float | None = None


@dataclass(frozen=True)
class TaskVelocity:
    """What the tool is to do in one cycle.

    Attributes:
        xdot: (m,) in the rows of the task Jacobian [m/s, rad/s].
        distance: to the target, over the task's position rows [m]; 0 if it has none.
        angle: to the target, over the task's rotation rows [rad]; 0 if it has none.
    """

    xdot: Array
    distance: float
    angle: float


class TargetTracker:
    """Goes through the targets of a scene in a circle.

    Attributes:
        index: of the present target.
        reached: how many were reached so far.
    """

    def __init__(self, task: Task, model: RobotModel, targets: tuple[Target, ...], start: Array) -> None:
        """Begin with the first target.

        Args:
            task: gains, bounds, tolerances.
            model: which rows the task has.
            targets: at least one.
            start: tool pose at the start, 4x4; its orientation is kept where a target has none.

        Raises:
            SimulationError: no target.
        """
        if not targets:
            raise SimulationError("the scene has no target; a task needs at least one")
        self._task, self._model, self._targets = task, model, targets
        self._start_rotation = start[:3, :3].copy()
        self._linear = [_LINEAR.index(row) for row in model.task_rows if row in _LINEAR]
        self._angular = [_ANGULAR.index(row) for row in model.task_rows if row in _ANGULAR]
        self.index = 0
        self.reached = 0
        self._holding = False

    @property
    def target(self) -> Target:
        """The present target."""
        return self._targets[self.index]

    def update(self, tool: Array, time: float = 0.0) -> TaskVelocity:
        """Task velocity at a tool pose (4x4), after taking the next target if the present one is reached.

        A single target is counted once and then held. The time [s] does not matter.
        """
        velocity = self._velocity(tool)
        if not self._holding and self._is_reached(velocity):
            self.reached += 1
            self._holding = len(self._targets) == 1
            self.index = (self.index + 1) % len(self._targets)
            velocity = self._velocity(tool)
        return velocity

    def _is_reached(self, velocity: TaskVelocity) -> bool:
        near = velocity.distance < self._task.tolerance
        return near and velocity.angle < self._task.angular_tolerance

    def _velocity(self, tool: Array) -> TaskVelocity:
        task, target = self._task, self.target
        offset = (target.position - tool[:3, 3])[self._linear]
        linear, distance = _bounded(offset, task.gain, task.max_speed)
        angular, angle = _bounded(
            self._rotation_error(tool)[self._angular], task.gain, task.max_angular_speed
        )
        return TaskVelocity(np.concatenate([linear, angular]), distance, angle)

    def _rotation_error(self, tool: Array) -> Array:
        """Rotation vector that remains, (3,), in the directions of the task's rotation rows [rad]."""
        if not self._angular:
            return np.zeros(3)
        rotation, frame = tool[:3, :3], self._model.task_frame
        wanted = self.target.rotation if self.target.rotation is not None else self._start_rotation
        if frame is None:
            return rotation_vector(wanted @ rotation.T)
        axis = frame[:, 2]
        return frame.T @ rotation.T @ turning_vector(rotation @ axis, wanted @ axis)


def _bounded(error: Array, gain: float, limit: float) -> tuple[Array, float]:
    """min(gain * |e|, limit) * e / |e|, and |e|."""
    size = float(np.linalg.norm(error))
    if size == 0.0:
        return np.zeros_like(error), 0.0
    return min(gain, limit / size) * error, size


def rotation_vector(rotation: Array) -> Array:
    """Logarithm on SO(3): unit axis times angle in [0, pi] (3,) of a rotation matrix, safe at both ends.

    The axis comes from the antisymmetric part where the angle is below 3, and from the symmetric part above,
    where the antisymmetric one vanishes.
    """
    twice_sine = np.array(
        [rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]]
    )
    sine, cosine = 0.5 * float(np.linalg.norm(twice_sine)), 0.5 * (float(np.trace(rotation)) - 1.0)
    angle = math.atan2(sine, cosine)
    if angle < 1e-8:
        return 0.5 * twice_sine
    if angle < 3.0:
        return (0.5 * angle / sine) * twice_sine
    outer = 0.5 * (rotation + rotation.T) - cosine * np.eye(3)  # (1 - cos) a aᵀ
    axis = outer[:, int(np.argmax(np.diag(outer)))]
    axis = axis / np.linalg.norm(axis)
    return angle * (-axis if float(axis @ twice_sine) < 0.0 else axis)


def turning_vector(axis: Array, wanted: Array) -> Array:
    """The shortest rotation vector (3,) that turns a unit vector onto another one.

    Opposite vectors are turned about some direction normal to both.
    """
    cross = np.cross(axis, wanted)
    sine, cosine = float(np.linalg.norm(cross)), float(axis @ wanted)
    if sine > 1e-9:
        turn: Array = (math.atan2(sine, cosine) / sine) * cross
        return turn
    if cosine > 0.0:
        return cross
    seed = np.eye(3)[int(np.argmin(np.abs(axis)))]
    normal = np.cross(axis, seed)
    opposite: Array = math.pi * normal / np.linalg.norm(normal)
    return opposite
