"""Fetches the C sources of DAQP, once: `python -m proxgen.builder.fetch_daqp`.

proxgen carries no copy of them. pip gets the source distribution from wherever it gets packages; what it
brings is checked against the digest that this version of proxgen was tested with.
"""

import hashlib
import sys
import tarfile
import tempfile
from pathlib import Path

from proxgen.builder.solvers import DAQP_SHA256, DAQP_VERSION, daqp_directory
from proxgen.builder.toolchain import run
from proxgen.errors import BuildError, ProxgenError


def fetch(directory: Path | None = None) -> bool:
    """Put DAQP's `csrc/` and LICENSE into a folder, whole or not at all.

    Args:
        directory: where to; `daqp_directory()` if None.

    Returns:
        False if they are there already.

    Raises:
        BuildError: pip cannot get them, or they are not what they should be.
    """
    directory = directory or daqp_directory()
    if _is_there(directory):
        return False
    try:
        directory.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=directory.parent, prefix=".daqp-") as folder:
            unpacked = _unpack(_download(Path(folder)), Path(folder))
            unpacked.replace(directory)
    except OSError as error:
        if not _is_there(directory):  # else another process was faster
            raise BuildError(
                f"cannot write {directory}: {error.strerror or error}; "
                "PROXGEN_DAQP_SOURCE may name another folder"
            ) from error
    return True


def _is_there(directory: Path) -> bool:
    """Whether a folder holds DAQP's sources."""
    return (directory / "csrc" / "include" / "daqp.h").is_file()


def _download(folder: Path) -> Path:
    """Let pip download the source distribution, and check its digest."""
    requirement = f"daqp=={DAQP_VERSION}"
    options = ["--no-deps", "--no-binary", "daqp", "--disable-pip-version-check", "--quiet"]
    command = [sys.executable, "-m", "pip", "download", *options, "--dest", str(folder), requirement]
    run(command, f"pip could not download the sources of {requirement}")
    archive = folder / f"daqp-{DAQP_VERSION}.tar.gz"
    if not archive.is_file():
        raise BuildError(f"pip did not bring {archive.name}", command)
    found = hashlib.sha256(archive.read_bytes()).hexdigest()
    if found != DAQP_SHA256:
        raise BuildError(f"{archive.name} is not the one that is known: sha256 {found}, not {DAQP_SHA256}")
    return archive


def _unpack(archive: Path, folder: Path) -> Path:
    """Unpack `csrc/` and LICENSE of the archive; returns the folder that holds them."""
    top = f"daqp-{DAQP_VERSION}"
    with tarfile.open(archive) as tar:
        for member in tar:
            wanted = member.name == f"{top}/LICENSE" or member.name.startswith(f"{top}/csrc/")
            content = tar.extractfile(member) if wanted and member.isfile() else None
            if content is not None:
                target = folder / "unpacked" / member.name
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(content.read())
    return folder / "unpacked" / top


if __name__ == "__main__":
    try:
        fetch()
    except ProxgenError as problem:
        raise SystemExit(f"proxgen: {problem}") from problem
