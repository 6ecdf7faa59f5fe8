"""The Python extension: cffi (API mode) over the controller's public C interface.

What Python sees is read from the headers themselves, through the preprocessor, so that there is no second
description of the interface: `controller.h`, and `packed.h`, which takes the input of a cycle as one block.
cffi releases the GIL during every call.
"""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from proxgen.builder.toolchain import run
from proxgen.errors import BuildError

HEADER = "packed.h"
"""Includes all that Python sees."""

PYTHON_FUNCTIONS = (
    "create",
    "destroy",
    "reset",
    "step_packed",
    "get_parameters",
    "set_parameters",
    "diagnostics",
    "counters",
    "version",
    "status_name",
)
"""The functions that Python calls, without the robot's prefix."""

_SYSTEM_HEADERS = ("stddef.h", "stdint.h", "stdbool.h", "string.h")
"""Headers whose types cffi knows, or that only functions need; they are preprocessed as empty files."""


def declarations(
    header: Path, include: Sequence[Path], compiler: Sequence[str], functions: Iterable[str], work: Path
) -> str:
    """The types of a header and the functions asked for, as cffi reads them.

    Args:
        header: C header; functions may be `static inline`.
        include: folders of the headers that it includes.
        compiler: C compiler, whose preprocessor is used.
        functions: names of the functions to keep.
        work: an empty folder.

    Raises:
        BuildError: the preprocessor fails, or a function is not declared.
    """
    for name in _SYSTEM_HEADERS:
        (work / name).write_text("")
    options = ["-E", "-P", "-nostdinc", f"-I{work}", *(f"-I{folder}" for folder in include)]
    text = run([*compiler, *options, str(header)], f"the preprocessor refuses {header.name}")
    wanted = set(functions)
    kept = []
    for statement in _statements(re.sub(r"^#.*$", "", text, flags=re.MULTILINE)):
        called = re.search(r"(\w+)\s*\(", statement)
        if statement.startswith("typedef"):
            kept.append(statement)
        elif not statement.startswith("extern") and called and called.group(1) in wanted:
            wanted.discard(called.group(1))
            kept.append(statement.removeprefix("static inline "))
    if wanted:
        raise BuildError(f"{header.name} does not declare {', '.join(sorted(wanted))}")
    return "\n".join(kept) + "\n"


def write_extension(module: str, cdef: str, source: Path) -> None:
    """Write the C source of an extension module that offers what `cdef` declares.

    Raises:
        BuildError: cffi does not understand the declarations.
    """
    import cffi
    from cffi.recompiler import make_c_source

    ffi = cffi.FFI()
    try:
        ffi.cdef(cdef)
        make_c_source(ffi, module, f'#include "{HEADER}"\n', str(source))
    except (cffi.CDefError, cffi.FFIError, cffi.VerificationError) as error:
        raise BuildError(f"cffi refuses the interface: {error}") from error


def _statements(text: str) -> Iterable[str]:
    """C declarations one by one, each with a semicolon; bodies of inline functions left out."""
    depth = 0
    current = ""
    for character in text:
        if character == "{":
            depth += 1
        current += character
        if character == "}":
            depth -= 1
            before = current[: current.find("{")]
            if depth == 0 and before.rstrip().endswith(")"):
                yield " ".join(before.split()) + ";"
                current = ""
        if character == ";" and depth == 0:
            yield " ".join(current.split())
            current = ""
