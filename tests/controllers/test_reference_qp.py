"""The reference's QP solver: thousands of QPs, a second opinion by brute force, the edge of feasibility."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from proxgen.controllers.protocol import Array
from proxgen.controllers.reference.feasibility import farkas_bound, feasibility_margin, row_shifts
from proxgen.controllers.reference.qp import QuadraticProgram, Verdict, kkt_residual, solve

TOLERANCE = 1e-8


def control_qp(rng: np.random.Generator, n: int, dependence: float) -> QuadraticProgram:
    """A QP as the controller makes them: rank-3 H with a small λ, rows that depend on each other.

    The second row is that of a shared elbow in half of the cases, the third a weighted sum (7); both up to
    rounding noise of size `dependence`.
    """
    J = 0.5 * rng.normal(size=(min(3, n), n))
    H = J.T @ J + 10.0 ** rng.uniform(-6.0, -1.0) * np.eye(n)
    first, weight = 0.4 * rng.normal(size=n), rng.random()
    second = first.copy() if rng.random() < 0.5 else 0.3 * rng.normal(size=n)
    second += dependence * rng.normal(size=n)
    A = np.array([first, second, weight * first + (1.0 - weight) * second])
    speed = rng.choice([0.0, 0.1, -0.1, -0.2])
    b = np.array([speed, speed if rng.random() < 0.7 else rng.choice([-0.2, 0.2]), 0.0])
    previous = 0.5 * rng.normal(size=n)
    lb, ub = np.maximum(-1.7, previous - 0.4), np.minimum(1.7, previous + 0.4)
    lb = np.minimum(lb, ub)
    if rng.random() < 0.2:
        joint = int(rng.integers(n))
        lb[joint] = ub[joint]
    return QuadraticProgram(H, -J.T @ (0.2 * rng.normal(size=len(J))), A, b, lb, ub)


def check(program: QuadraticProgram, verdict: Verdict) -> None:
    """A solution meets the KKT conditions, which suffice for a strictly convex QP; no answer is an error."""
    if verdict.infeasible:
        assert verdict.solution is None
        return
    found = verdict.solution
    assert found is not None, "neither solved nor proven infeasible"
    y, z = found.row_multipliers, found.bound_multipliers
    assert np.abs(program.H @ found.x + program.g + program.A.T @ y + z).max() < 1e-10
    assert (program.A @ found.x - program.b).max(initial=0.0) < 1e-10
    assert min((found.x - program.lb).min(), (program.ub - found.x).min()) > -1e-10
    assert y.min(initial=0.0) > -1e-10
    assert (y * (program.b - program.A @ found.x)).max(initial=0.0) < 1e-10
    assert np.where(z > 0.0, z * (program.ub - found.x), -z * (found.x - program.lb)).max() < 1e-10


@pytest.mark.parametrize("dependence", [0.0, 1e-17, 1e-16, 1e-15, 1e-13, 1e-2])
@pytest.mark.parametrize("n", [2, 7, 12])
def test_kkt_conditions_of_thousands_of_qps(n: int, dependence: float) -> None:
    """Dependent rows mislead quadprog in about one of a hundred QPs; none may come through."""
    rng, solved = np.random.default_rng(11), 0
    for _ in range(300):
        program = control_qp(rng, n, dependence)
        verdict = solve(program, TOLERANCE)
        check(program, verdict)
        solved += verdict.solution is not None
    assert 100 < solved < 300


def brute_force(program: QuadraticProgram) -> Array | None:
    """The solution by trying every set of active constraints; None if none of them gives one."""
    n, k = program.g.size, program.b.size
    C = np.concatenate((program.A, np.eye(n), -np.eye(n)))
    d = np.concatenate((program.b, program.ub, -program.lb))
    for rows in product((False, True), repeat=k):
        for sides in product((0, 1, 2), repeat=n):
            bounds = [k + j + (side - 1) * n for j, side in enumerate(sides) if side]
            active = [i for i in range(k) if rows[i]] + bounds
            if len(active) > n:
                continue
            matrix = np.block([[program.H, C[active].T], [C[active], np.zeros((len(active), len(active)))]])
            if np.linalg.cond(matrix) > 1e12:
                continue
            unknowns = np.linalg.solve(matrix, np.concatenate((-program.g, d[active])))
            x, multipliers = unknowns[:n], unknowns[n:]
            if (C @ x - d).max() < 1e-9 and multipliers.min(initial=0.0) > -1e-9:
                return np.asarray(x)
    return None


def test_brute_force_over_active_sets_agrees() -> None:
    rng, infeasible = np.random.default_rng(12), 0
    for _ in range(250):
        program = control_qp(rng, 3, 1e-2)
        found, expected = solve(program, TOLERANCE), brute_force(program)
        infeasible += found.infeasible
        assert found.infeasible == (expected is None)
        if found.solution is not None and expected is not None:
            np.testing.assert_allclose(found.solution.x, expected, rtol=0, atol=1e-9)
    assert infeasible > 20


def exact_solution(matrix: list[list[Fraction]], right: list[Fraction]) -> list[Fraction]:
    """Gaussian elimination in rational numbers."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for column in range(len(rows)):
        pivot = next(i for i in range(column, len(rows)) if rows[i][column] != 0)
        rows[column], rows[pivot] = rows[pivot], rows[column]
        rows[column] = [value / rows[column][column] for value in rows[column]]
        for i, row in enumerate(rows):
            if i != column and row[column] != 0:
                rows[i] = [a - row[column] * b for a, b in zip(row, rows[column], strict=True)]
    return [row[-1] for row in rows]


def test_solutions_are_exact_to_1e_10() -> None:
    """Against rational arithmetic on the same active set, with λ down to 1e-6."""
    rng, compared = np.random.default_rng(16), 0
    while compared < 25:
        program = control_qp(rng, 7, 1e-2)
        found = solve(program, TOLERANCE).solution
        if found is None:
            continue
        y, z = found.row_multipliers, found.bound_multipliers
        C = np.concatenate((program.A[y > 1e-9], np.eye(7)[np.abs(z) > 1e-9]))
        bounds = np.where(z > 0.0, program.ub, program.lb)[np.abs(z) > 1e-9]
        d = np.concatenate((program.b[y > 1e-9], bounds))
        matrix = np.block([[program.H, C.T], [C, np.zeros((len(d), len(d)))]])
        if np.linalg.matrix_rank(C) < len(d):
            continue
        exact = exact_solution(
            [[Fraction(float(value)) for value in row] for row in matrix],
            [Fraction(float(value)) for value in np.concatenate((-program.g, d))],
        )
        expected = np.array([float(value) for value in exact[:7]])
        np.testing.assert_allclose(found.x, expected, rtol=0, atol=1e-10)
        compared += 1


def with_margin(rng: np.random.Generator, n: int, margin: float) -> QuadraticProgram:
    """Rows and a box whose t* is `margin`, by LP duality: x* worsens its worst row whichever way it goes."""
    k = int(rng.integers(1, 5))
    lb, width = -rng.uniform(0.1, 1.5, n), rng.uniform(0.2, 2.0, n)
    A, y = 0.4 * rng.normal(size=(k, n)), rng.dirichlet(np.ones(k))
    if k > 1 and rng.random() < 0.5:
        inner = rng.random(n) < 0.5
        A[-1, inner] = -(y[:-1] @ A[:-1, inner]) / y[-1]
    slope = y @ A
    x = np.where(
        np.abs(slope) < 1e-12, lb + rng.uniform(0.1, 0.9, n) * width, np.where(slope > 0, lb, lb + width)
    )
    J = 0.5 * rng.normal(size=(3, n))
    H = J.T @ J + 1e-3 * np.eye(n)
    return QuadraticProgram(H, rng.normal(size=n), A, A @ x - margin, lb, lb + width)


@pytest.mark.parametrize("margin", [0.3, 1e-3, 1e-5, 1e-6, 1e-7, 2e-8])
def test_infeasible_is_said_of_every_qp_beyond_the_tolerance(margin: float) -> None:
    rng = np.random.default_rng(13)
    for _ in range(150):
        program = with_margin(rng, 7, margin)
        assert solve(program, TOLERANCE).infeasible


@pytest.mark.parametrize("margin", [-0.3, -1e-3, -1e-5, -1e-6, -1e-7, -1e-9, -1e-12, 0.0])
def test_solved_is_said_of_every_qp_that_is_feasible(margin: float) -> None:
    """Down to a single feasible point."""
    rng = np.random.default_rng(14)
    for _ in range(150):
        program = with_margin(rng, 7, margin)
        verdict = solve(program, TOLERANCE)
        assert verdict.solution is not None
        assert (program.A @ verdict.solution.x - program.b).max() < TOLERANCE


def test_margin_is_between_its_bounds() -> None:
    rng = np.random.default_rng(15)
    for _ in range(300):
        margin = float(rng.choice([-1.0, 1.0])) * 10.0 ** rng.uniform(-6.0, 0.0)
        program = with_margin(rng, 5, margin)
        point, least, most = feasibility_margin(program.A, program.b, program.lb, program.ub, TOLERANCE)
        assert least - 1e-14 <= margin <= most + 1e-14
        assert (least > TOLERANCE) == (margin > TOLERANCE)
        assert (most <= TOLERANCE) == (margin <= TOLERANCE)
        assert most == pytest.approx((program.A @ point - program.b).max(), abs=1e-15)
        assert (point >= program.lb).all() and (point <= program.ub).all()


@settings(derandomize=True, max_examples=200, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_farkas_bound_holds_for_any_multiplier(seed: int) -> None:
    """Whatever y is, no point of the box has a smaller worst row."""
    rng = np.random.default_rng(seed)
    k, n = int(rng.integers(1, 5)), int(rng.integers(1, 6))
    A, b, lb = rng.normal(size=(k, n)), rng.normal(size=k), -rng.random(n)
    ub = lb + rng.random(n)
    bound = farkas_bound(rng.normal(size=k), A, b, lb, ub)
    points = rng.uniform(lb, ub, (200, n))
    assert (points @ A.T - b).max(axis=1).min() >= bound - 1e-12


def test_a_qp_whose_variables_are_all_fixed() -> None:
    fixed = np.array([0.1, -0.2])
    A = np.array([[1.0, 1.0]])
    program = QuadraticProgram(np.eye(2), np.ones(2), A, np.array([0.0]), fixed, fixed)
    verdict = solve(program, TOLERANCE)
    assert verdict.solution is not None
    np.testing.assert_array_equal(verdict.solution.x, fixed)
    assert verdict.solution.residual < 1e-15
    impossible = QuadraticProgram(np.eye(2), np.ones(2), A, np.array([-0.2]), fixed, fixed)
    assert solve(impossible, TOLERANCE).infeasible
    no_rows = QuadraticProgram(np.eye(2), np.ones(2), np.empty((0, 2)), np.empty(0), fixed, fixed)
    without = solve(no_rows, TOLERANCE)
    assert without.solution is not None
    np.testing.assert_array_equal(without.solution.x, fixed)


def test_a_qp_without_rows() -> None:
    program = QuadraticProgram(
        np.eye(3), np.array([1.0, -3.0, 0.2]), np.empty((0, 3)), np.empty(0), -np.ones(3), np.ones(3)
    )
    verdict = solve(program, TOLERANCE)
    assert verdict.solution is not None
    np.testing.assert_allclose(verdict.solution.x, [-1.0, 1.0, -0.2], rtol=0, atol=1e-15)
    np.testing.assert_allclose(verdict.solution.bound_multipliers, [0.0, 2.0, 0.0], rtol=0, atol=1e-15)


def test_kkt_residual_sees_every_condition() -> None:
    """min ½x² - x s.t. x ≤ 0.5 in [0, 1]: x = 0.5, y = 0.5; then each condition is broken alone."""
    one, zero = np.ones(1), np.zeros(1)
    program = QuadraticProgram(np.eye(1), -one, np.eye(1), 0.5 * one, zero, one)
    assert kkt_residual(program, 0.5 * one, 0.5 * one, zero) == 0.0
    assert kkt_residual(program, 0.5 * one, zero, zero) == 0.5
    assert kkt_residual(program, 0.75 * one, 0.25 * one, zero) == 0.25
    assert kkt_residual(program, 0.25 * one, 0.75 * one, zero) == 0.75 * 0.25
    assert kkt_residual(program, 0.5 * one, 0.25 * one, 0.25 * one) == 0.25 * 0.5
    assert kkt_residual(program, 0.5 * one, 0.75 * one, -0.25 * one) == 0.25 * 0.5
    assert kkt_residual(program, -0.25 * one, zero, 1.25 * one) == 1.25 * 1.25
    negative = QuadraticProgram(np.eye(1), -one, -np.eye(1), -one, zero, 2.0 * one)
    assert kkt_residual(negative, one, -0.125 * one, -0.125 * one) == 0.125
    assert np.isnan(kkt_residual(program, np.array([np.nan]), zero, zero))


@pytest.mark.parametrize(
    ("x", "y", "z", "b", "slope", "residual"),
    [
        (0.5, 0.0, 0.0, 2.0, 0.0, 0.0),
        (0.5, 0.0, 0.0, 2.0, 0.25, 0.25),  # stationarity
        (0.75, 0.0, 0.0, 0.5, 0.0, 0.25),  # the row
        (1.25, 0.0, 0.0, 2.0, 0.0, 0.25),  # the upper bound
        (-0.25, 0.0, 0.0, 2.0, 0.0, 0.25),  # the lower bound
        (0.5, -0.25, 0.0, 0.5, 0.0, 0.25),  # sign of the row's multiplier
        (0.25, 0.5, 0.0, 0.5, 0.0, 0.125),  # room behind a row with a multiplier
        (0.75, 0.0, 0.5, 2.0, 0.0, 0.125),  # room below ub with a multiplier
        (0.25, 0.0, -0.5, 2.0, 0.0, 0.125),  # room above lb with a multiplier
    ],
)
def test_each_condition_alone_makes_a_residual(
    x: float, y: float, z: float, b: float, slope: float, residual: float
) -> None:
    """min ½x² + gx s.t. x ≤ b in [0, 1], with g such that only one condition is broken."""
    one = np.ones(1)
    program = QuadraticProgram(np.eye(1), (slope - x - y - z) * one, np.eye(1), b * one, 0.0 * one, one)
    assert kkt_residual(program, x * one, y * one, z * one) == residual


def test_row_shifts_are_not_dependent() -> None:
    shifts = row_shifts(40)
    assert (shifts >= 1e-9).all() and (shifts <= 2e-9).all()
    differences = np.abs(shifts[:, None] - shifts) + np.eye(40)
    assert differences.min() > 1e-12


def pinned_by_two_rows(upper: float) -> QuadraticProgram:
    """x_0 ≤ 0 and x_0 ≥ 1.5e-3 x_1 with x_1 ≥ `upper`: met by at most one point, and pushed hard."""
    A = np.array([[3.5e-5, 0.0], [-0.13577, 2.03e-4]])
    lb, ub = np.array([-0.4, upper]), np.array([0.4, 0.8])
    return QuadraticProgram(np.eye(2), np.array([-100.0, 0.0]), A, np.zeros(2), lb, ub)


def test_a_tie_that_cannot_be_certified_is_infeasible() -> None:
    """Rows that exclude each other by 3e-10 m/s, less than the tolerance, with multipliers of 3e6."""
    tie = pinned_by_two_rows(0.006)
    _, least, most = feasibility_margin(tie.A, tie.b, tie.lb, tie.ub, 0.0)
    assert 0.0 < least <= most < TOLERANCE
    assert solve(tie, TOLERANCE).infeasible
    point = solve(pinned_by_two_rows(0.0), TOLERANCE).solution
    assert point is not None
    np.testing.assert_allclose(point.x, 0.0, atol=1e-12)
