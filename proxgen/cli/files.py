"""Verbs that turn files into files: check, schema, generate, build."""

import argparse
import json
from pathlib import Path
from typing import Any

from proxgen.cli.arguments import add_config, one_of

BACKENDS = ("qpoases", "daqp")


def add_verbs(verbs: Any) -> None:
    """Add the verbs of this module to the parser."""
    check = verbs.add_parser("check", help="find all mistakes in a robot's YAML file")
    add_config(check)
    check.set_defaults(carry_out=carry_out_check)

    schema = verbs.add_parser("schema", help="print the JSON schema, for editors")
    schema.set_defaults(carry_out=carry_out_schema)

    generate = verbs.add_parser("generate", help="generate the controller's C code")
    add_config(generate)
    generate.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="default: generated/ROBOT in this folder"
    )
    generate.set_defaults(carry_out=carry_out_generate)

    build = verbs.add_parser("build", help="generate and compile the controller")
    add_config(build)
    build.add_argument("-o", "--output", type=Path, metavar="DIR", help="default: build/ROBOT in this folder")
    build.add_argument(
        "--backend",
        type=one_of("back end", BACKENDS),
        metavar="|".join(BACKENDS),
        help="the QP solver (default: solver.backend of the file)",
    )
    build.set_defaults(carry_out=carry_out_build)


def carry_out_check(arguments: argparse.Namespace) -> int:
    """Load the file and build the model from it, so that everything is looked at."""
    from proxgen.config import load
    from proxgen.model import build_model

    model = build_model(load(arguments.config))
    parts = f"{model.n} joints, {len(model.capsules)} capsules, {len(model.modules)} sensor modules"
    print(f"{arguments.config}: no problems ({parts})")
    return 0


def carry_out_schema(arguments: argparse.Namespace) -> int:
    """Print the JSON schema of a robot's YAML file."""
    from proxgen.config.schema import Config

    print(json.dumps(Config.model_json_schema(), indent=2))
    return 0


def carry_out_generate(arguments: argparse.Namespace) -> int:
    """Generate code and say where it is."""
    from proxgen.builder.api import generate
    from proxgen.config import load

    config = load(arguments.config)
    directory = arguments.output or Path("generated") / config.robot.name
    generate(config, directory)
    print(f"generated {directory}")
    return 0


def carry_out_build(arguments: argparse.Namespace) -> int:
    """Compile what is not up to date and say where it is."""
    from proxgen.builder import build
    from proxgen.config import load

    config = load(arguments.config)
    result = build(config, arguments.output, backend=arguments.backend)
    print(f"{'built' if result.rebuilt else 'up to date:'} {result.library_dir}")
    return 0
