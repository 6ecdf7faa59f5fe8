"""The arm at some joint positions: where its capsules and its tool are, and how far points are from it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from proxgen.model.kinematics import body_poses
from proxgen.model.robot_model import Array, RobotModel

_UNLIMITED = 1e10


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
    def tool_pose(self) -> Array:
        """Pose of the task point's frame in the world, 4x4."""
        pose: Array = self.poses[self.model.tool_body] @ self.model.tool_in_body
        return pose

    @property
    def tool(self) -> Array:
        """The task point in the world, (3,) [m]."""
        return self.tool_pose[:3, 3]

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

    def own_gaps(self) -> Array:
        """Distances (P, L) of the self-collision points from all capsules, between surfaces [m]."""
        points = self.model.self_points
        centres = np.array([(self.poses[p.body] @ np.append(p.position, 1.0))[:3] for p in points])
        gaps: Array = self.gaps(centres) - np.array([[p.radius] for p in points])
        return gaps

    def self_clearances(self) -> Array:
        """Gaps (L, L) between all capsules, by five points along each axis [m]; negative: they overlap."""
        count = len(self.model.capsules)
        radius = np.array([capsule.radius for capsule in self.model.capsules])
        fractions = np.linspace(0.0, 1.0, 5)[:, None, None]
        points = self.axes[:, 0] + fractions * (self.axes[:, 1] - self.axes[:, 0])
        gaps: Array = self.gaps(points.reshape(-1, 3)).reshape(5, count, -1).min(axis=0) - radius[:, None]
        return gaps


def sampling_ranges(model: RobotModel) -> tuple[Array, Array]:
    """Where joints are worth sampling: within their limits, and within a turn; (n,) each [rad or m]."""
    lower, upper = model.q_lower.copy(), model.q_upper.copy()
    for drive in model.drives:
        index = drive.index
        if not drive.prismatic or max(abs(lower[index]), abs(upper[index])) > _UNLIMITED:
            lower[index], upper[index] = max(lower[index], -np.pi), min(upper[index], np.pi)
    return lower, upper
