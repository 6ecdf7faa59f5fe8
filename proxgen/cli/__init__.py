"""The command line: the only place of proxgen that prints or exits."""

import os
import sys
import warnings
from collections.abc import Sequence
from typing import TextIO

from proxgen.errors import ConfigError, ProxgenError

MOST_PROBLEMS = 100
"""So many are printed; more come from a file that is something else, or from one mistake many times."""


def main(argv: Sequence[str] | None = None) -> int:
    """Carry out one command.

    Args:
        argv: the words after `proxgen`; those of the process if None.

    Returns:
        The exit status: 0 done, 1 failed, 2 wrong input.
    """
    with warnings.catch_warnings():
        warnings.showwarning = _show_warning
        return _main(sys.argv[1:] if argv is None else argv)


def _main(argv: Sequence[str]) -> int:
    """Carry out one command, and turn every expected failure into a message and a status."""
    try:
        from proxgen.cli.parser import parse  # takes a moment, in which Ctrl-C is to be answered, too

        arguments = parse(argv)
        status: int = arguments.carry_out(arguments)
        sys.stdout.flush()
        return status
    except SystemExit as request:  # of argparse, after it has said why
        return request.code if isinstance(request.code, int) else 1
    except ConfigError as error:
        return _fail(_listed(error), error.exit_status)
    except ProxgenError as error:
        return _fail(f"proxgen: {error}", error.exit_status)
    except BrokenPipeError:  # the reader, such as head, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        told = f"{place}{error.strerror}" if error.strerror else str(error)
        return _fail(f"proxgen: {told}", 1)
    except KeyboardInterrupt:
        return _fail("proxgen: interrupted", 130)


def _listed(error: ConfigError) -> str:
    """Problems, a line each, and how many; where there are very many, the first ones."""
    count = len(error.problems)
    lines = [str(problem) for problem in error.problems[:MOST_PROBLEMS]]
    shown = f"; these are the first {MOST_PROBLEMS}" if count > MOST_PROBLEMS else ""
    return "\n".join([*lines, f"{count} problem{'s' if count != 1 else ''}{shown}"])


def _fail(message: str, status: int) -> int:
    """Say what went wrong on standard error."""
    print(message, file=sys.stderr)
    return status


def _show_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """A warning as one line, without the place in the source that raised it."""
    print(f"proxgen: warning: {message}", file=file or sys.stderr)
