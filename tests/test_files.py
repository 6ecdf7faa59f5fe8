"""Files appear whole or not at all, with the mode that the user's umask gives."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from proxgen.files import whole_file, write_whole


@pytest.fixture
def group_writes() -> Iterator[None]:
    """A umask other than the usual one."""
    before = os.umask(0o007)
    yield
    os.umask(before)


def mode(path: Path) -> int:
    """Its permission bits."""
    return path.stat().st_mode & 0o7777


def test_folders_are_made_and_content_is_replaced(tmp_path: Path) -> None:
    path = tmp_path / "a" / "b" / "file.txt"
    assert write_whole(path, "first, longer") == path
    write_whole(path, "sécond")
    assert path.read_bytes() == "sécond".encode()
    assert write_whole(path, b"\x00").read_bytes() == b"\x00"
    assert [file.name for file in path.parent.iterdir()] == ["file.txt"]


def test_an_error_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_whole(tmp_path / "file", "old")
    with pytest.raises(ZeroDivisionError), whole_file(path) as stream:
        stream.write(b"half of the n")
        raise ZeroDivisionError
    with pytest.raises(UnicodeEncodeError):
        write_whole(path, "\ud800")

    def refuse(self: Path, target: Path) -> Path:
        raise OSError("disk full")

    monkeypatch.setattr(Path, "replace", refuse)
    with pytest.raises(OSError, match="disk full"):
        write_whole(path, "new")
    assert path.read_text() == "old"
    assert [file.name for file in tmp_path.iterdir()] == ["file"]


def test_an_error_names_the_file_and_not_its_part(tmp_path: Path) -> None:
    path = tmp_path / ("n" * 250)  # the part's name is longer still: too long, whoever writes
    with pytest.raises(OSError, match="File name too long") as caught:
        write_whole(path, "new")
    assert (caught.value.filename, caught.value.filename2) == (str(path), None)


@pytest.mark.usefixtures("group_writes")
def test_a_new_file_has_the_umask_s_mode_and_an_old_one_keeps_its_own(tmp_path: Path) -> None:
    path = write_whole(tmp_path / "file", "new")
    assert mode(path) == 0o660
    path.chmod(0o755)
    assert mode(write_whole(path, "newer")) == 0o755
    path.chmod(0o600)
    assert mode(write_whole(path, "secret")) == 0o600


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    file = write_whole(tmp_path / "there" / "file", "old")
    link = tmp_path / "link"
    link.symlink_to(file)
    write_whole(link, "new")
    assert link.is_symlink()
    assert file.read_text() == "new"


def test_a_device_is_written_to_and_a_folder_is_refused(tmp_path: Path) -> None:
    master, slave = os.openpty()  # a device of one's own: a test that fails must not replace /dev/null
    device = Path(os.ttyname(slave))
    write_whole(device, "text")
    assert os.read(master, 100) == b"text"
    assert device.is_char_device()
    os.close(slave)
    os.close(master)
    with pytest.raises(IsADirectoryError):
        write_whole(tmp_path, "text")
