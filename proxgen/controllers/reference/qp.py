"""The reference's own QP solver: quadprog's answer, sharpened, and no verdict without a proof.

    min ½ xᵀHx + gᵀx   subject to   A x ≤ b,  lb ≤ x ≤ ub                            (8)

quadprog is a dual active-set method (Goldfarb and Idnani 1983): exact in exact arithmetic, and it says when
there is no solution. Rounding can still lead it astray where rows depend on each other, which they do all the
time here: two capsules share an elbow, and the row (7) is a sum of rows (5). So:

* A solution is believed if it meets the KKT conditions. Before that, one linear solve on quadprog's active
  set removes the rounding errors that it has collected.
* "Infeasible" is believed if `feasibility.feasibility_margin` proves it. Otherwise the QP is solved again
  with its rows moved apart by up to 1e-9, which ends the dependence, and sharpened on the rows as they were.
* Variables with lb = ub are constants, and taken out first: quadprog takes their two bounds for a conflict.
"""

from dataclasses import dataclass

import numpy as np
import quadprog
from numpy.typing import NDArray

from proxgen.controllers.protocol import OFF, Array
from proxgen.controllers.reference.feasibility import feasibility_margin, row_shifts

GOOD = 1e-11
"""A first answer with a greater KKT residual is given a second chance, even if it could be certified."""

SHIFT_PARTS = (1.0, 1e-2, 1e-4)
"""Parts of the row shifts, tried until an answer is good: a row with a lever arm of 1e-6 m turns a shift of
1e-9 m/s into 1e-3 rad/s, which can change the active set."""

FIXED = 1e-12
"""Bounds that are no further apart fix their variable."""


@dataclass(frozen=True)
class QuadraticProgram:
    """The QP (8).

    Attributes:
        H: (n, n) symmetric, positive definite.
        g: (n,).
        A: (k, n).
        b: (k,).
        lb: (n,).
        ub: (n,); OFF: no bound.
    """

    H: Array
    g: Array
    A: Array
    b: Array
    lb: Array
    ub: Array


@dataclass(frozen=True)
class Solution:
    """A point, its multipliers, and how well they meet the KKT conditions.

    Attributes:
        x: (n,).
        row_multipliers: (k,) y ≥ 0.
        bound_multipliers: (n,) z, positive at ub, negative at lb: Hx + g + Aᵀy + z = 0.
        residual: `kkt_residual` of the three.
    """

    x: Array
    row_multipliers: Array
    bound_multipliers: Array
    residual: float


@dataclass(frozen=True)
class Verdict:
    """What `solve` found out.

    Attributes:
        solution: certified, or None.
        infeasible: proven; if neither this nor a solution, the solver has failed.
        iterations: working-set changes of all attempts.
        second_chance: quadprog's first answer did not stand.
    """

    solution: Solution | None
    infeasible: bool
    iterations: int
    second_chance: bool


def kkt_residual(program: QuadraticProgram, x: Array, y: Array, z: Array) -> float:
    """Greatest violation of the KKT conditions of (8); nan if anything is not finite.

    Stationarity Hx + g + Aᵀy + z, rows Ax - b, bounds, signs of y, and the complementarity products of the
    multipliers with the room that their constraints leave, each as the greatest absolute component.

    Args:
        program: the QP.
        x: (n,) point.
        y: (k,) multipliers of the rows.
        z: (n,) multipliers of the bounds, positive for ub, negative for lb.
    """
    room, above, below = program.b - program.A @ x, program.ub - x, x - program.lb
    violations = (
        np.abs(program.H @ x + program.g + program.A.T @ y + z),
        -room,
        -above,
        -below,
        -y,
        np.abs(y * room),
        np.abs(np.maximum(z, 0.0) * above),
        np.abs(np.minimum(z, 0.0) * below),
    )
    return float(np.concatenate(violations).max(initial=0.0))  # keeps nan, unlike Python's max


def solve(program: QuadraticProgram, tolerance: float) -> Verdict:
    """Solve the QP, or prove that it has no solution.

    Args:
        program: the QP.
        tolerance: greatest KKT residual of a solution, and the amount by which rows may exclude each other in
            a QP that still counts as feasible.
    """
    free = program.ub - program.lb > FIXED
    if free.all():
        return _solve_free(program, tolerance)
    verdict = _solve_free(_without_fixed(program, free), tolerance)
    if verdict.solution is None:
        return verdict
    x, y = program.lb.copy(), verdict.solution.row_multipliers
    x[free] = verdict.solution.x
    z = -(program.H @ x + program.g + program.A.T @ y)
    z[free] = verdict.solution.bound_multipliers
    solution = Solution(x, y, z, kkt_residual(program, x, y, z))
    return Verdict(solution, False, verdict.iterations, verdict.second_chance)


def _without_fixed(program: QuadraticProgram, free: NDArray[np.bool_]) -> QuadraticProgram:
    """The QP in the free variables alone, the others at their value."""
    value = program.lb[~free]
    return QuadraticProgram(
        H=program.H[np.ix_(free, free)],
        g=program.g[free] + program.H[np.ix_(free, ~free)] @ value,
        A=program.A[:, free],
        b=program.b - program.A[:, ~free] @ value,
        lb=program.lb[free],
        ub=program.ub[free],
    )


def _solve_free(program: QuadraticProgram, tolerance: float) -> Verdict:
    """`solve` for a QP in which every variable can move."""
    first, spent = _attempt(program, program)
    if first is not None and first.residual <= GOOD:
        return Verdict(first, False, spent, second_chance=False)
    point, least, most = feasibility_margin(program.A, program.b, program.lb, program.ub, tolerance)
    if least > tolerance:
        return Verdict(None, True, spent, second_chance=False)
    reachable = program.b if most > tolerance else np.maximum(program.b, program.A @ point)
    answers = [] if first is None else [first]
    for part in SHIFT_PARTS:
        apart = reachable + part * row_shifts(reachable.size)
        relaxed = QuadraticProgram(program.H, program.g, program.A, apart, program.lb, program.ub)
        answer, more = _attempt(relaxed, program)
        spent += more
        if answer is not None:
            answers.append(answer)
            if answer.residual <= GOOD:
                break
    answers = [answer for answer in answers if answer.residual <= tolerance]
    best = min(answers, key=lambda answer: answer.residual, default=None)
    if best is None:  # rows that exclude each other, if only by less than the tolerance?
        least = feasibility_margin(program.A, program.b, program.lb, program.ub, 0.0)[1]
    return Verdict(best, best is None and least > 0.0, spent, second_chance=True)


def _attempt(posed: QuadraticProgram, judged: QuadraticProgram) -> tuple[Solution | None, int]:
    """Solve `posed` by quadprog and sharpen on `judged`, which differs in b only; and the iterations."""
    if posed.g.size == 0:
        nothing, y = np.zeros(0), np.zeros(judged.b.size)
        return Solution(nothing, y, nothing, kkt_residual(judged, nothing, y, nothing)), 0
    identity = np.eye(posed.g.size)
    C = np.concatenate((posed.A, identity, -identity))
    try:
        x, _, _, iterations, multipliers, active = quadprog.solve_qp(
            posed.H, -posed.g, -C.T, -_right_hand_sides(posed), 0
        )
    except ValueError:
        return None, 0
    best = _sharpened(judged, C, active - 1)
    if best is None or not best.residual <= GOOD:
        raw = _solution(judged, x, multipliers)
        best = raw if best is None or not best.residual <= raw.residual else best
    return best, int(iterations[0])


def _right_hand_sides(program: QuadraticProgram) -> Array:
    """D of all constraints C x ≤ d: rows, upper bounds, lower bounds; a bound that is off lies far away."""
    return np.concatenate((program.b, np.minimum(program.ub, OFF), np.minimum(-program.lb, OFF)))


def _solution(program: QuadraticProgram, x: Array, multipliers: Array) -> Solution:
    """The multipliers of rows, upper and lower bounds taken apart again, and the residual."""
    rows, n = program.b.size, program.g.size
    y = multipliers[:rows]
    z = multipliers[rows : rows + n] - multipliers[rows + n :]
    return Solution(x, y, z, kkt_residual(program, x, y, z))


def _sharpened(program: QuadraticProgram, C: Array, active: NDArray[np.intp]) -> Solution | None:
    """Solve [[H, Cᵀ], [C, 0]] [x; y] = [-g; d] on the active set, with one step of iterative refinement."""
    n, k = program.g.size, active.size
    d = _right_hand_sides(program)
    matrix = np.zeros((n + k, n + k))
    matrix[:n, :n] = program.H
    matrix[:n, n:] = C[active].T
    matrix[n:, :n] = C[active]
    right = np.concatenate((-program.g, d[active]))
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return None
    unknowns = inverse @ right
    unknowns += inverse @ (right - matrix @ unknowns)
    multipliers = np.zeros(d.size)
    multipliers[active] = unknowns[n:]
    return _solution(program, unknowns[:n], multipliers)
