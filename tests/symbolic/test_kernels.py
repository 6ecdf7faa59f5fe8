"""Kernels against Pinocchio, finite differences and closed forms, at random states of many arms."""

from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest
from arms import RECIPES, write_arm
from kernel_checks import call, check_against_pinocchio

from proxgen.config import load
from proxgen.config.schema import Config
from proxgen.model import RobotModel, build_model
from proxgen.model.kinematics import body_poses, tool_pose
from proxgen.symbolic import build_program
from proxgen.symbolic.program_builder import carrying_bodies

STATES = 1000


def test_iiwa_kinematics_equal_pinocchio(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    check_against_pinocchio(iiwa7_config, iiwa7_model, STATES)


def test_any_arms_kinematics_equal_pinocchio(any_config: Config, any_model: RobotModel) -> None:
    check_against_pinocchio(any_config, any_model, 100)


@pytest.mark.parametrize("task", ["{kind: pose}", "{kind: pointing, axis: [0, 0.6, 0.8]}"])
@pytest.mark.parametrize("name", ["slider3", "endless4", "mimic5"])
def test_rotations_of_arms_with_every_kind_of_joint(name: str, task: str, tmp_path: Path) -> None:
    """A prismatic joint turns nothing, and a follower turns by its ratio."""
    recipe = next(recipe for recipe in RECIPES if recipe.name == name)
    config = load(write_arm(replace(recipe, task=task), tmp_path))
    model = build_model(config)
    check_against_pinocchio(config, model, 30)
    check_finite_differences(config, model)


def test_task_jacobian_passes_finite_differences(any_config: Config, any_model: RobotModel) -> None:
    check_finite_differences(any_config, any_model)


def check_finite_differences(config: Config, model: RobotModel) -> None:
    """J against differences of the tool's pose."""
    program, rng, step = build_program(config, model), np.random.default_rng(22), 1e-6
    for _ in range(10):
        q = rng.uniform(-2.0, 2.0, model.n)
        jacobian, rotation = call(program, "kinematics", q=q)["J"], tool_pose(model, q)[:3, :3]
        for joint in range(model.n):
            offset = step * np.eye(model.n)[joint]
            after, before = tool_pose(model, q + offset), tool_pose(model, q - offset)
            linear = (after[:3, 3] - before[:3, 3]) / (2 * step)
            angular = pin.log3(after[:3, :3] @ before[:3, :3].T) / (2 * step)
            if model.task_frame is not None:
                angular = (rotation @ model.task_frame).T @ angular
            rows = dict(zip(("x", "y", "z", "rx", "ry", "rz"), [*linear, *angular], strict=True))
            expected = [rows[name] for name in model.task_rows]
            np.testing.assert_allclose(jacobian[:, joint], expected, atol=1e-8)


def test_rows_pass_finite_differences(any_config: Config, any_model: RobotModel) -> None:
    """The row is minus the gradient of the distance between a body's point and a fixed obstacle point."""
    program, rng, step = build_program(any_config, any_model), np.random.default_rng(23), 1e-6
    bodies = carrying_bodies(any_model)
    for kernel in [k for k in program.kernels if k.name.startswith("row_")]:
        body = bodies[int(kernel.name.removeprefix("row_"))]
        for _ in range(5):
            q, local = rng.uniform(-2.0, 2.0, any_model.n), np.append(rng.uniform(-0.1, 0.2, 3), 1.0)
            point = (body_poses(any_model, q)[body] @ local)[:3]
            obstacle = point + rng.uniform(0.1, 0.3, 3)
            geometry = call(program, "kinematics", q=q)
            direction = (obstacle - point) / np.linalg.norm(obstacle - point)
            row = call(program, kernel.name, point=point, direction=direction, **geometry)["row"]
            gradient = []
            for offset in step * np.eye(any_model.n):
                after, before = (
                    np.linalg.norm(obstacle - (body_poses(any_model, q + sign * offset)[body] @ local)[:3])
                    for sign in (1, -1)
                )
                gradient.append((after - before) / (2 * step))
            np.testing.assert_allclose(row, -np.array(gradient), atol=1e-8)


def test_planar_arm_has_its_closed_form(planar2_config: Config, planar2_model: RobotModel) -> None:
    program, rng = build_program(planar2_config, planar2_model), np.random.default_rng(24)
    for _ in range(100):
        q = rng.uniform(-2.5, 2.5, 2)
        s1, c1, s12, c12 = np.sin(q[0]), np.cos(q[0]), np.sin(q.sum()), np.cos(q.sum())
        result = call(program, "kinematics", q=q)
        position = [0.5 * c1 + 0.4 * c12, 0.5 * s1 + 0.4 * s12, 0.1]
        np.testing.assert_allclose(result["tool_to_world"][:, 3], position, atol=1e-15)
        jacobian = np.array([[-0.5 * s1 - 0.4 * s12, -0.4 * s12], [0.5 * c1 + 0.4 * c12, 0.4 * c12]])
        np.testing.assert_allclose(result["J"], jacobian, atol=1e-15)
        objective = call(program, "objective", J=result["J"], q=q, xdot=[0.1, -0.2])
        # the manipulability of a planar two-link arm is l1 l2 |sin q2|
        assert objective["manipulability"] == pytest.approx(0.2 * abs(np.sin(q[1])), abs=1e-15)
        expected = jacobian.T @ jacobian + objective["damping"] * np.eye(2)
        np.testing.assert_allclose(objective["H"], expected, atol=1e-15)
        np.testing.assert_allclose(objective["g"], -jacobian.T @ [0.1, -0.2], atol=1e-15)


@pytest.mark.parametrize("rows", [1, 2, 3, 5, 6])
def test_manipulability_is_accurate_near_singular_configurations(
    iiwa7_config: Config, iiwa7_model: RobotModel, rows: int
) -> None:
    """Against the product of singular values, for Jacobians with a singular value of 1e-6, 1e-12 or 0."""
    from proxgen.symbolic.quadratic import manipulability

    symbol = ca.SX.sym("J", rows, 7)
    function, rng = ca.Function("w", [symbol], [manipulability(symbol)]), np.random.default_rng(25)
    for smallest in (1.0, 1e-6, 1e-12, 0.0):
        left = np.linalg.qr(rng.normal(size=(rows, rows)))[0]
        right = np.linalg.qr(rng.normal(size=(7, rows)))[0].T
        jacobian = left @ np.diag([*rng.uniform(0.5, 1.5, rows - 1), smallest]) @ right
        expected = np.prod(np.linalg.svd(jacobian, compute_uv=False))
        assert float(function(jacobian)) == pytest.approx(expected, abs=5e-15)


def test_damping_law(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    from proxgen.symbolic.quadratic import damping

    w, gain, threshold, floor = (ca.SX.sym(name) for name in ("w", "gain", "threshold", "floor"))
    law = ca.Function("damping", [w, gain, threshold, floor], [damping(w, gain, threshold, floor)])
    assert float(law(0.0, 0.1, 0.001, 1e-6)) == pytest.approx(0.1)
    assert float(law(0.0005, 0.1, 0.001, 1e-6)) == pytest.approx(0.025)
    assert float(law(0.001, 0.1, 0.001, 1e-6)) == pytest.approx(1e-6)
    assert float(law(0.2, 0.1, 0.001, 1e-3)) == pytest.approx(1e-3)
    assert float(law(0.0, 0.1, 0.0, 1e-3)) == pytest.approx(1e-3)  # no threshold: no damping, and no 0/0


def test_approach_law_passes_through_its_thresholds(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    program = build_program(iiwa7_config, iiwa7_model)
    expected = {0.30: 0.2, 0.275: 0.1, 0.25: 0.0, 0.235: 0.0, 0.22: 0.0, 0.195: -0.1, 0.17: -0.2, 0.0: -0.2}
    for distance, speed in expected.items():
        result = call(program, "approach_speed", distance=distance)["speed"]
        assert result == pytest.approx(speed, abs=1e-12)


def test_bounds_hold_their_promises(any_config: Config, any_model: RobotModel) -> None:
    """lb <= ub always; (11) at the limits; acceleration gives way to the limits; else it holds."""
    program, rng = build_program(any_config, any_model), np.random.default_rng(26)
    lower, upper = np.maximum(any_model.q_lower, -5.0), np.minimum(any_model.q_upper, 5.0)
    step = any_model.qddot_limit / any_config.control.rate
    for _ in range(500):
        q = rng.uniform(lower - 0.05, upper + 0.05)
        previous = rng.uniform(-1.5, 1.5, any_model.n) * any_model.qdot_limit
        result = call(program, "bounds", q=q, qdot_previous=previous)
        lb, ub = result["lb"], result["ub"]
        assert np.all(lb <= ub)
        assert np.all(np.abs([lb, ub]) <= any_model.qdot_limit)
        assert np.all(ub[q >= any_model.q_upper] <= 0.0)
        assert np.all(lb[q <= any_model.q_lower] >= 0.0)
        reachable = (previous + step >= lb) & (previous - step <= ub)
        assert np.all((lb >= previous - step - 1e-12)[reachable])
        assert np.all((ub <= previous + step + 1e-12)[reachable])


@pytest.mark.parametrize(("damper", "acceleration"), [(1e20, 20.0), (5.0, 20.0), (5.0, 2.0), (0.7, 3.0)])
def test_viability_brakes_in_time_and_gently(
    iiwa7_config: Config, iiwa7_model: RobotModel, damper: float, acceleration: float
) -> None:
    """Driving at ub in every cycle ends at the limit, not beyond it, and needs no more than a to brake."""
    program = build_program(iiwa7_config, iiwa7_model)
    q, qdot, period = np.zeros(7), np.zeros(7), 0.02
    options = {"viability": 1.0, "joint_damper": damper, "qddot_limit": np.full(7, acceleration)}
    for _ in range(700):
        before = qdot
        qdot = call(program, "bounds", q=q, qdot_previous=before, period=period, **options)["ub"]
        assert np.all(before - qdot <= acceleration * period + 1e-12)
        q = q + period * qdot
        assert np.all(q <= iiwa7_model.q_upper + 1e-12)
    assert np.all(q >= iiwa7_model.q_upper - 1e-3)


def test_closest_and_sensor_point(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    program, rng = build_program(iiwa7_config, iiwa7_model), np.random.default_rng(27)
    for _ in range(100):
        point, start, end = rng.uniform(-1.0, 1.0, (3, 3))
        closest = call(program, "closest_point", point=point, start=start, end=end)["closest"]
        candidates = start + np.linspace(0.0, 1.0, 2001)[:, None] * (end - start)
        least = np.linalg.norm(candidates - point, axis=1).min()
        assert np.linalg.norm(closest - point) <= least + 1e-12
        assert least - np.linalg.norm(closest - point) < 1e-5
    sphere = call(program, "closest_point", point=[1, 2, 3], start=[0.5, 0, 0], end=[0.5, 0, 0])["closest"]
    np.testing.assert_array_equal(sphere, [0.5, 0.0, 0.0])
    turn = np.hstack([pin.rpy.rpyToMatrix(0.1, 0.2, 0.3), [[1.0], [2.0], [3.0]]])
    inputs = {"position": [0.1, 0.0, 0.2], "normal": [0.0, 1.0, 0.0], "range": 0.5}
    result = call(program, "sensor_point", body_to_world=turn, **inputs)["point"]
    np.testing.assert_allclose(result, turn[:, :3] @ [0.1, 0.5, 0.2] + turn[:, 3], atol=1e-15)
