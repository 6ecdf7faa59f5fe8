"""The floor plan of docs/architecture.md, held by parsing the sources: imports, and the length of things."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "proxgen"
PYTHON_FILES = sorted(PACKAGE.rglob("*.py"))
TEST_FILES = sorted((ROOT / "tests").rglob("*.py"))

MAX_FILE_LINES = 400
MAX_FUNCTION_LINES = 80

_TABLE = re.findall(
    r"^\| `([\w.]+)` \|[^|]*\| ([\w., ]+) \|$", (ROOT / "docs" / "architecture.md").read_text(), re.M
)

ARROWS: dict[str, set[str]] = {
    room: set() if allowed == "nothing" else set(allowed.split(", "))
    for room, allowed in _TABLE
    if allowed != "everything"
}
"""Room -> rooms that it may import, as docs/architecture.md says. A room is a folder or a file of proxgen/;
each controller is a room of its own: the two sides of the comparison owe their independence to this table."""

ROOFS = {room for room, allowed in _TABLE if allowed == "everything"} | {"__init__", "__main__"}
"""Rooms that put the others together, so that they may import all of them."""

# Heavy library -> the only places that may import it.
LIBRARIES: dict[str, set[str]] = {
    "pybullet": {"simulation.world"},
    "pybullet_data": {"simulation.world"},
    "ruckig": {"simulation.cabinet"},
    "casadi": {"symbolic", "emit"},
    "pinocchio": {"model", "symbolic", "controllers.reference", "bench.peers.with_pink"},
    "quadprog": {"controllers.reference", "scaffold.fit"},
    "coal": {"scaffold.meshes"},
    "matplotlib": {"report", "reproduce.figures"},
    "PIL": {"report"},
    "rich": {"cli"},
    "yaml": {"config"},
}


def module_name(path: Path) -> str:
    """Dotted name below proxgen; a package is named after its folder."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts)


def within(module: str, place: str) -> bool:
    """True if the module is the place, or lies in it."""
    return module == place or module.startswith(place + ".")


@cache
def is_module(name: str) -> bool:
    """True if proxgen.NAME is a module or a package."""
    path = PACKAGE.joinpath(*name.split("."))
    return path.with_suffix(".py").is_file() or (path / "__init__.py").is_file()


@cache
def imports_of(path: Path) -> tuple[str, ...]:
    """Every module that the file imports, anywhere in it: lazily, and for type checking, too."""
    names: list[str] = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative imports hide the arrows"
            for alias in node.names:
                full = f"{node.module}.{alias.name}"
                inner = full.startswith("proxgen.") and is_module(full.removeprefix("proxgen."))
                names.append(full if inner else str(node.module))
    return tuple(names)


def room_of(module: str) -> str:
    """The room in which a module below proxgen lies."""
    rooms = [room for room in ARROWS if within(module, room)]
    return max(rooms, key=len) if rooms else module.split(".")[0]


def test_the_table_says_what_matters_most() -> None:
    assert len(ARROWS) + len(ROOFS) >= 18
    assert not ARROWS["controllers.reference"] & {"symbolic", "program", "emit", "builder"}
    assert ARROWS["controllers.compiled"] == {"errors", "controllers.protocol"}
    assert ARROWS["emit"] == {"errors", "program", "templates"}


def test_every_room_has_its_arrows() -> None:
    rooms = {room_of(module_name(path)) for path in PYTHON_FILES}
    # controllers/__init__.py is a doorway and holds nothing; the baselines build upon the reference.
    assert rooms <= set(ARROWS) | ROOFS | {"controllers"}


@pytest.mark.parametrize("path", PYTHON_FILES, ids=module_name)
def test_imports_follow_the_arrows(path: Path) -> None:
    room = room_of(module_name(path))
    if room in ROOFS:
        return
    allowed = ARROWS[room] | {room} if room in ARROWS else set()
    inner = [name.removeprefix("proxgen.") for name in imports_of(path) if name.startswith("proxgen.")]
    wrong = [name for name in inner if room_of(name) not in allowed]
    assert not wrong, f"{room} may import {sorted(allowed)}, not {wrong}"


def inner_imports(*rooms: str) -> set[str]:
    """What the files of some rooms import of proxgen, those rooms themselves left out."""
    files = [path for path in PYTHON_FILES if room_of(module_name(path)) in rooms]
    names = {name.removeprefix("proxgen.") for path in files for name in imports_of(path)}
    return {name for name in names if is_module(name) and room_of(name) not in rooms}


def test_what_both_sides_of_the_comparison_share() -> None:
    """An error here is in both, so that comparing does not show it: each module has tests from outside.

    Model and Drive tables: tests/model/test_model_from_outside.py, by pybullet. Values of parameters:
    tests/controllers/test_parameters_from_the_file.py. `to_pin` is the reference's alone.
    """
    reference = inner_imports("controllers.reference") - {"controllers.protocol", "errors"}
    generated = inner_imports("symbolic", "program", "emit") - {"errors", "model", "templates"}
    shared = {"config.schema", "config.ranges", "config.settable", "model.robot_model"}
    assert reference == shared | {"model.kinematics"}
    assert generated == shared | {"model.frames", "config.hashing"}


@pytest.mark.parametrize("library", LIBRARIES)
def test_libraries_stay_in_their_rooms(library: str) -> None:
    users = {
        module_name(path) for path in PYTHON_FILES if any(within(name, library) for name in imports_of(path))
    }
    strangers = {user for user in users if not any(within(user, place) for place in LIBRARIES[library])}
    assert not strangers


def test_the_parser_sees_lazy_and_nested_imports(tmp_path: Path) -> None:
    source = tmp_path / "lazy.py"
    source.write_text(
        "def f():\n    import pybullet as p\n    from proxgen.model import robot_model\n    return p\n"
    )
    assert imports_of(source) == ("pybullet", "proxgen.model.robot_model")


def loaded_modules(statement: str) -> set[str]:
    """Top-level modules in a fresh interpreter after the statement."""
    script = f"{statement}\nimport sys\nprint(*sorted({{name.split('.')[0] for name in sys.modules}}))"
    return set(
        subprocess.run(
            [sys.executable, "-c", script], check=True, capture_output=True, text=True
        ).stdout.split()
    )


def test_compiled_controller_needs_neither_casadi_nor_pinocchio() -> None:
    loaded = loaded_modules("import proxgen.controllers.compiled")
    assert "numpy" in loaded
    assert not loaded & {
        "casadi",
        "pinocchio",
        "coal",
        "hppfcl",
        "pybullet",
        "matplotlib",
        "pydantic",
        "yaml",
        "quadprog",
    }


def test_command_line_starts_without_heavy_libraries() -> None:
    loaded = loaded_modules("import proxgen.cli")
    assert not loaded & {"casadi", "pinocchio", "pybullet", "matplotlib", "quadprog", "scipy"}


def test_only_the_command_line_prints_or_exits() -> None:
    found = []
    for path in PYTHON_FILES:
        if within(module_name(path), "cli"):
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            name = ast.unparse(node.func) if isinstance(node, ast.Call) else ""
            if name in {
                "print",
                "exit",
                "quit",
                "sys.exit",
                "os._exit",
                "sys.stdout.write",
                "sys.stderr.write",
            }:
                found.append(f"{module_name(path)}:{node.lineno} {name}")  # type: ignore[attr-defined]
    assert not found


def c_sources(*folders: str) -> list[Path]:
    """C and C++ files below the folders."""
    suffixes = {".c", ".h", ".cpp", ".hpp"}
    return [
        path for folder in folders for path in sorted((ROOT / folder).rglob("*")) if path.suffix in suffixes
    ]


def test_only_one_file_includes_qpoases() -> None:
    including = [
        path.relative_to(ROOT).as_posix()
        for path in c_sources("runtime", "generated", "examples", "proxgen")
        if re.search(r"#\s*include\s*[<\"]qpOASES", path.read_text())
    ]
    assert including == ["runtime/src/solver_qpoases.cpp"]


def test_runtime_knows_no_robot() -> None:
    robots = [path.name for path in sorted((ROOT / "generated").iterdir()) if path.is_dir()]
    assert robots
    named = re.compile("|".join(robots), re.IGNORECASE)
    wrong = [
        path.name for path in c_sources("runtime/include", "runtime/src") if named.search(path.read_text())
    ]
    assert not wrong


def test_generated_code_knows_no_solver() -> None:
    sources = c_sources("generated")
    assert sources
    wrong = [
        path.as_posix()
        for path in sources
        if re.search(r"#\s*include\s*[<\"](qpOASES|daqp)", path.read_text())
    ]
    assert not wrong


def functions(path: Path) -> Iterator[tuple[str, int]]:
    """Name and length in lines of every function in the file."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name, (node.end_lineno or node.lineno) - node.lineno + 1


def test_files_and_functions_are_short() -> None:
    sources = [*PYTHON_FILES, *TEST_FILES, *c_sources("runtime", "examples")]
    long_files = {
        path.name: lines for path in sources if (lines := path.read_text().count("\n")) > MAX_FILE_LINES
    }
    assert not long_files, "a room is missing"
    long_functions = {
        f"{path.name}:{name}": length
        for path in sources
        if path.suffix == ".py"
        for name, length in functions(path)
        if length > MAX_FUNCTION_LINES
    }
    assert not long_functions
