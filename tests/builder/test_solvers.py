import hashlib
import io
import tarfile
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path

import pytest

from proxgen.builder import fetch_daqp
from proxgen.builder.fetch_daqp import fetch
from proxgen.builder.solvers import DAQP_VERSION, find_solver
from proxgen.errors import BuildError


def test_qpoases_is_found_where_pip_put_it() -> None:
    solver = find_solver("qpoases")
    assert solver.cxx and solver.units == ()
    assert solver.library is not None and solver.library.is_file()
    assert (solver.include / "qpOASES.hpp") in solver.headers
    assert solver.version == metadata.version("cmeel-qpoases")


def test_daqp_is_its_method_without_its_interfaces() -> None:
    solver = find_solver("daqp")
    assert not solver.cxx and solver.library is None
    assert [path.name for path in solver.units] == ["daqp.c", "auxiliary.c", "factorization.c"]
    assert solver.licence is not None and "MIT" in solver.licence.read_text()


def test_an_unknown_back_end_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(BuildError, match="unknown back end 'qpoasis'; did you mean 'qpoases'"):
        find_solver("qpoasis")


def test_missing_daqp_sources_name_the_command_that_gets_them(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PROXGEN_DAQP_SOURCE", str(tmp_path))
    with pytest.raises(BuildError, match=r"python -m proxgen\.builder\.fetch_daqp"):
        find_solver("daqp")


def test_missing_qpoases_names_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    def nothing(name: str) -> None:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "files", nothing)
    with pytest.raises(BuildError, match="pip install cmeel-qpoases"):
        find_solver("qpoases")


def archive(**content: str) -> bytes:
    """A source distribution with some files."""
    memory = io.BytesIO()
    with tarfile.open(fileobj=memory, mode="w:gz") as tar:
        for name, text in content.items():
            info = tarfile.TarInfo(f"daqp-{DAQP_VERSION}/" + name.replace("__", "/").replace("_dot_", "."))
            info.size = len(text)
            tar.addfile(info, io.BytesIO(text.encode()))
    return memory.getvalue()


ARCHIVE = archive(csrc__include__daqp_dot_h="/* header */", LICENSE="MIT", setup_dot_py="never run")


def pretend_pip(monkeypatch: pytest.MonkeyPatch, brings: bytes, known: bytes) -> list[Sequence[str]]:
    """Let pip 'download' something, and expect the digest of `known`."""
    commands: list[Sequence[str]] = []

    def run(command: Sequence[str], failure: str) -> str:
        commands.append(command)
        target = Path(command[command.index("--dest") + 1])
        (target / f"daqp-{DAQP_VERSION}.tar.gz").write_bytes(brings)
        return ""

    monkeypatch.setattr(fetch_daqp, "run", run)
    monkeypatch.setattr(fetch_daqp, "DAQP_SHA256", hashlib.sha256(known).hexdigest())
    return commands


def test_fetching_unpacks_sources_and_licence_only(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    commands = pretend_pip(monkeypatch, ARCHIVE, ARCHIVE)
    target = tmp_path / "share" / "daqp"
    assert fetch(target)
    assert sorted(str(p.relative_to(target)) for p in target.rglob("*") if p.is_file()) == [
        "LICENSE",
        "csrc/include/daqp.h",
    ]
    assert [path.name for path in target.parent.iterdir()] == ["daqp"], "nothing temporary is left"
    assert f"daqp=={DAQP_VERSION}" in commands[0] and "--no-deps" in commands[0]


def test_fetching_twice_does_nothing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    commands = pretend_pip(monkeypatch, ARCHIVE, ARCHIVE)
    assert fetch(tmp_path / "daqp")
    assert not fetch(tmp_path / "daqp")
    assert len(commands) == 1


def test_a_place_that_cannot_be_written_is_an_error_of_ours(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    pretend_pip(monkeypatch, ARCHIVE, ARCHIVE)
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(BuildError, match="PROXGEN_DAQP_SOURCE may name another folder"):
        fetch(tmp_path / "file" / "daqp")


def test_an_archive_that_is_not_the_known_one_is_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    pretend_pip(monkeypatch, archive(csrc__include__daqp_dot_h="/* other */"), ARCHIVE)
    with pytest.raises(BuildError, match="is not the one that is known"):
        fetch(tmp_path / "daqp")
    assert list(tmp_path.iterdir()) == []
