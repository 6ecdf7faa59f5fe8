"""Points of self-collision without a pair, and pairs that are always too close to each other."""

import numpy as np

from proxgen.config.schema import Config
from proxgen.errors import Problem
from proxgen.model.posture import Posture, sampling_ranges
from proxgen.model.robot_model import RobotModel

_POSTURES = 24


def touching_pairs(config: Config, model: RobotModel) -> list[Problem]:
    """A problem for each pair that is closer than d_r of self-collision in every sampled posture.

    Such a row, of parts that share a joint or lie in each other, would push for ever, or be a fault, and no
    posture could satisfy it. A point that is in no pair is a problem too: it would protect nothing.

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
        widest = np.maximum(widest, Posture(model, q).own_gaps())
    least = config.avoidance.self_collision.d_r
    problems = []
    for index, point in enumerate(model.self_points):
        if not any(point.capsules):
            message = f"'{point.name}' is a pair with no capsule: all are excluded, or move with it"
            problems.append(config.problem(f"avoidance.self_collision.points.{index}", message))
        for slot, capsule in enumerate(model.capsules):
            if point.capsules[slot] and widest[index, slot] < least:
                message = (
                    f"'{point.name}' is nearer than d_r = {least:.6g} m to capsule '{capsule.name}' in every "
                    f"posture; add {{capsule: {capsule.name}, point: {point.name}}} to exclude"
                )
                problems.append(config.problem(f"avoidance.self_collision.points.{index}", message))
    return problems
