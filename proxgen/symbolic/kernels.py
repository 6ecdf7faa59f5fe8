"""The functions to be generated: expressions wrapped with names, shapes, units and equations."""

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca

from proxgen.config.schema import Config
from proxgen.errors import GenerateError
from proxgen.model import RobotModel
from proxgen.program import Argument, Kernel, Parameter
from proxgen.symbolic import avoidance, quadratic
from proxgen.symbolic.kinematics import kinematics, point_jacobian, relative_jacobian


def _symbol(argument: Argument) -> Any:
    """An SX symbol of the argument's shape; vectors are columns."""
    shape = argument.shape if len(argument.shape) == 2 else (*argument.shape, 1) if argument.shape else (1, 1)
    return ca.SX.sym(argument.name, *shape)


def _kernel(
    name: str,
    summary: str,
    equation: str,
    inputs: Sequence[Argument],
    outputs: Sequence[Argument],
    symbols: Sequence[Any],
    results: Sequence[Any],
) -> Kernel:
    """Wrap expressions into a kernel; common subexpressions are found across all outputs."""
    names_in, names_out = [a.name for a in inputs], [a.name for a in outputs]
    try:
        function = ca.Function(name, list(symbols), list(results), names_in, names_out, {"cse": True})
    except RuntimeError as error:
        raise GenerateError(f"CasADi refuses the expressions of '{name}': {error}") from error
    return Kernel(name, summary, equation, tuple(inputs), tuple(outputs), function)


def _from(parameters: dict[str, Parameter], *names: str) -> list[Argument]:
    """Inputs that are read from the parameter block."""
    return [
        Argument(
            name, parameters[name].shape, parameters[name].unit, parameters[name].meaning, parameter=True
        )
        for name in names
    ]


def _joint_arguments(model: RobotModel) -> tuple[Argument, Argument]:
    """Axes and origins of the moving joints, as the kinematics gives them."""
    count = len(model.drives)
    return (
        Argument("joint_axis", (count, 3), "", "unit axis of each joint, world"),
        Argument("joint_origin", (count, 3), "m", "a point on each joint's axis, world"),
    )


def kinematics_kernel(model: RobotModel, bodies: Sequence[int]) -> Kernel:
    """Poses, joint axes and origins, task Jacobian: everything that depends on q alone."""
    q = Argument("q", (model.n,), "rad", "joint positions")
    symbol = _symbol(q)
    result = kinematics(model, symbol)
    poses = [ca.reshape(result.poses[body].row_major().T, 1, 12) for body in bodies]
    outputs = [
        Argument("tool_to_world", (3, 4), "1, m", "[R | t] of the task point"),
        Argument("body_to_world", (len(bodies), 12), "1, m", "[R | t], row-major 3x4, one body per row"),
        *_joint_arguments(model),
        Argument("J", (model.m, model.n), "m/rad, 1", "task Jacobian, rows " + " ".join(model.task_rows)),
    ]
    results = [
        result.tool.row_major(),
        ca.vertcat(*poses),
        ca.horzcat(*result.axes).T,
        ca.horzcat(*result.origins).T,
        result.jacobian,
    ]
    return _kernel(
        "kinematics",
        "Computes all poses, joint axes and the task Jacobian at q.",
        "xdot = J qdot (1)",
        [q],
        outputs,
        [symbol],
        results,
    )


def row_kernel(model: RobotModel, index: int, body: int) -> Kernel:
    """Row of (5) for a point of one body."""
    inputs = [
        *_joint_arguments(model),
        Argument("point", (3,), "m", "closest point on the link, world"),
        Argument("direction", (3,), "", "unit vector from the link to the obstacle, world"),
    ]
    symbols = [_symbol(argument) for argument in inputs]
    axes = tuple(symbols[0][i, :].T for i in range(len(model.drives)))
    origins = tuple(symbols[1][i, :].T for i in range(len(model.drives)))
    row = ca.mtimes(symbols[3].T, point_jacobian(model, axes, origins, body, symbols[2])).T
    return _kernel(
        f"row_{index}",
        "Computes the row of a point on a body: its speed towards the obstacle is row . qdot.",
        "A_i = d_hat' J_p (4)(5)",
        inputs,
        [Argument("row", (model.n,), "m/rad", "one row of A")],
        symbols,
        [row],
    )


def self_row_kernel(model: RobotModel, indices: tuple[int, int], bodies: tuple[int, int]) -> Kernel:
    """Row of self-collision for a point of one body and one that another body carries.

    Joints that move both bodies have no part in it: what they give the one point along d̂ they give the other.

    Args:
        model: the arm.
        indices: of the two bodies among the rows of `body_to_world`.
        bodies: the same as Pinocchio joint indices; the first is the capsule's.
    """
    inputs = [
        *_joint_arguments(model),
        Argument("point", (3,), "m", "closest point on the link, world"),
        Argument("carried", (3,), "m", "self-collision point that the other body carries, world"),
        Argument("direction", (3,), "", "unit vector from the former to the latter, world"),
    ]
    symbols = [_symbol(argument) for argument in inputs]
    axes = tuple(symbols[0][i, :].T for i in range(len(model.drives)))
    origins = tuple(symbols[1][i, :].T for i in range(len(model.drives)))
    relative = relative_jacobian(model, axes, origins, bodies, (symbols[2], symbols[3]))
    row = ca.mtimes(symbols[4].T, relative).T
    return _kernel(
        f"self_row_{indices[0]}_{indices[1]}",
        "Computes the row of a link and a point that another one carries: they approach at row . qdot.",
        "A_i = d_hat' (J_p - J_h), without the joints that move both",
        inputs,
        [Argument("row", (model.n,), "m/rad", "one row of A")],
        symbols,
        [row],
    )


def objective_kernel(model: RobotModel, parameters: dict[str, Parameter]) -> Kernel:
    """H, g, manipulability and damping."""
    inputs = [
        Argument("J", (model.m, model.n), "m/rad, 1", "task Jacobian"),
        Argument("q", (model.n,), "rad", "joint positions"),
        Argument("xdot", (model.m,), "m/s, rad/s", "task velocity"),
        *_from(parameters, "damping_gain", "damping_threshold", "damping_floor"),
        *_from(parameters, "posture_weight", "posture_gain", "posture"),
    ]
    symbols = [_symbol(argument) for argument in inputs]
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
    return _kernel(
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
        *_from(parameters, *names),
    ]
    symbols = [_symbol(argument) for argument in inputs]
    lb, ub = quadratic.bounds(*symbols)
    outputs = [
        Argument("lb", (model.n,), "rad/s", "lower bounds of qdot"),
        Argument("ub", (model.n,), "rad/s", "upper bounds of qdot"),
    ]
    return _kernel(
        "bounds",
        "Computes the bounds of qdot from position, velocity and acceleration limits; lb <= ub always.",
        "ub = max(0, min(qdot_limit, k_d (q_ub - q))) (3)(11), then within qdot_previous +- a dt, "
        "which gives way to the limits",
        inputs,
        outputs,
        symbols,
        [lb, ub],
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
    inputs = [distance, *_from(parameters, *names)]
    symbols = [_symbol(argument) for argument in inputs]
    summary = "Computes the greatest speed at which a link may approach an obstacle."
    return _kernel("approach_speed", summary, equation, inputs, [speed], symbols, [law(*symbols)])


def self_approach_kernel(parameters: dict[str, Parameter]) -> Kernel:
    """Approach law of self-collision: (13), whatever the schedule."""
    distance = Argument("distance", (), "m", "distance to the nearest self-collision point, between surfaces")
    names = ("self_d_a", "self_d_0u", "self_d_0l", "self_d_r", "approach_speed", "repulse_speed")
    inputs = [distance, *_from(parameters, *names)]
    symbols = [_symbol(argument) for argument in inputs]
    return _kernel(
        "self_approach_speed",
        "Computes the greatest speed at which a link may approach a point that another one carries.",
        "approach_speed at self_d_a, linear to 0 at self_d_0u, 0 to self_d_0l, linear to repulse_speed "
        "at self_d_r (13)",
        inputs,
        [Argument("speed", (), "m/s", "greatest approach speed")],
        symbols,
        [avoidance.approach_speed(*symbols)],
    )


def self_slack_kernel(parameters: dict[str, Parameter]) -> Kernel:
    """Weight of a soft row of self-collision."""
    distance = Argument("distance", (), "m", "distance to the nearest self-collision point, between surfaces")
    names = ("self_d_a", "self_d_r", "slack_weight", "slack_minimum", "slack_maximum")
    inputs = [distance, *_from(parameters, *names)]
    symbols = [_symbol(argument) for argument in inputs]
    return _kernel(
        "self_slack_weight",
        "Computes the weight of the slack of a self-collision row: the nearer, the harder.",
        "rho = slack_weight clip((self_d_a - d)/(self_d_a - self_d_r), slack_minimum, slack_maximum)^2",
        inputs,
        [Argument("weight", (), "", "rho")],
        symbols,
        [avoidance.slack_weight(*symbols)],
    )


def slack_kernel(parameters: dict[str, Parameter]) -> Kernel:
    """Weight of a soft row."""
    distance = Argument("distance", (), "m", "distance to the nearest obstacle")
    names = ("d_a", "d_r", "slack_weight", "slack_minimum", "slack_maximum")
    inputs = [distance, *_from(parameters, *names)]
    symbols = [_symbol(argument) for argument in inputs]
    return _kernel(
        "slack_weight",
        "Computes the weight of a capsule's slack: the nearer, the harder.",
        "rho = slack_weight clip((d_a - d)/(d_a - d_r), slack_minimum, slack_maximum)^2",
        inputs,
        [Argument("weight", (), "", "rho")],
        symbols,
        [avoidance.slack_weight(*symbols)],
    )


def closest_point_kernel() -> Kernel:
    """Closest point on a capsule's axis."""
    inputs = [
        Argument("point", (3,), "m", "obstacle point, world"),
        Argument("start", (3,), "m", "one end of the capsule's axis, world"),
        Argument("end", (3,), "m", "its other end, world"),
    ]
    symbols = [_symbol(argument) for argument in inputs]
    return _kernel(
        "closest_point",
        "Computes the point of a capsule's axis that is nearest to a point.",
        "p = a + t (b - a), t = clamp((h - a).(b - a)/|b - a|^2, 0, 1)",
        inputs,
        [Argument("closest", (3,), "m", "p, world")],
        symbols,
        [avoidance.closest_point(*symbols)],
    )


def sensor_point_kernel() -> Kernel:
    """Obstacle point of a reading."""
    inputs = [
        Argument("body_to_world", (3, 4), "1, m", "[R | t] of the body that carries the sensor"),
        Argument("position", (3,), "m", "the sensor's place, body frame"),
        Argument("normal", (3,), "", "its direction, body frame, unit"),
        Argument("range", (), "m", "its reading, or a switch's virtual distance"),
    ]
    symbols = [_symbol(argument) for argument in inputs]
    return _kernel(
        "sensor_point",
        "Computes the obstacle point that a reading stands for.",
        "h = o + r n",
        inputs,
        [Argument("point", (3,), "m", "h, world")],
        symbols,
        [avoidance.sensor_point(*symbols)],
    )
