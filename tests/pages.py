"""Pages of documentation whose blocks are run: shell commands, Python programs, files to be written."""

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Block:
    """A fenced block: its language and its text."""

    language: str
    text: str


def blocks_of(page: str) -> list[Block]:
    """All fenced blocks of a page that name a language, in their order."""
    found = re.findall(r"^```(\w+)\n(.*?)^```$", page, re.M | re.S)
    return [Block(language, text) for language, text in found]


def copy_repository(folder: Path) -> Path:
    """The files of the repository in a folder of their own, with this Python's environment as .venv."""
    unwanted = (
        ".git",
        ".venv",
        "build",
        "out",
        "dist",
        "__pycache__",
        ".*_cache",
        ".hypothesis",
        "*.egg-info",
    )
    shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*unwanted))
    (folder / ".venv").symlink_to(sys.prefix)
    return folder


def shell(script: str, folder: Path) -> str:
    """What a script says, with the activated environment of the clone; an AssertionError if it fails."""
    # -o: the environment is there already; make is not to install into it.
    activated = 'make() { command make -o .venv/.installed "$@"; }\n. .venv/bin/activate\n' + script
    clean = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("PYTEST_", "MAKE", "MFLAGS"))
    }
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", activated],
        cwd=folder,
        env=clean,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{script}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def run_block(block: Block, folder: Path) -> str:
    """Run a shell or Python block, or save a YAML block under the name in its first line; what it says."""
    if block.language == "sh":
        return shell(block.text, folder)
    if block.language == "python":
        return shell(f"python - <<'END'\n{block.text}END\n", folder)
    (folder / block.text.split()[1]).write_text(block.text)
    return ""
