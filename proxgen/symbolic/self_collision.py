"""Functions of self-collision: rows of pairs, their law, the weight of soft ones (docs/method.md)."""

import casadi as ca

from proxgen.config.schema import Config
from proxgen.model import RobotModel
from proxgen.program import Argument, Kernel, Parameter
from proxgen.symbolic import avoidance
from proxgen.symbolic.kinematics import relative_jacobian
from proxgen.symbolic.wrapping import joint_arguments, kernel, read_from, symbol


def self_kernels(
    config: Config, model: RobotModel, bodies: list[int], by_name: dict[str, Parameter]
) -> list[Kernel]:
    """Kernels of self-collision: rows for the bodies of all pairs, the law, the weight of soft rows."""
    if not model.self_points:
        return []
    pairs = {
        (capsule.body, point.body)
        for point in model.self_points
        for capsule, paired in zip(model.capsules, point.capsules, strict=True)
        if paired
    }
    rows = [
        self_row_kernel(model, (bodies.index(link), bodies.index(carrier)), (link, carrier))
        for link, carrier in sorted(pairs)
    ]
    weight = [self_slack_kernel(by_name)] if config.relaxation.mode == "slack" else []
    return [*rows, self_approach_kernel(by_name), *weight]


def self_row_kernel(model: RobotModel, indices: tuple[int, int], bodies: tuple[int, int]) -> Kernel:
    """Row of self-collision for a point of one body and one that another body carries.

    Joints that move both bodies have no part in it: what they give the one point along d̂ they give the other.

    Args:
        model: the arm.
        indices: of the two bodies among the rows of `body_to_world`.
        bodies: the same as Pinocchio joint indices; the first is the capsule's.
    """
    inputs = [
        *joint_arguments(model),
        Argument("point", (3,), "m", "closest point on the link, world"),
        Argument("carried", (3,), "m", "self-collision point that the other body carries, world"),
        Argument("direction", (3,), "", "unit vector from the former to the latter, world"),
    ]
    symbols = [symbol(argument) for argument in inputs]
    axes = tuple(symbols[0][i, :].T for i in range(len(model.drives)))
    origins = tuple(symbols[1][i, :].T for i in range(len(model.drives)))
    relative = relative_jacobian(model, axes, origins, bodies, (symbols[2], symbols[3]))
    row = ca.mtimes(symbols[4].T, relative).T
    return kernel(
        f"self_row_{indices[0]}_{indices[1]}",
        "Computes the row of a link and a point that another one carries: they approach at row . qdot.",
        "A_i = d_hat' (J_p - J_h), without the joints that move both",
        inputs,
        [Argument("row", (model.n,), "m/rad", "one row of A")],
        symbols,
        [row],
    )


def self_approach_kernel(parameters: dict[str, Parameter]) -> Kernel:
    """Approach law of self-collision: (13), whatever the schedule."""
    distance = Argument("distance", (), "m", "distance to the nearest self-collision point, between surfaces")
    names = ("self_d_a", "self_d_0u", "self_d_0l", "self_d_r", "approach_speed", "repulse_speed")
    inputs = [distance, *read_from(parameters, *names)]
    symbols = [symbol(argument) for argument in inputs]
    return kernel(
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
    inputs = [distance, *read_from(parameters, *names)]
    symbols = [symbol(argument) for argument in inputs]
    return kernel(
        "self_slack_weight",
        "Computes the weight of the slack of a self-collision row: the nearer, the harder.",
        "rho = slack_weight clip((self_d_a - d)/(self_d_a - self_d_r), slack_minimum, slack_maximum)^2",
        inputs,
        [Argument("weight", (), "", "rho")],
        symbols,
        [avoidance.slack_weight(*symbols)],
    )
