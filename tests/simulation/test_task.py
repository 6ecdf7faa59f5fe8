"""Task velocities: bounded, along the error, in the rows of the task Jacobian; targets in a circle."""

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray
from simulation_tools import task_jacobian

from proxgen.config.schema import Config, Task
from proxgen.errors import SimulationError
from proxgen.model import RobotModel
from proxgen.model.kinematics import tool_pose
from proxgen.simulation.scenery import rotation_of
from proxgen.simulation.task import Target, TargetTracker, rotation_vector, turning_vector

Array = NDArray[np.float64]


def pose(position: tuple[float, float, float], rotation: Array | None = None) -> Array:
    result = np.eye(4)
    result[:3, 3] = position
    if rotation is not None:
        result[:3, :3] = rotation
    return result


def test_speed_is_bounded_and_falls_in_front_of_the_target(iiwa7_model: RobotModel) -> None:
    task = Task(gain=2.0, max_speed=0.25)
    tracker = TargetTracker(task, iiwa7_model, (Target(np.array([1.0, 0.0, 0.0])),), np.eye(4))
    far = tracker.update(pose((0.0, 0.0, 0.0)))
    np.testing.assert_allclose(far.xdot, [0.25, 0.0, 0.0])
    assert far.distance == pytest.approx(1.0)
    near = tracker.update(pose((0.95, 0.0, 0.0)))
    np.testing.assert_allclose(near.xdot, [0.1, 0.0, 0.0])
    assert tracker.reached == 0


def test_targets_follow_each_other_in_a_circle(iiwa7_model: RobotModel) -> None:
    targets = (Target(np.zeros(3)), Target(np.array([1.0, 0.0, 0.0])))
    tracker = TargetTracker(Task(tolerance=0.02), iiwa7_model, targets, np.eye(4))
    assert tracker.update(pose((0.02, 0.0, 0.0))).xdot[0] < 0.0  # not nearer than the tolerance
    assert tracker.update(pose((0.01, 0.0, 0.0))).xdot[0] > 0.0
    assert (tracker.index, tracker.reached) == (1, 1)
    tracker.update(pose((0.99, 0.0, 0.0)))
    assert (tracker.index, tracker.reached) == (0, 2)


def test_a_single_target_counts_once_and_is_held(iiwa7_model: RobotModel) -> None:
    tracker = TargetTracker(Task(), iiwa7_model, (Target(np.zeros(3)),), np.eye(4))
    for x in (0.5, 0.01, 0.0, 0.3, 0.01):
        velocity = tracker.update(pose((x, 0.0, 0.0)))
    assert tracker.reached == 1
    assert velocity.xdot[0] == pytest.approx(-0.02)


def test_a_pose_is_reached_only_with_its_orientation(any_model: RobotModel) -> None:
    """At the target's position, turned by more than the tolerance about x, and then by less."""
    rows = [row for row in any_model.task_rows if row.startswith("r")]
    for angle in (0.06, 0.04):
        tracker = TargetTracker(
            Task(angular_tolerance=0.05), any_model, (Target(np.zeros(3), np.eye(3)),), np.eye(4)
        )
        velocity = tracker.update(pose((0.0, 0.0, 0.0), rotation_of((angle, 0.0, 0.0))))
        assert velocity.angle <= angle + 1e-12
        assert tracker.reached == (velocity.angle < 0.05)
        assert (tracker.reached == 0) == (bool(rows) and angle > 0.05)


def test_no_target_is_an_error(iiwa7_model: RobotModel) -> None:
    with pytest.raises(SimulationError, match="no target"):
        TargetTracker(Task(), iiwa7_model, (), np.eye(4))


def test_rotation_vector_is_the_inverse_of_the_exponential() -> None:
    rng = np.random.default_rng(8)
    angles = [0.0, 1e-12, 1e-7, 1e-4, 0.5, 2.0, 2.9999, 3.0001, np.pi - 1e-7, np.pi - 1e-12]
    for angle in angles:
        for _ in range(20):
            axis = rng.normal(size=3)
            vector = angle * axis / np.linalg.norm(axis)
            np.testing.assert_allclose(rotation_vector(pin.exp3(vector)), vector, atol=2e-9)
    half_turn = rotation_vector(np.diag([1.0, -1.0, -1.0]))
    np.testing.assert_allclose(np.abs(half_turn), [np.pi, 0.0, 0.0], atol=1e-12)


def test_turning_vector_is_the_shortest_turn() -> None:
    rng = np.random.default_rng(9)
    for _ in range(200):
        a, b = rng.normal(size=(2, 3))
        a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
        vector = turning_vector(a, b)
        np.testing.assert_allclose(pin.exp3(vector) @ a, b, atol=1e-12)
        assert np.linalg.norm(vector) == pytest.approx(np.arccos(np.clip(a @ b, -1.0, 1.0)))
        assert abs(vector @ a) < 1e-12
    for axis in np.eye(3):
        np.testing.assert_allclose(turning_vector(axis, axis), 0.0, atol=1e-12)
        np.testing.assert_allclose(pin.exp3(turning_vector(axis, -axis)) @ axis, -axis, atol=1e-12)


def test_a_step_along_the_task_velocity_brings_every_arm_nearer(
    any_config: Config, any_model: RobotModel
) -> None:
    """Whatever the rows, J q̇ = ẋ must make the errors smaller: this pins their signs and frames."""
    model, rng = any_model, np.random.default_rng(10)
    lower = np.maximum(model.q_lower, -2.0)
    upper = np.minimum(model.q_upper, 2.0)
    for _ in range(10):
        here, there = rng.uniform(lower, upper, (2, model.n))
        goal = tool_pose(model, there)
        tracker = TargetTracker(any_config.task, model, (Target(goal[:3, 3], goal[:3, :3]),), np.eye(4))
        before = tracker.update(tool_pose(model, here))
        qdot = np.linalg.pinv(task_jacobian(model, here), rcond=1e-3) @ before.xdot
        achieved = task_jacobian(model, here) @ qdot
        if np.linalg.norm(achieved - before.xdot) > 1e-6:
            continue  # a singular posture or more rows than joints: the velocity cannot be had
        step = 1e-6
        after = tracker.update(tool_pose(model, here + step * qdot))
        for was, now, rows in (
            (before.distance, after.distance, [r for r in model.task_rows if not r.startswith("r")]),
            (before.angle, after.angle, [r for r in model.task_rows if r.startswith("r")]),
        ):
            if rows:
                speed = np.linalg.norm([before.xdot[model.task_rows.index(row)] for row in rows])
                assert (was - now) / step == pytest.approx(speed, rel=0.1, abs=1e-3)


def test_without_an_orientation_a_pose_task_keeps_that_of_the_start(
    any_config: Config, any_model: RobotModel
) -> None:
    if not any(row.startswith("r") for row in any_model.task_rows):
        return
    start = pose((0.0, 0.0, 0.0), rotation_of((0.3, -0.2, 0.9)))
    tracker = TargetTracker(any_config.task, any_model, (Target(np.ones(3)),), start)
    velocity = tracker.update(pose((0.5, 0.0, 0.0), start[:3, :3]))
    assert velocity.angle == pytest.approx(0.0, abs=1e-12)
    turned = tracker.update(pose((0.5, 0.0, 0.0), start[:3, :3] @ rotation_of((0.2, 0.0, 0.0))))
    assert 0.01 < turned.angle < 0.2 + 1e-9


def test_a_subset_of_rows_ignores_the_others(planar2_config: Config, planar2_model: RobotModel) -> None:
    tracker = TargetTracker(
        planar2_config.task, planar2_model, (Target(np.array([0.3, 0.4, 5.0])),), np.eye(4)
    )
    velocity = tracker.update(pose((0.0, 0.0, 0.0)))
    assert velocity.distance == pytest.approx(0.5)
    assert velocity.xdot.shape == (2,)
    np.testing.assert_allclose(velocity.xdot / np.linalg.norm(velocity.xdot), [0.6, 0.8])
