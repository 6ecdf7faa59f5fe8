"""The shape of a robot's YAML file: every key with its type, unit, default, range and equation.

A key is declared here, in `skin.py` or in `avoidance.py`, and nowhere else; the JSON schema, the reference
page and the checks all come from there. Equation numbers are those of `docs/method.md`; values are SI and
radians.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal

from pydantic import AfterValidator, Discriminator, Field, PrivateAttr, Tag

from proxgen.config.avoidance import Active, Avoidance, Damper, Damping, Relaxation, Slack
from proxgen.config.origin import Origin
from proxgen.config.quantities import (
    Angle,
    AngularSpeed,
    Count,
    Frequency,
    JointAcceleration,
    JointPosition,
    JointSpeed,
    Length,
    Number,
    Rate,
    Speed,
    Time,
)
from proxgen.config.reserved import RESERVED_NAMES
from proxgen.config.section import (
    Direction,
    Finding,
    Flag,
    Name,
    Section,
    Vector3,
    unique_names,
    zero_vector,
)
from proxgen.config.skin import Capacitive, Cuff, Ring, Skin, TimeOfFlight
from proxgen.errors import Problem, unknown_name

__all__ = [
    "Active", "Avoidance", "Capacitive", "Capsule", "Config", "Control", "Cuff", "Damper", "Damping",
    "Limits", "Posture", "Relaxation", "Ring", "Robot", "Skin", "Slack", "Solver", "Task", "TimeOfFlight",
]  # fmt: skip

TaskRow = Literal["x", "y", "z", "rx", "ry", "rz"]
Position = Annotated[float, JointPosition()]
PositiveAcceleration = Annotated[float, JointAcceleration(ge=1e-6, le=1e6)]

ROWS_OF_KIND: dict[str, tuple[TaskRow, ...]] = {
    "position": ("x", "y", "z"),
    "pose": ("x", "y", "z", "rx", "ry", "rz"),
    "pointing": ("x", "y", "z", "rx", "ry"),
}
"""Rows that a kind of task has; `rx`, `ry` of a pointing task turn about the two normals to its axis."""


def scalar_or_mapping(value: object) -> str:
    """Which form of a value was written where one number, or one per joint, is allowed."""
    return "mapping" if isinstance(value, dict) else "scalar"


class Robot(Section):
    """Which arm, and which chain of it is controlled."""

    name: Name = Field(description="name of the generated folder, and prefix of every C symbol")
    urdf: str = Field(description="path of the URDF, relative to the YAML file, or package://PACKAGE/path")
    tool: str = Field(description="URDF frame whose motion is the task")
    tool_offset: Vector3 = Field((0.0, 0.0, 0.0), description="task point in the tool frame")
    locked_joints: dict[str, Position] = Field(
        default_factory=dict,
        description="joints between base and tool that are held at a fixed position; joints on other "
        "branches are always locked, at the position given here or the nearest to zero within their limits; "
        "nothing may lie on a branch that follows a controlled joint (mimic) unless it is locked here",
    )

    def contradictions(self) -> Iterator[Finding]:
        """A name that would clash with symbols of the runtime."""
        if self.name in RESERVED_NAMES:
            yield Finding(("name",), f"'{self.name}' {RESERVED_NAMES[self.name]}; choose another name")


class Posture(Section):
    """A preferred posture, followed where task and obstacles leave freedom."""

    joints: dict[str, Position] = Field(description="preferred position per joint; others stay free at 0")
    gain: Annotated[float, Rate(ge=0.0, le=100.0)] = Field(
        1.0, description="k: desired velocity = gain * (preferred - q) (9)"
    )
    weight: Annotated[float, Number(ge=0.0, le=100.0)] = Field(
        1e-3, description="W: weight of the squared deviation in the objective (9)"
    )


class Task(Section):
    """What the tool is to do, and how a target becomes the task velocity."""

    kind: Literal["position", "pose", "pointing"] = Field(
        "position",
        description="position (3 rows), pose (6), pointing (position and the direction of one axis, 5)",
    )
    rows: Annotated[tuple[TaskRow, ...], Field(min_length=1)] | None = Field(
        None, description="a subset of the rows of the task; all rows of its kind if absent"
    )
    axis: Direction = Field((0.0, 0.0, 1.0), description="pointing axis in the tool frame (kind: pointing)")
    gain: Annotated[float, Rate(gt=0.0, le=100.0)] = Field(2.0, description="k_p: task speed per error")
    max_speed: Annotated[float, Speed(gt=0.0, le=10.0)] = Field(
        0.25, description="v_max: bound of the linear task speed"
    )
    max_angular_speed: Annotated[float, AngularSpeed(gt=0.0, le=10.0)] = Field(
        1.0, description="bound of the angular task speed"
    )
    tolerance: Annotated[float, Length(gt=0.0, le=1.0)] = Field(
        0.02, description="a target nearer than this is reached"
    )
    angular_tolerance: Annotated[float, Angle(gt=0.0, le=3.2)] = Field(
        0.05, description="the same for the orientation"
    )
    posture: Posture | None = Field(None, description="null-space posture task")

    def contradictions(self) -> Iterator[Finding]:
        """A pointing axis without direction; rows that the kind does not have, or that are repeated."""
        yield from zero_vector("axis", self.axis)
        for index, row in enumerate(self.rows or ()):
            if row not in ROWS_OF_KIND[self.kind]:
                yield Finding(
                    (f"rows.{index}", "rows"),
                    unknown_name(f"row of a {self.kind} task", row, ROWS_OF_KIND[self.kind]),
                )
            elif row in (self.rows or ())[:index]:
                yield Finding((f"rows.{index}", "rows"), f"row '{row}' is given twice")


class Limits(Section):
    """Joint limits; positions and velocities are read from the URDF unless overridden here."""

    position: dict[str, tuple[Position, Position]] = Field(
        default_factory=dict,
        description="lower and upper position limit per joint, in place of the URDF's (11); the URDF's "
        "limits of joints that follow it (mimic) hold as well, also for the velocity",
    )
    velocity: dict[str, Annotated[float, JointSpeed(ge=1e-6, le=1e3)]] = Field(
        default_factory=dict, description="velocity limit per joint, in place of the URDF's (11)"
    )
    acceleration: (
        Annotated[
            Annotated[PositiveAcceleration, Tag("scalar")]
            | Annotated[dict[str, PositiveAcceleration], Tag("mapping")],
            Discriminator(scalar_or_mapping),
        ]
        | None
    ) = Field(20.0, description="bound of the change of the velocity, one for all or per joint; null: none")
    joint_damper: Annotated[float, Rate(ge=1e-6, le=1e3)] | None = Field(
        5.0, description="k_d: velocity allowed per distance to the position limit; null: hard switch (11)"
    )
    viability: Flag = Field(
        False, description="brake early enough to stop at every position limit with `acceleration` (a)"
    )
    tolerance: Annotated[float, JointPosition(ge=0.0, le=1.0)] = Field(
        0.1, description="a measured position further than this outside its limits is a fault"
    )

    def contradictions(self) -> Iterator[Finding]:
        """Position limits in the wrong order; viability without an acceleration to brake with."""
        for joint, (lower, upper) in self.position.items():
            if not lower < upper:
                message = f"the lower limit {lower:.6g} must be less than the upper limit {upper:.6g}"
                yield Finding((f"position.{joint}",), message)
        if self.viability and not self.acceleration:
            yield Finding(
                ("viability", "acceleration"), "viability needs an acceleration limit to brake with"
            )


class Capsule(Section):
    """A capsule that stands for a link: all points within `radius` of a segment."""

    name: Name = Field(description="for messages and plots; must differ from the other capsules' names")
    frame: str = Field(description="URDF frame in which the end points are given; the capsule moves with it")
    start: Vector3 = Field(description="one end of the axis")
    end: Vector3 = Field(description="the other end of the axis; equal to `start` for a sphere")
    radius: Annotated[float, Length(gt=0.0, le=1.0)] = Field(
        description="of the capsule; distances are measured to it if distance_reference is surface"
    )


class Solver(Section):
    """The QP solver of the compiled controller."""

    backend: Literal["qpoases", "daqp"] = Field(
        "qpoases", description="qpoases: as in the paper; daqp: faster, no heap use, C only"
    )
    max_iterations: Annotated[int, Count(ge=5, le=10000)] = Field(
        100, description="working-set changes per solve"
    )
    tolerance: Annotated[float, Number(ge=1e-12, le=1e-4)] = Field(
        1e-8, description="greatest KKT residual that is certified"
    )


class Control(Section):
    """The control cycle."""

    rate: Annotated[float, Frequency(ge=1.0, le=1e4)] = Field(50.0, description="cycles per second")
    deadline: Annotated[float, Time(ge=1e-4, le=10.0)] | None = Field(
        None, description="a longer time between two cycles is a fault; null: not checked"
    )

    def contradictions(self) -> Iterator[Finding]:
        """A deadline that every cycle would miss."""
        if self.deadline is not None and self.deadline < 1.0 / self.rate:
            period = 1.0 / self.rate
            message = (
                f"deadline = {self.deadline:.6g} s must be at least one period, {period:.6g} s at this rate"
            )
            yield Finding(("deadline", "rate"), message)


class Config(Section):
    """One robot's whole configuration, as loaded from one YAML file."""

    robot: Robot
    task: Task = Task()
    limits: Limits = Limits()
    capsules: Annotated[tuple[Capsule, ...], AfterValidator(unique_names)] = Field(
        min_length=1, description="one capsule per avoiding link, each with one row of (5)"
    )
    skin: Skin = Skin()
    avoidance: Avoidance = Avoidance()
    damping: Damping = Damping()
    relaxation: Relaxation = Relaxation()
    solver: Solver = Solver()
    control: Control = Control()

    _origin: Origin = PrivateAttr(default_factory=lambda: Origin(Path()))

    def contradictions(self) -> Iterator[Finding]:
        """Joints that are locked and wanted elsewhere at the same time."""
        posture = self.task.posture.joints if self.task.posture else {}
        for joint in self.robot.locked_joints:
            if joint in posture:
                message = f"joint '{joint}' is locked (robot.locked_joints); it has no posture to follow"
                yield Finding((f"task.posture.joints.{joint}",), message)
        yield from self._outside_limits("robot.locked_joints", self.robot.locked_joints)
        yield from self._additions()
        yield from self._outside_limits("task.posture.joints", posture)

    def _additions(self) -> Iterator[Finding]:
        """Additions that do not go with the task, the relaxation, the skin or the capsules."""
        method, rows = self.avoidance.method, self.task.rows or ROWS_OF_KIND[self.task.kind]
        linear = {"x", "y", "z"}.intersection(rows)
        if self.avoidance.circulation.enabled and not linear:
            message = "circulation moves the tool along x, y, z, and the task has none of these rows"
            yield Finding(("avoidance.circulation.enabled", "task.rows"), message)
        if method == "tangential" and len(linear) < 3:
            message = "the tangential method needs all of the rows x, y, z of the task"
            yield Finding(("avoidance.method", "task.rows"), message)
        if method != "proposed" and self.relaxation.mode != "staged":
            message = f"avoidance.method: {method} needs the relaxation mode 'staged'"
            yield Finding(("relaxation.mode", "avoidance.method"), message)
        blind = not (self.skin.cuffs or self.skin.max_points)
        if blind and not self.avoidance.self_collision.points:
            message = (
                "there are no cuffs, and no place for points from elsewhere: the arm would avoid nothing"
            )
            yield Finding(("skin.max_points", "skin.cuffs"), message)
        names = [capsule.name for capsule in self.capsules]
        for index, pair in enumerate(self.avoidance.self_collision.exclude):
            if pair.capsule not in names:
                key = f"avoidance.self_collision.exclude.{index}.capsule"
                yield Finding((key,), unknown_name("capsule", pair.capsule, names))

    def _outside_limits(self, key: str, positions: dict[str, float]) -> Iterator[Finding]:
        """Joint positions outside of what `limits.position` says."""
        for joint, position in positions.items():
            lower, upper = self.limits.position.get(joint, (position, position))
            if not lower <= position <= upper:
                limits = f"{lower:.6g} to {upper:.6g} of limits.position.{joint}"
                yield Finding((f"{key}.{joint}",), f"{position:.6g} is outside the limits {limits}")

    @property
    def source(self) -> Path:
        """The YAML file, as the user named it."""
        return self._origin.source

    @property
    def urdf_path(self) -> Path:
        """The robot description: `robot.urdf` resolved against the YAML file, or found in its package."""
        return self._origin.urdf_path

    @property
    def origin(self) -> Origin:
        """Where every value was written."""
        return self._origin

    def line_of(self, key: str) -> int:
        """Line of a key (dotted path); of the section around it if the key has its default; 0 if none."""
        return self._origin.mark(key).line

    def problem(self, key: str, message: str) -> Problem:
        """A problem at a key's place in its file, for checks that need more than the file."""
        return self._origin.problem(key, message)
