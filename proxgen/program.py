"""The waist: what is to be generated, as plain data, between understanding the input and writing text.

Nothing left of it (config, model, symbolic) writes files; nothing right of it (emit, build) knows what a
cuff or a task is. A `Program` says which functions there are, with names, shapes, units and the equation in
words; which constant tables; and which parameters stay settable at run time.
"""

from dataclasses import dataclass
from typing import Any

ADDITIONS = ("self_measurement", "memory", "circulation", "self_collision", "repulsive", "tangential")
"""Names of the additions (docs/method.md), each of which is code only where it is switched on."""


@dataclass(frozen=True)
class Argument:
    """An input or output of a kernel.

    Attributes:
        name: as in the C signature.
        shape: () for a scalar, (n,) for a vector, (rows, columns) for a matrix; row-major in C.
        unit: such as `rad/s`; empty if there is none.
        meaning: a short phrase, frame included.
        parameter: True if it is not passed by the caller but read from the parameter block.
    """

    name: str
    shape: tuple[int, ...]
    unit: str
    meaning: str
    parameter: bool = False


@dataclass(frozen=True)
class Kernel:
    """A function to be generated.

    Attributes:
        name: without the robot's prefix.
        summary: one sentence.
        equation: in words and plain-text mathematics, with the equation's number.
        inputs: in the order of the function's inputs.
        outputs: in the order of the function's outputs.
        function: CasADi SX function with exactly these inputs and outputs (matrices as matrices; the
            emitter densifies and transposes to row-major).
    """

    name: str
    summary: str
    equation: str
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    function: Any


@dataclass(frozen=True)
class Parameter:
    """A value that the user can change at run time.

    Attributes:
        name: field name in C and key in Python.
        shape: () or (n,).
        unit: as in `Argument`.
        default: from the configuration.
        lower: least value that is accepted (inclusive).
        upper: greatest value that is accepted (inclusive).
        meaning: a short phrase with the equation's number.
    """

    name: str
    shape: tuple[int, ...]
    unit: str
    default: float | tuple[float, ...]
    lower: float
    upper: float
    meaning: str


@dataclass(frozen=True)
class CapsuleEntry:
    """A row of the capsule table: `pg_capsule_t`."""

    name: str
    body: int
    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float
    reference_radius: float


@dataclass(frozen=True)
class SensorEntry:
    """A row of a sensor table: `pg_sensor_t`; `range` is a switch's virtual distance."""

    name: str
    body: int
    position: tuple[float, float, float]
    normal: tuple[float, float, float]
    range: float


@dataclass(frozen=True)
class SelfPointEntry:
    """A row of the table of self-collision points: `pg_self_point_t`, and its row of pairs.

    Attributes:
        name: as in the configuration.
        body: that carries it.
        position: in that body's frame [m].
        radius: of the ball; 0 for a point [m].
        capsules: for each capsule whether the two are a pair.
    """

    name: str
    body: int
    position: tuple[float, float, float]
    radius: float
    capsules: tuple[bool, ...]


@dataclass(frozen=True)
class SelfMeasurement:
    """Where sensors may see the arm itself.

    Attributes:
        rays: per range sensor the five unit vectors along which it looks, body frame.
        cones: per switch the distance at which something closes it [m], and the cosine of half its opening
            angle.
    """

    rays: tuple[tuple[tuple[float, float, float], ...], ...]
    cones: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Memory:
    """The memory of seen points.

    Attributes:
        capacity: number of slots.
        see_through: per range sensor the cosine of half the angle in which it is believed to see through.
    """

    capacity: int
    see_through: tuple[float, ...]


BASELINE_ROWS = {
    "repulsive": (
        "d_hat: not closer than the law allows",
        "d_hat: not further away",
        "first tangent: not forwards",
        "first tangent: not backwards",
        "second tangent: not forwards",
        "second tangent: not backwards",
    ),
    "tangential": (
        "d_hat: not closer than the law allows",
        "d_hat: not further away",
        "across the tangent: not to one side",
        "across the tangent: not to the other",
        "along the tangent: at least tangential_speed",
    ),
}
"""What the slots of the methods that the paper compares with stand for."""


@dataclass(frozen=True)
class Program:
    """All that is generated for one robot.

    `body` in the tables counts the rows of the kinematics kernel's output `body_to_world`.

    Attributes:
        robot: name and symbol prefix.
        config_hash: SHA-256 of the canonical configuration and the URDF, hexadecimal.
        joints: number of joints n.
        task_rows: number of task rows m.
        bodies: number of poses in `body_to_world`.
        joint_names: (n,).
        task_row_names: (m,), such as `x`.
        body_names: (bodies,).
        kernels: in the order of the cycle.
        parameters: in the order of the C struct.
        capsules: the capsule table; one fixed row slot each, and one more with self-collision.
        tof: table of the range sensors.
        capacitive: table of the switches.
        max_points: capacity for further obstacle points.
        relaxation: `staged` or `slack`.
        active_row: whether the row (7) exists; only with the method `proposed`.
        schedule: `paper` (law (13)) or `damper`.
        max_iterations: working-set changes per solve.
        tolerance: greatest KKT residual that is certified.
        sources: names and versions that determine the text, such as {"casadi": "3.8.2"}.
        method: `proposed`, or `repulsive` or `tangential`, which have the rows of `BASELINE_ROWS`.
        self_points: the points of self-collision; none: there is no such thing.
        self_measurement: tables of self-measurement removal; None: it is off.
        memory: size and table of the memory of seen points; None: there is none.
        circulation: whether there is circulation.
        config_file: name of the file that the configuration was written in, without its folder, so that the
            text is the same on every machine; empty if it was not written in one.
    """

    robot: str
    config_hash: str
    joints: int
    task_rows: int
    bodies: int
    joint_names: tuple[str, ...]
    task_row_names: tuple[str, ...]
    body_names: tuple[str, ...]
    kernels: tuple[Kernel, ...]
    parameters: tuple[Parameter, ...]
    capsules: tuple[CapsuleEntry, ...]
    tof: tuple[SensorEntry, ...]
    capacitive: tuple[SensorEntry, ...]
    max_points: int
    relaxation: str
    active_row: bool
    schedule: str
    max_iterations: int
    tolerance: float
    sources: dict[str, str]
    method: str = "proposed"
    self_points: tuple[SelfPointEntry, ...] = ()
    self_measurement: SelfMeasurement | None = None
    memory: Memory | None = None
    circulation: bool = False
    config_file: str = ""

    @property
    def additions(self) -> tuple[str, ...]:
        """What is switched on beyond the paper's method, in the order of `ADDITIONS`."""
        on = {
            "self_measurement": self.self_measurement is not None,
            "memory": self.memory is not None,
            "circulation": self.circulation,
            "self_collision": bool(self.self_points),
            self.method: True,
        }
        return tuple(name for name in ADDITIONS if on.get(name, False))

    @property
    def row_names(self) -> tuple[str, ...]:
        """What each row slot stands for."""
        if self.method != "proposed":
            return BASELINE_ROWS[self.method]
        names = [capsule.name for capsule in self.capsules]
        own = [f"{name} (self-collision)" for name in names] if self.self_points else []
        return (*names, *(["active row (7)"] if self.active_row else []), *own)

    def kernel(self, name: str) -> Kernel:
        """The kernel of that name; KeyError if there is none."""
        by_name = {kernel.name: kernel for kernel in self.kernels}
        return by_name[name]
