"""Expressions to kernels: symbols of declared arguments, functions with names, shapes and units."""

from collections.abc import Sequence
from typing import Any

import casadi as ca

from proxgen.errors import GenerateError
from proxgen.model import RobotModel
from proxgen.program import Argument, Kernel, Parameter


def symbol(argument: Argument) -> Any:
    """An SX symbol of the argument's shape; vectors are columns."""
    shape = argument.shape if len(argument.shape) == 2 else (*argument.shape, 1) if argument.shape else (1, 1)
    return ca.SX.sym(argument.name, *shape)


def kernel(
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


def read_from(parameters: dict[str, Parameter], *names: str) -> list[Argument]:
    """Inputs that are read from the parameter block."""
    return [
        Argument(
            name, parameters[name].shape, parameters[name].unit, parameters[name].meaning, parameter=True
        )
        for name in names
    ]


def joint_arguments(model: RobotModel) -> tuple[Argument, Argument]:
    """Axes and origins of the moving joints, as the kinematics gives them."""
    count = len(model.drives)
    return (
        Argument("joint_axis", (count, 3), "", "unit axis of each joint, world"),
        Argument("joint_origin", (count, 3), "m", "a point on each joint's axis, world"),
    )
