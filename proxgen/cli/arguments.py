"""Types of command-line arguments: what is accepted, and the sentence for what is not."""

import argparse
import os
from collections.abc import Callable, Iterable
from pathlib import Path

from proxgen.errors import unknown_name


def add_config(parser: argparse.ArgumentParser) -> None:
    """The robot's YAML file, which nearly every verb needs."""
    parser.add_argument("config", metavar="CONFIG", type=Path, help="the robot's YAML file")


def add_sensing_and_duration(parser: argparse.ArgumentParser) -> None:
    """What verbs that simulate have in common."""
    parser.add_argument(
        "--sensing",
        type=one_of("sensing", ("skin", "ideal")),
        default="skin",
        metavar="skin|ideal",
        help="the skin's sensors (default), or exact nearest points",
    )
    parser.add_argument(
        "--duration", type=seconds, default=60.0, metavar="S", help="simulated time in seconds (default: 60)"
    )


def one_of(kind: str, allowed: Iterable[str]) -> Callable[[str], str]:
    """A type that accepts some names, and answers any other with the nearest."""
    names = tuple(allowed)

    def check(text: str) -> str:
        if text not in names:
            raise argparse.ArgumentTypeError(unknown_name(kind, text, names))
        return text

    return check


def seconds(text: str) -> float:
    """A duration above zero: a number of seconds, or with a unit such as `500 ms`."""
    return _quantity("Time", text, gt=0.0, le=1e6)


def latency(text: str) -> float:
    """A time from 0 to a second."""
    return _quantity("Time", text, ge=0.0, le=1.0)


def length(text: str) -> float:
    """A length from 0: a number of metres, or with a unit such as `5 mm`."""
    return _quantity("Length", text, ge=0.0, le=0.5)


def probability(text: str) -> float:
    """A number from 0, less than 1."""
    return _quantity("Number", text, ge=0.0, lt=1.0)


def _quantity(kind: str, text: str, **bounds: float) -> float:
    """A number with or without a unit, as in the YAML file, within bounds."""
    from proxgen.config import quantities

    try:
        value: float = getattr(quantities, kind)(**bounds).parse(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error
    return value


def whole_number(text: str, least: int = 0) -> int:
    """A whole number from 0, or from another least one."""
    if not text.isascii() or not text.isdigit() or len(text) > 18 or int(text) < least:
        raise argparse.ArgumentTypeError(f"expected a whole number from {least}, found '{text}'")
    return int(text)


def count(text: str) -> int:
    """A whole number from 1."""
    return whole_number(text, 1)


def new_file(text: str) -> Path:
    """A file to be written; what keeps it from being written is said before the work, not after it."""
    path = Path(text)
    if text == "-":
        raise argparse.ArgumentTypeError("'-' is no file; /dev/stdout is standard output")
    if path.is_dir():
        raise argparse.ArgumentTypeError(f"{path} is a folder; a file is needed")
    if path.is_file() or not path.exists():
        new_folder(str(path.parent))  # /dev/stdout is written in place, and /dev belongs to root
    if path.exists() and not os.access(path, os.W_OK):
        raise argparse.ArgumentTypeError(f"{path} cannot be written: permission denied")
    return path


def new_folder(text: str) -> Path:
    """A folder for files to be written, which is made if it does not exist."""
    path = Path(text)
    nearest = next(place for place in (path, *path.absolute().parents) if place.exists())
    if not nearest.is_dir():
        raise argparse.ArgumentTypeError(f"{nearest} is a file; a folder is needed")
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise argparse.ArgumentTypeError(f"nothing can be written in {nearest}: permission denied")
    return path


def film_file(text: str) -> Path:
    """A film to be written; its ending names one of the formats."""
    from proxgen.report.film import FORMATS

    if Path(text).suffix not in FORMATS:
        allowed = " or ".join(FORMATS)
        raise argparse.ArgumentTypeError(f"expected a name that ends in {allowed}, found '{text}'")
    return new_file(text)
