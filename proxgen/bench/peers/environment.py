"""An environment of its own for each peer, made once and kept as long as its requirements stay the same."""

import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from proxgen.builder.toolchain import run

_STAMP = "requirements.txt"


def make_environment(directory: Path, requirements: Sequence[str]) -> Path:
    """Install packages into an environment below a folder, unless that has been done before.

    Args:
        directory: of the environment; whatever else is in it goes.
        requirements: with exact versions.

    Returns:
        Its Python.

    Raises:
        BuildError: it cannot be installed; with what pip said.
    """
    # Absolute but not resolved: the link behind it leads out of the environment.
    python, stamp = directory.absolute() / "bin" / "python", directory / _STAMP
    wanted = f"# {sys.version.split()[0]}\n" + "".join(f"{line}\n" for line in requirements)
    if stamp.is_file() and stamp.read_text() == wanted:
        return python
    shutil.rmtree(directory, ignore_errors=True)
    run([sys.executable, "-m", "venv", str(directory)], f"cannot make the environment {directory}")
    install = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    run([*install, *requirements], f"cannot install {', '.join(requirements)}")
    stamp.write_text(wanted)  # last: an environment without it is made anew
    return python


def site_packages(python: Path) -> Path:
    """Where an environment keeps its packages."""
    script = "import sysconfig; print(sysconfig.get_paths()['purelib'])"
    return Path(run([str(python), "-c", script], f"{python} does not run").strip())
