"""Program to text: readable C, raw kernels, manifest and README of one robot, written whole."""

from pathlib import Path

from proxgen.emit.folder import write_folder
from proxgen.emit.rendering import render
from proxgen.program import Program

__all__ = ["generate", "render"]


def generate(program: Program, directory: str | Path) -> None:
    """Write all generated files of a robot into `directory`.

    The same program gives the same bytes; files whose text did not change are not touched, files of ours that
    are no longer generated are removed, and all others stay.

    Raises:
        GenerateError: if the program is not consistent, or the folder cannot be written.
    """
    write_folder(Path(directory), render(program))
