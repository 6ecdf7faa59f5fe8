"""Section IV.C: what happens when the rows cannot all be met. A ladder of smaller QPs, or soft rows."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from proxgen.controllers.protocol import OFF, Array, Status
from proxgen.controllers.reference.parameters import Parameters
from proxgen.controllers.reference.qp import QuadraticProgram, Solution, solve

STAGES = (
    Status.SOLVED,
    Status.REDUCED_ACTIVE,
    Status.REDUCED_DISTANT,
    Status.REDUCED_REPULSION,
    Status.REDUCED_CRITICAL,
)


NONE = np.empty(0)
"""Distances of an addition that is off."""


@dataclass(frozen=True)
class Decision:
    """How the QP of a cycle was decided.

    Attributes:
        status: of the stage that was solved, or why there is none.
        solution: of that stage, or None.
        slack: (R,) how far each soft row is exceeded [m/s]; zeros in staged mode.
        iterations: working-set changes, all stages.
        solves: QPs solved, all stages and second chances.
        second_chances: solves whose first answer did not stand.
    """

    status: Status
    solution: Solution | None
    slack: Array
    iterations: int
    solves: int
    second_chances: int


@dataclass(frozen=True)
class Ladder:
    """What the stages do with the rows.

    Attributes:
        dropped_at: (R,) the stage from which each row is dropped; KEPT: none.
        least: right-hand sides below are raised to it from the stage of raised repulsion on [m/s].
    """

    dropped_at: NDArray[np.int_]
    least: float = 0.0


KEPT = 99
"""Stands for a stage that does not come."""


def dropping(distance: Array, distant: float, critical: float) -> NDArray[np.int_]:
    """The stage from which rows at distances (K,) are dropped: those beyond `distant`, beyond `critical`."""
    late = np.where(distance > critical, Status.REDUCED_CRITICAL, KEPT)
    stages: NDArray[np.int_] = np.where(distance > distant, Status.REDUCED_DISTANT, late)
    return stages


def stage_rows(
    status: Status, on: NDArray[np.bool_], b: Array, ladder: Ladder
) -> tuple[NDArray[np.bool_], Array]:
    """Rows and right-hand sides of a stage (each includes what the stages before it did).

    Args:
        status: the stage, one of `STAGES`.
        on: (R,) rows of stage 0.
        b: (R,) their right-hand sides [m/s].
        ladder: what happens to each row.

    Returns:
        (R,) rows that are kept, and (R,) right-hand sides.
    """
    kept: NDArray[np.bool_] = on & (status < ladder.dropped_at)
    return kept, np.maximum(b, ladder.least) if status >= Status.REDUCED_REPULSION else b


def staged(program: QuadraticProgram, on: NDArray[np.bool_], ladder: Ladder, tolerance: float) -> Decision:
    """The first stage of the ladder that is feasible; a stage that changes nothing is skipped.

    Args:
        program: the QP with all R rows, those that are off included.
        on: (R,) rows of stage 0.
        ladder: what the stages do with the rows.
        tolerance: greatest KKT residual.
    """
    iterations = solves = second_chances = 0
    failed = False
    for status, kept, b in _distinct_stages(on, program.b, ladder):
        stage = QuadraticProgram(program.H, program.g, program.A[kept], b[kept], program.lb, program.ub)
        verdict = solve(stage, tolerance)
        iterations += verdict.iterations
        solves += 1 + verdict.second_chance
        second_chances += verdict.second_chance
        if verdict.solution is not None:
            slack = np.zeros(on.size)
            return Decision(status, verdict.solution, slack, iterations, solves, second_chances)
        failed |= not verdict.infeasible
    status = Status.STOPPED_SOLVER if failed else Status.STOPPED_INFEASIBLE
    return Decision(status, None, np.zeros(on.size), iterations, solves, second_chances)


def _distinct_stages(
    on: NDArray[np.bool_], b: Array, ladder: Ladder
) -> Iterator[tuple[Status, NDArray[np.bool_], Array]]:
    """The stages that differ from the one before."""
    previous: tuple[NDArray[np.bool_], Array] | None = None
    for status in STAGES:
        kept, right = stage_rows(status, on, b, ladder)
        if (
            previous is None
            or not np.array_equal(kept, previous[0])
            or not np.array_equal(right[kept], previous[1][kept])
        ):
            yield status, kept, right
        previous = kept, right


def slack_weights(
    on: NDArray[np.bool_], distance: Array, p: Parameters, self_distance: Array = NONE
) -> Array:
    """Weights ρ (R,) of the soft rows: slack_weight · clip((d_a - d)/(d_a - d_r), minimum, maximum)².

    The active row has its own weight; a row that is off has slack_weight.

    Args:
        on: (R,) rows that are on.
        distance: (L,) of the capsules [m]; inf is allowed where the row is off.
        p: distances and weights.
        self_distance: (L,) of self-collision [m], or (0,) without it.
    """
    capsules, first_self = distance.size, on.size - self_distance.size
    rho = np.full(on.size, p.slack_weight)
    rho[capsules:first_self] = p.slack_active_weight
    for first, distances, d_a, d_r in (
        (0, distance, p.d_a, p.d_r),
        (first_self, self_distance, p.self_d_a, p.self_d_r),
    ):
        slots = np.flatnonzero(on[first : first + distances.size])
        ramp = (d_a - distances[slots]) / (d_a - d_r)
        rho[first + slots] *= np.minimum(np.maximum(ramp, p.slack_minimum), p.slack_maximum) ** 2
    return rho


def soft_program(program: QuadraticProgram, rho: Array) -> QuadraticProgram:
    """The QP in x = [q̇; s], s ≥ 0: rows A q̇ - s ≤ b, and the additional cost ½ Σ ρ_i s_i².

    Args:
        program: the QP with its k hard rows.
        rho: (k,) weights.
    """
    k, n = program.A.shape
    H = np.zeros((n + k, n + k))
    H[:n, :n] = program.H
    H[n:, n:] = np.diag(rho)
    return QuadraticProgram(
        H=H,
        g=np.concatenate((program.g, np.zeros(k))),
        A=np.hstack((program.A, -np.eye(k))),
        b=program.b,
        lb=np.concatenate((program.lb, np.zeros(k))),
        ub=np.concatenate((program.ub, np.full(k, OFF))),
    )


def soft(program: QuadraticProgram, on: NDArray[np.bool_], rho: Array, tolerance: float) -> Decision:
    """One QP in which every row that is on may be exceeded at a price.

    Args:
        program: the QP with all R rows, those that are off included.
        on: (R,) rows that are on.
        rho: (R,) weights.
        tolerance: greatest KKT residual.
    """
    n = program.g.size
    hard = QuadraticProgram(program.H, program.g, program.A[on], program.b[on], program.lb, program.ub)
    verdict = solve(soft_program(hard, rho[on]), tolerance)
    slack = np.zeros(on.size)
    if verdict.solution is not None:
        slack[on] = verdict.solution.x[n:]
    status = Status.SOLVED if verdict.solution is not None else Status.STOPPED_SOLVER
    chances = int(verdict.second_chance)
    return Decision(status, verdict.solution, slack, verdict.iterations, 1 + chances, chances)
