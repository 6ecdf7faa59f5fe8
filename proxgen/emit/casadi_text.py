"""What CasADi writes, made fit for a review: no function that nothing calls, words for the others."""

import re
from collections.abc import Mapping

from proxgen.emit.text import block_comment, shape_text
from proxgen.errors import GenerateError
from proxgen.program import Kernel

_ANSWERS = (
    "checkout|release|incref|decref|n_in|n_out|default_in|name_in|name_out|sparsity_in|sparsity_out|"
    "work|work_bytes"
)
"""Functions with which CasADi describes each kernel to programs that load it. Nothing here calls them."""


def without_answers(text: str, robot: str) -> str:
    """A source or a header without the functions that nothing calls, and what only they name.

    Args:
        text: as CasADi writes it.
        robot: prefix of the functions' names.
    """
    unused = rf"{robot}_(?:kernel_\w+?_(?:{_ANSWERS})|kernels_casadi_\w+)"
    start = rf"^\w[^\n=]*\b{unused}\([^\n]*\)"
    lines = re.MULTILINE
    text = re.sub(rf"{start} *\{{(?:[^\n]+\}}|.*?^\}})\n\n?", "", text, flags=lines | re.DOTALL)
    text = re.sub(rf"{start};\n", "", text, flags=lines)
    text = re.sub(rf"^#define {robot}_kernel_\w+_SZ_\w+ \d+\n", "", text, flags=lines)
    text = text.replace("/* Configuration this file was compiled with */\n", "")
    for table in set(re.findall(r"\bcasadi_s\d+\b", text)):
        if len(re.findall(rf"\b{table}\b", text)) == 2:  # the macro of its name, and itself
            text = re.sub(rf"^(?:#define|static const casadi_int) {table}\b[^\n]*\n", "", text, flags=lines)
    return re.sub(r"\n{3,}", "\n\n", text)


def described(text: str, kernels: Mapping[str, Kernel]) -> str:
    """A source with what each kernel computes, and from what, where CasADi says its arguments' sizes.

    Args:
        text: as CasADi writes it.
        kernels: by the names of their C functions.

    Raises:
        GenerateError: the place is not found.
    """
    for symbol, kernel in kernels.items():
        heads = re.findall(rf"^/\* {symbol}:\(.*\) \*/$", text, re.MULTILINE)
        if len(heads) != 1:
            raise GenerateError(f"CasADi's text of kernel {kernel.name} is not as expected")
        text = text.replace(heads[0], _comment(symbol, kernel))
    return text


def _comment(symbol: str, kernel: Kernel) -> str:
    """Summary, equation, and what the pointers in `arg` and `res` point to."""
    lines = [f"{symbol}: {kernel.summary}", "", f"  {kernel.equation}", ""]
    for side, arguments in (("arg", kernel.inputs), ("res", kernel.outputs)):
        for index, argument in enumerate(arguments):
            unit = f" [{argument.unit}]" if argument.unit else ""
            lines.append(f"  {side}[{index}] {argument.name}: {shape_text(argument)}{unit}")
    return block_comment(lines)
