"""Files that appear whole or not at all: written beside their place first, then moved into it."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO


@contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """A stream whose content takes the place of a file when the block ends without an error.

    Folders are made. A new file gets the mode that the umask leaves, one that exists keeps its own, and a
    link stays a link. What is no regular file, such as /dev/stdout, is written to directly.

    Args:
        path: the file.

    Raises:
        OSError: it cannot be written; then it is as it was.
    """
    if path.exists() and not path.is_file():
        with path.open("wb") as stream:
            yield stream
        return
    path = path.resolve()  # else the link would be replaced, not the file that it leads to
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with part.open("wb") as stream:
            yield stream
        if path.exists():
            part.chmod(path.stat().st_mode & 0o7777)
        part.replace(path)
    except OSError as error:
        if error.filename == str(part):  # nobody knows the part's name
            error.filename, error.filename2 = str(path), None
        raise
    finally:
        with suppress(OSError):  # what failed before is what matters
            part.unlink()


def write_whole(path: Path, content: bytes | str) -> Path:
    """Write a file whole or not at all; text as UTF-8. Otherwise as `whole_file`.

    Returns:
        The path.
    """
    with whole_file(path) as stream:
        stream.write(content.encode() if isinstance(content, str) else content)
    return path
