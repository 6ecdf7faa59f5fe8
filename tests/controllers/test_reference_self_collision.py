"""Self-collision: rows against finite differences, pairs, thresholds, and an arm that folds upon itself."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from reference_tools import silence, step_at, variant

from proxgen.controllers.protocol import Array, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.controllers.reference.geometry import Capsules
from proxgen.controllers.reference.kinematics import Arm
from proxgen.controllers.reference.relaxation import slack_weights
from proxgen.controllers.reference.row_order import RowOrder
from proxgen.controllers.reference.self_collision import SelfPoints, self_rows
from proxgen.errors import ConfigError
from proxgen.model import RobotModel

POINTS = """
avoidance:
  self_collision:
    d_a: 1.0
    d_0u: 0.07
    points:
      - {name: tool, frame: tcp, radius: 60 mm}
      - {name: side, frame: flange, position: [0.1, 0.02, 0]}
      - {name: shoulder, frame: link_2, position: [0.12, 0.1, 0.05], radius: 10 mm}
      - {name: base, frame: link_0, position: [0.3, -0.2, 0.1], radius: 20 mm}
    exclude:
      - {capsule: forearm, point: side}
"""

STEP = 1e-6


@pytest.fixture(scope="module")
def controller(tmp_path_factory: pytest.TempPathFactory) -> ReferenceController:
    """The iiwa 7 with three points, seen from far away."""
    return ReferenceController(*variant(tmp_path_factory.mktemp("self"), POINTS))


def distances_by_hand(model: RobotModel, q: Array) -> Array:
    """Distance of every capsule's surface from that of its nearest point, (L,), by sampling of the axes."""
    arm = Arm(model)
    arm.move_to(q)
    start, end = Capsules(model).place(arm)
    t = np.linspace(0.0, 1.0, 4001)[:, None]
    least = np.full(len(model.capsules), np.inf)
    for point in model.self_points:
        world = arm.rotations[point.body] @ point.position + arm.origins[point.body]
        for slot, capsule in enumerate(model.capsules):
            if point.capsules[slot]:
                axis = (1.0 - t) * start[slot] + t * end[slot]
                gap = np.linalg.norm(axis - world, axis=1).min() - capsule.radius - point.radius
                least[slot] = min(least[slot], gap)
    return least


def test_pairs_are_those_of_other_bodies_that_are_not_excluded(controller: ReferenceController) -> None:
    pairs = {point.name: point.capsules for point in controller.model.self_points}
    assert pairs["tool"] == (True, True, False)  # the hand carries it
    assert pairs["side"] == (True, False, False)
    assert pairs["shoulder"] == pairs["base"] == (True, True, True)


def test_distances_are_those_of_the_surfaces(controller: ReferenceController) -> None:
    rng = np.random.default_rng(21)
    for q in rng.uniform(-1.9, 1.9, (30, 7)):
        found = step_at(controller, q).diagnostics.self_distance
        expected = distances_by_hand(controller.model, q)
        expected[expected > 1.0] = np.inf
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6)


def test_rows_are_the_rates_of_the_distances(controller: ReferenceController) -> None:
    """d/dt distance = -A q̇ for motion of any joint, also of those that carry both."""
    rng, checked = np.random.default_rng(22), 0
    for _ in range(120):
        q, qdot = rng.uniform(-1.9, 1.9, 7), rng.normal(size=7)
        here = step_at(controller, q).diagnostics
        ahead = step_at(controller, q + STEP * qdot).diagnostics.self_distance
        behind = step_at(controller, q - STEP * qdot).diagnostics.self_distance
        rows, on = here.A[-3:], here.row_on[-3:] & np.isfinite(ahead) & np.isfinite(behind)
        rate = (ahead[on] - behind[on]) / (2.0 * STEP)
        np.testing.assert_allclose(-(rows[on] @ qdot), rate, rtol=0, atol=1e-7)
        checked += int(on.sum())
    assert checked > 100


def test_joints_below_both_do_not_move_them_towards_each_other(controller: ReferenceController) -> None:
    """The tool against the upper arm, both of which joints 1 to 3 carry."""
    model = controller.model
    own = SelfPoints(replace(model, self_points=model.self_points[:1]))
    arm, capsules = Arm(model), Capsules(model)
    arm.move_to(np.array([0.3, 0.4, -0.2, 2.0, 0.5, 1.8, 0.0]))
    nearest = own.nearest(arm, capsules, 1.0)
    assert np.isfinite(nearest.distance[0])
    row = self_rows(arm, capsules, nearest, controller._parameters)[0][0]
    np.testing.assert_allclose(row[:3], 0.0, atol=1e-15)
    assert np.linalg.norm(row[3:]) > 0.1


@pytest.mark.parametrize("row_speed", [1.0, 0.1])
def test_the_law_has_thresholds_of_its_own(controller: ReferenceController, row_speed: float) -> None:
    """Right-hand sides follow (13) with 1.0, 0.07, 0.05 and 0.03 m, and never demand more than row_speed."""
    rng, seen, less = np.random.default_rng(23), set(), 0
    controller.set_parameters(row_speed=row_speed)
    for q in rng.uniform(-2.0, 2.0, (300, 7)):
        found = step_at(controller, q).diagnostics
        for slot in np.flatnonzero(found.row_on[-3:]):
            d, row = float(found.self_distance[slot]), found.A[-3 + slot]
            if d > 0.07:
                speed = 0.2 * (d - 0.07) / 0.93
            elif d > 0.05:
                speed = 0.0
            else:
                speed = -0.2 * min((0.05 - d) / 0.02, 1.0)
            expected = max(speed, -row_speed * float(np.linalg.norm(row)))
            assert found.ubA[-3 + slot] == pytest.approx(expected, abs=1e-12)
            seen.add((d > 0.07, d > 0.05))
            less += expected > speed
    controller.set_parameters(row_speed=1.0)
    assert len(seen) == 3
    assert less > 0 or row_speed == 1.0


def test_rows_are_dropped_by_their_own_distances(controller: ReferenceController) -> None:
    order = RowOrder("proposed", "paper", capsules=3, active=True, self_collision=True)
    p = controller._parameters
    ladder = order.ladder(np.full(3, 0.2), np.array([0.2, 0.06, 0.02]), p)
    assert ladder.dropped_at.tolist()[3:] == [Status.REDUCED_ACTIVE, 2, 4, 99]
    assert order.count == 7


def test_soft_rows_weigh_by_their_own_distances(controller: ReferenceController) -> None:
    on, p = np.ones(7, dtype=bool), controller._parameters
    weights = slack_weights(on, np.full(3, 0.235), p, np.array([1.0, 0.515, 0.03]))
    np.testing.assert_allclose(weights, [25.0, 25.0, 25.0, 10.0, 1.0, 25.0, 100.0], rtol=1e-12)


def test_a_point_on_an_axis_is_a_fault(tmp_path: Path) -> None:
    """Stretched out, the upper arm's axis goes through a point that the hand carries far behind it."""
    text = "avoidance: {self_collision: {points: [{name: inside, frame: tcp, position: [0, 0, -0.906]}]}}\n"
    controller = ReferenceController(*variant(tmp_path, text))
    command = step_at(controller, np.zeros(7))
    assert command.status is Status.FAULT_OBSTACLE_INSIDE
    np.testing.assert_array_equal(command.diagnostics.self_distance, np.full(3, np.inf))


def fold(controller: ReferenceController, cycles: int) -> float:
    """Pull the tool towards the upper arm; the least distance of a long gripper from it, between surfaces."""
    model, arm = controller.model, Arm(controller.model)
    q, least = np.array([0.0, 0.3, 0.0, -1.6, 0.0, 1.0, 0.0]), np.inf
    controller.reset()
    for cycle in range(cycles):
        arm.move_to(q)
        start, end = Capsules(model).place(arm)
        tool = arm.rotations[model.tool_body] @ model.tool_in_body[:3, 3] + arm.origins[model.tool_body]
        middle = 0.5 * (start[0] + end[0])
        gripper = tool + 0.1 * arm.rotations[model.tool_body][:, 2]
        t = np.clip((gripper - start[0]) @ (end[0] - start[0]) / 0.16, 0.0, 1.0)
        least = min(least, float(np.linalg.norm(start[0] + t * (end[0] - start[0]) - gripper)) - 0.135)
        pull = 0.25 * (middle - tool) / np.linalg.norm(middle - tool)
        command = controller.step(q, pull, silence(model, 0.02 * cycle))
        q = q + 0.02 * command.qdot
    return least


def test_the_arm_does_not_fold_into_itself(tmp_path: Path) -> None:
    """Without the rows the gripper enters the upper arm; with them it comes as near as the law allows."""
    point = "{name: gripper, frame: tcp, position: [0, 0, 0.1], radius: 60 mm}"
    points = f"avoidance: {{self_collision: {{points: [{point}]}}}}\n"
    assert fold(ReferenceController(*variant(tmp_path, "")), 250) < 0.0
    with_rows = fold(ReferenceController(*variant(tmp_path, points)), 250)
    assert 0.05 < with_rows < 0.10


def test_pairs_that_always_touch_are_refused(tmp_path: Path) -> None:
    """The wrist is a point of the hand's axis and an end of the forearm's: both have to be excluded."""
    text = "avoidance: {self_collision: {points: [{name: wrist, frame: link_6, radius: 70 mm}]}}\n"
    with pytest.raises(ConfigError) as caught:
        variant(tmp_path, text)
    assert [problem.key for problem in caught.value.problems] == ["avoidance.self_collision.points.0"] * 2
    assert "add {capsule: forearm, point: wrist} to exclude" in str(caught.value)
    assert "add {capsule: hand, point: wrist} to exclude" in str(caught.value)


def test_points_without_a_pair_are_refused(tmp_path: Path) -> None:
    exclude = ", ".join(f"{{capsule: {name}, point: tool}}" for name in ("upper_arm", "forearm"))
    text = f"avoidance: {{self_collision: {{points: [{{name: tool, frame: tcp}}], exclude: [{exclude}]}}}}\n"
    with pytest.raises(ConfigError, match="'tool' is a pair with no capsule"):
        variant(tmp_path, text)


def test_exclusions_of_what_does_not_exist_are_refused(tmp_path: Path) -> None:
    text = (
        "avoidance: {self_collision: {points: [{name: tool, frame: tcp}], "
        "exclude: [{capsule: fore_arm, point: tool}, {capsule: hand, point: tol}]}}\n"
    )
    with pytest.raises(ConfigError) as caught:
        variant(tmp_path, text)
    assert "unknown self-collision point 'tol'; did you mean 'tool'?" in str(caught.value)
