"""`proxgen init`: a first configuration and a first scene for any serial arm."""

import os
import re
import tempfile
import warnings
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np

from proxgen.config.loader import load
from proxgen.config.urdf import PACKAGE, resolve_urdf
from proxgen.errors import ConfigError, ModelError, Problem, ProxgenWarning
from proxgen.files import whole_file
from proxgen.model import RobotModel, build_model
from proxgen.model.posture import Posture
from proxgen.scaffold.capsules import CapsuleProposal, propose_capsules
from proxgen.scaffold.chain import Arm, read_arm
from proxgen.scaffold.cuffs import propose_cuffs
from proxgen.scaffold.names import robot_name
from proxgen.scaffold.postures import start_posture, task_rows, usual_postures
from proxgen.scaffold.render import Sheet, Stopgaps, render_robot, render_scene
from proxgen.scaffold.scene import propose_scene


def scaffold(urdf: str, tool: str, output: Path | None = None, *, force: bool = False) -> Path:
    """Write a first YAML file for a robot, and a first scene beside it.

    Args:
        urdf: path of a URDF, or `package://PACKAGE/path` in an installed Python package.
        tool: name of the frame whose motion is the task.
        output: the YAML file; `ROBOT.yaml` in the current folder if None. The scene goes beside it.
        force: replace files that exist.

    Returns:
        The YAML file. Both files are written, or none.

    Raises:
        ModelError: the URDF or one of its meshes cannot be read, or has no arm that ends at the tool.
        ConfigError: a file exists already.

    Warns:
        ProxgenWarning: the URDF lacks limits or geometry; the file has blanks to be filled in.
    """
    path = resolve_urdf(urdf, Path.cwd())
    arm = read_arm(path, tool)
    name = robot_name(arm.robot)
    output = Path(f"{name}.yaml") if output is None else output
    scene_file = output.with_name(f"{output.stem}_scene.yaml")
    existing = [file for file in (output, scene_file) if file.exists()]
    if existing and not force:
        message = "the file exists already; --force (force=True) replaces it"
        raise ConfigError([Problem(file, 0, "", message) for file in existing])
    capsules = propose_capsules(arm.bodies)
    scale = float(np.clip(np.floor(4.0 * arm.size + 0.5) / 4.0, 0.25, 1.0))
    solid = all(capsule.radius is not None for capsule in capsules)
    blanks = _blanks(arm, capsules)
    sheet = Sheet(name, str(path), ("x", "y", "z"), solid, not blanks, scale)
    model = _draft_model(render_robot(sheet, arm, capsules, [], Stopgaps()), capsules)
    rows = task_rows(model)
    if not rows:
        message = f"no joint moves the position of the tool frame '{tool}'; choose a frame further out"
        raise ModelError(f"{path}: {message}")
    start = start_posture(model, rows)
    cuffs = propose_cuffs(capsules, usual_postures(start)) if solid else []
    sheet = replace(sheet, rows=rows)
    model = _draft_model(render_robot(sheet, arm, capsules, cuffs, Stopgaps()), capsules)
    scene = propose_scene(Posture(model, start.q), rows, arm.size, sheet.thresholds)
    sheet = replace(sheet, urdf=_reference(urdf, path, output))
    texts = {
        output: render_robot(sheet, arm, capsules, cuffs),
        scene_file: render_scene(sheet, arm, scene, output.name, scene_file.name),
    }
    _write(texts)
    if blanks:
        message = f"{output}: fill in what the URDF does not say, at FILL IN: {', '.join(blanks)}"
        warnings.warn(message, ProxgenWarning, stacklevel=2)
    return output


def _draft_model(text: str, capsules: list[CapsuleProposal]) -> RobotModel:
    """The model of a file that does not exist yet; this also shows that the file is accepted."""
    with tempfile.TemporaryDirectory() as folder:
        draft = Path(folder) / "draft.yaml"
        draft.write_text(text, encoding="utf-8")
        try:
            return build_model(load(draft))
        except ConfigError as error:
            told = "; ".join(_told(problem, capsules) for problem in error.problems)
            if "is out of range" in told:
                told += ' (a URDF is in metres: a mesh in millimetres needs scale="0.001 0.001 0.001")'
            raise ModelError(f"the URDF leads to values that a configuration cannot have: {told}") from error


def _told(problem: Problem, capsules: list[CapsuleProposal]) -> str:
    """A problem of the draft, with the link for a capsule's number."""
    match = re.fullmatch(r"capsules\.(\d+)\.radius", problem.key)
    if match is None:
        return f"{problem.key}: {problem.message}"
    return f"radius of the capsule around link '{capsules[int(match[1])].frame}': {problem.message}"


def _reference(urdf: str, path: Path, output: Path) -> str:
    """How the YAML file names the URDF: as a package's file, or relative to itself."""
    if urdf.startswith(PACKAGE):
        return urdf
    return Path(os.path.relpath(path, output.resolve().parent)).as_posix()


def _write(texts: Mapping[Path, str]) -> None:
    """Write files whole, all or none: everything goes beside its place first."""
    with ExitStack() as together:
        for path, text in texts.items():
            together.enter_context(whole_file(path)).write(text.encode())


def _blanks(arm: Arm, capsules: list[CapsuleProposal]) -> list[str]:
    """Keys of what the user has to fill in."""
    blanks = [f"limits.position.{joint.name}" for joint in arm.joints if joint.needs_position]
    blanks += [f"limits.velocity.{joint.name}" for joint in arm.joints if joint.needs_velocity]
    return blanks + [f"capsules.{k}.radius" for k, capsule in enumerate(capsules) if capsule.radius is None]
