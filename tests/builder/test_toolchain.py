import sys
from pathlib import Path

import pytest

from proxgen.builder.toolchain import command_identity, find_toolchain, run, run_all
from proxgen.errors import BuildError


@pytest.mark.usefixtures("no_compilers")
def test_a_missing_c_compiler_says_what_to_install() -> None:
    with pytest.raises(BuildError, match=r"no C compiler found.*apt-get install gcc.*variable CC"):
        find_toolchain(cxx=False)


@pytest.mark.usefixtures("no_compilers")
def test_a_missing_cxx_compiler_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", sys.executable)
    with pytest.raises(BuildError, match=r"no C\+\+ compiler found.*apt-get install g\+\+.*variable CXX"):
        find_toolchain(cxx=True)


@pytest.mark.usefixtures("no_compilers")
def test_no_cxx_compiler_is_needed_for_plain_c(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", sys.executable)
    assert find_toolchain(cxx=False).linker == (sys.executable,)


def test_a_compiler_that_is_named_but_not_there_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler -m64")
    with pytest.raises(BuildError, match="'no-such-compiler', which CC names, is not there"):
        find_toolchain(cxx=False)


def test_flags_of_the_environment_come_after_ours(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", f"{sys.executable} -x")
    monkeypatch.setenv("CFLAGS", "-O0 -DTEXT='two words'")
    command = find_toolchain(cxx=False).compile_command(Path("a.c"))
    assert command[:2] == (sys.executable, "-x")
    assert command[-2:] == ("-O0", "-DTEXT=two words")
    assert command.index("-O3") < command.index("-O0")


def test_fast_math_is_never_asked_for() -> None:
    toolchain = find_toolchain(cxx=True)
    for name in ("a.c", "a.cpp"):
        assert not any("fast-math" in word for word in toolchain.compile_command(Path(name)))


def test_an_updated_compiler_is_another_one(tmp_path: Path) -> None:
    compiler = tmp_path / "cc"
    compiler.write_text("#!/bin/sh\n")
    compiler.chmod(0o755)
    before = command_identity((str(compiler), "-O2"))
    assert command_identity((str(compiler), "-O2")) == before
    compiler.write_text("#!/bin/sh\n# new\n")
    assert command_identity((str(compiler), "-O2")) != before


def test_a_failing_tool_shows_all_that_it_said() -> None:
    script = (
        "import sys; print('out' * 9999); sys.stdout.flush(); print('cause', file=sys.stderr); sys.exit(3)"
    )
    with pytest.raises(BuildError) as failure:
        run([sys.executable, "-c", script], "it failed")
    assert failure.value.command == (sys.executable, "-c", script)
    assert "out" * 9999 in failure.value.output and "cause" in failure.value.output
    assert str(failure.value).startswith("it failed\ncommand: ") and "cause" in str(failure.value)


def test_a_tool_that_is_not_there_is_an_error_of_ours() -> None:
    with pytest.raises(BuildError, match="cannot link: No such file"):
        run(["no-such-linker"], "cannot link")


def test_all_jobs_run_and_the_first_failure_is_told(tmp_path: Path) -> None:
    touch = "import sys, pathlib; pathlib.Path(sys.argv[1]).touch(); sys.exit(int(sys.argv[2]))"
    jobs = [
        ([sys.executable, "-c", touch, str(tmp_path / str(i)), str(int(i in (1, 3)))], f"job {i} failed")
        for i in range(5)
    ]
    with pytest.raises(BuildError, match="job 1 failed"):
        run_all(jobs)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["0", "1", "2", "3", "4"]
