"""The QP (8) without rounding: for disputes that floating-point numbers cannot settle.

The dual active-set method of Goldfarb and Idnani (1983) in rational arithmetic. It ends after finitely many
steps, either at the optimum or at rows that contradict each other, and what it says is true of the numbers as
they are. It takes milliseconds to a second: judges use it, controllers do not.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from proxgen.controllers.protocol import Array
from proxgen.controllers.reference.qp import QuadraticProgram


@dataclass(frozen=True)
class ExactSolution:
    """The optimum.

    Attributes:
        x: (n,).
        multipliers: of the constraints that hold, by index: rows, then upper bounds, then lower bounds.
    """

    x: list[Fraction]
    multipliers: dict[int, Fraction]


def solve_exactly(program: QuadraticProgram, shift: float = 0.0) -> ExactSolution | None:
    """The optimum of a QP, or None if no point meets its rows and bounds.

    Args:
        program: the QP.
        shift: added to the right-hand side of every row [m/s].
    """
    n = program.g.size
    H, C = _fractions(program.H), _fractions(np.concatenate((program.A, np.eye(n), -np.eye(n))))
    b = [Fraction(value) + Fraction(shift) for value in program.b.tolist()]
    d = b + [Fraction(value) for value in np.concatenate((program.ub, -program.lb)).tolist()]
    start = _equations(H, [-Fraction(value) for value in program.g.tolist()])
    if start is None:
        raise ValueError("H is not positive definite")
    x, held, y = start, list[int](), list[Fraction]()
    while True:
        excess, worst = max((_dot(C[i], x) - d[i], -i) for i in range(len(C)))
        if excess <= 0:
            return ExactSolution(x, dict(zip(held, y, strict=True)))
        moved = _hold(H, C, d, (x, held, y), -worst)
        if moved is None:
            return None
        x, held, y = moved


def meets_exactly(A: Array, b: Array, lb: Array, ub: Array, shift: float = 0.0) -> bool:
    """Whether some lb ≤ x ≤ ub has A x ≤ b + shift, in rational arithmetic.

    Args:
        A: (k, n) rows.
        b: (k,) right-hand sides.
        lb: (n,) lower bounds.
        ub: (n,) upper bounds.
        shift: see `solve_exactly`.
    """
    n = lb.size
    return solve_exactly(QuadraticProgram(np.eye(n), np.zeros(n), A, b, lb, ub), shift) is not None


_Point = tuple[list[Fraction], list[int], list[Fraction]]
"""x, the constraints that hold, and their multipliers."""


def _hold(
    H: list[list[Fraction]], C: list[list[Fraction]], d: list[Fraction], point: _Point, new: int
) -> _Point | None:
    """Move to where constraint `new` holds as well; None if those that hold do not allow it."""
    x, held, y = list(point[0]), list(point[1]), list(point[2])
    n, gained = len(x), Fraction(0)
    while True:
        zeros = [Fraction(0)] * len(held)
        matrix = [[*H[i], *(C[c][i] for c in held)] for i in range(n)] + [[*C[c], *zeros] for c in held]
        step = _equations(matrix, [-value for value in C[new]] + zeros)
        if step is None:
            raise ValueError("H is not positive definite")
        dx, dy = step[:n], step[n:]
        slope, excess = _dot(C[new], dx), _dot(C[new], x) - d[new]
        full = None if slope == 0 else -excess / slope
        ratios = [(-y[k] / dy[k], k) for k in range(len(held)) if dy[k] < 0]
        if full is None and not ratios:
            return None
        first, leaving = min(ratios, default=(Fraction(0), -1))
        length = full if full is not None and (not ratios or full <= first) else first
        x = [a + length * b for a, b in zip(x, dx, strict=True)]
        y = [a + length * b for a, b in zip(y, dy, strict=True)]
        gained += length
        if length == full:
            return x, [*held, new], [*y, gained]
        del held[leaving], y[leaving]


def _fractions(array: Array) -> list[list[Fraction]]:
    """The entries of a matrix as they are."""
    return [[Fraction(value) for value in row] for row in array.tolist()]


def _dot(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    """Σ a_i b_i."""
    return sum((p * q for p, q in zip(a, b, strict=True)), Fraction(0))


def _equations(matrix: list[list[Fraction]], right: list[Fraction]) -> list[Fraction] | None:
    """The solution of linear equations; None if there is not exactly one."""
    size = len(right)
    lines = [[*line, value] for line, value in zip(matrix, right, strict=True)]
    for c in range(size):
        pivot = next((i for i in range(c, size) if lines[i][c]), None)
        if pivot is None:
            return None
        lines[c], lines[pivot] = lines[pivot], lines[c]
        lines[c] = [value / lines[c][c] for value in lines[c]]
        for i in range(size):
            factor = lines[i][c]
            if i != c and factor:
                lines[i] = [u - factor * v for u, v in zip(lines[i], lines[c], strict=True)]
    return [line[size] for line in lines]
