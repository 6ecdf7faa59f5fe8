"""A Program written by hand: a planar two-link arm whose every formula fits on a line."""

from dataclasses import replace
from typing import Any

import casadi as ca

from proxgen.program import Argument, CapsuleEntry, Kernel, Parameter, Program, SensorEntry

JOINTS = (
    Argument("joint_axis", (2, 3), "", "unit axis of each joint, world"),
    Argument("joint_origin", (2, 3), "m", "a point on each joint's axis, world"),
)
UPPER, LOWER = 0.4, 0.3  # lengths of the links [m]


def argument(name: str, *shape: int, parameter: bool = False) -> Argument:
    return Argument(name, shape, "m", f"meaning of {name}", parameter)


def kernel(name: str, inputs: list[Argument], outputs: list[Argument], function: Any) -> Kernel:
    """Call `function` on symbols of the inputs' shapes, and wrap what it returns."""
    symbols = [ca.SX.sym(a.name, *(*a.shape, 1, 1)[:2]) for a in inputs]
    results = function(*symbols)
    return Kernel(
        name,
        f"Computes {name}.",
        f"equation of {name} (1)",
        tuple(inputs),
        tuple(outputs),
        ca.Function(name, symbols, list(results)),
    )


def pose(angle: Any, x: Any, y: Any) -> Any:
    cosine, sine = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(cosine, -sine, 0, x), ca.horzcat(sine, cosine, 0, y), ca.horzcat(0, 0, 1, 0))


def kinematics(q: Any) -> list[Any]:
    elbow = UPPER * ca.vertcat(ca.cos(q[0]), ca.sin(q[0]))
    tool = elbow + LOWER * ca.vertcat(ca.cos(q[0] + q[1]), ca.sin(q[0] + q[1]))
    bodies = [pose(q[0], 0, 0), pose(q[0] + q[1], elbow[0], elbow[1])]
    flat = [ca.reshape(body.T, 1, 12) for body in bodies]
    axes = ca.DM([[0, 0, 1], [0, 0, 1]])
    origins = ca.horzcat(ca.vertcat(0, 0, 0), ca.vertcat(elbow, 0)).T
    return [pose(q[0] + q[1], tool[0], tool[1]), ca.vertcat(*flat), axes, origins, ca.jacobian(tool, q)]


def row(moved: int) -> Any:
    def function(axes: Any, origins: Any, point: Any, direction: Any) -> list[Any]:
        columns = [
            ca.dot(direction, ca.cross(axes[j, :].T, point - origins[j, :].T)) if j < moved else ca.SX(1, 1)
            for j in range(2)
        ]
        return [ca.vertcat(*columns)]

    return function


def objective(jacobian: Any, xdot: Any, gain: Any, weight: Any) -> list[Any]:
    manipulability = ca.fabs(jacobian[0, 0] * jacobian[1, 1] - jacobian[0, 1] * jacobian[1, 0])
    hessian = ca.mtimes(jacobian.T, jacobian) + gain * ca.DM.eye(2) + ca.diag(weight)
    return [hessian, -ca.mtimes(jacobian.T, xdot), manipulability, gain]


def bounds(q: Any, previous: Any, lower: Any, upper: Any) -> list[Any]:
    return [ca.fmin(0, lower - q), ca.fmax(0, upper - q)]


def closest_point(point: Any, start: Any, end: Any) -> list[Any]:
    along = end - start
    return [start + ca.fmin(ca.fmax(ca.dot(point - start, along) / ca.dot(along, along), 0), 1) * along]


def planar_program(robot: str = "planar") -> Program:
    """The whole program of the arm."""
    point, direction = argument("point", 3), argument("direction", 3)
    distance = argument("distance")
    limits = [argument("q_lower", 2, parameter=True), argument("q_upper", 2, parameter=True)]
    gain, weight = argument("damping_gain", parameter=True), argument("weight", 2, parameter=True)
    J = argument("J", 2, 2)
    rows = [kernel(f"row_{k}", [*JOINTS, point, direction], [argument("row", 2)], row(k + 1)) for k in (0, 1)]
    kernels = (
        kernel(
            "kinematics",
            [argument("q", 2)],
            [argument("tool_to_world", 3, 4), argument("body_to_world", 2, 12), *JOINTS, J],
            lambda q: kinematics(q),
        ),
        kernel(
            "sensor_point",
            [
                argument("body_to_world", 3, 4),
                argument("position", 3),
                argument("normal", 3),
                argument("range"),
            ],
            [point],
            lambda body, o, n, r: [ca.mtimes(body[:, :3], o + r * n) + body[:, 3]],
        ),
        kernel(
            "closest_point",
            [point, argument("start", 3), argument("end", 3)],
            [argument("closest", 3)],
            closest_point,
        ),
        *rows,
        kernel("approach_speed", [distance, gain], [argument("speed")], lambda d, k: [k * d]),
        kernel("slack_weight", [distance, gain], [argument("weight")], lambda d, k: [k / d]),
        kernel(
            "objective",
            [J, argument("xdot", 2), gain, weight],
            [argument("H", 2, 2), argument("g", 2), argument("manipulability"), argument("damping")],
            objective,
        ),
        kernel(
            "bounds",
            [argument("q", 2), argument("qdot_previous", 2), *limits],
            [argument("lb", 2), argument("ub", 2)],
            bounds,
        ),
    )
    return Program(
        robot=robot,
        config_hash="0123456789abcdef" * 4,
        joints=2,
        task_rows=2,
        bodies=2,
        joint_names=("shoulder", "elbow"),
        task_row_names=("x", "y"),
        body_names=("upper", "lower"),
        kernels=kernels,
        parameters=(
            Parameter("q_lower", (2,), "rad", (-1.5, -2.5), -1e20, 1e20, "lower position limits (11)"),
            Parameter("q_upper", (2,), "rad", (1.5, 2.5), -1e20, 1e20, "upper position limits (11)"),
            Parameter("damping_gain", (), "", 0.1, 0.0, 1e20, "g_lambda (15)"),
            Parameter("weight", (2,), "", (0.25, 1 / 3), 0.0, 1e20, "weights"),
        ),
        capsules=(
            CapsuleEntry("upper_arm", 0, (0.0, 0.0, 0.0), (UPPER, 0.0, 0.0), 0.05, 0.0),
            CapsuleEntry("forearm", 1, (0.0, 0.0, 0.0), (LOWER, 0.0, 0.0), 0.05, 0.05),
        ),
        tof=(SensorEntry("cuff.0.0", 1, (0.1, 0.05, 0.0), (0.0, 1.0, 0.0), 1.0),),
        capacitive=(),
        max_points=8,
        relaxation="staged",
        active_row=True,
        schedule="paper",
        max_iterations=50,
        tolerance=1e-8,
        sources={"proxgen": "0.1.0", "casadi": str(ca.CasadiMeta.version())},
    )


def with_kernel(program: Program, changed: Kernel) -> Program:
    """The program with one of its kernels replaced by another one of the same name."""
    return replace(program, kernels=tuple(changed if k.name == changed.name else k for k in program.kernels))
