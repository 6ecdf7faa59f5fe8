"""The functions to be generated, in the order of the cycle: names, shapes, units and equations."""

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca

from proxgen.config.schema import Config
from proxgen.model import RobotModel
from proxgen.program import Argument, Kernel, Parameter
from proxgen.symbolic import avoidance, quadratic
from proxgen.symbolic.kinematics import kinematics, point_jacobian
from proxgen.symbolic.wrapping import joint_arguments, kernel, read_from, symbol


def kinematics_kernel(model: RobotModel, bodies: Sequence[int]) -> Kernel:
    """Poses, joint axes and origins, task Jacobian: everything that depends on q alone."""
    q = Argument("q", (model.n,), "rad", "joint positions")
    position = symbol(q)
    result = kinematics(model, position)
    poses = [ca.reshape(result.poses[body].row_major().T, 1, 12) for body in bodies]
    outputs = [
        Argument("tool_to_world", (3, 4), "1, m", "[R | t] of the task point"),
        Argument("body_to_world", (len(bodies), 12), "1, m", "[R | t], row-major 3x4, one body per row"),
        *joint_arguments(model),
        Argument("J", (model.m, model.n), "m/rad, 1", "task Jacobian, rows " + " ".join(model.task_rows)),
    ]
    results = [
        result.tool.row_major(),
        ca.vertcat(*poses),
        ca.horzcat(*result.axes).T,
        ca.horzcat(*result.origins).T,
        result.jacobian,
    ]
    return kernel(
        "kinematics",
        "Computes all poses, joint axes and the task Jacobian at q.",
        "xdot = J qdot (1)",
        [q],
        outputs,
        [position],
        results,
    )


def sensor_point_kernel() -> Kernel:
    """Obstacle point of a reading."""
    inputs = [
        Argument("body_to_world", (3, 4), "1, m", "[R | t] of the body that carries the sensor"),
        Argument("position", (3,), "m", "the sensor's place, body frame"),
        Argument("normal", (3,), "", "its direction, body frame, unit"),
        Argument("range", (), "m", "its reading, or a switch's virtual distance"),
    ]
    symbols = [symbol(argument) for argument in inputs]
    return kernel(
        "sensor_point",
        "Computes the obstacle point that a reading stands for.",
        "h = o + r n",
        inputs,
        [Argument("point", (3,), "m", "h, world")],
        symbols,
        [avoidance.sensor_point(*symbols)],
    )


def closest_point_kernel() -> Kernel:
    """Closest point on a capsule's axis."""
    inputs = [
        Argument("point", (3,), "m", "obstacle point, world"),
        Argument("start", (3,), "m", "one end of the capsule's axis, world"),
        Argument("end", (3,), "m", "its other end, world"),
    ]
    symbols = [symbol(argument) for argument in inputs]
    return kernel(
        "closest_point",
        "Computes the point of a capsule's axis that is nearest to a point.",
        "p = a + t (b - a), t = clamp((h - a).(b - a)/|b - a|^2, 0, 1)",
        inputs,
        [Argument("closest", (3,), "m", "p, world")],
        symbols,
        [avoidance.closest_point(*symbols)],
    )


def row_kernel(model: RobotModel, index: int, body: int) -> Kernel:
    """Row of (5) for a point of one body."""
    inputs = [
        *joint_arguments(model),
        Argument("point", (3,), "m", "closest point on the link, world"),
        Argument("direction", (3,), "", "unit vector from the link to the obstacle, world"),
    ]
    symbols = [symbol(argument) for argument in inputs]
    axes = tuple(symbols[0][i, :].T for i in range(len(model.drives)))
    origins = tuple(symbols[1][i, :].T for i in range(len(model.drives)))
    row = ca.mtimes(symbols[3].T, point_jacobian(model, axes, origins, body, symbols[2])).T
    return kernel(
        f"row_{index}",
        "Computes the row of a point on a body: its speed towards the obstacle is row . qdot.",
        "A_i = d_hat' J_p (4)(5)",
        inputs,
        [Argument("row", (model.n,), "m/rad", "one row of A")],
        symbols,
        [row],
    )


def approach_kernel(config: Config, parameters: dict[str, Parameter]) -> Kernel:
    """Approach law of the configured schedule."""
    distance = Argument("distance", (), "m", "distance to the nearest obstacle")
    speed = Argument("speed", (), "m/s", "greatest approach speed")
    if config.avoidance.schedule == "paper":
        names: tuple[str, ...] = ("d_a", "d_0u", "d_0l", "d_r", "approach_speed", "repulse_speed")
        law: Callable[..., Any] = avoidance.approach_speed
        equation = (
            "approach_speed at d_a, linear to 0 at d_0u, 0 to d_0l, linear to repulse_speed at d_r (13)"
        )
    else:
        names = ("damper_influence", "damper_safety", "approach_speed", "damper_gain", "damper_repulse_speed")
        law = avoidance.damper_speed
        equation = "approach_speed (d - d_s)/(d_i - d_s) above d_s, max(v_r, gain (d - d_s)) below"
    inputs = [distance, *read_from(parameters, *names)]
    symbols = [symbol(argument) for argument in inputs]
    summary = "Computes the greatest speed at which a link may approach an obstacle."
    return kernel("approach_speed", summary, equation, inputs, [speed], symbols, [law(*symbols)])


def slack_kernel(parameters: dict[str, Parameter]) -> Kernel:
    """Weight of a soft row."""
    distance = Argument("distance", (), "m", "distance to the nearest obstacle")
    names = ("d_a", "d_r", "slack_weight", "slack_minimum", "slack_maximum")
    inputs = [distance, *read_from(parameters, *names)]
    symbols = [symbol(argument) for argument in inputs]
    return kernel(
        "slack_weight",
        "Computes the weight of a capsule's slack: the nearer, the harder.",
        "rho = slack_weight clip((d_a - d)/(d_a - d_r), slack_minimum, slack_maximum)^2",
        inputs,
        [Argument("weight", (), "", "rho")],
        symbols,
        [avoidance.slack_weight(*symbols)],
    )


def objective_kernel(model: RobotModel, parameters: dict[str, Parameter]) -> Kernel:
    """H, g, manipulability and damping."""
    inputs = [
        Argument("J", (model.m, model.n), "m/rad, 1", "task Jacobian"),
        Argument("q", (model.n,), "rad", "joint positions"),
        Argument("xdot", (model.m,), "m/s, rad/s", "task velocity"),
        *read_from(parameters, "damping_gain", "damping_threshold", "damping_floor"),
        *read_from(parameters, "posture_weight", "posture_gain", "posture"),
    ]
    symbols = [symbol(argument) for argument in inputs]
    jacobian, q, xdot, gain, threshold, floor, weight, posture_gain, posture = symbols
    w = quadratic.manipulability(jacobian)
    regularisation = quadratic.damping(w, gain, threshold, floor)
    hessian, gradient = quadratic.objective(
        jacobian, xdot, regularisation, weight, posture_gain * (posture - q)
    )
    outputs = [
        Argument("H", (model.n, model.n), "", "Hessian"),
        Argument("g", (model.n,), "", "gradient"),
        Argument("manipulability", (), "", "w (14)"),
        Argument("damping", (), "", "lambda (15)"),
    ]
    return kernel(
        "objective",
        "Computes the objective of the QP and the damping near singular configurations.",
        "H = J'J + lambda I + W, g = -J'xdot - W k (q_p - q) (9); w = sqrt(det(JJ')) (14); "
        "lambda = max(lambda_min, g_lambda (1 - w/w_0)^2 where w < w_0) (15)",
        inputs,
        outputs,
        symbols,
        [hessian, gradient, w, regularisation],
    )


def bounds_kernel(model: RobotModel, parameters: dict[str, Parameter]) -> Kernel:
    """Bounds of q̇."""
    names = ("q_lower", "q_upper", "qdot_limit", "qddot_limit", "joint_damper", "viability", "period")
    inputs = [
        Argument("q", (model.n,), "rad", "joint positions"),
        Argument("qdot_previous", (model.n,), "rad/s", "the previous command"),
        *read_from(parameters, *names),
    ]
    symbols = [symbol(argument) for argument in inputs]
    lb, ub = quadratic.bounds(*symbols)
    outputs = [
        Argument("lb", (model.n,), "rad/s", "lower bounds of qdot"),
        Argument("ub", (model.n,), "rad/s", "upper bounds of qdot"),
    ]
    return kernel(
        "bounds",
        "Computes the bounds of qdot from position, velocity and acceleration limits; lb <= ub always.",
        "ub = max(0, min(qdot_limit, k_d (q_ub - q))) (3)(11), then within qdot_previous +- a dt, "
        "which gives way to the limits",
        inputs,
        outputs,
        symbols,
        [lb, ub],
    )
