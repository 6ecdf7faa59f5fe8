"""Pairs of self-collision that are always too close, because they share a joint or lie in each other."""

import numpy as np

from proxgen.config.schema import Config
from proxgen.errors import Problem
from proxgen.model.posture import Posture, sampling_ranges
from proxgen.model.robot_model import RobotModel

_POSTURES = 24


def touching_pairs(config: Config, model: RobotModel) -> list[Problem]:
    """A problem for each pair that is closer than d_r of self-collision in every sampled posture.

    Such a row would push for ever, or be a fault, and no posture could satisfy it.

    Args:
        config: where the points were written.
        model: its model.

    Returns:
        In the order of the points, then of the capsules.
    """
    if not model.self_points:
        return []
    rng = np.random.default_rng(0)
    lower, upper = sampling_ranges(model)
    widest = np.full((len(model.self_points), len(model.capsules)), -np.inf)
    for q in (np.clip(0.0, lower, upper), *(rng.uniform(lower, upper) for _ in range(_POSTURES))):
        posture = Posture(model, q)
        poses = [posture.poses[point.body] for point in model.self_points]
        places = [
            pose[:3, :3] @ point.position + pose[:3, 3]
            for pose, point in zip(poses, model.self_points, strict=True)
        ]
        radii = np.array([point.radius for point in model.self_points])
        widest = np.maximum(widest, posture.gaps(np.array(places)) - radii[:, None])
    least = config.avoidance.self_collision.d_r
    problems = []
    for index, point in enumerate(model.self_points):
        for slot, capsule in enumerate(model.capsules):
            if point.capsules[slot] and widest[index, slot] < least:
                message = (
                    f"'{point.name}' is nearer than d_r = {least:.6g} m to capsule '{capsule.name}' in every "
                    f"posture; add {{capsule: {capsule.name}, point: {point.name}}} to exclude"
                )
                problems.append(config.problem(f"avoidance.self_collision.points.{index}", message))
    return problems
