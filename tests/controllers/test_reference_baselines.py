"""The repulsive and the tangential method: what they demand of the nearest point, and their ladders."""

from pathlib import Path

import numpy as np
import pytest
from reference_tools import step_at, variant

from proxgen.config.scene import load_scene
from proxgen.controllers.protocol import OFF, Array, Diagnostics, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.controllers.reference.avoidance import Nearest
from proxgen.controllers.reference.baselines import DROPPED_AT, WIDTH, Tangential
from proxgen.controllers.reference.geometry import Capsules, closest_on_segments
from proxgen.controllers.reference.kinematics import Arm
from proxgen.controllers.reference.parameters import Parameters
from proxgen.controllers.reference.relaxation import Ladder, stage_rows
from proxgen.controllers.reference.tangents import basis_of, first_of_best, tangents_of
from proxgen.errors import ConfigError
from proxgen.simulation.rollout import run

REPULSIVE = "avoidance: {method: repulsive}\nlimits: {acceleration: null}\n"
TANGENTIAL = "avoidance: {method: tangential}\nlimits: {acceleration: null}\n"
BENT = np.array([0.2, 0.5, -0.3, -1.4, 0.4, 1.0, 0.2])


@pytest.fixture(scope="module")
def repulsive(tmp_path_factory: pytest.TempPathFactory) -> ReferenceController:
    return ReferenceController(*variant(tmp_path_factory.mktemp("repulsive"), REPULSIVE))


@pytest.fixture(scope="module")
def tangential(tmp_path_factory: pytest.TempPathFactory) -> ReferenceController:
    return ReferenceController(*variant(tmp_path_factory.mktemp("tangential"), TANGENTIAL))


def point_beside(controller: ReferenceController, q: Array, slot: int, distance: float) -> Array:
    """An obstacle point (1, 3) at this distance from a capsule's axis, and far from the others."""
    arm, capsules = Arm(controller.model), Capsules(controller.model)
    arm.move_to(q)
    start, end = (ends[slot] for ends in capsules.place(arm))
    best, room = np.empty((1, 3)), -np.inf
    for normal in tangents_of((end - start) / np.linalg.norm(end - start)):
        point = (0.3 * start + 0.7 * end + distance * normal)[None]
        others = np.delete(capsules.surface_distance(arm, point) + capsules.radius[:, None], slot)
        if others.min() > room:
            best, room = point, float(others.min())
    return best


def moving(
    controller: ReferenceController, q: Array, slot: int, point: Array, qdot: Array
) -> tuple[Array, Array]:
    """Velocity of the capsule's point that is nearest to `point` (3,), and the direction from it."""
    arm, capsules = Arm(controller.model), Capsules(controller.model)
    arm.move_to(q)
    closest = closest_on_segments(point[None], *capsules.place(arm))[slot, 0]
    offset = point - closest
    velocity = arm.point_jacobian(int(capsules.body[slot]), closest) @ qdot
    return velocity, offset / np.linalg.norm(offset)


def test_tangents_are_a_circle_around_the_direction() -> None:
    rng = np.random.default_rng(31)
    for direction in [*rng.normal(size=(20, 3)), np.array([1.0, 0, 0]), np.array([0, 0, -1.0])]:
        unit = direction / np.linalg.norm(direction)
        candidates, basis = tangents_of(unit), basis_of(unit)
        np.testing.assert_allclose(candidates @ unit, 0.0, atol=1e-15)
        np.testing.assert_allclose(np.linalg.norm(candidates, axis=1), 1.0, rtol=1e-14)
        np.testing.assert_allclose(candidates[0], basis.first)
        np.testing.assert_allclose(candidates[6], basis.second, atol=1e-15)
        np.testing.assert_allclose(candidates[:12], -candidates[12:], atol=1e-15)


def test_of_equal_scores_the_first_is_kept() -> None:
    assert first_of_best(np.array([0.3, 0.3 + 1e-12, 0.3 + 1e-8, 0.3 + 1.05e-8])) == 2


@pytest.mark.parametrize("distance", [0.24, 0.20, 0.15])
def test_the_nearest_point_moves_straight_away(repulsive: ReferenceController, distance: float) -> None:
    """J_p q̇ = -v d̂ whatever the task wants, with v = -law(d); the hand can do that."""
    point = point_beside(repulsive, BENT, 2, distance)
    speed = 0.0 if distance > 0.22 else min(0.2 * (0.22 - distance) / 0.05, 0.2)
    command = step_at(repulsive, BENT, point, np.array([0.2, -0.1, 0.05]))
    velocity, direction = moving(repulsive, BENT, 2, point[0], command.qdot)
    assert command.status is Status.SOLVED
    np.testing.assert_allclose(velocity, -speed * direction, rtol=0, atol=2.0 * WIDTH)


def test_beyond_the_dead_zone_there_is_no_row(repulsive: ReferenceController) -> None:
    near = step_at(repulsive, BENT, point_beside(repulsive, BENT, 2, 0.2501)).diagnostics
    assert near.distance[2] == pytest.approx(0.2501)
    assert not near.row_on.any() and (near.ubA == OFF).all()
    on_it = step_at(repulsive, BENT, point_beside(repulsive, BENT, 2, 0.25)).diagnostics
    assert on_it.row_on.all()


def test_what_cannot_be_moved_has_no_row(repulsive: ReferenceController) -> None:
    """The upper arm's point moves in a plane only: the row along its axis would be 0 = 0, and is off."""
    found = step_at(repulsive, BENT, point_beside(repulsive, BENT, 0, 0.15)).diagnostics
    assert found.row_on[:2].all()
    assert found.row_on[2:].sum() == 2
    rows = found.A[found.row_on][::2]
    assert np.linalg.matrix_rank(rows, tol=1e-3) == 2


@pytest.mark.parametrize("slot", [1, 2])
def test_the_nearest_point_moves_along_a_tangent(tangential: ReferenceController, slot: int) -> None:
    """At least 0.1 m/s along one of the candidates, and nothing across it or towards the obstacle."""
    point = point_beside(tangential, BENT, slot, 0.235)
    command = step_at(tangential, BENT, point, np.array([0.05, 0.2, -0.1]))
    velocity, direction = moving(tangential, BENT, slot, point[0], command.qdot)
    candidates = tangents_of(direction)
    tangent = candidates[int(np.argmax(candidates @ velocity))]
    assert command.status is Status.SOLVED
    along = float(velocity @ tangent)
    assert along > 0.1 - 1e-9
    np.testing.assert_allclose(velocity, along * tangent, rtol=0, atol=2.0 * WIDTH)


def nearest_at(distance: list[float], direction: list[list[float]]) -> Nearest:
    """Obstacle points of which only distances [m] and directions matter."""
    nowhere = np.zeros((len(distance), 3))
    return Nearest(np.array(distance), nowhere, nowhere, np.array(direction, dtype=float), False)


def chosen(method: Tangential, nearest: Nearest, angle: float, p: Parameters) -> float:
    """Angle of the tangent that is chosen for a task velocity at `angle`, around the direction z [rad]."""
    tangent = method._choose(0, nearest, 0.2 * np.array([np.cos(angle), np.sin(angle), 0.3]), p)
    method._tangent = tangent
    assert tangent[2] == pytest.approx(0.0, abs=1e-15)
    return float(np.arctan2(tangent[1], tangent[0]))


def test_the_tangent_goes_with_the_task_and_is_kept(tangential: ReferenceController) -> None:
    """Candidates are 15 degrees apart; the weight 1/2 outweighs a small turn, but not one of 0.8 rad."""
    p, wall = tangential._parameters, nearest_at([0.24, np.inf], [[0, 0, 1], [np.nan] * 3])
    method = Tangential("paper", ("x", "y", "z"))
    assert chosen(method, wall, 0.15, p) == pytest.approx(np.radians(15.0))
    assert chosen(method, wall, 0.09, p) == pytest.approx(np.radians(15.0))
    assert chosen(method, wall, -0.8, p) == pytest.approx(
        np.radians(-30.0)
    )  # halfway, for the last one's sake
    method.reset()
    assert chosen(method, wall, 0.09, p) == pytest.approx(0.0)


def test_other_obstacles_turn_the_tangent_away(tangential: ReferenceController) -> None:
    """One at d_r in the way weighs 1, as much as the task; one at d_a weighs nothing."""
    p = tangential._parameters
    for distance, angle in ((0.30, 0.0), (0.17, 45.0)):
        method = Tangential("paper", ("x", "y", "z"))
        corner = nearest_at([0.16, distance], [[0, 0, 1], [1, 0, 0]])
        assert chosen(method, corner, np.radians(1.0), p) == pytest.approx(np.radians(2.0 * angle), abs=0.3)


def test_the_ladders_are_those_of_the_table() -> None:
    b, on = np.full(6, -0.1), np.ones(6, dtype=bool)
    for method, kept in (
        ("repulsive", {0: [0, 1, 2, 3, 4, 5], 1: [0, 1], 2: [0], 3: [0], 4: [0]}),
        ("tangential", {0: [0, 1, 2, 3, 4], 1: [0, 1, 2, 3], 2: [0], 3: [0], 4: [0]}),
    ):
        ladder = Ladder(np.array(DROPPED_AT[method]), WIDTH)
        count = len(ladder.dropped_at)
        for stage, rows in kept.items():
            found, right = stage_rows(Status(stage), on[:count], b[:count], ladder)
            assert np.flatnonzero(found).tolist() == rows
            assert right[0] == (WIDTH if stage >= 3 else -0.1)


def test_too_fast_a_retreat_is_given_up_step_by_step(repulsive: ReferenceController) -> None:
    """An arm that may hardly accelerate: the retreat is out of reach, standing still is not."""
    repulsive.set_parameters(qddot_limit=np.full(7, 1.0))
    try:
        command = step_at(repulsive, BENT, point_beside(repulsive, BENT, 2, 0.15))
    finally:
        repulsive.set_parameters(qddot_limit=np.full(7, OFF))
    assert command.status is Status.REDUCED_REPULSION
    check_within(command.diagnostics, command.qdot)


def check_within(found: Diagnostics, qdot: Array) -> None:
    assert (qdot >= found.lb).all() and (qdot <= found.ub).all()


def test_additions_to_the_proposed_method_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="circulation needs method: proposed, not repulsive"):
        variant(tmp_path, "avoidance: {method: repulsive, circulation: {enabled: true}}\n")
    with pytest.raises(ConfigError, match="needs the relaxation mode 'staged'"):
        variant(tmp_path, "avoidance: {method: tangential}\nrelaxation: {mode: slack}\n")


def test_the_tangential_method_needs_all_of_the_tools_velocity(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="needs all of the rows x, y, z of the task"):
        variant(tmp_path, "avoidance: {method: tangential}\n", robot="planar2")


def test_repulsion_stops_in_front_of_the_gap_and_the_tangent_does_not(tmp_path: Path) -> None:
    """The paper's claim in 15 s with true distances: the repulsive method never gets anywhere."""
    reached = {}
    for method in ("repulsive", "tangential"):
        config, model = variant(tmp_path, f"avoidance: {{method: {method}}}\n")
        controller = ReferenceController(config, model)
        log = run(config, model, controller, load_scene("pillar"), sensing="ideal", duration=15.0)
        reached[method] = int(log.targets_reached[-1])
        assert log.true_surface_distance.min() > 0.0
        assert not log.outside_limits().any()
    assert reached["repulsive"] <= 1 < reached["tangential"]
