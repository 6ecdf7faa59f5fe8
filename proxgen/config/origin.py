"""Where the values of a loaded file come from: file and line of every key."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from proxgen.errors import Problem


class Mark(NamedTuple):
    """A place in a file: 1-based line; 0 stands for the file as a whole."""

    file: Path
    line: int


@dataclass(frozen=True)
class Origin:
    """Where a loaded file and its values come from.

    Attributes:
        source: the file, as the user named it.
        marks: place of every key that was written, by dotted path such as `skin.cuffs.0.name`; keys that
            have their default are not in it. With `extends` a key's place may be in another file.
        urdf_path: the robot description that the file names, as an absolute path.
    """

    source: Path
    marks: Mapping[str, Mark] = field(default_factory=dict)
    urdf_path: Path = Path()

    def mark(self, key: str) -> Mark:
        """Place of a key; of the nearest section around it if it was not written itself."""
        parts = key.split(".") if key else []
        for length in range(len(parts), 0, -1):
            mark = self.marks.get(".".join(parts[:length]))
            if mark is not None:
                return mark
        return Mark(self.source, 0)

    def problem(self, key: str, message: str) -> Problem:
        """A problem at the place of a key."""
        mark = self.mark(key)
        return Problem(mark.file, mark.line, key, message)

    def problem_among(self, keys: Iterable[str], message: str) -> Problem:
        """A problem that several keys make together, at the first one that the file itself writes."""
        keys = list(keys)
        own = [key for key in keys if key in self.marks and self.marks[key].file == self.source]
        written = [key for key in keys if key in self.marks]
        return self.problem((own or written or keys)[0], message)
