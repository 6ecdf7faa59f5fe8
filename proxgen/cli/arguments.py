"""Types of command-line arguments: what is accepted, and the sentence for what is not."""

import argparse
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
    from proxgen.config.quantities import Time

    try:
        return Time(gt=0.0, le=1e6).parse(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def whole_number(text: str) -> int:
    """A whole number from 0."""
    if not text.isascii() or not text.isdigit() or len(text) > 18:
        raise argparse.ArgumentTypeError(f"expected a whole number from 0, found '{text}'")
    return int(text)
