"""The arm at a posture: its Jacobian, and distances from its capsules, by differences and by sampling."""

import numpy as np
import pytest

from proxgen.model import RobotModel
from proxgen.model.posture import Posture, sampling_ranges


def test_the_jacobian_is_the_derivative_of_the_tool(any_model: RobotModel) -> None:
    rng, step = np.random.default_rng(41), 1e-6
    for _ in range(5):
        q, qdot = rng.uniform(-1.5, 1.5, any_model.n), rng.normal(size=any_model.n)
        ahead, behind = (Posture(any_model, q + sign * step * qdot).tool for sign in (1.0, -1.0))
        velocity = (ahead - behind) / (2.0 * step)
        np.testing.assert_allclose(Posture(any_model, q).jacobian @ qdot, velocity, atol=1e-8)


def test_gaps_are_the_least_of_points_along_the_axes(any_model: RobotModel) -> None:
    """Beside, behind and inside; the axes are those of the bodies."""
    rng = np.random.default_rng(42)
    posture = Posture(any_model, rng.uniform(-1.5, 1.5, any_model.n))
    points = rng.uniform(-0.8, 0.8, (40, 3))
    for slot, capsule in enumerate(any_model.capsules):
        pose = posture.poses[capsule.body]
        part = np.linspace(0.0, 1.0, 2001)[:, None]
        axis = (capsule.start + part * (capsule.end - capsule.start)) @ pose[:3, :3].T + pose[:3, 3]
        least = np.linalg.norm(points[:, None] - axis, axis=2).min(axis=1) - capsule.radius
        np.testing.assert_allclose(posture.gaps(points)[:, slot], least, atol=2e-5)


def test_joints_are_sampled_within_their_limits_and_a_turn(any_model: RobotModel) -> None:
    lower, upper = sampling_ranges(any_model)
    prismatic = np.array([drive.prismatic for drive in any_model.drives if drive.ratio == 1.0])
    assert (lower >= any_model.q_lower).all() and (upper <= any_model.q_upper).all()
    np.testing.assert_array_equal(lower[prismatic], any_model.q_lower[prismatic])
    np.testing.assert_array_equal(upper[prismatic], any_model.q_upper[prismatic])
    turning = np.minimum(any_model.q_upper, np.pi)[~prismatic]
    np.testing.assert_array_equal(upper[~prismatic], turning)
    assert (upper - lower <= 2.0 * np.pi).all()
    assert pytest.approx(lower[~prismatic]) == np.maximum(any_model.q_lower, -np.pi)[~prismatic]
