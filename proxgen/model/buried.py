"""Cuffs that see nothing because they lie inside another link, whatever the arm does."""

import numpy as np

from proxgen.config.schema import Config
from proxgen.errors import Problem
from proxgen.model.posture import Posture, sampling_ranges
from proxgen.model.robot_model import RobotModel

_POSTURES = 24


def buried_cuffs(config: Config, model: RobotModel) -> list[Problem]:
    """A problem for each cuff with a module that lies inside another link's capsule in every sampled posture.

    Args:
        config: where the cuffs were written.
        model: its model.

    Returns:
        In the order of the cuffs.
    """
    if not model.modules:
        return []
    rng = np.random.default_rng(0)
    lower, upper = sampling_ranges(model)
    depth = np.full((len(model.modules), len(model.capsules)), np.inf)
    for q in (np.clip(0.0, lower, upper), *(rng.uniform(lower, upper) for _ in range(_POSTURES))):
        posture = Posture(model, q)
        places = np.array(
            [posture.poses[m.body][:3, :3] @ m.position + posture.poses[m.body][:3, 3] for m in model.modules]
        )
        depth = np.minimum(depth, -posture.gaps(places))
    carried = np.array([[m.body == capsule.body for capsule in model.capsules] for m in model.modules])
    buried = (depth > 0.0) & ~carried
    problems = []
    first = 0
    for index, cuff in enumerate(config.skin.cuffs):
        count = sum(ring.modules for ring in cuff.rings)
        inside = buried[first : first + count]
        first += count
        if inside.any():
            name = model.capsules[int(np.argmax(inside.sum(axis=0)))].name
            hidden = int(inside.any(axis=1).sum())
            message = (
                f"{hidden} of the {count} modules of cuff '{cuff.name}' lie inside the capsule '{name}' "
                "of another link, in every posture; they would only see the arm"
            )
            problems.append(config.problem(f"skin.cuffs.{index}", message))
    return problems
