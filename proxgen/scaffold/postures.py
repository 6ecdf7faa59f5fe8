"""Where the arm can be: sampled postures, a good one to start from, and places that the tool can reach."""

from dataclasses import dataclass

import numpy as np

from proxgen.model.kinematics import body_poses
from proxgen.model.posture import Posture, sampling_ranges
from proxgen.model.robot_model import Array, RobotModel

_SAMPLES = 2500
_NEIGHBOURS = 1200
_SEED = 20
_PAIR_POSTURES = 50
_SELDOM = 0.1
_USUAL_POSTURES = 20


def task_rows(model: RobotModel) -> tuple[str, ...]:
    """The rows x, y, z in which the tool can move, at most as many as there are joints; the best ones."""
    rng = np.random.default_rng(_SEED)
    lower, upper = sampling_ranges(model)
    motion = np.zeros(3)
    for _ in range(50):
        motion += np.linalg.norm(Posture(model, rng.uniform(lower, upper)).jacobian, axis=1)
    movable = [row for row in np.argsort(-motion, kind="stable") if motion[row] > 1e-6 * motion.max()]
    return tuple("xyz"[row] for row in sorted(movable[: model.n]))


@dataclass(frozen=True)
class Folding:
    """Which links tell by their distance whether the arm is folded into itself.

    Attributes:
        pairs: (L, L) capsules with at least two bodies in between that are clear of each other in some
            postures. A wide torso that always holds the shoulder says nothing about a posture.
    """

    pairs: Array

    @staticmethod
    def of(model: RobotModel) -> "Folding":
        """The pairs of an arm, from postures at random."""
        rng = np.random.default_rng(_SEED + 2)
        lower, upper = sampling_ranges(model)
        postures = (Posture(model, rng.uniform(lower, upper)) for _ in range(_PAIR_POSTURES))
        clear = np.mean([posture.self_clearances() > 0.0 for posture in postures], axis=0)
        body = np.array([capsule.body for capsule in model.capsules])
        return Folding((np.abs(body[:, None] - body[None]) > 2) & (clear > _SELDOM))

    def clearance(self, posture: Posture) -> float:
        """Least gap between the links of these pairs [m]; infinite if there are none."""
        return (
            float(posture.self_clearances()[self.pairs].min(initial=np.inf)) if self.pairs.any() else np.inf
        )


def start_posture(model: RobotModel, rows: tuple[str, ...]) -> Posture:
    """A posture with room on all sides: agile, far from limits, not folded, above its base."""
    folding = Folding.of(model)
    rng = np.random.default_rng(_SEED)
    lower, upper = sampling_ranges(model)
    chosen = ["xyz".index(row) for row in rows]
    base = min(0.0, float(body_poses(model, np.clip(0.0, lower, upper))[1][2, 3]))
    best, best_score = Posture(model, 0.5 * (lower + upper)), -np.inf
    for _ in range(_SAMPLES):
        q = rng.uniform(lower, upper)
        posture = Posture(model, _rounded(q, lower, upper))
        margin = float((np.minimum(q - lower, upper - q) / (upper - lower)).min())
        agility = float(np.prod(np.linalg.svd(posture.jacobian[chosen], compute_uv=False)))
        tool = posture.tool
        ahead = 1.0 + tool[0] / max(float(np.hypot(tool[0], tool[1])), 1e-9)
        score = agility * np.sqrt(margin) * (0.2 + ahead)
        if score <= best_score:
            continue
        score *= 1.0 if folding.clearance(posture) > 0.0 else 1e-3
        score *= 1.0 if posture.axes[:, :, 2].min() >= base else 1e-3
        if score > best_score:
            best, best_score = posture, score
    return best


def _rounded(q: Array, lower: Array, upper: Array) -> Array:
    """Joint positions with two decimals, three below 0.1, still within the range."""
    decimals = np.round(q, 2) if np.abs(q).max() > 0.2 else np.round(q, 3)
    clipped: Array = np.clip(decimals, lower, upper) + 0.0
    return clipped


def neighbours(start: Posture) -> list[Posture]:
    """Postures around the start, within the middle of the joints' ranges, not folded into themselves."""
    model, rng = start.model, np.random.default_rng(_SEED + 1)
    lower, upper = sampling_ranges(model)
    margin = 0.05 * (upper - lower)
    reach = np.minimum(0.35 * (upper - lower), 0.7)
    folding = Folding.of(model)
    found, least = [], min(0.0, folding.clearance(start))
    for _ in range(_NEIGHBOURS):
        q = np.clip(start.q + rng.uniform(-reach, reach), lower + margin, upper - margin)
        posture = Posture(model, q)
        if folding.clearance(posture) >= least:
            found.append(posture)
    return found


def usual_postures(start: Posture) -> list[Posture]:
    """The start, the zero posture, and some that are not folded: in the middle of the ranges, or near it.

    A link that lies in another one has no place for a cuff there, whatever the place. An arm that is in its
    torso wherever its joints are in the middle of their ranges is seen around the start.
    """
    model, rng = start.model, np.random.default_rng(3)
    folding = Folding.of(model)
    lower, upper = sampling_ranges(model)
    quarter = 0.25 * (upper - lower)
    found = [start, Posture(model, np.clip(0.0, lower, upper))]
    for middle in (0.5 * (lower + upper), start.q):
        for _ in range(5 * _USUAL_POSTURES):
            posture = Posture(model, np.clip(middle + rng.uniform(-quarter, quarter), lower, upper))
            if len(found) < 2 + _USUAL_POSTURES and folding.clearance(posture) > 0.0:
                found.append(posture)
    return found
