"""kernels.c and kernels.h as a reviewer meets them: nothing that is not called, and words for what is."""

import re
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from handmade import planar_program

from proxgen.emit.casadi_text import described
from proxgen.emit.kernels import kernel_symbol, render_kernels
from proxgen.errors import GenerateError


@pytest.mark.parametrize("robot", ["planar", "n_in", "kernel_work"])
def test_the_kernels_are_all_that_is_there(
    robot: str, tmp_path: Path, compile_c: Callable[..., Path]
) -> None:
    program = planar_program(robot)
    expected = {kernel_symbol(robot, kernel.name) for kernel in program.kernels}
    files = render_kernels(program, "/* banner */")
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    compiled = compile_c(tmp_path / "kernels.c", "-Wunused-const-variable", raw=True)
    listing = subprocess.run(["nm", str(compiled)], check=True, capture_output=True, text=True).stdout
    assert set(re.findall(r" T (\w+)$", listing, re.M)) == expected
    assert set(re.findall(r"\bint (\w+)\(", files["kernels.h"])) == expected
    assert re.findall(r"casadi_s\d+|_SZ_", "".join(files.values())) == []


def test_every_kernel_says_what_it_computes_and_from_what() -> None:
    program = planar_program()
    text = render_kernels(program, "/* banner */")["kernels.c"]
    for kernel in program.kernels:
        symbol = kernel_symbol("planar", kernel.name)
        (comment,) = re.findall(rf"^/\* {symbol}: (.*?) \*/\nstatic int casadi_f\d+\(", text, re.M | re.S)
        assert kernel.summary in comment
        assert all(f"arg[{i}] {argument.name}: " in comment for i, argument in enumerate(kernel.inputs))
        assert all(f"res[{i}] {argument.name}: " in comment for i, argument in enumerate(kernel.outputs))
    assert "res[0] tool_to_world: 3x4 row-major" in text


def test_a_text_that_is_not_casadis_is_refused() -> None:
    kernel = replace(planar_program().kernels[0], name="bounds")
    with pytest.raises(GenerateError, match="CasADi's text of kernel bounds is not as expected"):
        described("int planar_kernel_bounds(void);\n", {"planar_kernel_bounds": kernel})
