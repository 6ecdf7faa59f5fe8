import ctypes
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from handmade import LOWER, UPPER, argument, kernel, planar_program, with_kernel

import proxgen
from proxgen.emit import generate, render
from proxgen.emit.folder import MARK
from proxgen.emit.rendering import ABI_VERSION
from proxgen.errors import GenerateError
from proxgen.program import CapsuleEntry, Program

ROOT = Path(__file__).resolve().parents[2]
FILES = {
    "README.md",
    "binding.h",
    "controller.h",
    "controller.hpp",
    "kernels.c",
    "kernels.h",
    "manifest.json",
    "model.c",
    "model.h",
}
READABLE = ("model.h", "model.c", "binding.h", "controller.h", "controller.hpp")

Compile = Callable[..., Path]
Load = Callable[..., ctypes.CDLL]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    generate(planar_program(), tmp_path / "planar")
    return tmp_path / "planar"


def compiled(folder: Path, compile_c: Compile) -> list[Path]:
    return [compile_c(folder / "model.c"), compile_c(folder / "kernels.c", raw=True)]


def test_the_folder_holds_the_files_that_the_contract_names(folder: Path) -> None:
    assert {path.name for path in folder.iterdir()} == FILES


def test_generated_text_is_the_same_on_every_run_and_in_every_process(folder: Path, tmp_path: Path) -> None:
    code = "import sys; from handmade import planar_program; from proxgen.emit import generate; "
    code += "generate(planar_program(), sys.argv[1])"
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parent), "PYTHONHASHSEED": "7"}
    again = tmp_path / "elsewhere" / "again"
    subprocess.run([sys.executable, "-c", code, str(again)], check=True, env=environment)
    for name in sorted(FILES):
        assert (again / name).read_bytes() == (folder / name).read_bytes(), name


def test_every_file_says_where_it_comes_from(folder: Path) -> None:
    for path in folder.iterdir():
        text = path.read_text()
        assert f"{MARK} {proxgen.__version__}" in text[:512], path.name
        assert planar_program().config_hash in text, path.name


def test_generated_text_names_no_date_and_no_path(folder: Path) -> None:
    for path in folder.iterdir():
        text = path.read_text()
        assert str(ROOT) not in text and str(Path.home()) + "/" not in text
        assert not re.search(r"\b20\d\d-\d\d-\d\d\b", text), path.name


@pytest.mark.parametrize("robot", ["a", "planar", "left_arm_of_two"])
def test_what_is_to_be_read_is_laid_out_by_clang_format(robot: str, tmp_path: Path) -> None:
    generate(planar_program(robot), tmp_path)
    clang_format = Path(sys.executable).parent / "clang-format"
    command: list[str | Path] = [
        clang_format,
        f"--style=file:{ROOT / '.clang-format'}",
        "--dry-run",
        "-Werror",
    ]
    subprocess.run([*command, *(tmp_path / name for name in READABLE)], check=True)


def test_a_urdf_may_call_its_joints_anything(compile_c: Callable[..., Path], tmp_path: Path) -> None:
    """Names end up in comments: one ended its comment, a backslash joined its line with the next."""
    names = ("a*/ int b; /*", "c\\")
    program = replace(planar_program(), joint_names=names, body_names=names)
    generate(program, tmp_path)
    compile_c(tmp_path / "model.c", "-trigraphs")
    for name in ("model.h", "model.c"):
        text = (tmp_path / name).read_text()
        assert "\\\n" not in text and "*/ int b" not in text
    assert "0 a* / int b; / *, 1 c/" in (tmp_path / "model.h").read_text()


@pytest.mark.parametrize("language", ["c", "c++"])
@pytest.mark.parametrize("header", ["model.h", "controller.h", "controller.hpp"])
def test_headers_compile_on_their_own(folder: Path, header: str, language: str, tmp_path: Path) -> None:
    if header.endswith("pp") and language == "c":
        language = "c++"
    compiler = os.environ.get("CC", "cc")
    standard = "c99" if language == "c" else "c++17"  # the least that a caller may have
    source = tmp_path / ("main.c" if language == "c" else "main.cpp")
    source.write_text(
        f'#include "{header}"\n#include "{header}"\nint main(void);\nint main(void) {{ return 0; }}\n'
    )
    warnings = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror", "-fsyntax-only"]
    warnings += ["-Wold-style-cast", "-Weffc++"] if language == "c++" else ["-Wstrict-prototypes"]
    include = [f"-I{folder}", f"-I{ROOT / 'runtime' / 'include'}"]
    command = [compiler, "-x", language, f"-std={standard}", *warnings, *include, str(source)]
    subprocess.run(command, check=True)


@pytest.mark.parametrize("call", ["controller.set(p)", "controller.get(p)", "controller.step({}, {}, {})"])
def test_what_a_call_says_is_not_to_be_overlooked_in_cxx(folder: Path, call: str, tmp_path: Path) -> None:
    source, include = tmp_path / "main.cpp", [f"-I{folder}", f"-I{ROOT / 'runtime' / 'include'}"]
    command = [os.environ.get("CC", "cc"), "-std=c++17", "-Werror", "-fsyntax-only", *include, str(source)]
    for statement, accepted in ((f"(void){call}", True), (call, False)):
        body = f"planar::Controller controller; planar::Parameters p{{}}; (void)p; {statement};"
        source.write_text(f'#include "controller.hpp"\nint main() {{ {body} }}\n')
        assert (subprocess.run(command, capture_output=True).returncode == 0) == accepted


class Kinematics(ctypes.Structure):
    _fields_ = (
        ("tool_to_world", ctypes.c_double * 12),
        ("body_to_world", ctypes.c_double * 24),
        ("joint_axis", ctypes.c_double * 6),
        ("joint_origin", ctypes.c_double * 6),
        ("J", ctypes.c_double * 4),
    )


def doubles(values: list[float]) -> "ctypes.Array[ctypes.c_double]":
    return (ctypes.c_double * len(values))(*values)


def test_the_readable_functions_give_the_closed_form(folder: Path, compile_c: Compile, load_c: Load) -> None:
    library = load_c(*compiled(folder, compile_c))
    q, found = doubles([0.3, 0.9]), Kinematics()
    assert library.planar_kinematics(q, ctypes.byref(found)) == 0
    a, b = 0.3, 0.3 + 0.9
    elbow = UPPER * np.array([np.cos(a), np.sin(a)])
    tool = elbow + LOWER * np.array([np.cos(b), np.sin(b)])
    pose = np.array(found.tool_to_world).reshape(3, 4)
    np.testing.assert_allclose(pose[:2, 3], tool, atol=1e-15)
    np.testing.assert_allclose(pose[:2, :2], [[np.cos(b), -np.sin(b)], [np.sin(b), np.cos(b)]], atol=1e-15)
    jacobian = np.array(found.J).reshape(2, 2)
    np.testing.assert_allclose(jacobian[:, 0], [-tool[1], tool[0]], atol=1e-15)
    np.testing.assert_allclose(jacobian[:, 1], [elbow[1] - tool[1], tool[0] - elbow[0]], atol=1e-15)

    row = doubles([9.0, 9.0])
    point, along_y = doubles([tool[0], tool[1], 0.0]), doubles([0.0, 1.0, 0.0])
    assert library.planar_row(0, ctypes.byref(found), point, along_y, row) == 0
    np.testing.assert_allclose(list(row), [tool[0], 0.0], atol=1e-15)
    assert library.planar_row(1, ctypes.byref(found), point, along_y, row) == 0
    np.testing.assert_allclose(list(row), jacobian[1], atol=1e-15)
    assert library.planar_row(2, ctypes.byref(found), point, along_y, row) == 1


def test_parameters_reach_their_kernels(folder: Path, compile_c: Compile, load_c: Load) -> None:
    library = load_c(*compiled(folder, compile_c))
    parameters = (ctypes.c_double * 7).in_dll(library, "planar_default_parameters")
    np.testing.assert_array_equal(list(parameters), [-1.5, -2.5, 1.5, 2.5, 0.1, 0.25, 1 / 3])
    speed = ctypes.c_double()
    library.planar_approach_speed.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p]
    assert library.planar_approach_speed(parameters, 3.0, ctypes.byref(speed)) == 0
    assert speed.value == 0.1 * 3.0
    lb, ub = doubles([0.0, 0.0]), doubles([0.0, 0.0])
    assert library.planar_bounds(parameters, doubles([0.5, -0.5]), doubles([0.0, 0.0]), lb, ub) == 0
    np.testing.assert_allclose([*lb, *ub], [-2.0, -2.0, 1.0, 3.0])


def test_two_robots_link_into_one_program(tmp_path: Path, compile_c: Compile, load_c: Load) -> None:
    objects = []
    for robot in ("left", "right"):
        generate(planar_program(robot), tmp_path / robot)
        objects += compiled(tmp_path / robot, compile_c)
    library = load_c(*objects)
    found = Kinematics()
    for robot in ("left", "right"):
        assert getattr(library, f"{robot}_kinematics")(doubles([0.0, 0.0]), ctypes.byref(found)) == 0
        assert found.tool_to_world[3] == UPPER + LOWER


def test_every_symbol_carries_the_robots_name(folder: Path, compile_c: Compile) -> None:
    for compiled_object in compiled(folder, compile_c):
        command = ["nm", "--defined-only", "--extern-only", str(compiled_object)]
        listing = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        names = [line.split()[-1] for line in listing.splitlines()]
        assert names and all(name.startswith("planar_") for name in names)


def test_another_abi_stops_the_compiler(folder: Path, tmp_path: Path) -> None:
    types = (ROOT / "runtime" / "include" / "proxgen" / "types.h").read_text()
    other = tmp_path / "other" / "proxgen"
    other.mkdir(parents=True)
    changed = types.replace(
        f"#define PG_ABI_VERSION {ABI_VERSION}\n", f"#define PG_ABI_VERSION {ABI_VERSION + 1}\n"
    )
    assert changed != types, "ABI_VERSION and types.h differ"
    (other / "types.h").write_text(changed)
    command = [os.environ.get("CC", "cc"), "-fsyntax-only", f"-I{other.parent}", str(folder / "model.c")]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode != 0
    assert "Regenerate planar: its code is for another version of proxgen/types.h" in result.stderr


def test_the_manifest_holds_what_a_program_needs(folder: Path) -> None:
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["robot"] == "planar" and manifest["abi"] == ABI_VERSION
    assert manifest["dimensions"] == {
        "joints": 2,
        "task_rows": 2,
        "bodies": 2,
        "capsules": 2,
        "tof": 1,
        "capacitive": 0,
        "max_points": 8,
        "rows": 3,
    }
    assert [p["name"] for p in manifest["parameters"]] == ["q_lower", "q_upper", "damping_gain", "weight"]
    assert manifest["parameters"][0]["default"] == [-1.5, -2.5]
    assert [f["name"] for f in manifest["functions"]][:2] == ["planar_kinematics", "planar_sensor_point"]


def test_the_readme_lists_every_parameter_and_capsule(folder: Path) -> None:
    text = (folder / "README.md").read_text()
    for name in ("q_lower", "damping_gain", "upper_arm", "forearm", "proxgen generate planar.yaml"):
        assert name in text


def broken(**changes: object) -> Program:
    return replace(planar_program(), **changes)  # type: ignore[arg-type]


def test_a_program_without_a_required_kernel_is_refused() -> None:
    kernels = tuple(k for k in planar_program().kernels if k.name != "bounds")
    with pytest.raises(GenerateError, match="no kernel 'bounds', which the runtime calls"):
        render(broken(kernels=kernels))


def test_an_unknown_parameter_is_refused_with_the_nearest_name() -> None:
    inputs = [argument("distance"), argument("damping_gian", parameter=True)]
    wrong = kernel("approach_speed", inputs, [argument("speed")], lambda d, k: [k * d])
    with pytest.raises(GenerateError, match="did you mean 'damping_gain'"):
        render(with_kernel(planar_program(), wrong))


def test_a_parameter_of_another_shape_is_refused() -> None:
    inputs = [argument("distance"), argument("weight", parameter=True)]
    wrong = kernel("approach_speed", inputs, [argument("speed")], lambda d, k: [k * d])
    with pytest.raises(GenerateError, match=r"parameter weight has shape \(2,\), not \(\)"):
        render(with_kernel(planar_program(), wrong))


def test_row_kernels_with_different_arguments_are_refused() -> None:
    wrong = kernel("row_1", [argument("point", 3)], [argument("row", 2)], lambda p: [p[:2]])
    with pytest.raises(GenerateError, match="row_0 and row_1 differ"):
        render(with_kernel(planar_program(), wrong))


def test_a_capsule_on_a_body_that_does_not_exist_is_refused() -> None:
    capsule = CapsuleEntry("tail", 7, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.1, 0.0)
    with pytest.raises(GenerateError, match="tail is on body 7; there are only 2"):
        render(broken(capsules=(capsule,)))


def test_a_parameter_with_too_few_values_is_refused() -> None:
    first, *others = planar_program().parameters
    with pytest.raises(GenerateError, match="q_lower has 1 values for 2 entries"):
        render(broken(parameters=(replace(first, default=(0.0,)), *others)))


def test_a_robot_whose_name_is_a_keyword_is_refused() -> None:
    with pytest.raises(GenerateError, match="'double' cannot be a name in C"):
        render(planar_program("double"))
