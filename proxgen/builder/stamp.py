"""The memory of a build: a stamp says from which inputs the files of a folder were made."""

import fcntl
import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

from proxgen.builder.sources import digest_files
from proxgen.errors import BuildError

PRIVATE = ".proxgen"
"""Folder within a build folder for what is not to be installed: stamp, lock, objects."""


@dataclass(frozen=True)
class Stamp:
    """What the last build of a folder was.

    Attributes:
        key: digest of all inputs.
        generation: digest of the inputs of the generated code alone.
        generated: folder of the generated code, absolute or within the build folder.
        generated_digest: of its files, so that a change by hand is seen.
        files: size of every file of the build, by path within the folder.
        source: the YAML file, absolute.
    """

    key: str
    generation: str
    generated: str
    generated_digest: str
    files: dict[str, int]
    source: str = ""

    def holds(self, directory: Path) -> bool:
        """Whether the files of the build are all there still, and the generated code is as it was."""
        return self.generated_holds(directory) and all(
            _size(directory / name) == size for name, size in self.files.items()
        )

    def generated_holds(self, directory: Path) -> bool:
        """Whether the generated code is as the last build of the folder left it."""
        return digest_folder(directory / self.generated) == self.generated_digest


def read_stamp(directory: Path) -> Stamp | None:
    """The stamp of a build folder; None if there is none that can be read."""
    try:
        return Stamp(**json.loads((directory / PRIVATE / "stamp.json").read_text()))
    except (OSError, ValueError, TypeError):
        return None


def write_stamp(directory: Path, stamp: Stamp, work: Path) -> None:
    """Write the stamp whole; it is the last thing that a build writes."""
    (work / "stamp.json").write_text(json.dumps(asdict(stamp), indent=1))
    (work / "stamp.json").replace(directory / PRIVATE / "stamp.json")


def remove_stamp(directory: Path) -> None:
    """Forget the last build, before its files change."""
    (directory / PRIVATE / "stamp.json").unlink(missing_ok=True)


def digest_folder(directory: Path) -> str:
    """Digest of the files of a folder; empty if there is no such folder."""
    if not directory.is_dir():
        return ""
    return digest_files(sorted(path for path in directory.iterdir() if path.is_file()))


@contextmanager
def locked(directory: Path) -> Iterator[None]:
    """Hold the lock of a build folder, which is made if need be: one build at a time.

    Raises:
        BuildError: the folder cannot be written.
    """
    try:
        (directory / PRIVATE).mkdir(parents=True, exist_ok=True)
        stream = (directory / PRIVATE / "lock").open("w")
    except OSError as error:
        raise BuildError(f"cannot write {directory}: {error.strerror or error}") from error
    with stream:
        fcntl.flock(stream, fcntl.LOCK_EX)
        yield


def _size(path: Path) -> int:
    """Size of a file; -1 if there is none."""
    try:
        return path.stat().st_size
    except OSError:
        return -1
