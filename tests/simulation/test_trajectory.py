"""Targets with times: the way between them, the velocity fed forward, and whole runs from a CSV file."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray
from simulation_tools import StraightController

from proxgen.config.scene import load_scene
from proxgen.config.schema import Config, Task
from proxgen.model import RobotModel
from proxgen.model.kinematics import tool_pose
from proxgen.simulation.rollout import run
from proxgen.simulation.task import Target, TargetTracker
from proxgen.simulation.trajectory import TrajectoryTracker, open_tracker, rotation_by

Array = NDArray[np.float64]


def targets(*points: tuple[float, float]) -> tuple[Target, ...]:
    """Targets (time, x) along x."""
    return tuple(Target(np.array([x, 0.0, 0.0]), None, time) for time, x in points)


def at(x: float) -> Array:
    """Tool pose on the x axis."""
    pose = np.eye(4)
    pose[0, 3] = x
    return pose


def test_targets_with_times_are_a_trajectory(iiwa7_model: RobotModel) -> None:
    timed = open_tracker(Task(), iiwa7_model, targets((1.0, 0.1)), np.eye(4))
    assert isinstance(timed, TrajectoryTracker)
    plain = open_tracker(Task(), iiwa7_model, (Target(np.zeros(3)),), np.eye(4))
    assert type(plain) is TargetTracker


def test_on_the_way_the_velocity_is_that_of_the_way(iiwa7_model: RobotModel) -> None:
    tracker = TrajectoryTracker(Task(), iiwa7_model, targets((1.0, 0.1), (3.0, 0.3)), np.eye(4))
    for time, x in ((0.0, 0.0), (0.5, 0.05), (1.0, 0.1), (2.0, 0.2)):
        velocity = tracker.update(at(x), time)
        np.testing.assert_allclose(velocity.xdot, [0.1, 0.0, 0.0], atol=1e-12)
        assert velocity.distance == pytest.approx(0.0, abs=1e-12)
        np.testing.assert_allclose(tracker.target.position, [x, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(tracker.update(at(0.3), 4.0).xdot, 0.0, atol=1e-12)
    assert (tracker.index, tracker.reached) == (1, 2)


def test_an_error_is_corrected_within_the_bound(iiwa7_model: RobotModel) -> None:
    task = Task(gain=2.0, max_speed=0.25, tolerance=0.02)
    tracker = TrajectoryTracker(task, iiwa7_model, targets((1.0, 0.1), (3.0, 0.3)), np.eye(4))
    np.testing.assert_allclose(tracker.update(at(0.0), 0.25).xdot, [0.1 + 2.0 * 0.025, 0.0, 0.0])
    assert np.linalg.norm(tracker.update(at(-1.0), 1.0).xdot) == pytest.approx(0.25)
    assert (tracker.index, tracker.reached) == (1, 0)  # passed, but not reached


def test_exponential_is_that_of_pinocchio() -> None:
    rng = np.random.default_rng(1)
    for angle in (0.0, 1e-12, 1e-6, 0.5, 3.0, np.pi):
        vector = rng.normal(size=3)
        vector *= angle / np.linalg.norm(vector)
        np.testing.assert_allclose(rotation_by(vector), pin.exp3(vector), atol=1e-14)


def test_orientation_turns_steadily(any_config: Config, any_model: RobotModel) -> None:
    """Along the way, small steps with the task velocity stay on it, in whatever rows the task has."""
    rng = np.random.default_rng(2)
    here = tool_pose(any_model, rng.uniform(-0.5, 0.5, any_model.n))
    turn = np.array([0.2, -0.1, 0.15])
    goal = Target(here[:3, 3] + [0.02, 0.01, -0.03], rotation_by(turn) @ here[:3, :3], 2.0)
    tracker = open_tracker(any_config.task, any_model, (goal,), here)
    velocity = tracker.update(here, 0.0)
    linear = [row for row in any_model.task_rows if not row.startswith("r")]
    wanted = [(goal.position - here[:3, 3])["xyz".index(row)] / 2.0 for row in linear]
    np.testing.assert_allclose(velocity.xdot[: len(linear)], wanted, atol=1e-12)
    angular = turn / 2.0
    if any_model.task_frame is not None:
        angular = any_model.task_frame.T @ here[:3, :3].T @ angular
    rows = [["rx", "ry", "rz"].index(row) for row in any_model.task_rows if row.startswith("r")]
    np.testing.assert_allclose(velocity.xdot[len(linear) :], angular[rows], atol=1e-12)


def test_a_run_follows_a_trajectory_file(
    planar2_config: Config, planar2_model: RobotModel, tmp_path: Path
) -> None:
    times = np.linspace(0.0, 8.0, 41)
    circle = [(t, 0.6 + 0.1 * np.cos(0.4 * t), 0.1 * np.sin(0.4 * t)) for t in times]
    lines = [f"{t:.6f},{x:.6f},{y:.6f},0.1" for t, x, y in circle]
    (tmp_path / "circle.csv").write_text("# a part of a circle\ntime,x,y,z\n" + "\n".join(lines) + "\n")
    (tmp_path / "circle.yaml").write_text("name: circle\ntargets: circle.csv\nstart: [-0.9, 1.5]\n")
    scene = load_scene(tmp_path / "circle.yaml")
    assert len(scene.targets) == 41
    log = run(
        planar2_config,
        planar2_model,
        StraightController(planar2_model),
        scene,
        sensing="ideal",
        duration=8.0,
    )
    assert log.target_distance[100:].max() < 0.005
    angle = 0.4 * log.time[100:]
    np.testing.assert_allclose(log.tool_position[100:, 0], 0.6 + 0.1 * np.cos(angle), atol=0.006)
    assert log.summary()["targets_reached"] > 30
