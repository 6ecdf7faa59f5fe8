"""Objective, damping and bounds of the QP as expressions: (3), (9), (11), (14), (15)."""

from typing import Any

import casadi as ca


def manipulability(jacobian: Any) -> Any:
    """W = sqrt(det(J Jᵀ)) of (14), as the product of the rows' lengths after orthogonalisation.

    det(J Jᵀ) itself would lose half of the digits near a singular configuration, where (15) needs them:
    an error of 1e-16 in the determinant is one of 1e-8 in w. Modified Gram-Schmidt keeps it at 1e-16.

    Args:
        jacobian: SX (m, n).

    Returns:
        SX scalar; 0 if m > n.
    """
    rows = [jacobian[row, :] for row in range(jacobian.shape[0])]
    if len(rows) > jacobian.shape[1]:
        return ca.SX(0)
    product = ca.SX(1)
    for index, row in enumerate(rows):
        length = ca.sqrt(ca.sumsqr(row))
        product *= length
        direction = row / ca.fmax(length, 1e-300)
        for later in range(index + 1, len(rows)):
            rows[later] = rows[later] - ca.dot(direction, rows[later]) * direction
    return product


def damping(w: Any, gain: Any, threshold: Any, floor: Any) -> Any:
    """λ of (15) with the floor λ_min.

    The quotient is guarded, not branched, because CasADi evaluates both sides of a condition.
    """
    missing = ca.fmax(0, 1 - w / ca.fmax(threshold, 1e-300))
    return ca.fmax(floor, gain * missing**2 * (w < threshold))


def objective(
    jacobian: Any, xdot: Any, regularisation: Any, posture_weight: Any, posture_velocity: Any
) -> tuple[Any, Any]:
    """H (n, n) and g (n, 1) of (9), with the posture task's share.

    H = JᵀJ + λI + W, g = −Jᵀẋ − W q̇_p; only one triangle is computed, the other one is a copy.
    """
    count = jacobian.shape[1]
    hessian = ca.SX(count, count)
    for row in range(count):
        for column in range(row, count):
            hessian[row, column] = ca.dot(jacobian[:, row], jacobian[:, column])
            hessian[column, row] = hessian[row, column]
        hessian[row, row] += regularisation + posture_weight[row]
    gradient = -ca.mtimes(jacobian.T, xdot) - posture_weight * posture_velocity
    return hessian, gradient


def bounds(
    q: Any,
    qdot_previous: Any,
    lower: Any,
    upper: Any,
    speed: Any,
    acceleration: Any,
    damper: Any,
    viability: Any,
    period: Any,
) -> tuple[Any, Any]:
    """Lb and ub (n, 1) each: (3)(11), joint damper, viability, and the acceleration bound that gives way.

    max(0, ...) is (11): a joint at or beyond its limit may only return. `viability` is 0 or 1. Its law, with
    T = max(1/k_d, Δt) and the room d, is sqrt(max(2ad + a²((T + Δt)² - 2T²), a²(T + Δt)²)) - aΔt.
    """
    not_viable = (1 - viability) * 1e30
    slope = ca.fmin(damper, 1 / period + not_viable)
    T, step, twice = 1 / slope, acceleration * period, 2 * acceleration
    square, longest = acceleration**2, (T + period) ** 2
    shift, least, less = square * (longest - 2 * T**2), square * longest, not_viable - step

    def towards(room: Any) -> Any:
        """The greatest speed towards a limit that is `room` away."""
        braking = ca.sqrt(ca.fmax(twice * room + shift, least)) + less
        return ca.fmax(0, ca.fmin(ca.fmin(speed, slope * room), braking))

    ub, lb = towards(upper - q), -towards(q - lower)
    return ca.fmin(ca.fmax(lb, qdot_previous - step), ub), ca.fmax(ca.fmin(ub, qdot_previous + step), lb)
