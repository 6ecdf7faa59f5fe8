"""Objective and bounds of the QP: (3), (9), (11), (14), (15)."""

import numpy as np

from proxgen.controllers.protocol import Array
from proxgen.controllers.reference.parameters import Parameters


def manipulability(jacobian: Array) -> float:
    """Manipulability w = √det(J Jᵀ) of (14), as the product of J's singular values; 0 if m > n.

    The determinant itself has lost half of its digits where (15) needs them: near a singular configuration.
    J is (m, n).
    """
    rows, columns = jacobian.shape
    if rows > columns:
        return 0.0
    return float(np.prod(np.linalg.svd(jacobian, compute_uv=False)))


def damping(w: float, p: Parameters) -> float:
    """λ of (15), and never less than λ_min: g_λ (1 - w/w_0)² where w < w_0."""
    near_singular = p.damping_gain * (1.0 - w / p.damping_threshold) ** 2 if w < p.damping_threshold else 0.0
    return max(p.damping_floor, near_singular)


def objective(jacobian: Array, xdot: Array, q: Array, damping: float, p: Parameters) -> tuple[Array, Array]:
    """H = JᵀJ + λI + W (n, n) and g = -Jᵀẋ - W k (q_p - q) (n,) of (9).

    Args:
        jacobian: J (m, n).
        xdot: (m,) task velocity.
        q: (n,) joint positions.
        damping: λ.
        p: weights W, gain k and positions q_p of the posture task.
    """
    H = jacobian.T @ jacobian + np.diag(damping + p.posture_weight)
    g = -jacobian.T @ xdot - p.posture_weight * p.posture_gain * (p.posture - q)
    return H, g


def bounds(q: Array, qdot_previous: Array, p: Parameters) -> tuple[Array, Array]:
    """Bounds lb, ub (n,) of q̇ (3)(11), within what the acceleration allows.

    Args:
        q: (n,) joint positions.
        qdot_previous: (n,) the previous command.
        p: limits.
    """
    ub = _ceiling(p.q_upper - q, p)
    lb = -_ceiling(q - p.q_lower, p)
    return acceleration_bounds(lb, ub, qdot_previous, p)


def _ceiling(room: Array, p: Parameters) -> Array:
    """Greatest speed (n,) towards a position limit that is `room` (n,) away: 0 at and beyond it (11)."""
    ceiling = np.minimum(p.qdot_limit, p.joint_damper * room)
    if p.viability:
        ceiling = np.minimum(ceiling, _viable_speed(room, p))
    return np.where(room <= 0.0, 0.0, ceiling)


def _viable_speed(room: Array, p: Parameters) -> Array:
    """Greatest speed (n,) from which braking by at most aΔt per cycle ends at the limit.

    Up to the speed aT, the line d/T asks for no more than a. From a speed v above it, d - aT² must be room
    for braking down to aT, (v² - (aT)²)/(2a), and for one more cycle, (v - aT)Δt; this is solved for v.
    """
    a, dt = p.qddot_limit, p.period
    T = max(1.0 / p.joint_damper, dt)
    beyond = np.maximum(room - a * T**2, 0.0)
    return np.minimum(room / T, np.sqrt((a * (dt + T)) ** 2 + 2.0 * a * beyond) - a * dt)


def acceleration_bounds(lb: Array, ub: Array, qdot_previous: Array, p: Parameters) -> tuple[Array, Array]:
    """The bounds (n,) that q̇₋ ± aΔt leaves; the limits win where they conflict, so that lb' ≤ ub'.

    lb' = min(max(lb, q̇₋ - aΔt), ub),  ub' = max(min(ub, q̇₋ + aΔt), lb)
    """
    step = p.qddot_limit * p.period
    return (
        np.minimum(np.maximum(lb, qdot_previous - step), ub),
        np.maximum(np.minimum(ub, qdot_previous + step), lb),
    )


def blind_bounds(qdot_previous: Array, p: Parameters) -> tuple[Array, Array]:
    """Bounds (n,) of velocity and acceleration alone, for a q that cannot be used."""
    return acceleration_bounds(-p.qdot_limit, p.qdot_limit, qdot_previous, p)
