"""The handshake: headers with other sizes make another number, however great the sizes are."""

import os
import re
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

from handmade import planar_program

from proxgen.emit.rendering import render

SIZES = {"JOINTS": 2, "TASK_ROWS": 2, "CAPSULES": 2, "ROWS": 3, "TOF": 1, "CAPACITIVE": 1, "MAX_POINTS": 8}
OTHERS = [{name: size + more} for name, size in SIZES.items() for more in (1, 64, 4096)] + [
    {"TASK_ROWS": 1, "CAPSULES": 66, "ROWS": 67},
    {"JOINTS": 1, "TASK_ROWS": 10},
    {"ROWS": 2, "CAPSULES": 1, "TOF": 4097},
    {"TOF": 0, "CAPACITIVE": 4097},
    {"CAPACITIVE": 0, "MAX_POINTS": 8200},
]
"""Each was the same number as some arm's while every size had a part of the number to itself."""


def definition(**on: Any) -> str:
    """What a header defines the number by, with additions on."""
    header = render(replace(planar_program(), **on))["controller.h"]
    lines = re.findall(r"^#define PLANAR_(?:FACTOR|INTERFACE)\b(?:.*\\\n)*.*\n", header, re.M)
    assert lines
    return "".join(lines)


def numbers(cases: list[tuple[str, dict[str, int]]], folder: Path) -> list[int]:
    """What a C compiler makes of definitions and sizes."""
    code = ["#include <stdio.h>", "#define PG_ABI_VERSION 1", "int main(void) {"]
    for defined, sizes in cases:
        code += [f"#undef PLANAR_{name}" for name in (*SIZES, "FACTOR", "INTERFACE")]
        code += [f"#define PLANAR_{name} {size}" for name, size in (SIZES | sizes).items()]
        code += [defined, 'printf("%llu\\n", PLANAR_INTERFACE);']
    source, program = folder / "numbers.c", folder / "numbers"
    source.write_text("\n".join([*code, "return 0; }", ""]))
    compiler = [os.environ.get("CC", "cc"), "-std=c11", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
    subprocess.run([*compiler, str(source), "-o", str(program)], check=True)
    return [int(line) for line in subprocess.check_output([str(program)], text=True).split()]


def test_other_sizes_and_additions_make_another_number(tmp_path: Path) -> None:
    cases = [(definition(), sizes) for sizes in [{}, *OTHERS]]
    cases += [(definition(circulation=True), {}), (definition(method="tangential"), {})]
    found = numbers(cases, tmp_path)
    assert len(set(found)) == len(cases)
