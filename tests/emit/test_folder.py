import os
from pathlib import Path

import pytest

from proxgen.emit.folder import MARK, write_folder
from proxgen.errors import GenerateError

FILES = {"a.h": f"/* {MARK} */\nint a;\n", "b.h": f"/* {MARK} */\nint b;\n"}


def content(directory: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in directory.iterdir()}


def test_a_new_folder_holds_exactly_the_files(tmp_path: Path) -> None:
    written = write_folder(tmp_path / "deep" / "robot", FILES)
    assert written == ("a.h", "b.h")
    assert content(tmp_path / "deep" / "robot") == FILES
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["robot"]


def test_unchanged_files_keep_their_time(tmp_path: Path) -> None:
    write_folder(tmp_path / "robot", FILES)
    for name in FILES:
        os.utime(tmp_path / "robot" / name, (1, 1))
    written = write_folder(tmp_path / "robot", {**FILES, "b.h": f"/* {MARK} */\nlong b;\n"})
    assert written == ("b.h",)
    assert (tmp_path / "robot" / "a.h").stat().st_mtime == 1
    assert (tmp_path / "robot" / "b.h").stat().st_mtime != 1


def test_stale_files_go_only_if_they_are_ours(tmp_path: Path) -> None:
    write_folder(tmp_path / "robot", FILES)
    (tmp_path / "robot" / "notes.txt").write_text("mine")
    assert write_folder(tmp_path / "robot", {"a.h": FILES["a.h"]}) == ("b.h",)
    assert content(tmp_path / "robot") == {"a.h": FILES["a.h"], "notes.txt": "mine"}


def test_a_folder_that_cannot_be_made_is_an_error_of_ours(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(GenerateError, match="cannot write"):
        write_folder(tmp_path / "file" / "robot", FILES)


def test_a_failure_leaves_the_folder_as_it_was(tmp_path: Path) -> None:
    write_folder(tmp_path / "robot", FILES)
    with pytest.raises(UnicodeEncodeError):
        write_folder(tmp_path / "robot", {"a.h": "changed", "b.h": "\udc80"})
    assert content(tmp_path / "robot") == FILES
    assert [path.name for path in tmp_path.iterdir()] == ["robot"]
