"""The reference's Jacobians and rows against finite differences of poses and distances, on many arms."""

import numpy as np
import pinocchio as pin
import pytest

from proxgen.compare.states import random_states
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array, Diagnostics, Measurement
from proxgen.controllers.reference import ReferenceController
from proxgen.controllers.reference.kinematics import Arm
from proxgen.model import RobotModel
from proxgen.model.kinematics import tool_pose

STEP = 1e-6
TOLERANCE = 2e-8
"""Central differences of smooth functions of size 1: STEP² plus rounding / STEP."""


def tool_velocity(model: RobotModel, q: Array, qdot: Array) -> Array:
    """Velocity of the tool (6,), linear and angular, by central differences (in `task_frame`, if any)."""
    behind, ahead = tool_pose(model, q - STEP * qdot), tool_pose(model, q + STEP * qdot)
    linear = (ahead - behind)[:3, 3] / (2.0 * STEP)
    angular = pin.log3(ahead[:3, :3] @ behind[:3, :3].T) / (2.0 * STEP)
    if model.task_frame is not None:
        angular = (tool_pose(model, q)[:3, :3] @ model.task_frame).T @ angular
    return np.concatenate((linear, angular))


def check_task_jacobian(model: RobotModel) -> None:
    """J q̇ is the selected part of the tool's velocity."""
    arm, rng = Arm(model), np.random.default_rng(5)
    chosen = [("x", "y", "z", "rx", "ry", "rz").index(row) for row in model.task_rows]
    for _ in range(50):
        q, qdot = rng.uniform(-2.0, 2.0, model.n), rng.normal(size=model.n)
        arm.move_to(q)
        velocity = tool_velocity(model, q, qdot)[chosen]
        np.testing.assert_allclose(arm.task_jacobian() @ qdot, velocity, rtol=0, atol=TOLERANCE)


def test_task_jacobian_of_the_iiwa(iiwa7_model: RobotModel) -> None:
    check_task_jacobian(iiwa7_model)


def test_task_jacobian_of_any_arm(any_model: RobotModel) -> None:
    check_task_jacobian(any_model)


def diagnostics_at(controller: ReferenceController, q: Array, points: Array) -> Diagnostics:
    """The QP at q with these obstacle points and nothing else."""
    model = controller.model
    ranges = np.array([module.tof.range for module in model.tof_modules if module.tof])
    controller.reset()
    seen = Measurement(0.0, ranges, np.zeros(len(model.capacitive_modules), dtype=bool), points=points)
    return controller.step(q, np.zeros(model.m), seen).diagnostics


def check_rows(config: Config, model: RobotModel) -> None:
    """d/dt distance = -A q̇ in every slot, and J_c = -(weighted sum of the gradients), weights held."""
    controller, rng = ReferenceController(config, model), np.random.default_rng(6)
    controller.set_parameters(limit_tolerance=10.0)
    count, checked, active = len(model.capsules), 0, 0
    for state in random_states(config, model, 60, seed=7, faults=0.0):
        q, qdot, points = state.q, rng.normal(size=model.n), state.measurement.points
        here = diagnostics_at(controller, q, points)
        ahead = diagnostics_at(controller, q + STEP * qdot, points)
        behind = diagnostics_at(controller, q - STEP * qdot, points)
        same = (ahead.nearest_point == behind.nearest_point).all(axis=1) & np.isfinite(here.distance)
        distances = np.full(count, np.nan)
        distances[same] = (ahead.distance[same] - behind.distance[same]) / (2.0 * STEP)
        rows = here.row_on[:count] & same
        np.testing.assert_allclose(-(here.A[:count] @ qdot)[rows], distances[rows], rtol=0, atol=1e-7)
        checked += int(rows.sum())
        near = here.distance <= controller.parameters["d_active"]
        if here.row_on[count:].any() and same[near].all():
            weights = 1.0 / np.maximum(here.distance[near], 1e-3)
            expected = -weights @ distances[near] / weights.sum()
            assert here.A[count] @ qdot == pytest.approx(expected, abs=1e-7)
            assert here.ubA[count] == 0.0
            active += 1
    assert checked > 30
    assert active > 10 or not config.avoidance.active.enabled


def test_rows_of_the_iiwa(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    check_rows(iiwa7_config, iiwa7_model)


def test_rows_of_any_arm(any_config: Config, any_model: RobotModel) -> None:
    check_rows(any_config, any_model)


def test_obstacle_points_of_the_skin(any_config: Config, any_model: RobotModel) -> None:
    """A reading stands for the point o + r n, a closed switch for o + d_v n: the rows are the same."""
    controller, rng = ReferenceController(any_config, any_model), np.random.default_rng(8)
    ranges = np.array([module.tof.range for module in any_model.tof_modules if module.tof])
    arm = Arm(any_model)
    for _ in range(20):
        q = rng.uniform(np.maximum(any_model.q_lower, -3.0), np.minimum(any_model.q_upper, 3.0))
        readings = np.where(rng.random(ranges.size) < 0.5, rng.uniform(0.02, 0.3, ranges.size), ranges)
        closed = rng.random(len(any_model.capacitive_modules)) < 0.3
        controller.reset()
        by_skin = controller.step(q, np.zeros(any_model.m), Measurement(0.0, readings, closed)).diagnostics
        arm.move_to(q)
        places = [
            (m, r) for m, r, top in zip(any_model.tof_modules, readings, ranges, strict=True) if r < top
        ]
        places += [
            (module, module.capacitive.virtual_distance)
            for module, is_closed in zip(any_model.capacitive_modules, closed, strict=True)
            if is_closed and module.capacitive
        ]
        points = [
            arm.rotations[module.body] @ (module.position + reach * module.normal) + arm.origins[module.body]
            for module, reach in places
        ]
        by_points = diagnostics_at(controller, q, np.array(points).reshape(-1, 3))
        np.testing.assert_allclose(by_skin.distance, by_points.distance, rtol=0, atol=1e-14)
        np.testing.assert_allclose(by_skin.A, by_points.A, rtol=0, atol=1e-13)
        np.testing.assert_array_equal(by_skin.row_on, by_points.row_on)
