"""Whether a build is up to date is decided by everything that it was made from: each change of it is seen."""

import shutil
from importlib import metadata
from pathlib import Path

import pytest

from proxgen.builder import BuildResult, build, pipeline, sources
from proxgen.config.schema import Config

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(
    ("changed", "code_too"),
    [
        ("runtime/src/cycle.c", False),
        ("runtime/src/state.h", False),
        ("runtime/src/solver_daqp.c", False),
        ("runtime/include/proxgen/types.h", False),
        ("proxgen/symbolic/kernels.py", True),
        ("proxgen/emit/tables.py", True),
        ("proxgen/emit/templates/model.c.j2", True),
        ("proxgen/model/build.py", True),
        ("proxgen/config/schema.py", True),
        ("proxgen/program.py", True),
    ],
)
def test_a_changed_file_makes_another_key(
    changed: str, code_too: bool, planar2_config: Config, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the runtime, of the generator; the generated code itself follows from the generator alone."""
    for name in ("runtime/src", "runtime/include"):
        shutil.copytree(ROOT / name, tmp_path / name)
    for source in sources.generator_files():
        copy = tmp_path / "proxgen" / source.relative_to(sources._PACKAGE)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, copy)
    monkeypatch.setattr(sources, "_PACKAGE", tmp_path / "proxgen")
    before = pipeline._plan(planar2_config, tmp_path / "built", "daqp", None)
    path = tmp_path / changed
    path.write_text(path.read_text() + "\n")
    after = pipeline._plan(planar2_config, tmp_path / "built", "daqp", None)
    assert before.key != after.key
    assert (before.generation != after.generation) is code_too


def test_a_file_that_was_cut_off_is_made_again(
    planar2_daqp: BuildResult, planar2_config: Config, tmp_path: Path
) -> None:
    shutil.copytree(planar2_daqp.library_dir, tmp_path / "planar2")
    library = tmp_path / "planar2" / "lib" / "libplanar2.a"
    whole = library.read_bytes()
    library.write_bytes(whole[:1000])
    assert build(planar2_config, tmp_path / "planar2", backend="daqp").rebuilt
    assert library.read_bytes() == whole


def test_other_versions_of_the_libraries_make_another_key(
    planar2_config: Config, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """CasADi writes the code, and Pinocchio reads the arm."""
    before = pipeline._plan(planar2_config, tmp_path, "daqp", None)
    version = metadata.version
    for library in ("casadi", "pin"):
        with monkeypatch.context() as patch:
            versions = {library: "9.9"}
            patch.setattr(metadata, "version", lambda name, v=versions: v.get(name) or version(name))
            after = pipeline._plan(planar2_config, tmp_path, "daqp", None)
        assert before.key != after.key
        assert before.generation != after.generation


def test_a_digest_is_of_names_and_of_where_files_end(tmp_path: Path) -> None:
    texts = [{"a": "12", "b": "3"}, {"a": "1", "b": "23"}, {"a": "12", "c": "3"}, {"a": "123"}]
    digests = set()
    for index, files in enumerate(texts):
        (tmp_path / str(index)).mkdir()
        paths = [tmp_path / str(index) / name for name in files]
        for path in paths:
            path.write_text(files[path.name])
        digests.add(sources.digest_files(paths))
    assert len(digests) == len(texts)
