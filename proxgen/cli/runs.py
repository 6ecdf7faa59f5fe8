"""Verbs that simulate: run and compare."""

import argparse
import warnings
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

from proxgen.cli.arguments import (
    add_config,
    add_sensing_and_duration,
    film_file,
    latency,
    length,
    new_file,
    new_folder,
    one_of,
    probability,
    whole_number,
)
from proxgen.cli.output import columns, progress_bar, write_json
from proxgen.errors import ConfigError, Problem, ProxgenWarning

if TYPE_CHECKING:
    from proxgen.compare import Comparison
    from proxgen.config import Config
    from proxgen.config.scene import Scene
    from proxgen.controllers.protocol import Controller
    from proxgen.model import RobotModel
    from proxgen.simulation.log import RolloutLog
    from proxgen.simulation.plant import Plant

METHODS = ("repulsive", "tangential")
"""What the paper compares with: the compiled controller with another `avoidance.method`."""

CONTROLLERS = ("compiled", "reference", *METHODS)
PLANTS = ("kinematic", "dynamic")
SCENES = ("facing", "gap", "moving", "pillar", "post")
"""What `--help` names; those in `scenes` beside the robot's file are found by name, too."""


def add_verbs(verbs: Any) -> None:
    """Add the verbs of this module to the parser."""
    run = verbs.add_parser("run", help="let a controller move the arm through a scene, in simulation")
    add_config(run)
    run.add_argument(
        "--scene",
        required=True,
        metavar="NAME|FILE",
        help=f"{', '.join(SCENES)}, or a file such as my_scene.yaml",
    )
    run.add_argument(
        "--controller",
        type=one_of("controller", CONTROLLERS),
        default="compiled",
        metavar="|".join(CONTROLLERS),
        help="which one moves the arm (default: compiled); the last two are the methods of the comparison",
    )
    add_sensing_and_duration(run)
    run.add_argument(
        "--plant",
        type=one_of("plant", PLANTS),
        default="kinematic",
        metavar="|".join(PLANTS),
        help="follows commands exactly (default), or has masses, behind a model of the control cabinet",
    )
    run.add_argument(
        "--latency", type=latency, metavar="S", help="of the cabinet, with --plant dynamic (default: 10 ms)"
    )
    run.add_argument(
        "--noise", type=length, metavar="M", help="standard deviation of range readings (default: CONFIG's)"
    )
    run.add_argument(
        "--dropout",
        type=probability,
        metavar="P",
        help="probability that a sample of a sensor is lost (default: CONFIG's)",
    )
    run.add_argument(
        "--perturb",
        type=whole_number,
        metavar="SEED",
        help="move start (0.03 rad) and targets (0.02 m) at random, to see what was luck",
    )
    run.add_argument(
        "--seed", type=whole_number, default=0, metavar="N", help="of noise and dropouts (default: 0)"
    )
    run.add_argument(
        "--out", type=new_folder, metavar="DIR", help="write the log, the numbers and a report there"
    )
    run.add_argument("--json", type=new_file, metavar="FILE", help="write the numbers there")
    run.add_argument(
        "--film",
        type=film_file,
        metavar="FILE",
        help="render the run as FILE.gif or FILE.webp (about a minute)",
    )
    run.add_argument("--gui", action="store_true", help="show the simulation in a window")
    run.set_defaults(carry_out=carry_out_run, refuse=run.error)

    compare = verbs.add_parser(
        "compare", help="feed the same states to the compiled controller and to the reference"
    )
    add_config(compare)
    compare.add_argument(
        "--scene",
        action="append",
        metavar="NAME|FILE",
        help="may be given several times; default: ROBOT_scene.yaml beside CONFIG, or every scene that fits",
    )
    add_sensing_and_duration(compare)
    compare.add_argument("--out", type=new_folder, metavar="DIR", help="write the logs and a report there")
    compare.add_argument("--json", type=new_file, metavar="FILE", help="write the numbers there")
    compare.set_defaults(carry_out=carry_out_compare)


def carry_out_run(arguments: argparse.Namespace) -> int:
    """Simulate, say what came out, write what was asked for."""
    from proxgen.config import load
    from proxgen.config.scene import load_scene
    from proxgen.config.variants import with_method
    from proxgen.model import build_model

    _refuse_what_has_no_effect(arguments)
    config = load(arguments.config)
    if arguments.controller in METHODS:
        config = with_method(config, arguments.controller)
    scene = load_scene(arguments.scene, beside=arguments.config)
    sensed = _with_worse_sensors(config, arguments)
    model = build_model(sensed)
    if arguments.sensing == "skin" and not model.modules:
        message = (
            "the arm has no sensors, so that it sees no obstacle; --sensing ideal gives it exact distances"
        )
        warnings.warn(f"{arguments.config}: {message}", ProxgenWarning, stacklevel=1)
    from proxgen.simulation.doubts import doubts
    from proxgen.simulation.rollout import run
    from proxgen.simulation.scenery import perturbed

    offset = None
    if arguments.perturb is not None:
        scene, offset = perturbed(scene, model, arguments.perturb)
    for message in doubts(scene, model):
        warnings.warn(f"{arguments.scene}: {message}", ProxgenWarning, stacklevel=1)
    controller = _controller(arguments.controller, config, model)
    with (
        closing(_plant(arguments, model)) as plant,
        progress_bar(f"{config.robot.name} in {scene.name}") as progress,
    ):
        log = run(
            sensed,
            model,
            controller,
            scene,
            sensing=arguments.sensing,
            duration=arguments.duration,
            seed=arguments.seed,
            progress=progress,
            gui=arguments.gui,
            start_offset=offset,
            plant=plant,
        )
    _write_run(arguments, log, sensed, model)
    return 0


def _write_run(
    arguments: argparse.Namespace, log: "RolloutLog", config: "Config", model: "RobotModel"
) -> None:
    """The numbers first, and what takes long or may fail last, so that a failure there loses none of them."""
    summary = log.summary()
    print(columns([(key, _shown(value)) for key, value in summary.items()]))
    if arguments.json:
        write_json(arguments.json, summary)
    if arguments.out:
        arguments.out.mkdir(parents=True, exist_ok=True)
        log.save(arguments.out / "log.npz")
        write_json(arguments.out / "summary.json", summary)
    if arguments.film:
        from proxgen.report.film import write_film

        with progress_bar("film") as progress:
            print(f"film: {write_film(arguments.film, log, model, progress=progress)}")
    if arguments.out:
        from proxgen.report import write_report

        print(f"report: {write_report(arguments.out, [log], config=config, film=arguments.film)}")


def _refuse_what_has_no_effect(arguments: argparse.Namespace) -> None:
    """Flags that say something of what is not there are a mistake; exit status 2."""
    if arguments.latency is not None and arguments.plant != "dynamic":
        arguments.refuse("--latency is the control cabinet's; it needs --plant dynamic")
    for flag in ("noise", "dropout"):
        if getattr(arguments, flag) is not None and arguments.sensing != "skin":
            arguments.refuse(f"--{flag} is of the skin's sensors; it needs --sensing skin")


def _with_worse_sensors(config: "Config", arguments: argparse.Namespace) -> "Config":
    """The configuration with noise and dropouts, if any are asked for; the controller is not told."""
    from proxgen.config.variants import with_noise

    if arguments.noise is None and arguments.dropout is None:
        return config
    return with_noise(config, arguments.noise, arguments.dropout)


def _plant(arguments: argparse.Namespace, model: "RobotModel") -> "Plant":
    """What moves."""
    if arguments.plant == "kinematic":
        import numpy as np

        from proxgen.simulation.plant import KinematicPlant

        return KinematicPlant(np.zeros(model.n))
    from proxgen.simulation.cabinet import Cabinet
    from proxgen.simulation.dynamic_plant import DynamicPlant

    return DynamicPlant(model, Cabinet() if arguments.latency is None else Cabinet(arguments.latency))


def carry_out_compare(arguments: argparse.Namespace) -> int:
    """Compare the two controllers; status 1 if they differ by more than the tolerance."""
    from proxgen.compare import compare
    from proxgen.config import load
    from proxgen.config.scene import load_scene
    from proxgen.model import build_model

    config = load(arguments.config)
    if arguments.scene:
        scenes = [load_scene(name, beside=arguments.config) for name in arguments.scene]
    else:
        scenes = _fitting_scenes(arguments.config, build_model(config))
    with progress_bar(f"{config.robot.name}: compiled and reference") as progress:
        comparison = compare(
            config, scenes, sensing=arguments.sensing, duration=arguments.duration, progress=progress
        )
    numbers = comparison.to_json()
    if arguments.json:
        write_json(arguments.json, numbers)
    if arguments.out:
        _write_comparison(arguments.out, comparison, config)
    rows = numbers["scenes"]
    print(columns([tuple(rows[0])] + [tuple(_shown(value) for value in row.values()) for row in rows]))
    for failure in comparison.failures:
        print(failure)
    print(f"verdict: {comparison.verdict}")
    return 0 if comparison.verdict == "pass" else 1


def _write_comparison(directory: Path, comparison: "Comparison", config: "Config") -> None:
    """The logs of the closed loops, the numbers and the report."""
    from proxgen.report import write_report

    directory.mkdir(parents=True, exist_ok=True)
    logs = [scene.log for scene in comparison.scenes if scene.log is not None]
    for log in logs:
        log.save(directory / f"{log.meta['scene']}.npz")
    write_json(directory / "comparison.json", comparison.to_json())
    print(f"report: {write_report(directory, logs, comparison, config)}")


def _controller(name: str, config: "Config", model: "RobotModel") -> "Controller":
    """The controller that moves the arm."""
    if name == "reference":
        from proxgen.controllers.reference import ReferenceController

        return ReferenceController(config, model)
    import proxgen
    from proxgen.config.variants import variant_name

    folder = Path("build") / variant_name(config) if name in METHODS else None
    controller: Controller = proxgen.build(config, folder)
    return controller


def _fitting_scenes(beside: Path, model: "RobotModel") -> "list[Scene]":
    """The scene beside the robot's file that `init` wrote; else all that the arm can start in."""
    from proxgen.config.scene import load_scene, scene_names

    own = beside.with_name(f"{beside.stem}_scene.yaml")
    if own.is_file():
        return [load_scene(own)]
    scenes: list[Scene] = []
    refusals: list[Problem] = []
    for name in scene_names(beside):
        scene = load_scene(name, beside=beside)
        try:
            limits = (model.q_lower.tolist(), model.q_upper.tolist())
            scene.start_positions(model.joint_names, *limits, model.prismatic)
            scenes.append(scene)
        except ConfigError as error:
            refusals += error.problems
    if not scenes:
        raise ConfigError(refusals)
    return scenes


def _shown(value: Any) -> str:
    """A number of a result as text."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_shown(inner)}" for key, inner in value.items())
    return f"{value:.4g}" if isinstance(value, float) else f"{value}"
