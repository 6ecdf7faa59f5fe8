import ctypes
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from handmade import argument, kernel, planar_program, with_kernel

from proxgen.emit.kernels import kernel_symbol, operation_count, render_kernels, row_major
from proxgen.errors import GenerateError
from proxgen.program import Kernel, Program


def sparse_program() -> Program:
    """A kernel with sparse, non-square, non-symmetric matrices on both sides."""
    x = ca.SX.sym("x", 2, 3)
    sparse = ca.SX(3, 4)
    sparse[0, 1], sparse[2, 0], sparse[2, 3] = x[0, 1], x[1, 2], 7 * x[0, 0]
    function = ca.Function("f", [x], [sparse, x[1, :]])
    outputs = (argument("A", 3, 4), argument("b", 1, 3))
    only = Kernel("storage", "s", "e", (argument("x", 2, 3),), outputs, function)
    return replace(planar_program("storage"), kernels=(only,))


def run(library: ctypes.CDLL, symbol: str, inputs: list[np.ndarray], sizes: list[int]) -> list[np.ndarray]:
    pointer = ctypes.POINTER(ctypes.c_double)
    given = [np.ascontiguousarray(value, dtype=float) for value in inputs]
    results = [np.full(size + 1, -99.0) for size in sizes]
    arguments = (pointer * len(given))(*[value.ctypes.data_as(pointer) for value in given])
    outputs = (pointer * len(results))(*[value.ctypes.data_as(pointer) for value in results])
    assert getattr(library, symbol)(arguments, outputs, None, None, 0) == 0
    for result in results:
        assert result[-1] == -99.0, "written beyond the end"
    return [result[:-1] for result in results]


def test_matrices_are_row_major_and_dense_in_c(
    tmp_path: Path, compile_c: Callable[..., Path], load_c: Callable[..., ctypes.CDLL]
) -> None:
    for name, text in render_kernels(sparse_program(), "/* banner */").items():
        (tmp_path / name).write_text(text)
    library = load_c(compile_c(tmp_path / "kernels.c", raw=True))
    x = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    matrix, row = run(library, "storage_kernel_storage", [x], [12, 3])
    expected = np.array([[0, 2.0, 0, 0], [0, 0, 0, 0], [6.0, 0, 0, 7.0]])
    np.testing.assert_array_equal(matrix.reshape(3, 4), expected)
    np.testing.assert_array_equal(row, [4.0, 5.0, 6.0])


def test_row_major_is_its_own_inverse() -> None:
    matrix = ca.DM([[1, 2, 3], [0, 5, 0]])
    assert np.array_equal(row_major(row_major(ca.sparsify(matrix))).full(), matrix.full())


def test_every_kernel_gives_the_numbers_of_its_casadi_function(
    tmp_path: Path, compile_c: Callable[..., Path], load_c: Callable[..., ctypes.CDLL]
) -> None:
    program = planar_program()
    for name, text in render_kernels(program, "/* banner */").items():
        (tmp_path / name).write_text(text)
    library = load_c(compile_c(tmp_path / "kernels.c", raw=True))
    random = np.random.default_rng(0)
    for each in program.kernels:
        for _ in range(20):
            inputs = [random.uniform(-2, 2, a.shape) for a in each.inputs]
            sizes = [int(np.prod(a.shape, dtype=int)) for a in each.outputs]
            found = run(library, kernel_symbol("planar", each.name), inputs, sizes)
            expected = each.function.call([ca.DM(value) for value in inputs])
            for value, reference in zip(found, expected, strict=True):
                np.testing.assert_allclose(value, np.array(reference).ravel(), rtol=1e-14, atol=1e-14)


def test_casadi_integers_are_ints() -> None:
    assert "#define casadi_int int" in render_kernels(planar_program(), "")["kernels.c"]


def test_kernels_call_neither_fmax_nor_fmin(
    tmp_path: Path, compile_c: Callable[..., Path], load_c: Callable[..., ctypes.CDLL]
) -> None:
    for name, text in render_kernels(planar_program(), "/* banner */").items():
        (tmp_path / name).write_text(text)
    compiled = compile_c(tmp_path / "kernels.c", "-O2", raw=True)
    listing = subprocess.run(["nm", "-u", compiled], check=True, capture_output=True, text=True).stdout
    assert set(listing.split()) - {"U"} <= {"sin", "cos", "sincos", "sqrt", "_GLOBAL_OFFSET_TABLE_"}


def test_operations_are_counted_without_moves() -> None:
    counted = kernel("k", [argument("a"), argument("b")], [argument("c")], lambda a, b: [ca.sin(a) + 2 * b])
    assert operation_count(counted) == 3


def test_a_function_with_another_shape_than_declared_is_refused() -> None:
    wrong = kernel("approach_speed", [argument("distance")], [argument("speed")], lambda d: [d])
    wrong = replace(wrong, outputs=(argument("speed", 2),))
    with pytest.raises(GenerateError, match=r"output speed is declared \(2, 1\), its function has \(1, 1\)"):
        render_kernels(with_kernel(planar_program(), wrong), "")


def test_a_function_with_more_inputs_than_declared_is_refused() -> None:
    wrong = kernel(
        "approach_speed", [argument("d"), argument("k")], [argument("speed")], lambda d, k: [k * d]
    )
    wrong = replace(wrong, inputs=wrong.inputs[:1])
    with pytest.raises(GenerateError, match="1 inputs declared, its function has 2"):
        render_kernels(with_kernel(planar_program(), wrong), "")


def test_a_function_that_is_not_made_of_scalar_operations_is_refused() -> None:
    x = ca.MX.sym("x", 3, 3)
    function = ca.Function("f", [x], [ca.MX(3, 3) + ca.solve(x, x + 1, "lapacklu")])
    heavy = Kernel("heavy", "s", "e", (argument("x", 3, 3),), (argument("y", 3, 3),), function)
    with pytest.raises(GenerateError, match="heavy cannot be written as scalar operations"):
        render_kernels(replace(planar_program(), kernels=(heavy,)), "")
