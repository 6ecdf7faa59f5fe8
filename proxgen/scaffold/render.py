"""From proposals to the text of the two YAML files. Structure is in the templates, formats are here."""

import json
import re
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import jinja2
import numpy as np

from proxgen.config.urdf import PACKAGE
from proxgen.model.robot_model import Array
from proxgen.scaffold.capsules import CapsuleProposal
from proxgen.scaffold.chain import Arm, ArmJoint
from proxgen.scaffold.cuffs import GAP, CuffProposal
from proxgen.scaffold.names import shortened
from proxgen.scaffold.scene import SceneProposal, Thresholds
from proxgen.templates import environment

WIDTH = 110
_PLAIN = re.compile(r"^(\.{1,2}/)*[A-Za-z_/][A-Za-z0-9_./-]*$")
_NOT_STRINGS = frozenset({"true", "false", "yes", "no", "on", "off", "y", "n", "null"})


@dataclass(frozen=True)
class Sheet:
    """What the robot's file says beside the arm, the capsules and the cuffs.

    Attributes:
        robot: name, an identifier.
        urdf: as it is written in the file.
        rows: the task's position rows.
        solid: whether the URDF has any collision geometry on moving links.
        complete: whether the URDF says everything that is needed.
        scale: 1 for an arm of a metre or more, less for a smaller one.
    """

    robot: str
    urdf: str
    rows: tuple[str, ...]
    solid: bool
    complete: bool
    scale: float

    @property
    def speed(self) -> float:
        """Greatest speed of the tool [m/s]."""
        return 0.25 * self.scale

    @property
    def tolerance(self) -> float:
        """Distance at which a target is reached [m]."""
        return 0.02 * self.scale

    @property
    def trigger(self) -> float:
        """Distance at which a switch closes [m]."""
        return 0.10 * self.scale

    @property
    def virtual(self) -> float:
        """Where a closed switch places its obstacle point [m]."""
        return 0.08 * self.scale

    @property
    def damping(self) -> tuple[float, float, float]:
        """Gain, threshold and floor of (15): as in the preset, scaled as J'J, w and J'J are with lengths."""
        return 0.1 * self.scale**2, 1e-3 * self.scale ** len(self.rows), 1e-3 * self.scale**2

    @property
    def thresholds(self) -> Thresholds:
        """Thresholds to the capsules' surfaces."""
        return Thresholds(*(round(value * self.scale, 4) for value in (0.24, 0.18, 0.15, 0.10)))


class Blanks:
    """What stands where the URDF gives nothing: a blank and the question."""

    def position(self, joint: ArmJoint) -> str:
        """Position limits that only the user knows."""
        return f"# FILL IN: [lower, upper] in {joint.unit}"

    def velocity(self, joint: ArmJoint) -> str:
        """A velocity limit that only the user knows."""
        return f"# FILL IN: in {joint.unit}/s"

    def radius(self, capsule: CapsuleProposal) -> str:
        """A capsule's radius, or the question for it."""
        return number(capsule.radius) if capsule.radius is not None else "# FILL IN: in m"


class Stopgaps(Blanks):
    """Values in place of the blanks, so that a draft can be loaded. They never reach the user's file."""

    def position(self, joint: ArmJoint) -> str:
        """Limits that most joints have."""
        return "[-0.1, 0.1]" if joint.kind == "prismatic" else "[-1, 1]"

    def velocity(self, joint: ArmJoint) -> str:
        """Any velocity."""
        return "1"

    def radius(self, capsule: CapsuleProposal) -> str:
        """A thin link."""
        return number(0.02 if capsule.radius is None else capsule.radius)


def render_robot(
    sheet: Sheet,
    arm: Arm,
    capsules: Sequence[CapsuleProposal],
    cuffs: Sequence[CuffProposal],
    fill: Blanks | None = None,
) -> str:
    """Text of the robot's file.

    Args:
        sheet: general values.
        arm: what the URDF says.
        capsules: one per link, radius None where it is asked for.
        cuffs: possibly none.
        fill: what to write where the URDF gives nothing; blanks with a question by default.
    """
    covered = {capsule.frame for capsule in capsules}
    return _template("robot.yaml.j2").render(
        sheet=sheet,
        arm=arm,
        capsules=capsules,
        cuffs=cuffs,
        fill=fill or Blanks(),
        thresholds=sheet.thresholds,
        gap_mm=f"{GAP * 1000.0:.0f}",
        asked_positions=[joint for joint in arm.joints if joint.needs_position],
        asked_velocities=[joint for joint in arm.joints if joint.needs_velocity],
        limits_table=_limits_table(arm.joints),
        branches=", ".join(f"{joint.name} ({number(joint.position)})" for joint in arm.branches),
        mimics=", ".join(f"{name} (follows {leader})" for name, leader in arm.mimics),
        hollow=", ".join(body.link for body in arm.bodies if body.link not in covered),
    )


def render_scene(sheet: Sheet, arm: Arm, scene: SceneProposal, config_name: str, scene_name: str) -> str:
    """Text of the scene's file; both file names are shown in it."""
    speed = round(0.1 * sheet.scale, 3)
    return _template("scene.yaml.j2").render(
        robot=sheet.robot,
        name=shortened(sheet.robot, "_scene"),
        config_name=config_name,
        scene_name=scene_name,
        scene=scene,
        speed=speed,
        period=float(np.ceil(2.0 * scene.visitor.distance / speed) + 5.0),
        start=[(joint.name, position) for joint, position in zip(arm.joints, scene.start, strict=True)],
        asked=any(joint.needs_position for joint in arm.joints),
    )


def _limits_table(joints: Sequence[ArmJoint]) -> str:
    """The limits that the URDF gives, as comments."""
    width = max(len(joint.name) for joint in joints)
    lines = []
    for joint in joints:
        span, speed = "no position limits", "no velocity limit"
        if joint.kind == "continuous":
            span = "turns without end"
        elif joint.lower is not None and joint.upper is not None:
            span = f"{number(joint.lower)} to {number(joint.upper)} {joint.unit}"
        if joint.velocity is not None:
            speed = f"{number(joint.velocity)} {joint.unit}/s"
        lines.append(f"#   {_one_line(joint.name).ljust(width)}  {span}, {speed}")
    return "\n".join(lines)


def number(value: float) -> str:
    """A number with up to 5 decimals and 6 significant digits, without an exponent."""
    if value and abs(value) < 1e-4:
        return f"{value:.9f}".rstrip("0")
    text = f"{float(f'{value:.6g}'):.5f}".rstrip("0").rstrip(".")
    return "0" if text in {"-0", ""} else text


def vector(values: Array) -> str:
    """A list of numbers."""
    return f"[{', '.join(number(float(value)) for value in values)}]"


def scalar(text: str) -> str:
    """A string as a YAML scalar: plain if it can be, else in quotes."""
    if _PLAIN.match(text) and text.lower() not in _NOT_STRINGS:
        return text
    if text.startswith(PACKAGE) and _PLAIN.match(text.removeprefix(PACKAGE)):
        return text
    return json.dumps(text, ensure_ascii=False)


def comment(text: str, start: str) -> str:
    """Text as comment lines; `start` opens the first line, its indentation and # the others."""
    indent = start[: start.index("#") + 1]
    words = _one_line(start[len(indent) :] + text)
    wrapped = textwrap.wrap(
        words,
        WIDTH,
        initial_indent=f"{indent} ",
        subsequent_indent=f"{indent}   ",
        break_long_words=False,
        break_on_hyphens=False,
    )
    return "\n".join(wrapped)


def _one_line(text: str) -> str:
    """Text without line breaks, which would end a comment."""
    return " ".join(text.split())


def _template(name: str) -> jinja2.Template:
    """A template of this room, with the formats above."""
    formats = environment("scaffold", number=number, vector=vector, scalar=scalar, comment=comment)
    return formats.get_template(name)
