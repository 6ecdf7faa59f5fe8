"""Targets with times: the tool follows the way between them, with the way's own velocity fed forward."""

import numpy as np
from numpy.typing import NDArray

from proxgen.config.schema import Task
from proxgen.model.robot_model import RobotModel
from proxgen.simulation.task import Target, TargetTracker, TaskVelocity, rotation_vector

Array = NDArray[np.float64]


class TrajectoryTracker(TargetTracker):
    """Follows targets that have times, straight from one to the next, and holds the last.

    Before the first one's time the way leads there from the start. A target counts as reached if the tool is
    within the tolerances when its time has come.
    """

    def __init__(self, task: Task, model: RobotModel, targets: tuple[Target, ...], start: Array) -> None:
        """Begin at the start; the arguments are those of `TargetTracker`, every target with a time."""
        super().__init__(task, model, targets, start)
        rotations = [self._start_rotation if t.rotation is None else t.rotation for t in targets]
        self._times = np.array([target.time for target in targets], dtype=float)
        self._positions = np.array([target.position for target in targets])
        self._rotations = np.array(rotations)
        self._due = self._times.copy()
        if self._times[0] > 0.0:
            self._times = np.insert(self._times, 0, 0.0)
            self._positions = np.insert(self._positions, 0, start[:3, 3], axis=0)
            self._rotations = np.insert(self._rotations, 0, self._start_rotation, axis=0)
        self._passed = 0
        self._present = Target(self._positions[0], self._rotations[0], self._times[0])

    @property
    def target(self) -> Target:
        """Where the tool should be now."""
        return self._present

    def update(self, tool: Array, time: float = 0.0) -> TaskVelocity:
        """Velocity of the way at a time [s] plus the correction of the error, within the task's bounds."""
        self._present, linear, angular = self._on_the_way(time)
        correction = self._velocity(tool)
        while self._passed < len(self._due) and time >= self._due[self._passed]:
            self.reached += self._is_reached(correction)
            self._passed += 1
        self.index = min(self._passed, len(self._due) - 1)
        forward = np.concatenate([linear[self._linear], self._in_task_frame(tool, angular)[self._angular]])
        count = len(self._linear)
        xdot = forward + correction.xdot
        return TaskVelocity(
            np.concatenate(
                [
                    _bounded(xdot[:count], self._task.max_speed),
                    _bounded(xdot[count:], self._task.max_angular_speed),
                ]
            ),
            correction.distance,
            correction.angle,
        )

    def _on_the_way(self, time: float) -> tuple[Target, Array, Array]:
        """Pose at a time, and its linear and angular velocity (3,) in the world."""
        leg = int(np.searchsorted(self._times, time, side="right")) - 1
        if leg >= len(self._times) - 1:
            return Target(self._positions[-1], self._rotations[-1], time), np.zeros(3), np.zeros(3)
        duration = self._times[leg + 1] - self._times[leg]
        part = (time - self._times[leg]) / duration
        travel = self._positions[leg + 1] - self._positions[leg]
        turn = rotation_vector(self._rotations[leg + 1] @ self._rotations[leg].T)
        rotation = rotation_by(part * turn) @ self._rotations[leg]
        return (
            Target(self._positions[leg] + part * travel, rotation, time),
            travel / duration,
            turn / duration,
        )

    def _in_task_frame(self, tool: Array, angular: Array) -> Array:
        """An angular velocity (3,) in the directions of the task's rotation rows."""
        frame = self._model.task_frame
        return angular if frame is None else frame.T @ tool[:3, :3].T @ angular


def open_tracker(task: Task, model: RobotModel, targets: tuple[Target, ...], start: Array) -> TargetTracker:
    """The tracker for targets with times, or without; the arguments are those of `TargetTracker`."""
    timed = bool(targets) and all(target.time is not None for target in targets)
    return (TrajectoryTracker if timed else TargetTracker)(task, model, targets, start)


def rotation_by(vector: Array) -> Array:
    """Rotation matrix (3, 3) of a rotation vector (3,): the inverse of `rotation_vector`."""
    angle = float(np.linalg.norm(vector))
    cross = np.array(
        [[0.0, -vector[2], vector[1]], [vector[2], 0.0, -vector[0]], [-vector[1], vector[0], 0.0]]
    )
    sine = np.sinc(angle / np.pi)  # sin(angle) / angle
    versine = 0.5 * np.sinc(0.5 * angle / np.pi) ** 2  # (1 - cos(angle)) / angle^2
    rotation: Array = np.eye(3) + sine * cross + versine * cross @ cross
    return rotation


def _bounded(velocity: Array, limit: float) -> Array:
    """A velocity, shortened to the limit if it is longer."""
    size = float(np.linalg.norm(velocity))
    return velocity if size <= limit else (limit / size) * velocity
