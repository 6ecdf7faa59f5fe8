"""What a build leaves, used as a stranger would: from C and C++, by pkg-config and CMake, without Python."""

import os
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest

from proxgen.builder import BuildResult, build
from proxgen.config.schema import Config

STEP = """
#include <{robot}/controller.h>

int step_{robot}(void);
int step_{robot}(void) {{
  static const double q[{X}_JOINTS] = {{0.1, 0.6}};
  static const double xdot[{X}_TASK_ROWS] = {{0.01}};
  double range[{X}_TOF + 1], qdot[{X}_JOINTS];
  unsigned char closed[{X}_CAPACITIVE + 1] = {{0}};
  for (int i = 0; i < {X}_TOF; i++) range[i] = {robot}_tof[i].range;
  {robot}_measurement_t seen = {{0}};
  seen.time = 1.0;
  seen.tof_range = range;
  seen.capacitive = closed;
  {robot}_controller_t *controller;
  if ({robot}_create(&controller) != PG_SOLVED) return 1;
  pg_status_t status = {robot}_step(controller, q, xdot, &seen, qdot);
  if ({robot}_destroy(controller) != PG_SOLVED) return 2;
  return status == PG_SOLVED && qdot[0] == qdot[0] ? 0 : 3;
}}
"""
STRICT = ("-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")


def call(command: Sequence[str | Path], **variables: str) -> str:
    """Run a tool that has to succeed; nothing of Python's in its environment."""
    environment = {"PATH": os.environ["PATH"], **variables}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def program(folder: Path, *robots: str) -> list[Path]:
    """A C program that makes one step with each robot."""
    for robot in robots:
        (folder / f"{robot}.c").write_text(STEP.format(robot=robot, X=robot.upper()))
    declared = "".join(f"int step_{robot}(void);\n" for robot in robots)
    called = " + ".join(f"step_{robot}()" for robot in robots)
    (folder / "main.c").write_text(f"{declared}int main(void);\nint main(void) {{ return {called}; }}\n")
    return [folder / "main.c", *(folder / f"{robot}.c" for robot in robots)]


@pytest.fixture
def moved(planar2_daqp: BuildResult, tmp_path: Path) -> Path:
    """A build folder that was moved after it was built."""
    shutil.copytree(planar2_daqp.library_dir, tmp_path / "moved")
    return tmp_path / "moved"


@pytest.fixture(scope="session")
def iiwa7_moved(iiwa7_qpoases: BuildResult, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same with qpOASES, which moves along."""
    target = tmp_path_factory.mktemp("iiwa7") / "moved"
    shutil.copytree(iiwa7_qpoases.library_dir, target)
    return target


@pytest.mark.parametrize("robot", ["planar2", "iiwa7"])
def test_a_c_program_needs_pkg_config_only(
    robot: str, moved: Path, iiwa7_moved: Path, tmp_path: Path
) -> None:
    folder = {"planar2": moved, "iiwa7": iiwa7_moved}[robot]
    search = {"PKG_CONFIG_PATH": str(folder / "lib" / "pkgconfig")}
    flags = call(["pkg-config", "--cflags", "--libs", f"proxgen_{robot}"], **search).split()
    target = tmp_path / "program"
    call(["cc", *STRICT, *program(tmp_path, robot), *flags, "-o", target])
    call([target])


def test_the_package_can_be_linked_statically(moved: Path, iiwa7_moved: Path, tmp_path: Path) -> None:
    for robot, folder in (("planar2", moved), ("iiwa7", iiwa7_moved)):
        search = {"PKG_CONFIG_PATH": str(folder / "lib" / "pkgconfig")}
        flags = call(["pkg-config", "--cflags", "--libs", "--static", f"proxgen_{robot}"], **search).split()
        flags = [str(folder / "lib" / f"lib{robot}.a") if flag == f"-l{robot}" else flag for flag in flags]
        target = tmp_path / robot
        call(["cc", *STRICT, *program(tmp_path, robot), *flags, "-o", target])
        call([target])
        assert f"lib{robot}.so" not in call(["readelf", "-d", target])


CMAKE = """
cmake_minimum_required(VERSION 3.16)
project(stranger C CXX)
find_package(proxgen_{robot} 0.1 REQUIRED)
add_executable(shared main.c {robot}.c)
target_link_libraries(shared PRIVATE proxgen_{robot}::{robot})
add_executable(static main.c {robot}.c)
target_link_libraries(static PRIVATE proxgen_{robot}::{robot}_static)
add_executable(cxx main.cpp)
target_compile_features(cxx PRIVATE cxx_std_17)
target_link_libraries(cxx PRIVATE proxgen_{robot}::{robot})
"""
CPP = """
#include <{robot}/controller.hpp>
int main() {{
  {robot}::Controller controller;
  if (!controller) return 1;
  {robot}::Measurement seen;
  seen.time = 1.0;
  return controller.step({{0.1, 0.6}}, {{0.01}}, seen).stopped() ? 2 : 0;
}}
"""


@pytest.mark.parametrize("robot", ["planar2", "iiwa7"])
def test_a_cmake_project_finds_the_package(
    robot: str, moved: Path, iiwa7_moved: Path, tmp_path: Path
) -> None:
    folder = {"planar2": moved, "iiwa7": iiwa7_moved}[robot]
    program(tmp_path, robot)
    (tmp_path / "CMakeLists.txt").write_text(CMAKE.format(robot=robot))
    (tmp_path / "main.cpp").write_text(CPP.format(robot=robot))
    out = tmp_path / "out"
    call(["cmake", "-S", str(tmp_path), "-B", str(out), f"-DCMAKE_PREFIX_PATH={folder}"])
    call(["cmake", "--build", str(out)])
    for name in ("shared", "static", "cxx"):
        call([tmp_path / "out" / name])


@pytest.mark.parametrize("another", ["version", "processor"])
def test_cmake_refuses_what_does_not_fit(another: str, moved: Path, tmp_path: Path) -> None:
    asked = {"version": "", "processor": "set(CMAKE_SIZEOF_VOID_P 4)\n"}[another]
    number = {"version": "99", "processor": ""}[another]
    (tmp_path / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.16)\nproject(stranger NONE)\n{asked}"
        f"find_package(proxgen_planar2 {number} PATHS {moved})\n"
        "if(proxgen_planar2_FOUND)\n  message(FATAL_ERROR found)\nendif()\n"
    )
    call(["cmake", "-S", tmp_path, "-B", tmp_path / "out"])


@pytest.mark.parametrize("kind", ["so", "a"])
def test_two_robots_with_different_solvers_live_in_one_program(
    kind: str, moved: Path, iiwa7_moved: Path, tmp_path: Path
) -> None:
    include = [f"-I{folder / 'include'}" for folder in (moved, iiwa7_moved)]
    libraries = [moved / "lib" / f"libplanar2.{kind}", iiwa7_moved / "lib" / f"libiiwa7.{kind}"]
    solver = next((iiwa7_moved / "lib").glob("libqpOASES.so.*"))
    search = [f"-Wl,-rpath,{folder / 'lib'}" for folder in (moved, iiwa7_moved)]
    sources = program(tmp_path, "planar2", "iiwa7")
    target = tmp_path / "program"
    call(["cc", *STRICT, *sources, *include, *libraries, solver, "-lstdc++", "-lm", *search, "-o", target])
    call([target])


def test_two_robots_with_the_same_solver_live_in_one_program(
    moved: Path, planar2_config: Config, tmp_path: Path
) -> None:
    robot = planar2_config.robot.model_copy(update={"name": "other"})
    other = build(planar2_config.model_copy(update={"robot": robot}), tmp_path / "other", backend="daqp")
    include = [f"-I{folder / 'include'}" for folder in (moved, other.library_dir)]
    libraries = [moved / "lib" / "libplanar2.a", other.library_dir / "lib" / "libother.a"]
    target = tmp_path / "program"
    sources = program(tmp_path, "planar2", "other")
    call(["cc", *STRICT, *sources, *include, *libraries, "-lm", "-o", target])
    call([target])


def defined(library: Path, *options: str) -> set[str]:
    """Names that a library defines for others."""
    listing = call(["nm", "--defined-only", "--extern-only", *options, library])
    return {line.split()[2] for line in listing.splitlines() if len(line.split()) == 3}


def test_only_public_names_leave_a_library(moved: Path, iiwa7_moved: Path) -> None:
    for robot, folder in (("planar2", moved), ("iiwa7", iiwa7_moved)):
        shared = defined(folder / "lib" / f"lib{robot}.so", "--dynamic")
        static = defined(folder / "lib" / f"lib{robot}.a")
        assert {f"{robot}_step", f"{robot}_create_checked", f"{robot}_kinematics"} <= shared
        for names in (shared, static):
            assert all(name.startswith(f"{robot}_") for name in names)
            assert not any("kernel" in name or "internal" in name for name in names)


def test_daqp_needs_neither_heap_nor_cxx_runtime(moved: Path) -> None:
    listing = call(["nm", "--undefined-only", moved / "lib" / "libplanar2.a"])
    needed = {
        member: {line.split()[-1] for line in lines.splitlines() if " U " in line} - {"_GLOBAL_OFFSET_TABLE_"}
        for member, lines in re.findall(r"^(\w+\.o):\n(.*?)(?:\n\n|\Z)", listing, re.M | re.S)
    }
    assert set(needed) == {"libplanar2.o", "heap.o"}
    allowed = {"memset", "memcpy", "memmove", "memcmp", "sin", "cos", "sincos", "sqrt"}
    assert needed["libplanar2.o"] <= allowed
    # What create needs, and create_in does without.
    assert needed["heap.o"] == {"malloc", "free", "planar2_create_in_checked"}


def test_nothing_in_the_package_names_this_machine(moved: Path, planar2_daqp: BuildResult) -> None:
    for path in moved.rglob("*"):
        if path.is_file() and path.relative_to(moved).parts[0] != ".proxgen":
            assert str(planar2_daqp.library_dir.parent).encode() not in path.read_bytes(), path
