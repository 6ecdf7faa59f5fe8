"""Kernels to raw C: the only place where matrices change from CasADi's column order to C's row order."""

import tempfile
from pathlib import Path
from typing import Any

import casadi as ca

from proxgen.emit.casadi_text import described, without_answers
from proxgen.emit.text import identifier
from proxgen.errors import GenerateError
from proxgen.program import Argument, Kernel, Program

_OPTIONS: dict[str, Any] = {
    "casadi_int": "int",  # its default, long long, would make the runtime's int* corrupt the stack
    "casadi_real": "double",
    "with_header": True,
    "with_export": False,  # the library exports its public functions only
    "static_aux": True,  # helpers such as casadi_sq must not meet those of another robot
}

_PREAMBLE = """\
#include <math.h>

/* CasADi calls fmax and fmin of the C library, which costs more than the arithmetic around them; these become
 * one instruction each. They differ for NaN only, which the runtime lets nowhere near. */
#define fmax(x, y) ((x) > (y) ? (x) : (y))
#define fmin(x, y) ((x) < (y) ? (x) : (y))

"""


def row_major(matrix: Any) -> Any:
    """The transposed dense matrix, whose column-major storage is the row-major storage of `matrix`.

    CasADi stores the structural nonzeros only, column by column; C wants every entry, row by row. It is its
    own inverse on dense matrices, so that inputs are read with it and outputs written.
    """
    return ca.densify(matrix).T


def kernel_symbol(robot: str, kernel: str) -> str:
    """Name of a kernel's C function."""
    return identifier(f"{robot}_kernel_{kernel}")


def row_major_function(robot: str, kernel: Kernel) -> Any:
    """The kernel's CasADi function with dense inputs and outputs in row-major storage.

    Raises:
        GenerateError: if the function does not have the inputs and outputs that the kernel declares.
    """
    _check_signature(kernel)
    inputs = [ca.SX.sym(argument.name, *reversed(_two_dimensional(argument))) for argument in kernel.inputs]
    try:
        outputs = kernel.function.call([row_major(value) for value in inputs])
    except RuntimeError as error:
        # Scalar operations need no work memory, and the wrappers give none.
        raise GenerateError(
            f"kernel {kernel.name} cannot be written as scalar operations: {error}"
        ) from error
    return ca.Function(
        kernel_symbol(robot, kernel.name),
        inputs,
        [row_major(value) for value in outputs],
        [argument.name for argument in kernel.inputs],
        # CasADi wants different names for inputs and outputs; C does not see these.
        [f"out_{argument.name}" for argument in kernel.outputs],
    )


def operation_count(kernel: Kernel) -> int:
    """Number of arithmetic operations of a kernel, reading and writing of arguments not counted."""
    moves = {ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST, ca.OP_PARAMETER}
    function = kernel.function
    codes = (function.instruction_id(index) for index in range(function.n_instructions()))
    return sum(code not in moves for code in codes)


def render_kernels(program: Program, banner: str) -> dict[str, str]:
    """`kernels.h` and `kernels.c`, as CasADi writes them, under our banner.

    Raises:
        GenerateError: if a kernel does not fit its declaration, or is no function of scalar operations.
    """
    generator = ca.CodeGenerator(f"{program.robot}_kernels", _OPTIONS)
    for kernel in program.kernels:
        generator.add(row_major_function(program.robot, kernel))
    with tempfile.TemporaryDirectory() as folder:
        generator.generate(folder + "/")
        source = (Path(folder) / f"{program.robot}_kernels.c").read_text()
        header = (Path(folder) / f"{program.robot}_kernels.h").read_text()
    guard = f"{program.robot.upper()}_KERNELS_H"
    header = f"#ifndef {guard}\n#define {guard}\n\n{header}\n#endif"
    source = described(without_answers(source, program.robot), _symbols(program))
    return {
        "kernels.h": _clean(f"{banner}\n{without_answers(header, program.robot)}"),
        "kernels.c": _clean(f"{banner}\n{_PREAMBLE}{source}"),
    }


def _symbols(program: Program) -> dict[str, Kernel]:
    """The kernels by the names of their C functions."""
    return {kernel_symbol(program.robot, kernel.name): kernel for kernel in program.kernels}


def _clean(text: str) -> str:
    """Without the spaces that CasADi leaves at the ends of lines."""
    return "\n".join(line.rstrip() for line in text.splitlines()).rstrip("\n") + "\n"


def _two_dimensional(argument: Argument) -> tuple[int, int]:
    """Rows and columns as CasADi counts them; a vector is a column."""
    rows, columns = (*argument.shape, 1, 1)[:2]
    return rows, columns


def _check_signature(kernel: Kernel) -> None:
    """Refuse a kernel whose function has other inputs or outputs than it declares."""
    function = kernel.function
    for side, arguments, count, shape_of in (
        ("input", kernel.inputs, function.n_in(), function.size_in),
        ("output", kernel.outputs, function.n_out(), function.size_out),
    ):
        if len(arguments) != count:
            raise GenerateError(
                f"kernel {kernel.name}: {len(arguments)} {side}s declared, its function has {count}"
            )
        for index, argument in enumerate(arguments):
            declared, found = _two_dimensional(argument), tuple(shape_of(index))
            if declared != found:
                raise GenerateError(
                    f"kernel {kernel.name}: {side} {argument.name} is declared {declared}, "
                    f"its function has {found}"
                )
