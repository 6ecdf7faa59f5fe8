"""The ladder of section IV.C, stage by stage, and the soft rows."""

from collections import Counter

import numpy as np
import pytest

from proxgen.compare.states import random_states
from proxgen.config.schema import Config
from proxgen.controllers.protocol import OFF, Array, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.controllers.reference.feasibility import feasibility_margin
from proxgen.controllers.reference.parameters import default_parameters
from proxgen.controllers.reference.qp import QuadraticProgram
from proxgen.controllers.reference.relaxation import (
    STAGES,
    Ladder,
    dropping,
    slack_weights,
    soft,
    stage_rows,
    staged,
)
from proxgen.controllers.reference.row_order import RowOrder
from proxgen.model import RobotModel

TOLERANCE = 1e-8
DISTANT, CRITICAL = 0.25, 0.17
ALL_ON = np.ones(3, dtype=bool)


def ladder(distance: Array) -> Ladder:
    """Capsules at these distances, and the active row."""
    return Ladder(np.append(dropping(distance, DISTANT, CRITICAL), Status.REDUCED_ACTIVE))


def one_joint(b: tuple[float, float, float], lower: float = -1.0) -> QuadraticProgram:
    """Wants x = 0.9. Rows of two capsules, x ≤ b0 and -x ≤ b1, and the active row -x ≤ b2."""
    A = np.array([[1.0], [-1.0], [-1.0]])
    return QuadraticProgram(np.eye(1), np.array([-0.9]), A, np.array(b), np.array([lower]), np.ones(1))


@pytest.mark.parametrize(
    ("b", "distance", "lower", "status", "x", "solves"),
    [
        ((0.5, 0.1, 0.0), (0.28, 0.28), -1.0, Status.SOLVED, 0.5, 1),
        ((-0.5, 0.6, 0.0), (0.28, 0.28), -1.0, Status.REDUCED_ACTIVE, -0.5, 2),
        ((-0.5, -0.2, 0.0), (0.10, 0.28), -1.0, Status.REDUCED_DISTANT, -0.5, 3),
        ((-0.5, -0.2, 0.0), (0.10, 0.10), -1.0, Status.REDUCED_REPULSION, 0.0, 3),
        ((-0.5, 0.0, 0.0), (0.20, 0.10), 0.1, Status.REDUCED_CRITICAL, 0.9, 4),
        ((-0.5, 0.0, 0.0), (0.10, 0.20), 0.1, Status.STOPPED_INFEASIBLE, None, 4),
        ((0.0, 0.0, 0.0), (0.10, 0.10), 0.1, Status.STOPPED_INFEASIBLE, None, 2),
    ],
)
def test_each_stage_decides_where_it_is_the_first_feasible_one(
    b: tuple[float, float, float],
    distance: tuple[float, float],
    lower: float,
    status: Status,
    x: float | None,
    solves: int,
) -> None:
    """`solves` counts the stages that differ from the one before: the others are skipped."""
    decision = staged(one_joint(b, lower), ALL_ON, ladder(np.array(distance)), TOLERANCE)
    assert decision.status is status
    assert decision.solves == solves
    assert not decision.slack.any()
    if x is None:
        assert decision.solution is None
    else:
        assert decision.solution is not None
        assert decision.solution.x == pytest.approx([x], abs=1e-14)


def test_stages_are_cumulative() -> None:
    distance, b = np.array([0.28, 0.20, 0.10]), np.array([-0.1, -0.2, 0.1, 0.0])
    on = np.ones(4, dtype=bool)
    kept = {status: stage_rows(status, on, b, ladder(distance)) for status in STAGES}
    assert kept[Status.SOLVED][0].tolist() == [True, True, True, True]
    assert kept[Status.REDUCED_ACTIVE][0].tolist() == [True, True, True, False]
    assert kept[Status.REDUCED_DISTANT][0].tolist() == [False, True, True, False]
    assert kept[Status.REDUCED_REPULSION][0].tolist() == [False, True, True, False]
    assert kept[Status.REDUCED_CRITICAL][0].tolist() == [False, False, True, False]
    assert kept[Status.REDUCED_DISTANT][1].tolist() == b.tolist()
    assert kept[Status.REDUCED_CRITICAL][1].tolist() == [0.0, 0.0, 0.1, 0.0]
    assert on.all() and b[0] == -0.1, "the rows of stage 0 must stay as they were"


def test_rows_on_a_threshold_stay() -> None:
    """d > d_0u is dropped, d = d_0u is not; the same at d_r."""
    distance = np.array([DISTANT, np.nextafter(DISTANT, 1.0)])
    kept, _ = stage_rows(Status.REDUCED_DISTANT, ALL_ON, np.zeros(3), ladder(distance))
    assert kept.tolist() == [True, False, False]
    distance = np.array([CRITICAL, np.nextafter(CRITICAL, 1.0)])
    kept, _ = stage_rows(Status.REDUCED_CRITICAL, ALL_ON, np.zeros(3), ladder(distance))
    assert kept.tolist() == [True, False, False]


def check_decisions(config: Config, model: RobotModel, count: int, seed: int) -> Counter[Status]:
    """Every decision on random states: the stage's rows hold, and each stage before it was infeasible."""
    controller = ReferenceController(config, model)
    order, p = RowOrder.of(config), default_parameters(config, model)
    seen: Counter[Status] = Counter()
    for state in random_states(config, model, count, seed=seed, faults=0.0):
        if state.reset:
            controller.reset()
        command = controller.step(state.q, state.xdot, state.measurement)
        found, status = command.diagnostics, command.status
        seen[status] += 1
        assert (command.qdot >= found.lb).all() and (command.qdot <= found.ub).all()
        for stage in STAGES:
            steps = order.ladder(found.distance, found.self_distance, p)
            kept, b = stage_rows(stage, found.row_on, found.ubA, steps)
            if stage == status:
                assert (found.A[kept] @ command.qdot - b[kept]).max(initial=0.0) < TOLERANCE
                break
            least = feasibility_margin(found.A[kept], b[kept], found.lb, found.ub, TOLERANCE)[1]
            assert least > TOLERANCE
        if status is Status.STOPPED_INFEASIBLE:
            np.testing.assert_array_equal(command.qdot, np.clip(0.0, found.lb, found.ub))
            assert np.isnan(found.kkt_residual)
        elif status.success:
            assert found.kkt_residual < 1e-10
    return seen


def test_every_stage_is_reached_and_right(planar2_config: Config, planar2_model: RobotModel) -> None:
    seen = check_decisions(planar2_config, planar2_model, 1500, seed=31)
    assert set(seen) == {*STAGES, Status.STOPPED_INFEASIBLE}


def test_decisions_of_the_iiwa(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    seen = check_decisions(iiwa7_config, iiwa7_model, 400, seed=32)
    assert {Status.SOLVED, Status.REDUCED_REPULSION, Status.REDUCED_CRITICAL} <= set(seen)


def test_damper_schedule_has_no_critical_stage(planar2_config: Config, planar2_model: RobotModel) -> None:
    """d_s takes the place of d_0u and of d_r, so the last stage changes nothing."""
    damper = planar2_config.avoidance.damper.model_copy(
        update={"influence_distance": 0.15, "safety_distance": 0.10}
    )
    avoidance = planar2_config.avoidance.model_copy(update={"schedule": "damper", "damper": damper})
    config = planar2_config.model_copy(update={"avoidance": avoidance})
    seen = check_decisions(config, planar2_model, 600, seed=33)
    assert Status.REDUCED_DISTANT in seen or Status.REDUCED_REPULSION in seen
    assert Status.REDUCED_CRITICAL not in seen


def in_slack_mode(config: Config) -> Config:
    """The configuration with soft rows."""
    return config.model_copy(update={"relaxation": config.relaxation.model_copy(update={"mode": "slack"})})


def test_soft_weights_follow_the_ramp(planar2_config: Config, planar2_model: RobotModel) -> None:
    """100 clip((d_a - d)/(d_a - d_r), 0.1, 2)² with d_a = 0.15, d_r = 0.08; 10 for (7); 100 where off."""
    p = default_parameters(planar2_config, planar2_model)
    on, distance = (
        np.array([True, True, True, True, False, True]),
        np.array([0.08, 0.115, 0.15, -0.1, np.inf]),
    )
    weights = slack_weights(on, distance, p)
    np.testing.assert_allclose(weights, [100.0, 25.0, 1.0, 400.0, 100.0, 10.0], rtol=1e-13)


def test_one_soft_row_by_hand(planar2_config: Config, planar2_model: RobotModel) -> None:
    """min ½x² - 0.9x + ½ρ(x - b)²: x = (0.9 + ρb)/(1 + ρ), s = x - b."""
    p = default_parameters(planar2_config, planar2_model)
    program, on = one_joint((-0.2, OFF, OFF)), np.array([True, False, False])
    decision = soft(program, on, slack_weights(on, np.array([0.08, np.inf]), p), TOLERANCE)
    x = (0.9 - 100.0 * 0.2) / 101.0
    assert decision.status is Status.SOLVED
    assert decision.solution is not None
    assert decision.solution.x[0] == pytest.approx(x, abs=1e-14)
    np.testing.assert_allclose(decision.slack, [x + 0.2, 0.0, 0.0], rtol=0, atol=1e-14)


def soft_gradient(H: Array, g: Array, A: Array, b: Array, rho: Array, x: Array) -> Array:
    """Gradient of ½xᵀHx + gᵀx + ½ Σ ρ max(Ax - b, 0)²."""
    return np.asarray(H @ x + g + A.T @ (rho * np.maximum(A @ x - b, 0.0)))


def test_slack_mode_always_solves_its_qp(planar2_config: Config, planar2_model: RobotModel) -> None:
    """With s eliminated it is a box-constrained QP: the gradient may only push against a bound."""
    config = in_slack_mode(planar2_config)
    controller = ReferenceController(config, planar2_model)
    p, soft_cycles = default_parameters(config, planar2_model), 0
    for state in random_states(config, planar2_model, 500, seed=34, faults=0.0):
        command = controller.step(state.q, state.xdot, state.measurement)
        found, x = command.diagnostics, command.qdot
        on = found.row_on
        assert command.status is Status.SOLVED
        rho = slack_weights(on, found.distance, p)[on]
        gradient = soft_gradient(found.H, found.g, found.A[on], found.ubA[on], rho, x)
        inside = (x > found.lb + 1e-9) & (x < found.ub - 1e-9)
        assert np.abs(gradient[inside]).max(initial=0.0) < 1e-9
        assert gradient[x <= found.lb + 1e-9].min(initial=0.0) > -1e-9 or (found.lb == found.ub).any()
        assert gradient[x >= found.ub - 1e-9].max(initial=0.0) < 1e-9 or (found.lb == found.ub).any()
        expected = np.maximum(found.A @ x - found.ubA, 0.0)
        np.testing.assert_allclose(found.slack[on], expected[on], rtol=0, atol=1e-10)
        assert not found.slack[~on].any()
        soft_cycles += found.slack.max() > 1e-3
    assert soft_cycles > 100


def test_heavy_slack_comes_near_the_hard_rows(planar2_config: Config, planar2_model: RobotModel) -> None:
    """Where all rows can be met, soft rows cost no more than hard ones; heavy ones hardly give way."""
    hard = ReferenceController(planar2_config, planar2_model)
    loose = ReferenceController(in_slack_mode(planar2_config), planar2_model)
    loose.set_parameters(slack_weight=1e6, slack_active_weight=1e6, slack_minimum=1.0)
    compared = 0
    for state in random_states(planar2_config, planar2_model, 300, seed=35, faults=0.0):
        hard.reset()
        loose.reset()
        command = hard.step(state.q, state.xdot, state.measurement)
        if command.status is Status.SOLVED and command.diagnostics.row_on.any():
            near = loose.step(state.q, state.xdot, state.measurement)
            H, g = command.diagnostics.H, command.diagnostics.g
            cost = [0.5 * x @ H @ x + g @ x for x in (near.qdot, command.qdot)]
            assert cost[0] + 0.5e6 * np.sum(near.diagnostics.slack**2) <= cost[1] + 1e-12
            assert near.diagnostics.slack.max() < 1e-3
            compared += 1
    assert compared > 30
