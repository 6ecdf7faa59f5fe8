"""Verbs that turn files into files: init, check, schema, generate, build."""

import argparse
import json
import warnings
from pathlib import Path
from typing import Any

from proxgen.cli.arguments import add_config, new_file, new_folder, one_of
from proxgen.cli.output import columns, shown_path
from proxgen.errors import ConfigError, Problem, ProxgenWarning

BACKENDS = ("qpoases", "daqp")


def add_verbs(verbs: Any) -> None:
    """Add the verbs of this module to the parser."""
    init = verbs.add_parser("init", help="write a first YAML file, and a first scene, for any URDF")
    init.add_argument("urdf", metavar="URDF", help="a path, or package://PACKAGE/path in a Python package")
    init.add_argument("--tool", required=True, metavar="FRAME", help="the frame whose motion is the task")
    init.add_argument(
        "-o", "--output", type=new_file, metavar="FILE", help="default: ROBOT.yaml in this folder"
    )
    init.add_argument("--force", action="store_true", help="replace files that exist")
    init.set_defaults(carry_out=carry_out_init)

    check = verbs.add_parser("check", help="find all mistakes in the YAML file of a robot or a scene")
    check.add_argument("config", metavar="FILE", type=Path, help="the YAML file of a robot or of a scene")
    check.add_argument(
        "--explain", action="store_true", help="print every value in use and where it comes from"
    )
    check.set_defaults(carry_out=carry_out_check)

    schema = verbs.add_parser("schema", help="print the JSON schema, for editors")
    which = schema.add_mutually_exclusive_group()
    which.add_argument("--scene", action="store_true", help="of a scene's file, instead of a robot's")
    which.add_argument("--page", action="store_true", help="print docs/configuration.md instead")
    schema.set_defaults(carry_out=carry_out_schema)

    generate = verbs.add_parser("generate", help="generate the controller's C code")
    add_config(generate)
    generate.add_argument(
        "-o", "--output", type=new_folder, metavar="DIR", help="default: generated/ROBOT in this folder"
    )
    generate.set_defaults(carry_out=carry_out_generate)

    build = verbs.add_parser("build", help="generate and compile the controller")
    add_config(build)
    build.add_argument(
        "-o", "--output", type=new_folder, metavar="DIR", help="default: build/ROBOT in this folder"
    )
    build.add_argument(
        "--backend",
        type=one_of("back end", BACKENDS),
        metavar="|".join(BACKENDS),
        help="the QP solver (default: solver.backend of the file)",
    )
    build.set_defaults(carry_out=carry_out_build)


def carry_out_init(arguments: argparse.Namespace) -> int:
    """Write the first files and say what comes next."""
    from proxgen.scaffold import scaffold

    path = scaffold(arguments.urdf, arguments.tool, arguments.output, force=arguments.force)
    scene = path.with_name(f"{path.stem}_scene.yaml")
    print(f"wrote {path} and {scene}")
    print(f"next: proxgen check {path} && proxgen compare {path} --scene {scene}")
    return 0


def carry_out_check(arguments: argparse.Namespace) -> int:
    """Load the file and build the model from it, so that everything is looked at."""
    from proxgen.config import load
    from proxgen.config.loader import is_scene

    if is_scene(arguments.config):
        return _check_scene(arguments)
    config = load(arguments.config)
    from proxgen.model import build_model
    from proxgen.model.braking import hard_braking
    from proxgen.model.held import held_outside

    model = build_model(config)
    hard = hard_braking(config, model)
    for doubt in (*held_outside(config), *([hard] if hard is not None else [])):
        warnings.warn(str(doubt), ProxgenWarning, stacklevel=1)
    if arguments.explain:
        from proxgen.config.explain import explain

        print(explain(config), end="")
        rows: list[tuple[str, ...]] = [("# joint", "lower", "upper", "velocity", "acceleration")]
        limits = (model.q_lower, model.q_upper, model.qdot_limit, model.qddot_limit)
        for name, *values in zip(model.joint_names, *(limit.tolist() for limit in limits), strict=True):
            rows.append((f"# {name}", *(f"{value:.6g}" for value in values)))
        print(f"# limits in use, the URDF's ({config.urdf_path.name}) where the file gives none:")
        print(columns(rows))
        return 0
    counts = ((model.n, "joint"), (len(model.capsules), "capsule"), (len(model.modules), "sensor module"))
    parts = ", ".join(f"{count} {name}{'s' if count != 1 else ''}" for count, name in counts)
    print(f"{arguments.config}: no problems ({parts})")
    return 0


def _check_scene(arguments: argparse.Namespace) -> int:
    """Load a scene; whether the arm fits into it is seen when it runs."""
    from proxgen.config.scene import load_scene

    scene = load_scene(arguments.config)
    parts = f"a scene with {len(scene.obstacles)} obstacles and {len(scene.targets)} targets"
    print(f"{arguments.config}: no problems ({parts})")
    return 0


def carry_out_schema(arguments: argparse.Namespace) -> int:
    """Print the JSON schema of a file, or the reference page."""
    if arguments.page:
        from proxgen.config.reference_page import configuration_page

        print(configuration_page(), end="")
        return 0
    from proxgen.config.json_schema import robot_schema, scene_schema

    print(json.dumps(scene_schema() if arguments.scene else robot_schema(), indent=2))
    return 0


def carry_out_generate(arguments: argparse.Namespace) -> int:
    """Generate code and say where it is."""
    from proxgen.builder.api import generate
    from proxgen.config import load

    print(f"generated {generate(load(arguments.config), arguments.output)}")
    return 0


def carry_out_build(arguments: argparse.Namespace) -> int:
    """Compile what is not up to date and say where it is."""
    from proxgen.builder import build, default_directory, other_owner
    from proxgen.config import load

    config = load(arguments.config)
    if arguments.output is None and (other := other_owner(config)) is not None:
        message = (
            f"{default_directory(config)} holds the controller of {shown_path(other)}, which has the same "
            f"name '{config.robot.name}'; give this file another one, or say with -o where to build"
        )
        raise ConfigError([Problem(arguments.config, 0, "robot.name", message)])
    result = build(config, arguments.output, backend=arguments.backend)
    print(f"{'built' if result.rebuilt else 'up to date:'} {shown_path(result.library_dir)}")
    return 0
