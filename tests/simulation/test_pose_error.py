"""The orientation error of pose and pointing tasks: finite and smooth from the identity to a half turn."""

import numpy as np
import pinocchio as pin
import pytest
from arms import RECIPES, write_arm
from kernel_checks import call
from numpy.typing import NDArray

from proxgen.config import load
from proxgen.config.schema import Config
from proxgen.model import build_model
from proxgen.model.kinematics import tool_pose
from proxgen.simulation.task import rotation_vector, turning_vector
from proxgen.symbolic import build_program

Array = NDArray[np.float64]

ANGLES = (0.0, 1e-9, 1e-4, 1.0, np.pi - 1e-4)


def directions(count: int, seed: int) -> Array:
    """Unit vectors, the axes among them, (count + 3, 3)."""
    random = np.random.default_rng(seed).normal(size=(count, 3))
    units: Array = np.vstack([np.eye(3), random / np.linalg.norm(random, axis=1)[:, None]])
    return units


def inverse_right_jacobian(vector: Array) -> Array:
    """d log / d rotation: how a rotation vector changes when a small turn is added on the right, (3, 3)."""
    angle, cross = float(np.linalg.norm(vector)), pin.skew(vector)
    factor = 1.0 / 12.0
    if angle > 1e-3:
        factor = 1.0 / angle**2 - (1.0 + np.cos(angle)) / (2.0 * angle * np.sin(angle))
    inverse: Array = np.eye(3) + 0.5 * cross + factor * cross @ cross
    return inverse


@pytest.mark.parametrize("angle", (*ANGLES, 1e-12, 2.9999, 3.0001, np.pi - 1e-7))
def test_the_logarithm_is_exact_at_every_angle(angle: float) -> None:
    for axis in directions(30, 1):
        vector = rotation_vector(pin.exp3(angle * axis))
        assert np.isfinite(vector).all()
        np.testing.assert_allclose(vector, angle * axis, rtol=0, atol=1e-15 + 3e-9 * angle)


@pytest.fixture(scope="module", params=[r for r in RECIPES if "pose" in r.task], ids=lambda r: r.name)
def pose_arm(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Config:
    """An arm with a pose task."""
    return load(write_arm(request.param, tmp_path_factory.mktemp(request.param.name)))


@pytest.mark.parametrize("angle", ANGLES)
def test_the_pose_error_passes_finite_differences(pose_arm: Config, angle: float) -> None:
    """The error e = log(R_wanted R(q)^T) changes by -J_r^-1(e) J_angular, with J of the generated kernel."""
    model = build_model(pose_arm)
    program, rng, step = build_program(pose_arm, model), np.random.default_rng(3), 1e-6
    for axis in directions(3, 2):
        q = rng.uniform(-1.0, 1.0, model.n)
        wanted = pin.exp3(angle * axis) @ tool_pose(model, q)[:3, :3]
        error = rotation_vector(wanted @ tool_pose(model, q)[:3, :3].T)
        J = call(program, "kinematics", q=q)["J"][3:]
        assert np.isfinite(J).all()
        difference = np.column_stack(
            [
                (
                    rotation_vector(wanted @ tool_pose(model, q + step * unit)[:3, :3].T)
                    - rotation_vector(wanted @ tool_pose(model, q - step * unit)[:3, :3].T)
                )
                / (2.0 * step)
                for unit in np.eye(model.n)
            ]
        )
        np.testing.assert_allclose(difference, -inverse_right_jacobian(error) @ J, rtol=0, atol=2e-6)


@pytest.mark.parametrize("angle", ANGLES)
def test_the_pointing_error_turns_the_axis_all_the_way(angle: float) -> None:
    for axis in directions(10, 4):
        normal = np.cross(axis, np.roll(axis, 1) + np.array([0.1, 0.2, 0.3]))
        turn = angle * normal / np.linalg.norm(normal)
        vector = turning_vector(axis, pin.exp3(turn) @ axis)
        assert np.isfinite(vector).all()
        np.testing.assert_allclose(vector, turn, rtol=0, atol=1e-15 + 3e-9 * angle)
