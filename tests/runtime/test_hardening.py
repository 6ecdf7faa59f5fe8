"""The C sources under strict compilers and their analysers, and the fuzzer's corpus without a fuzzer.

`make sanitize` runs this again with clang.
"""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from proxgen.builder.program import compile_program
from proxgen.builder.solvers import find_solver
from proxgen.builder.toolchain import find_toolchain, run, run_all

ROOT = Path(__file__).resolve().parents[2]
RUNTIME = ROOT / "runtime"
ROBOTS = sorted(path.parent.name for path in (ROOT / "generated").glob("*/model.c"))
STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
PICKY = ["-Wshadow", "-Wundef", "-Wcast-align", "-Wcast-qual", "-Wredundant-decls"]
PICKY += ["-Wsign-conversion", "-Wdouble-promotion"]
"""What the project that compiles a controller's sources may ask for besides; our tests do not."""
EMBED = ROOT / "examples" / "embed" / "elsewhere"


def programs(robot: str) -> list[Path]:
    """C that is written around the controllers, as far as it fits a robot of `generated/`."""
    programs = [RUNTIME / "bench" / "replay.c", *(RUNTIME / "fuzz").glob("*.c")]
    programs += [RUNTIME / "tests" / name for name in ("random_cycles.c", "test_threads.c")]
    return programs + ([*EMBED.glob("*.c")] if robot == "iiwa7" else [])


def checks(source: Path, command: list[str], compiler: tuple[str, ...]) -> Iterator[list[str]]:
    """What has to pass without a word: the warnings; for the controller itself, the analyser, too."""
    ours = source.is_relative_to(RUNTIME / "src") or source.name == "model.c"
    picky = PICKY if ours else []
    if "clang" in run([*compiler, "--version"], "the compiler does not run"):
        yield [*command, *STRICT, *picky]
        if ours:
            yield [*command, "--analyze", "--analyzer-output", "text", "-Xclang", "-analyzer-werror"]
    else:  # gcc's analyser does not know C++
        yield [*command, *STRICT, *picky, *(["-fanalyzer"] if ours and source.suffix == ".c" else [])]


@pytest.mark.parametrize("robot", ROBOTS)
def test_sources_are_clean(robot: str) -> None:
    toolchain, generated = find_toolchain(cxx=True), ROOT / "generated" / robot
    include = [f"-I{folder}" for folder in (generated, RUNTIME / "include", RUNTIME / "src")]
    for name in ("daqp", "qpoases"):
        include += ["-isystem", str(find_solver(name).include)]
    jobs = []
    for source in (generated / "model.c", *(RUNTIME / "src").glob("*.c*"), *programs(robot)):
        command = [*toolchain.compile_command(source), *include, "-c", str(source), "-o", os.devnull]
        compiler = toolchain.cc if source.suffix == ".c" else toolchain.cxx
        jobs += [(check, f"{source.name} is not clean") for check in checks(source, command, compiler)]
    run_all(jobs)


@pytest.mark.parametrize("backend", ["daqp", "qpoases"])
def test_the_corpus_of_the_fuzzer_breaks_no_promise(backend: str, tmp_path: Path) -> None:
    corpus = sorted((RUNTIME / "fuzz" / "corpus").iterdir())
    assert len(corpus) > 100
    main, generated = RUNTIME / "fuzz" / "replay_corpus.c", ROOT / "generated" / "planar2"
    program = compile_program(main, generated, backend, tmp_path / "replay_corpus")
    assert run([str(program), *map(str, corpus)], "a promise is broken") == f"{len(corpus)} inputs\n"
