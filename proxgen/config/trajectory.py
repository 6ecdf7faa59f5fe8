"""A trajectory in a CSV file: targets with times, one per line."""

import csv
import math
from pathlib import Path
from typing import Any

from proxgen.errors import Problem

COLUMNS = ("time", "x", "y", "z")
ORIENTATION = ("roll", "pitch", "yaw")


def read_trajectory(path: Path) -> tuple[list[dict[str, Any]], list[Problem]]:
    """Read the way points of a trajectory.

    Args:
        path: a CSV file. Its first line names the columns: `time,x,y,z` [s, m], and, for tasks with an
            orientation, `roll,pitch,yaw` [rad]. Lines that begin with # are comments.

    Returns:
        Targets as a scene has them, and all mistakes with their lines.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        return [], [Problem(path, 0, "", f"the trajectory cannot be read: {error.strerror or error}")]
    except UnicodeDecodeError:
        return [], [Problem(path, 0, "", "the trajectory cannot be read: it is not a text file")]
    rows = [
        (number, next(csv.reader([line])))
        for number, line in enumerate(lines, start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    header = tuple(word.strip() for word in rows[0][1]) if rows else ()
    if header not in (COLUMNS, COLUMNS + ORIENTATION):
        wanted = f"{','.join(COLUMNS)} or {','.join(COLUMNS + ORIENTATION)}"
        return [], [Problem(path, rows[0][0] if rows else 0, "", f"the first line must be {wanted}")]
    targets: list[dict[str, Any]] = []
    problems = []
    for number, words in rows[1:]:
        values = _numbers(words)
        if values is None or len(values) != len(header):
            problems.append(Problem(path, number, "", f"expected {len(header)} finite numbers"))
        elif values[0] < 0.0:
            problems.append(Problem(path, number, "", f"time = {values[0]:.6g} s must be at least 0"))
        elif targets and values[0] <= targets[-1]["time"]:
            message = f"time = {values[0]:.6g} s must be later than before, {targets[-1]['time']:.6g} s"
            problems.append(Problem(path, number, "", message))
        else:
            targets.append(_target(values))
    if len(rows) == 1:
        problems.append(Problem(path, 0, "", "the trajectory has no points"))
    return targets, problems


def _numbers(words: list[str]) -> list[float] | None:
    """The words as numbers, or None if one is not."""
    try:
        values = [float(word) for word in words]
    except ValueError:
        return None
    return values if all(map(math.isfinite, values)) else None


def _target(values: list[float]) -> dict[str, Any]:
    """A target from the columns."""
    target: dict[str, Any] = {"time": values[0], "position": values[1:4]}
    return target | {"orientation": values[4:]} if len(values) > 4 else target
