from collections.abc import Iterable, Sequence
from pathlib import Path

import pytest

from proxgen.builder import objects
from proxgen.builder.objects import Unit, compile_units
from proxgen.builder.sources import runtime_units
from proxgen.builder.toolchain import find_toolchain, run_all
from proxgen.errors import BuildError


class Project:
    """Two sources, one of which includes a header."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.cache, self.work = folder, folder / "cache", folder / "work"
        self.work.mkdir()
        self.write("plain.c", "int plain(void) { return 1; }\n")
        self.write("user.c", '#include "size.h"\nint user(void) { return SIZE; }\n')
        self.write("size.h", "#define SIZE 1\n")

    def write(self, name: str, text: str) -> None:
        (self.folder / name).write_text(text)

    def units(self) -> list[Unit]:
        header = self.folder / "size.h"
        return [
            Unit(self.folder / "plain.c", (), ()),
            Unit(self.folder / "user.c", (self.folder,), (header,)),
        ]

    def compile(self) -> list[str]:
        """Names of the objects."""
        made = compile_units(self.units(), self.cache, self.work, find_toolchain(cxx=False))
        assert all(path.is_file() for path in made)
        assert not any(self.work.iterdir())
        return [path.name for path in made]


@pytest.fixture
def project(tmp_path: Path) -> Project:
    return Project(tmp_path)


def test_objects_come_in_the_order_of_the_units(project: Project) -> None:
    first, second = project.compile()
    assert first.startswith("plain-") and second.startswith("user-")


def test_only_what_changed_is_compiled_again(project: Project, monkeypatch: pytest.MonkeyPatch) -> None:
    compiled: list[str] = []

    def watch(jobs: Iterable[tuple[Sequence[str], str]]) -> None:
        listed = list(jobs)
        compiled.extend(message.split()[0] for _, message in listed)
        run_all(listed)

    monkeypatch.setattr(objects, "run_all", watch)
    before = project.compile()
    assert sorted(compiled) == ["plain.c", "user.c"]
    compiled.clear()
    assert project.compile() == before and compiled == []
    project.write("size.h", "#define SIZE 2\n")
    after = project.compile()
    assert compiled == ["user.c"]
    assert (before[0] == after[0], before[1] == after[1]) == (True, False)
    compiled.clear()
    project.write("size.h", "#define SIZE 1\n")
    assert project.compile() == before and compiled == [], "the objects of the build before are still there"


def test_other_flags_make_other_objects(project: Project, monkeypatch: pytest.MonkeyPatch) -> None:
    before = project.compile()
    monkeypatch.setenv("CFLAGS", "-g")
    assert set(project.compile()).isdisjoint(before)


def test_a_refused_file_is_told_whole_and_leaves_no_object(project: Project) -> None:
    project.write("user.c", "int user(void) { return nobody_knows; }\n#error second complaint\n")
    with pytest.raises(BuildError, match=r"user\.c could not be compiled") as failure:
        project.compile()
    assert "nobody_knows" in failure.value.output and "second complaint" in failure.value.output
    assert not list(project.cache.glob("user-*"))


def test_only_the_chosen_back_end_is_compiled() -> None:
    names = {backend: {path.name for path in runtime_units(backend)} for backend in ("daqp", "qpoases")}
    assert names["daqp"] ^ names["qpoases"] == {"solver_daqp.c", "solver_qpoases.cpp"}
    assert {"cycle.c", "ladder.c"} <= names["daqp"]


def test_other_options_make_another_object(project: Project) -> None:
    """The same source, and the object of the other options in the cache."""
    toolchain, source = find_toolchain(cxx=False), project.folder / "plain.c"
    made = [
        compile_units([Unit(source, (), (), options)], project.cache, project.work, toolchain)[0]
        for options in ((), ("-Dplain=other",))
    ]
    assert made[0] != made[1]
    assert b"other" in made[1].read_bytes() and b"other" not in made[0].read_bytes()
