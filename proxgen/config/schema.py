"""The shape of a robot's YAML file: every key with its type, unit, default, range and equation.

This is the only place where a key is declared; the JSON schema, the reference page and the checks all come
from it. Equation numbers are those of `docs/method.md`. All values are SI units and radians.
"""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from proxgen.config.quantities import (
    Angle,
    AngularSpeed,
    Frequency,
    JointAcceleration,
    JointPosition,
    JointSpeed,
    Length,
    Rate,
    Speed,
    Time,
)

Vector3 = tuple[Length, Length, Length]
Direction = tuple[float, float, float]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=40)]
TaskRow = Literal["x", "y", "z", "rx", "ry", "rz"]


class Section(BaseModel):
    """Base of all sections: frozen, and strict about keys that it does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Robot(Section):
    """Which arm, and which chain of it is controlled."""

    name: Name = Field(description="name of the generated folder, and prefix of every C symbol")
    urdf: str = Field(description="path of the URDF, relative to the YAML file, or package://PACKAGE/path")
    tool: str = Field(description="URDF frame whose motion is the task")
    tool_offset: Vector3 = Field((0.0, 0.0, 0.0), description="task point in the tool frame")
    locked_joints: dict[str, JointPosition] = Field(
        default_factory=dict,
        description="joints between base and tool that are held at a fixed position; joints on other branches "
        "are always locked, at the position given here or at the nearest to zero within their limits",
    )


class Posture(Section):
    """A preferred posture, followed where task and obstacles leave freedom."""

    joints: dict[str, JointPosition] = Field(description="preferred position per joint; others stay free at 0")
    gain: Rate = Field(1.0, ge=0.0, description="desired velocity = gain * (preferred - q)")
    weight: float = Field(1e-3, ge=0.0, description="weight of the squared deviation in the objective")


class Task(Section):
    """What the tool is to do, and how a target becomes the task velocity."""

    kind: Literal["position", "pose", "pointing"] = Field(
        "position", description="position (3 rows), pose (6), pointing (position and the direction of one axis, 5)"
    )
    rows: tuple[TaskRow, ...] | None = Field(
        None, min_length=1, description="a subset of the world-frame rows of the task; all of its kind if absent"
    )
    axis: Direction = Field((0.0, 0.0, 1.0), description="pointing axis in the tool frame (kind: pointing)")
    gain: Rate = Field(2.0, gt=0.0, le=100.0, description="k_p: task speed per error")
    max_speed: Speed = Field(0.25, gt=0.0, le=10.0, description="v_max: bound of the linear task speed")
    max_angular_speed: AngularSpeed = Field(1.0, gt=0.0, le=10.0, description="bound of the angular task speed")
    tolerance: Length = Field(0.02, gt=0.0, le=1.0, description="a target nearer than this is reached")
    angular_tolerance: Angle = Field(0.05, gt=0.0, le=3.2, description="the same for the orientation")
    posture: Posture | None = Field(None, description="null-space posture task")


class Limits(Section):
    """Joint limits; positions and velocities are read from the URDF unless overridden here."""

    position: dict[str, tuple[JointPosition, JointPosition]] = Field(
        default_factory=dict, description="lower and upper position limit per joint, in place of the URDF's"
    )
    velocity: dict[str, Annotated[JointSpeed, Field(gt=0.0)]] = Field(
        default_factory=dict, description="velocity limit per joint, in place of the URDF's"
    )
    acceleration: Annotated[JointAcceleration, Field(gt=0.0)] | dict[
        str, Annotated[JointAcceleration, Field(gt=0.0)]
    ] | None = Field(20.0, description="bound of the change of the velocity, one for all or per joint; null: none")
    joint_damper: Rate | None = Field(
        5.0, gt=0.0, description="velocity allowed per distance to the position limit; null: hard switch (11)"
    )
    viability: bool = Field(
        False, description="keep every position limit reachable by braking: |qdot| <= sqrt(2 a (q_ub - q))"
    )
    tolerance: JointPosition = Field(
        0.1, ge=0.0, le=1.0, description="a measured position further than this outside its limits is a fault"
    )


class Capsule(Section):
    """A capsule that stands for a link: all points within `radius` of a segment."""

    name: Name
    frame: str = Field(description="URDF frame in which the end points are given")
    start: Vector3
    end: Vector3
    radius: Length = Field(gt=0.0, le=1.0)


class TimeOfFlight(Section):
    """A time-of-flight range sensor: far and narrow."""

    range: Length = Field(1.0, gt=0.0, le=10.0, description="the greatest distance that is measured")
    cone: Angle = Field(0.3490658503988659, ge=0.0, lt=1.5707963267948966, description="full opening angle")
    rate: Frequency = Field(100.0, gt=0.0, le=1e5)
    latency: Time = Field(0.0, ge=0.0, le=1.0)
    noise: Length = Field(0.0, ge=0.0, le=0.5, description="standard deviation of a reading (simulation)")
    dropout: float = Field(0.0, ge=0.0, lt=1.0, description="probability that a reading is lost (simulation)")


class Capacitive(Section):
    """A capacitive proximity switch: near, wide and binary; it stands for a virtual obstacle point."""

    trigger: Length = Field(0.10, gt=0.0, le=1.0, description="distance below which the switch closes")
    cone: Angle = Field(2.6179938779914944, gt=0.0, lt=3.141592653589793, description="full opening angle")
    virtual_distance: Length = Field(
        0.08, ge=0.0, le=1.0, description="where along the normal the virtual obstacle point lies"
    )
    rate: Frequency = Field(1000.0, gt=0.0, le=1e6)
    latency: Time = Field(0.0, ge=0.0, le=1.0)
    dropout: float = Field(0.0, ge=0.0, lt=1.0, description="probability that a sample is lost (simulation)")


class Ring(Section):
    """Sensor modules, evenly spread on a circle around the cuff's axis."""

    offset: Length = Field(description="distance of the ring's centre from the cuff's origin, along its axis")
    radius: Length = Field(ge=0.0, le=1.0)
    modules: int = Field(ge=1, le=512)
    tilt: Angle | tuple[Angle, ...] = Field(
        0.0,
        description="angle of the normals out of the ring's plane towards the axis; a list alternates over the modules",
    )
    stagger: float = Field(0.0, ge=0.0, lt=1.0, description="turns the ring by this fraction of a module's spacing")


class Cuff(Section):
    """A cuff of proximity sensors around a link."""

    name: Name
    frame: str = Field(description="URDF frame that carries the cuff")
    origin: Vector3 = Field((0.0, 0.0, 0.0), description="a point on the cuff's axis, in the frame")
    axis: Direction = Field((0.0, 0.0, 1.0), description="the cuff's axis, in the frame")
    rings: tuple[Ring, ...] = Field(min_length=1)
    tof: TimeOfFlight | None = Field(None, description="in place of skin.tof for this cuff")
    capacitive: Capacitive | None = Field(None, description="in place of skin.capacitive for this cuff")


class Skin(Section):
    """The proximity sensors: cuffs of modules, each with a range sensor and a switch."""

    cuffs: tuple[Cuff, ...] = ()
    tof: TimeOfFlight | None = Field(TimeOfFlight(), description="of every module; null: no range sensors")
    capacitive: Capacitive | None = Field(Capacitive(), description="of every module; null: no switches")
    timeout: Time = Field(0.1, gt=0.0, le=10.0, description="a reading older than this is a fault")
    max_points: int = Field(
        64, ge=0, le=4096, description="capacity for obstacle points from other sources, per cycle"
    )


class Damper(Section):
    """The damper schedule: one line through the safety distance, in place of the law (13)."""

    influence_distance: Length = Field(0.32, gt=0.0, le=5.0, description="d_i: rows begin here")
    safety_distance: Length = Field(0.22, ge=0.0, le=5.0, description="d_s: no approach below")
    gain: Rate = Field(6.0, gt=0.0, le=100.0, description="repulsive speed per distance below d_s")
    repulse_speed: Speed = Field(-0.4, ge=-5.0, le=0.0, description="v_r: bound of the repulsive speed")


class Active(Section):
    """Active avoidance (6)(7): the weighted sum of distances must not fall."""

    enabled: bool = True
    distance: Length = Field(0.30, gt=0.0, le=5.0, description="d_active: links nearer than this take part")


class Avoidance(Section):
    """From distances to rows: thresholds (17), law (13), active row (7)."""

    distance_reference: Literal["axis", "surface"] = Field(
        "axis", description="distances are measured to the capsule's axis, or to its surface"
    )
    schedule: Literal["paper", "damper"] = Field("paper", description="law (13), or the damper schedule")
    d_a: Length = Field(0.30, gt=0.0, le=5.0, description="obstacles beyond give no row (17)")
    d_0u: Length = Field(0.25, ge=0.0, le=5.0, description="upper end of the dead zone (17)")
    d_0l: Length = Field(0.22, ge=0.0, le=5.0, description="lower end of the dead zone (17)")
    d_r: Length = Field(0.17, ge=0.0, le=5.0, description="full repulsion at and below this distance (17)")
    approach_speed: Speed = Field(0.2, gt=0.0, le=5.0, description="greatest approach speed, at d_a (16)")
    repulse_speed: Speed = Field(-0.2, ge=-5.0, le=0.0, description="approach speed at d_r, not positive (16)")
    row_speed: AngularSpeed = Field(
        1.0, gt=0.0, le=100.0, description="a row never demands more joint speed than this: b >= -row_speed |A|"
    )
    active: Active = Active()
    damper: Damper = Damper()


class Damping(Section):
    """Damping near singular configurations (14)(15)."""

    gain: float = Field(0.1, ge=0.0, le=100.0, description="g_lambda (15)")
    threshold: float = Field(0.001, ge=0.0, le=100.0, description="w_0: manipulability below which it acts (15)")
    floor: float = Field(1e-3, ge=1e-9, le=1.0, description="lambda_min: keeps H positive definite")


class Slack(Section):
    """Weights of the soft rows (relaxation: slack)."""

    weight: float = Field(100.0, gt=0.0, le=1e6)
    minimum: float = Field(0.1, gt=0.0, le=10.0, description="lower clip of the ramp (d_a - d)/(d_a - d_r)")
    maximum: float = Field(2.0, gt=0.0, le=10.0, description="upper clip of the ramp")
    active_weight: float = Field(10.0, gt=0.0, le=1e6, description="weight of the active row (7)")


class Relaxation(Section):
    """What happens when not all rows can be met (section IV.C)."""

    mode: Literal["staged", "slack"] = Field(
        "staged", description="staged: drop rows step by step; slack: soften all rows, weighted by distance"
    )
    slack: Slack = Slack()


class Solver(Section):
    """The QP solver of the compiled controller."""

    backend: Literal["qpoases", "daqp"] = "qpoases"
    max_iterations: int = Field(100, ge=5, le=10000, description="working-set changes per solve")
    tolerance: float = Field(1e-8, ge=1e-12, le=1e-4, description="greatest KKT residual that is certified")


class Control(Section):
    """The control cycle."""

    rate: Frequency = Field(50.0, ge=1.0, le=1e4)
    deadline: Time | None = Field(
        None, gt=0.0, le=10.0, description="a longer time between two cycles is a fault; null: not checked"
    )


class Config(Section):
    """One robot's whole configuration, as loaded from one YAML file."""

    robot: Robot
    task: Task = Task()
    limits: Limits = Limits()
    capsules: tuple[Capsule, ...] = Field(min_length=1)
    skin: Skin = Skin()
    avoidance: Avoidance = Avoidance()
    damping: Damping = Damping()
    relaxation: Relaxation = Relaxation()
    solver: Solver = Solver()
    control: Control = Control()

    _source: Path | None = None

    @model_validator(mode="after")
    def _thresholds_in_order(self) -> "Config":
        return self
