"""The verbs and flags of the command line, and how a mistake in them is answered."""

import argparse
from collections.abc import Sequence
from typing import Any, NoReturn

from proxgen import __version__
from proxgen.cli import files, measuring, reproducing, runs
from proxgen.errors import unknown_name

GROUPS = (files, runs, reproducing, measuring)
"""Modules of verbs; each adds its own to the parser, and imports what a verb needs when it is carried out."""

DESCRIPTION = "From one YAML file to a compiled, certified collision-avoidance controller for any serial arm."
EPILOG = "Exit status: 0 done, 1 failed (a comparison's verdict among others), 2 wrong input."


class Parser(argparse.ArgumentParser):
    """argparse, but a name that does not exist is answered with the nearest one that does."""

    def __init__(self, **options: object) -> None:
        """Abbreviated flags are refused: they would change their meaning when a flag is added."""
        super().__init__(**(options | {"allow_abbrev": False}))  # type: ignore[arg-type]

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
    arguments, rest = parser.parse_known_args(argv)
    verb = verbs.get(first, parser)
    for word in rest:
        if word.startswith("-"):
            verb.error(unknown_name("flag", word.partition("=")[0], verb.flags))
        verb.error(f"unexpected argument '{word}'")
    return arguments
