"""The one family of errors that proxgen raises; every one carries what a caller needs to act on it.

Messages name what was found, what is allowed and, for a name that does not exist, the nearest one that
does. `proxgen.cli` turns an error into text on stderr and its `exit_status`; nothing else prints.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path


class ProxgenWarning(UserWarning):
    """Something that a careful user wants to know, but that does not stop the work."""


class ProxgenError(Exception):
    """Base of all errors of proxgen.

    Attributes:
        exit_status: what the command line returns for it: 2 for input or tools that the user can mend,
            1 for anything else.
    """

    exit_status = 1


@dataclass(frozen=True, order=True)
class Problem:
    """One mistake in a file that the user wrote.

    Attributes:
        file: the file as the user named it.
        line: 1-based line, or 0 where the file as a whole is meant.
        key: dotted path of the key, such as `skin.cuffs.0.rings.1.tilt`; empty where there is none.
        message: what was found, and what is allowed.
    """

    file: Path
    line: int
    key: str
    message: str

    def __str__(self) -> str:
        """`file:line: key: message`, the form that editors jump to."""
        place = f"{self.file}:{self.line}" if self.line else f"{self.file}"
        return f"{place}: {self.key}: {self.message}" if self.key else f"{place}: {self.message}"


class ConfigError(ProxgenError):
    """The YAML file, or a file that it names, cannot be used; holds all problems at once."""

    exit_status = 2

    def __init__(self, problems: Sequence[Problem]) -> None:
        """Keep `problems` in the order of the file."""
        self.problems = tuple(sorted(problems))
        super().__init__("\n".join(str(problem) for problem in self.problems))


class ModelError(ProxgenError):
    """The robot description (URDF) does not give the model that the configuration asks for.

    Attributes:
        key: dotted path of the configuration key that asked for it, so that a line can be named.
    """

    exit_status = 2

    def __init__(self, message: str, key: str = "") -> None:
        """Keep the `key` beside the message."""
        self.key = key
        super().__init__(message)


class GenerateError(ProxgenError):
    """Code could not be generated from a valid model."""


class BuildError(ProxgenError):
    """The system compiler is missing, or refused the code.

    Attributes:
        command: the command line that failed.
        output: everything that the compiler said, uncut.
    """

    exit_status = 2

    def __init__(self, message: str, command: Sequence[str] = (), output: str = "") -> None:
        """Show the message first, then the command and the whole output."""
        self.command = tuple(command)
        self.output = output
        parts = [message]
        if command:
            parts.append("command: " + " ".join(command))
        if output:
            parts.append(output.rstrip())
        super().__init__("\n".join(parts))


class ControllerError(ProxgenError):
    """A controller was called wrongly: a size, a type or a parameter that it refuses.

    Bad *measurements* are not errors: they have a status and a safe behaviour (see `controllers.protocol`).
    """


class SimulationError(ProxgenError):
    """The simulated world could not be set up or stepped."""


class CompareError(ProxgenError):
    """Two controllers cannot be compared (not: they differ, which is a verdict)."""


class ReproduceError(ProxgenError):
    """Some of the paper's experiments could not be finished; what is finished is kept.

    Attributes:
        failures: reason by name of the run or comparison.
    """

    def __init__(self, message: str, failures: Mapping[str, str]) -> None:
        """Show the message first, then a line for each failure."""
        self.failures = dict(failures)
        super().__init__("\n".join([message, *(f"  {name}: {why}" for name, why in failures.items())]))


def shortened(text: str) -> str:
    """At most 60 characters of what a user wrote: a message is not to be buried below it."""
    return text if len(text) <= 60 else f"{text[:57]}..."


def nearest_name(name: str, allowed: Iterable[str]) -> str | None:
    """The allowed name that `name` was probably meant to be, or None if nothing is close."""
    close = get_close_matches(name, list(allowed), n=1, cutoff=0.6)
    return close[0] if close else None


def unknown_name(kind: str, name: str, allowed: Iterable[str]) -> str:
    """A sentence that says that `name` does not exist, which names do, and the nearest one."""
    names = sorted(set(allowed))
    nearest = nearest_name(name, names)
    hint = f"; did you mean '{nearest}'?" if nearest else ""
    return f"unknown {kind} '{shortened(name)}'{hint} (allowed: {', '.join(names) if names else 'none'})"
