"""From kernels to the readable C functions that wrap them: who passes what, and where it comes from.

An input that is a parameter is read from the parameter block. An input or output with the name and shape of
an output of the kernel `kinematics` comes from, or goes to, the kinematics struct. Everything else is an
argument. Kernels called `row_<body>` become one function with the body as its first argument; those called
`self_row_<body>_<carrier>`, one with two bodies.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from math import prod

from proxgen.emit.kernels import kernel_symbol, operation_count
from proxgen.emit.text import comment_text, identifier
from proxgen.errors import GenerateError, unknown_name
from proxgen.program import Argument, Kernel, Program

REQUIRED = (
    "kinematics",
    "row",
    "objective",
    "bounds",
    "approach_speed",
    "slack_weight",
    "closest_point",
    "sensor_point",
)
"""Functions without which the runtime does not link."""

_ROW = re.compile(r"^(row_(\d+)|self_row_(\d+)_(\d+))$")
_BODIES = {"row": ("body",), "self_row": ("body", "carrier")}
"""Arguments of the functions that choose their kernel by bodies."""


@dataclass(frozen=True)
class Case:
    """One kernel behind a function; `bodies` is empty unless the function chooses by them."""

    bodies: tuple[int, ...]
    symbol: str
    note: str


@dataclass(frozen=True)
class Function:
    """A readable C function around one kernel, or around one kernel per body.

    Attributes:
        name: without the robot's prefix.
        summary: one sentence.
        equation: in words, with its number.
        declaration: return type, name and arguments, without a final semicolon.
        inputs: passed by the caller.
        outputs: passed by the caller.
        parameters: names read from the parameter block.
        fields_read: fields read from the kinematics struct.
        fields_written: fields written to it.
        arguments: C expressions for the kernel's inputs.
        results: C expressions for the kernel's outputs.
        cases: the kernels.
        choosers: arguments by which the function chooses among them.
        operations: arithmetic operations; the most of all cases.
    """

    name: str
    summary: str
    equation: str
    declaration: str
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    parameters: tuple[str, ...]
    fields_read: tuple[str, ...]
    fields_written: tuple[str, ...]
    arguments: tuple[str, ...]
    results: tuple[str, ...]
    cases: tuple[Case, ...]
    choosers: tuple[str, ...]
    operations: int


def functions(program: Program) -> tuple[Function, ...]:
    """The readable functions of a program, in the order of their first kernels.

    Raises:
        GenerateError: if a required function is missing, or a kernel asks for a parameter that there is not.
    """
    groups: dict[str, list[Kernel]] = {}
    for kernel in program.kernels:
        groups.setdefault(_function_name(kernel), []).append(kernel)
    for name in REQUIRED:
        if name not in groups:
            raise GenerateError(f"the program has no kernel '{name}', which the runtime calls")
    fields = kinematics_fields(program)
    return tuple(_function(program, name, kernels, fields) for name, kernels in groups.items())


def kinematics_fields(program: Program) -> dict[str, Argument]:
    """Fields of the kinematics struct by name: the outputs of the kernel `kinematics`."""
    return {argument.name: argument for argument in program.kernel("kinematics").outputs}


def field_dimensions(argument: Argument) -> str:
    """C dimensions of a struct field: `[12]` for a pose, `[3][12]` for a list of poses, `[21]` for a matrix.

    A table, one row per thing, has two dimensions in C; a matrix in the mathematical sense, which has a
    capital letter, and a single pose are flat and row-major.
    """
    if len(argument.shape) == 2 and not argument.name[0].isupper() and argument.shape != (3, 4):
        return f"[{argument.shape[0]}][{argument.shape[1]}]"
    return f"[{prod(argument.shape)}]" if argument.shape else ""


def _function(program: Program, name: str, kernels: list[Kernel], fields: dict[str, Argument]) -> Function:
    """Wrap the kernels of one function, which all have the same inputs and outputs."""
    first = kernels[0]
    for kernel in kernels[1:]:
        if (kernel.inputs, kernel.outputs) != (first.inputs, first.outputs):
            raise GenerateError(f"kernels {first.name} and {kernel.name} differ in their inputs or outputs")
    _check_parameters(program, first)
    passed_in = tuple(a for a in first.inputs if not a.parameter and not _is_field(a, fields))
    passed_out = tuple(a for a in first.outputs if not _is_field(a, fields))
    read = tuple(a.name for a in first.inputs if not a.parameter and _is_field(a, fields))
    written = tuple(a.name for a in first.outputs if _is_field(a, fields))
    choosers = _BODIES.get(name, ())
    prefix = program.robot
    declared = [f"int {chooser}" for chooser in choosers]
    if any(argument.parameter for argument in first.inputs):
        declared.append(f"const {prefix}_parameters_t *parameters")
    if read and not written:
        declared.append(f"const {prefix}_kinematics_t *kinematics")
    declared += [_declare(argument, output=False) for argument in passed_in]
    if written:
        declared.append(f"{prefix}_kinematics_t *kinematics")
    declared += [_declare(argument, output=True) for argument in passed_out]
    return Function(
        name=name,
        summary=first.summary,
        equation=first.equation,
        declaration=f"int {identifier(f'{prefix}_{name}')}({', '.join(declared)})",
        inputs=passed_in,
        outputs=passed_out,
        parameters=tuple(a.name for a in first.inputs if a.parameter),
        fields_read=read,
        fields_written=written,
        arguments=tuple(_expression(a, fields, output=False) for a in first.inputs),
        results=tuple(_expression(a, fields, output=True) for a in first.outputs),
        cases=tuple(_cases(program, kernels)),
        choosers=choosers,
        operations=max(operation_count(kernel) for kernel in kernels),
    )


def _cases(program: Program, kernels: Iterable[Kernel]) -> Iterable[Case]:
    """One case per kernel."""
    for kernel in kernels:
        bodies = _bodies(kernel)
        if any(body >= program.bodies for body in bodies):
            raise GenerateError(
                f"kernel {kernel.name}: there are only {program.bodies} bodies, counted from 0"
            )
        note = comment_text(", ".join(program.body_names[body] for body in bodies))
        yield Case(bodies, kernel_symbol(program.robot, kernel.name), note)


def _bodies(kernel: Kernel) -> tuple[int, ...]:
    """The bodies in the name of a kernel of a function that chooses by them."""
    match = _ROW.match(kernel.name)
    return tuple(int(number) for number in match.groups()[1:] if number is not None) if match else ()


def _function_name(kernel: Kernel) -> str:
    """Name of the function around a kernel: its own, without the bodies."""
    return kernel.name.rstrip("_0123456789") if _ROW.match(kernel.name) else kernel.name


def _check_parameters(program: Program, kernel: Kernel) -> None:
    """Refuse a kernel that reads a parameter that does not exist or has another shape."""
    shapes = {parameter.name: parameter.shape for parameter in program.parameters}
    for argument in kernel.inputs:
        if argument.parameter and argument.name not in shapes:
            raise GenerateError(f"kernel {kernel.name}: {unknown_name('parameter', argument.name, shapes)}")
        if argument.parameter and argument.shape != shapes[argument.name]:
            raise GenerateError(
                f"kernel {kernel.name}: parameter {argument.name} has shape {shapes[argument.name]}, "
                f"not {argument.shape}"
            )


def _is_field(argument: Argument, fields: dict[str, Argument]) -> bool:
    """Whether an argument lives in the kinematics struct."""
    return argument.name in fields and argument.shape == fields[argument.name].shape


def _declare(argument: Argument, *, output: bool) -> str:
    """Declaration of an argument in C, such as `const double q[7]`."""
    name = identifier(argument.name)
    if not argument.shape:
        return f"double *{name}" if output else f"double {name}"
    size = " * ".join(str(dimension) for dimension in argument.shape)
    return f"double {name}[{size}]" if output else f"const double {name}[{size}]"


def _expression(argument: Argument, fields: dict[str, Argument], *, output: bool) -> str:
    """C expression for the address of an argument's first number."""
    if argument.parameter:
        return f"parameters->{argument.name}" if argument.shape else f"&parameters->{argument.name}"
    if _is_field(argument, fields):
        path = f"kinematics->{argument.name}"
        if not argument.shape:
            return f"&{path}"
        return f"{path}[0]" if field_dimensions(argument).count("[") == 2 else path
    return argument.name if argument.shape or output else f"&{argument.name}"
