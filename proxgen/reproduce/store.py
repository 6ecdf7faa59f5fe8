"""What is kept of finished work: one record per task, written whole, and only used if it still fits."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from proxgen.errors import SimulationError
from proxgen.files import write_whole
from proxgen.simulation.log import RolloutLog

Numbers = Mapping[str, Any]
"""A record's numbers; some are mappings themselves. Their keys are dotted: `cycle_us.p50`."""


@dataclass(frozen=True)
class Store:
    """A folder with a record (JSON) per task, and the log (npz) of those that ran.

    Attributes:
        directory: made when something is written.
    """

    directory: Path

    def log_path(self, name: str) -> Path:
        """Where the log of a task is."""
        return self.directory / f"{name}.npz"

    def save(self, name: str, fingerprint: str, numbers: Numbers, log: RolloutLog | None = None) -> None:
        """Keep what a task found; the record comes last, so that it stands for the log, too."""
        self.directory.mkdir(parents=True, exist_ok=True)
        if log is not None:
            log.save(self.log_path(name))
        content = {"task": name, "fingerprint": fingerprint, "log": log is not None, "numbers": numbers}
        text = json.dumps(content, indent=1, allow_nan=False) + "\n"
        write_whole(self._record_path(name), text)

    def find(self, name: str, fingerprint: str) -> dict[str, Any] | None:
        """The numbers of a task that is done and was the same then as now; else None."""
        try:
            content = json.loads(self._record_path(name).read_text(encoding="utf-8"))
            fits = content["fingerprint"] == fingerprint
            whole = not content["log"] or self.log_path(name).is_file()
            numbers: dict[str, Any] = content["numbers"]
        except (OSError, ValueError, KeyError, TypeError):
            return None
        return numbers if fits and whole else None

    def log(self, name: str) -> RolloutLog:
        """The log of a task that is done.

        Raises:
            SimulationError: it cannot be read any more.
        """
        return RolloutLog.load(self.log_path(name))

    def tidy(self) -> None:
        """Remove what interrupted writers left."""
        for part in self.directory.glob("*.part"):
            part.unlink(missing_ok=True)

    def _record_path(self, name: str) -> Path:
        return self.directory / f"{name}.json"


def write_json(path: Path, content: Any) -> None:
    """Write a JSON file whole or not at all.

    Raises:
        SimulationError: it cannot be written.
    """
    text = json.dumps(content, indent=2, allow_nan=False) + "\n"
    try:
        write_whole(path, text)
    except OSError as error:
        raise SimulationError(f"cannot write {path}: {error.strerror or error}") from error
