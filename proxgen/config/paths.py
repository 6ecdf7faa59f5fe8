"""Looking for files that a user names: an impossible name is a file that is not there, never an exception."""

from collections.abc import Iterable
from pathlib import Path

from proxgen.errors import nearest_name


def is_file(path: Path) -> bool:
    """Whether there is such a file."""
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name that is too long, or that has a zero byte
        return False


def is_folder(path: Path) -> bool:
    """Whether there is such a folder."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def did_you_mean(path: Path, shown: Path | None = None) -> str:
    """A hint if the folder has a file of nearly this name; `shown` is the path as the user wrote it."""
    try:
        names: Iterable[str] = [entry.name for entry in path.parent.iterdir()]
    except (OSError, ValueError):
        names = ()
    nearest = nearest_name(path.name, names)
    return f"; did you mean '{(shown or path).parent / nearest}'?" if nearest else ""
