"""`examples/embed`, built and run as its README says: no Python in the process, none in the environment."""

import os
import re
import shutil
from pathlib import Path

import pytest

from proxgen.builder.toolchain import run

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples" / "embed"
STRANGER = Path(__file__).parent / "data" / "stranger.c"
INTERRUPT = Path(__file__).parent / "data" / "interrupt.c"
SYSTEM = {"linux-vdso.so", "libm.so", "libc.so", "libstdc++.so", "libgcc_s.so"}


def call(*command: str | Path, **variables: str | Path) -> str:
    """Run a tool that has to succeed; nothing but the given variables in its environment."""
    settings = {"PATH": os.environ["PATH"], **variables}
    words = ["env", "-i", *(f"{name}={value}" for name, value in settings.items()), *map(str, command)]
    return run(words, f"{command[0]} failed")


def libraries(program: Path) -> set[str]:
    """Names of all libraries that are loaded into the process, without their versions."""
    listing = call("ldd", program)
    names = {re.sub(r"\.so\..*", ".so", Path(line.split()[0]).name) for line in listing.splitlines()}
    return {name for name in names if not name.startswith("ld-linux")}


def check_loop(output: str, deadlines: int) -> None:
    """Every deadline has a cycle or was left out, every cycle has a status; lateness is reported."""
    (cycles, skipped) = map(int, re.findall(r"cycles: (\d+) at 1 kHz, (\d+) deadlines left out", output)[0])
    (overruns, _) = map(int, re.findall(r"overruns: (\d+); started at most (\d+) us late", output)[0])
    assert cycles + skipped == deadlines
    assert cycles > 0
    assert overruns <= cycles
    assert sum(map(int, re.findall(r"^[A-Z_]+: (\d+)$", output, re.M))) == cycles


@pytest.fixture
def examples(tmp_path: Path) -> Path:
    """A copy of the example, as a project of its own."""
    return Path(shutil.copytree(EXAMPLES, tmp_path / "project"))


def test_cmake_project_with_shared_and_static_library(package: Path, examples: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    strict = "-Wall -Wextra -Wpedantic -Wconversion -Werror"
    flags = [f"-DCMAKE_C_FLAGS={strict}", f"-DCMAKE_CXX_FLAGS={strict}"]
    call("cmake", "-S", examples, "-B", out, f"-DCMAKE_PREFIX_PATH={package}", *flags)
    call("cmake", "--build", out)
    for name in ("loop", "loop_cpp"):
        assert libraries(out / name) <= SYSTEM | {"libiiwa7.so"}
        check_loop(call(out / name, "0.2"), 200)
    shutil.rmtree(package)
    assert libraries(out / "loop_static") <= SYSTEM
    check_loop(call(out / "loop_static", "0.2"), 200)


def test_makefile_with_pkg_config(package: Path, examples: Path, tmp_path: Path) -> None:
    search = package / "lib" / "pkgconfig"
    call("make", "-C", examples, f"PKG_CONFIG_PATH={search}", f"OUT={tmp_path / 'out'}")
    check_loop(call(tmp_path / "out" / "loop", "0.1"), 100)
    check_loop(call(tmp_path / "out" / "loop_cpp", "0.1"), 100)


@pytest.mark.parametrize("loop", ["loop", "loop_cpp"])
def test_signals_do_not_end_the_loop(loop: str, package: Path, examples: Path, tmp_path: Path) -> None:
    search, interrupt = package / "lib" / "pkgconfig", tmp_path / "interrupt.so"
    program = tmp_path / loop
    call("make", "-C", examples, f"PKG_CONFIG_PATH={search}", f"OUT={tmp_path}", program)
    call("cc", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", INTERRUPT, "-o", interrupt)
    check_loop(call(program, "0.1", LD_PRELOAD=interrupt), 100)


def test_the_loops_say_how_old_their_readings_are(package: Path, examples: Path, tmp_path: Path) -> None:
    """With readings that are never renewed, what they report is stale: a module that is off is noticed."""
    for name, renewed, once in (
        ("loop.c", "skin->cycle == 0 || skin->cycle % SKIN_EVERY == i % SKIN_EVERY", "skin->cycle == 0"),
        ("loop.cpp", "first || cycle_ % every == i % every", "first"),
    ):
        text = (examples / name).read_text()
        assert text.count(renewed) == 1
        (examples / name).write_text(text.replace(renewed, once))
    call("make", "-C", examples, f"PKG_CONFIG_PATH={package / 'lib' / 'pkgconfig'}", f"OUT={tmp_path}")
    for program in ("loop", "loop_cpp"):
        output = call(tmp_path / program, "0.4")
        check_loop(output, 400)
        assert re.search(r"^FAULT_STALE: \d+$", output, re.M)


def test_a_stranger_needs_forty_lines_and_one_command(package: Path, tmp_path: Path) -> None:
    assert len(STRANGER.read_text().splitlines()) <= 40
    search = package / "lib" / "pkgconfig"
    program = tmp_path / "stranger"
    script = f"cc -Wall -Wextra -Werror {STRANGER} -o {program} $(pkg-config --cflags --libs proxgen_iiwa7)"
    call("sh", "-c", script, PKG_CONFIG_PATH=search)
    (joint,) = re.findall(r"^150 cycles, 0 stops, joint 1 at (-?[\d.]+) rad$", call(program), re.M)
    assert float(joint) > 0.2


def test_the_readme_of_the_runtime_is_enough(package: Path, tmp_path: Path) -> None:
    """Its program, its command and its CMake lines, word for word but for the robot's name."""
    readme = (ROOT / "runtime" / "README.md").read_text()
    blocks = dict(re.findall(r"^```(c|sh|cmake)\n(.*?)^```", readme, re.M | re.S))
    named = {
        kind: re.sub(r"(?<![a-z])arm(?![a-z])", "iiwa7", text).replace("ARM_", "IIWA7_")
        for kind, text in blocks.items()
    }
    (tmp_path / "avoid.c").write_text(named["c"])
    head = "cmake_minimum_required(VERSION 3.16)\nproject(readme C)\n"
    (tmp_path / "CMakeLists.txt").write_text(head + named["cmake"])
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "iiwa7").symlink_to(package)
    call("sh", "-ec", f"cd {tmp_path}\n{named['sh']}")
    assert call(tmp_path / "avoid") == ""
    call("cmake", "-S", tmp_path, "-B", tmp_path / "out", f"-DCMAKE_PREFIX_PATH={tmp_path}/build/iiwa7")
    call("cmake", "--build", tmp_path / "out")
    assert call(tmp_path / "out" / "avoid") == ""


def test_the_readme_names_what_is_there() -> None:
    links = re.findall(r"\]\(([^)]+)\)", (EXAMPLES / "README.md").read_text())
    assert {"loop.c", "loop.cpp", "CMakeLists.txt", "Makefile"} <= set(links)
    assert all((EXAMPLES / link).exists() for link in links)
