"""Where the arm can be: sampled postures, a good one to start from, and places that the tool can reach."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from proxgen.model.kinematics import body_poses
from proxgen.model.robot_model import Array, RobotModel

_SAMPLES = 2500
_NEIGHBOURS = 1200
_SEED = 20
_UNLIMITED = 1e10
FULL_TURN = np.pi
"""Joints that turn further than this either way are sampled within it."""


@dataclass(frozen=True)
class Posture:
    """The arm at some joint positions.

    Attributes:
        model: the arm.
        q: (n,) joint positions [rad or m].
    """

    model: RobotModel
    q: Array

    @cached_property
    def poses(self) -> list[Array]:
        """Poses of all bodies in the world, 4x4 each."""
        return body_poses(self.model, self.q)

    @property
    def tool(self) -> Array:
        """The task point in the world, (3,) [m]."""
        pose: Array = self.poses[self.model.tool_body] @ self.model.tool_in_body
        return pose[:3, 3]

    @cached_property
    def axes(self) -> Array:
        """Ends of the capsules' axes in the world, (L, 2, 3) [m]."""
        return np.array(
            [
                [
                    self.poses[capsule.body][:3, :3] @ end + self.poses[capsule.body][:3, 3]
                    for end in (capsule.start, capsule.end)
                ]
                for capsule in self.model.capsules
            ]
        )

    @property
    def jacobian(self) -> Array:
        """Position Jacobian of the task point, (3, n)."""
        drives, rotations = self.model.drives, np.array([pose[:3, :3] for pose in self.poses[1:]])
        axes = np.einsum("bij,bj->bi", rotations, np.array([drive.axis for drive in drives]))
        arms = self.tool - np.array([pose[:3, 3] for pose in self.poses[1:]])
        prismatic = np.array([drive.prismatic for drive in drives])
        motions = np.where(prismatic[:, None], axes, np.cross(axes, arms))
        jacobian: Array = motions.T @ self.model.transmission
        return jacobian

    def gaps(self, points: Array) -> Array:
        """Distances (P, L) from points (P, 3) to the surfaces of all capsules [m]; negative inside."""
        axis = self.axes[:, 1] - self.axes[:, 0]
        square = np.maximum((axis * axis).sum(axis=1), 1e-30)
        offset = points[:, None] - self.axes[:, 0]
        fraction = np.clip((offset * axis).sum(axis=2) / square, 0.0, 1.0)
        distance: Array = np.linalg.norm(offset - fraction[:, :, None] * axis, axis=2)
        distance -= np.array([capsule.radius for capsule in self.model.capsules])
        return distance

    def self_clearance(self) -> float:
        """Least gap between capsules with at least two others in between, by points along their axes [m]."""
        body = np.array([capsule.body for capsule in self.model.capsules])
        radius = np.array([capsule.radius for capsule in self.model.capsules])
        apart = np.abs(body[:, None] - body[None]) > 2
        if not apart.any():
            return np.inf
        fractions = np.linspace(0.0, 1.0, 5)[:, None, None]
        points = self.axes[:, 0] + fractions * (self.axes[:, 1] - self.axes[:, 0])
        gaps = self.gaps(points.reshape(-1, 3)).reshape(5, len(body), -1).min(axis=0) - radius[:, None]
        return float(gaps[apart].min())


def ranges(model: RobotModel) -> tuple[Array, Array]:
    """Where joints are sampled: within their limits, and within a turn; (n,) each [rad or m]."""
    lower, upper = model.q_lower.copy(), model.q_upper.copy()
    for drive in model.drives:
        index = drive.index
        if not drive.prismatic or max(abs(lower[index]), abs(upper[index])) > _UNLIMITED:
            lower[index], upper[index] = max(lower[index], -FULL_TURN), min(upper[index], FULL_TURN)
    return lower, upper


def task_rows(model: RobotModel) -> tuple[str, ...]:
    """The rows x, y, z in which the tool can move, at most as many as there are joints; the best ones."""
    rng = np.random.default_rng(_SEED)
    lower, upper = ranges(model)
    motion = np.zeros(3)
    for _ in range(50):
        motion += np.linalg.norm(Posture(model, rng.uniform(lower, upper)).jacobian, axis=1)
    movable = [row for row in np.argsort(-motion, kind="stable") if motion[row] > 1e-6 * motion.max()]
    return tuple("xyz"[row] for row in sorted(movable[: model.n]))


def start_posture(model: RobotModel, rows: tuple[str, ...]) -> Posture:
    """A posture with room on all sides: agile, far from limits, not folded, above its base."""
    rng = np.random.default_rng(_SEED)
    lower, upper = ranges(model)
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
        score *= 1.0 if posture.self_clearance() > 0.0 else 1e-3
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
    lower, upper = ranges(model)
    margin = 0.05 * (upper - lower)
    reach = np.minimum(0.35 * (upper - lower), 0.7)
    found, least = [], min(0.0, start.self_clearance())
    for _ in range(_NEIGHBOURS):
        q = np.clip(start.q + rng.uniform(-reach, reach), lower + margin, upper - margin)
        posture = Posture(model, q)
        if posture.self_clearance() >= least:
            found.append(posture)
    return found
