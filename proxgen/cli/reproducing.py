"""The verb that repeats the paper: reproduce."""

import argparse
from pathlib import Path
from typing import Any

from proxgen.cli.arguments import new_folder
from proxgen.cli.output import progress_bar

OUT = Path("out/reproduce")


def add_verbs(verbs: Any) -> None:
    """Add the verb of this module to the parser."""
    verb = verbs.add_parser(
        "reproduce", help="the paper's experiments with every figure, claim by claim, and what goes beyond"
    )
    verb.add_argument("--quick", action="store_true", help="two starts instead of eight, shorter comparisons")
    verb.add_argument(
        "--out",
        type=new_folder,
        default=OUT,
        metavar="DIR",
        help=f"for the page, the numbers and the runs; what is finished there is used (default: {OUT})",
    )
    verb.set_defaults(carry_out=carry_out_reproduce)


def carry_out_reproduce(arguments: argparse.Namespace) -> int:
    """Run what is missing, say what came out, write the page; claims that do not hold are no failure."""
    from proxgen.reproduce.plan import full_plan, quick_plan
    from proxgen.reproduce.run import reproduce
    from proxgen.reproduce.tables import headline

    plan = quick_plan() if arguments.quick else full_plan()
    with progress_bar(f"reproduce ({plan.name})") as progress:
        outcome = reproduce(plan, arguments.out, progress=progress, say=_say)
    for title, verdicts in (("claims of the paper", outcome.paper), ("beyond the paper", outcome.beyond)):
        print(f"\n{title}: {headline(verdicts)}")
        for verdict in verdicts:
            print(f"  {verdict.word:<14} {verdict.claim.text}")
    print(f"report: {outcome.page}")
    return 0


def _say(line: str) -> None:
    """One result, as soon as it is there."""
    print(line, flush=True)
