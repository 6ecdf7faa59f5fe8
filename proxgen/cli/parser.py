"""The verbs and flags of the command line, and how a mistake in them is answered."""

import argparse
from collections.abc import Sequence
from itertools import takewhile
from typing import Any, NoReturn

from proxgen import __version__
from proxgen.cli import files, measuring, reproducing, runs
from proxgen.errors import unknown_name

GROUPS = (files, runs, reproducing, measuring)
"""Modules of verbs; each adds its own to the parser, and imports what a verb needs when it is carried out."""

DESCRIPTION = "From one YAML file to a compiled, certified collision-avoidance controller for any serial arm."
EPILOG = """\
from nothing to a controller that avoids:
  proxgen init my_robot.urdf --tool FRAME    writes a first YAML file, and a scene
  proxgen check ROBOT.yaml                   all mistakes at once
  proxgen run ROBOT.yaml --scene gap --out out/gap

`proxgen VERB --help` says more of each verb; docs/configuration.md has every key of the file.
Exit status: 0 done, 1 failed (a comparison's verdict among others), 2 wrong input.
"""


class Parser(argparse.ArgumentParser):
    """argparse, but a name that does not exist is answered with the nearest one that does."""

    def __init__(self, **options: object) -> None:
        """No abbreviated flags, as a new flag would change their meaning; lines stay as they are."""
        kept = {"allow_abbrev": False, "formatter_class": argparse.RawDescriptionHelpFormatter}
        super().__init__(**(options | kept))  # type: ignore[arg-type]

    @property
    def flags(self) -> list[str]:
        """All long flags of this parser."""
        return [name for action in self._actions for name in action.option_strings if name.startswith("--")]

    def error(self, message: str) -> NoReturn:
        """Say what is wrong, then how it is used; exit status 2."""
        self.exit(2, f"{self.prog}: {message}\n{self.format_usage()}")


class Verbs:
    """Where modules add their verbs; what the list of verbs says of one is also the head of its own help."""

    def __init__(self, action: Any) -> None:
        """Keep argparse's own action."""
        self._action = action

    def add_parser(self, name: str, *, help: str) -> Parser:
        """A new verb, with a phrase that says what it does."""
        parser: Parser = self._action.add_parser(name, help=help, description=f"{help[0].upper()}{help[1:]}.")
        return parser


def build_parser() -> tuple[Parser, dict[str, Parser]]:
    """The parser of the whole command line, and the parsers of its verbs by name."""
    parser = Parser(prog="proxgen", description=DESCRIPTION, epilog=EPILOG)
    parser.add_argument("--version", action="version", version=f"proxgen {__version__}")
    verbs = parser.add_subparsers(dest="verb", metavar="VERB", title="verbs", parser_class=Parser)
    for group in GROUPS:
        group.add_verbs(Verbs(verbs))
    return parser, dict(verbs.choices)


def parse(argv: Sequence[str]) -> argparse.Namespace:
    """Turn the words after `proxgen` into a namespace; its `carry_out` is the verb's function.

    Raises:
        SystemExit: after --help, --version (status 0), or a mistake (status 2, with what is allowed).
    """
    parser, verbs = build_parser()
    if not argv:
        parser.print_help()
        parser.exit(2)
    first = argv[0]
    if not first.startswith("-") and first not in verbs:
        parser.error(unknown_name("verb", first, verbs))
    verb = verbs.get(first, parser)
    for word in takewhile(lambda word: word != "--", argv):
        if word.startswith("--"):  # before argparse says what is missing, which is often what was misspelt
            _refuse_unknown(word, verb)
    arguments, rest = parser.parse_known_args(argv)
    for word in rest:
        if word.startswith("-"):
            _refuse_unknown(word, verb)
        verb.error(f"unexpected argument '{word}'")
    return arguments


def _refuse_unknown(word: str, verb: Parser) -> None:
    """A flag that a verb does not have is a mistake; exit status 2."""
    name = word.partition("=")[0]
    if name not in verb.flags:
        verb.error(unknown_name("flag", name, verb.flags))
