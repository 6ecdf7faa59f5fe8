"""From a scene file to what the simulation needs: obstacles, targets and the start of one particular arm."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from proxgen.config import scene as schema
from proxgen.errors import SimulationError
from proxgen.model.robot_model import RobotModel
from proxgen.simulation.obstacles import Motion, Obstacle, ObstacleField
from proxgen.simulation.task import Target

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Surroundings:
    """A scene as one arm meets it.

    Attributes:
        name: of the scene.
        field: its obstacles.
        targets: pursued in a circle.
        start: (n,) joint positions at the start [rad or m].
    """

    name: str
    field: ObstacleField
    targets: tuple[Target, ...]
    start: Array


def surroundings(scene: schema.Scene, model: RobotModel, start_offset: Array | None = None) -> Surroundings:
    """Put an arm into a scene.

    Args:
        scene: as loaded.
        model: the arm.
        start_offset: (n,) added to the scene's start [rad or m]; what would then be outside the position
            limits is put onto them.

    Raises:
        ConfigError: the scene's start does not fit the arm's joints or limits.
        SimulationError: a start offset of the wrong size, or not finite.
    """
    limits = (model.q_lower.tolist(), model.q_upper.tolist())
    start = np.array(scene.start_positions(model.joint_names, *limits, model.prismatic))
    if start_offset is not None:
        offset = np.asarray(start_offset, dtype=float)
        if offset.shape != (model.n,):
            raise SimulationError(f"a start offset of shape {offset.shape} for an arm with {model.n} joints")
        if not np.isfinite(offset).all():
            raise SimulationError("the start offset is not finite")
        start = np.clip(start + offset, model.q_lower, model.q_upper)
    field = ObstacleField([_obstacle(obstacle) for obstacle in scene.obstacles])
    return Surroundings(scene.name, field, tuple(_target(target) for target in scene.targets), start)


def perturbed(
    scene: schema.Scene, model: RobotModel, seed: int, *, joints: float = 0.03, targets: float = 0.02
) -> tuple[schema.Scene, Array]:
    """A scene a little changed, to see how much of a result was luck.

    Args:
        scene: as loaded.
        model: the arm.
        seed: of the change; uniform in every coordinate.
        joints: greatest offset of each joint at the start [rad or m].
        targets: greatest offset of each target along x, y and z [m].

    Returns:
        The scene with its targets moved, and the offset (n,) of the start for `rollout.run`.
    """
    luck = np.random.default_rng(seed)
    offset = luck.uniform(-joints, joints, model.n)
    moved = tuple(
        target.model_copy(
            update={"position": tuple((target.position + luck.uniform(-targets, targets, 3)).tolist())}
        )
        for target in scene.targets
    )
    return scene.model_copy(update={"targets": moved}), offset


def _obstacle(obstacle: schema.Obstacle) -> Obstacle:
    return Obstacle(
        name=obstacle.name,
        shape=obstacle.shape,
        half_size=0.5 * np.array(obstacle.size or (0.0, 0.0, 0.0)),
        radius=obstacle.radius or 0.0,
        length=obstacle.length or 0.0,
        position=np.array(obstacle.position, dtype=float),
        rotation=rotation_of(obstacle.orientation),
        motion=None if obstacle.motion is None else _motion(obstacle.motion),
    )


def _motion(motion: schema.Motion) -> Motion:
    direction = np.array(motion.direction, dtype=float)
    return Motion(
        direction=direction / np.linalg.norm(direction),
        distance=motion.distance,
        speed=motion.speed,
        hold=motion.hold,
        period=motion.period,
        phase=motion.phase,
    )


def _target(target: schema.Target) -> Target:
    rotation = None if target.orientation is None else rotation_of(target.orientation)
    return Target(np.array(target.position, dtype=float), rotation, target.time)


def rotation_of(rpy: tuple[float, float, float]) -> Array:
    """Rotation matrix of roll, pitch, yaw about the world's x, y, z, in this order, as in a URDF."""
    (sr, sp, sy), (cr, cp, cy) = map(math.sin, rpy), map(math.cos, rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
