"""The QP without rounding: the optimum, and whether there is one."""

from fractions import Fraction

import numpy as np
import pytest

from proxgen.controllers.reference.exact import meets_exactly, solve_exactly
from proxgen.controllers.reference.feasibility import feasibility_margin
from proxgen.controllers.reference.qp import QuadraticProgram, solve

TOLERANCE = 1e-8


def test_the_optimum_is_that_of_the_solver() -> None:
    """Random QPs with 3 joints and 5 rows, feasible and not, whose pull makes constraints come and go."""
    rng = np.random.default_rng(12)
    found = set()
    for _ in range(40):
        root, A, b = rng.normal(size=(3, 3)), rng.normal(size=(5, 3)), rng.normal(size=5) + 0.3
        H, g = root.T @ root + 0.01 * np.eye(3), 5.0 * rng.normal(size=3)
        program = QuadraticProgram(H, g, A, b, -rng.uniform(0.1, 1.0, 3), rng.uniform(0.1, 1.0, 3))
        exact, other = solve_exactly(program), solve(program, TOLERANCE).solution
        assert (exact is None) == (other is None)
        found.add(exact is None)
        if exact is None or other is None:
            continue
        np.testing.assert_allclose([float(value) for value in exact.x], other.x, atol=1e-9)
        y = np.zeros(11)
        y[list(exact.multipliers)] = [float(value) for value in exact.multipliers.values()]
        np.testing.assert_allclose(y[:5], other.row_multipliers, atol=1e-8)
    assert found == {True, False}


def test_the_optimum_is_exact() -> None:
    """min ½ x² - x with 3 x ≤ 1: x is a third, which no floating-point number is."""
    program = QuadraticProgram(
        np.eye(1), -np.ones(1), np.full((1, 1), 3.0), np.ones(1), -np.ones(1), np.ones(1)
    )
    found = solve_exactly(program)
    assert found is not None
    assert found.x == [Fraction(1, 3)]
    assert found.multipliers == {0: Fraction(2, 9)}


def test_rows_are_met_where_a_search_meets_them() -> None:
    rng = np.random.default_rng(8)
    for _ in range(20):
        A, b = rng.normal(size=(4, 3)), rng.normal(size=4) - 0.5
        lb, ub = -rng.uniform(0.0, 0.5, 3), rng.uniform(0.0, 0.5, 3)
        _, least, most = feasibility_margin(A, b, lb, ub, 0.0)
        assert meets_exactly(A, b, lb, ub, most + 1e-12)
        assert not meets_exactly(A, b, lb, ub, least - 1e-6)


@pytest.mark.parametrize(("excess", "met"), [(-1e-30, True), (0.0, True), (1e-30, False)])
def test_a_single_point_is_met(excess: float, met: bool) -> None:
    """Two opposite rows that leave a line, a plane or nothing."""
    A, box = np.array([[0.1, 0.3], [-0.1, -0.3]]), np.ones(2)
    assert meets_exactly(A, np.full(2, -excess), -box, box) is met
    assert meets_exactly(A, np.full(2, -excess), -box, box, 1e-9)


def test_h_has_to_be_invertible() -> None:
    nothing = np.zeros((0, 1)), np.zeros(0)
    with pytest.raises(ValueError, match="positive definite"):
        solve_exactly(QuadraticProgram(np.zeros((1, 1)), np.ones(1), *nothing, -np.ones(1), np.ones(1)))
