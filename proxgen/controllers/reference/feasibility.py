"""Whether rows and bounds can be met at all, with a proof for either answer.

    t* = min over lb ≤ x ≤ ub of the greatest component of A x - b

A point of the box bounds t* from above. A multiplier y ≥ 0, Σy = 1 bounds it from below (Farkas, LP duality):
no point of the box can bring its worst row below min over the box of yᵀ(A x - b), which is a sum over the
joints. Both bounds hold whatever the search did that found point and multiplier; only rounding is left.
"""

import numpy as np
import quadprog

from proxgen.controllers.protocol import OFF, Array

SHIFT = 1e-9
"""Rows are moved apart by one to two times this [m/s], so that dependent rows do not meet in one point."""

PROXIMAL_WEIGHTS = (0.1, *np.geomspace(0.1, 1e-6, 16).tolist(), *[1e-6] * 15)
"""Weight of the proximal term in each step; one or two steps are usual. Small weights take long steps where t
depends little on x, but lose digits to rounding."""


def row_shifts(count: int) -> Array:
    """Unequal small shifts (count,), not in arithmetic progression, as that could be a dependence again."""
    golden_section = 0.6180339887498949
    shifts: Array = SHIFT * (1.0 + np.modf(golden_section * np.arange(1, count + 1))[0])
    return shifts


def feasibility_margin(
    A: Array, b: Array, lb: Array, ub: Array, tolerance: float
) -> tuple[Array, float, float]:
    """Bounds of t*, as tight as needed to tell on which side of the tolerance it lies.

    The linear program in (x, t) is solved by the proximal-point method, which ends after finitely many steps.
    Each step is a QP whose Hessian is a multiple of the identity, the gentlest that quadprog can get.

    Args:
        A: (k, n) rows.
        b: (k,) right-hand sides.
        lb: (n,) lower bounds.
        ub: (n,) upper bounds.
        tolerance: the search ends as soon as it is known on which side of it t* lies.

    Returns:
        A point of the box, and (least, most) with least ≤ t* ≤ most; `most` is what the point attains.
    """
    k, n = A.shape
    point = np.clip(np.zeros(n), lb, ub)
    if k == 0:
        return point, -np.inf, -np.inf
    most, least = float(np.max(A @ point - b)), farkas_bound(np.ones(k), A, b, lb, ub)
    C = np.zeros((k + 2 * n, n + 1))
    C[:k, :n], C[:k, n] = A, -1.0
    C[k : k + n, :n], C[k + n :, :n] = np.eye(n), -np.eye(n)
    d = np.concatenate((b + row_shifts(k), np.minimum(ub, OFF), np.minimum(-lb, OFF)))
    identity, slope = np.eye(n + 1), np.append(np.zeros(n), 1.0)
    centre = np.append(point, most)
    for weight in PROXIMAL_WEIGHTS:
        if least > tolerance or most <= tolerance:
            break
        try:
            centre, _, _, _, y, _ = quadprog.solve_qp(weight * identity, weight * centre - slope, -C.T, -d, 0)
        except ValueError:
            break
        candidate = np.clip(centre[:n], lb, ub)
        attained = float(np.max(A @ candidate - b))
        if attained < most:
            point, most = candidate, attained
        least = max(least, farkas_bound(y[:k], A, b, lb, ub))
    return point, least, most


def farkas_bound(multipliers: Array, A: Array, b: Array, lb: Array, ub: Array) -> float:
    """Minimum over the box of yᵀ(A x - b), y = multipliers (k,) without negative ones, scaled to Σy = 1."""
    y = np.maximum(multipliers, 0.0)
    total = float(np.sum(y))
    if not total > 0.0:
        return -np.inf
    y = y / total
    slope = y @ A
    return float(np.sum(np.minimum(slope * lb, slope * ub)) - y @ b)
