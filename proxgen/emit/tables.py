"""Constant tables and structs as lines of C: parameters, capsules, sensors, kinematics."""

from collections.abc import Iterable, Sequence

from proxgen.emit.signatures import field_dimensions, kinematics_fields
from proxgen.emit.text import braces, comment_text, identifier, number
from proxgen.errors import GenerateError
from proxgen.program import CapsuleEntry, Parameter, Program, SelfPointEntry, SensorEntry


def parameter_fields(program: Program) -> list[str]:
    """Fields of the parameter struct, in order, with unit and meaning."""
    return [
        f"  double {identifier(p.name)}{_dimension(p)}; {_remark(p.unit, p.meaning)}"
        for p in program.parameters
    ]


def kinematics_struct(program: Program) -> list[str]:
    """Fields of the kinematics struct, in order, with unit and meaning."""
    return [
        f"  double {identifier(name)}{field_dimensions(field)}; {_remark(field.unit, field.meaning)}"
        for name, field in kinematics_fields(program).items()
    ]


def parameter_values(program: Program, which: str) -> list[str]:
    """Designated initialisers of a parameter block: `default`, `lower` or `upper`."""
    return [f"  .{p.name} = {_value(p, getattr(p, which))}," for p in program.parameters]


def capsule_rows(program: Program) -> list[str]:
    """Rows of the capsule table."""
    _check_bodies(program, program.capsules)
    rows = [
        f"  {{{c.body}, {braces(c.start)}, {braces(c.end)}, "
        f"{number(c.radius)}, {number(c.reference_radius)}}}, /* {comment_text(c.name)} */"
        for c in program.capsules
    ]
    return rows or ["  {0, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.0, 0.0}, /* none: C has no empty tables */"]


def sensor_rows(program: Program, sensors: Sequence[SensorEntry]) -> list[str]:
    """Rows of a sensor table."""
    _check_bodies(program, sensors)
    rows = [
        f"  {{{s.body}, {braces(s.position)}, {braces(s.normal)}, {number(s.range)}}},"
        f" /* {comment_text(s.name)} */"
        for s in sensors
    ]
    return rows or ["  {0, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.0}, /* none: C has no empty tables */"]


def self_point_rows(program: Program) -> list[str]:
    """Rows of the table of self-collision points; none if there is no such thing."""
    _check_bodies(program, program.self_points)
    return [
        f"  {{{p.body}, {braces(p.position)}, {number(p.radius)}}}, /* {comment_text(p.name)} */"
        for p in program.self_points
    ]


def self_pair_rows(program: Program) -> list[str]:
    """For each of these points, for each capsule whether they are a pair: 0 or 1.

    Raises:
        GenerateError: a point that does not say so for every capsule.
    """
    for point in program.self_points:
        if len(point.capsules) != len(program.capsules):
            raise GenerateError(
                f"{point.name} has pairs for {len(point.capsules)} of {len(program.capsules)} capsules"
            )
    return [
        f"  {{{', '.join(str(int(paired)) for paired in p.capsules)}}}, /* {comment_text(p.name)} */"
        for p in program.self_points
    ]


def ray_rows(program: Program) -> list[str]:
    """Per range sensor the rays along which it may see the arm; empty without self-measurement removal."""
    if program.self_measurement is None:
        return []
    rays = program.self_measurement.rays
    rows = [
        f"  {{{', '.join(braces(ray) for ray in five)}}}, /* {comment_text(sensor.name)} */"
        for sensor, five in zip(program.tof, rays, strict=True)
    ]
    return rows or ["  {{0.0}}, /* none: C has no empty tables */"]


def cone_rows(program: Program) -> list[str]:
    """Per switch its reach and its cone; empty without self-measurement removal."""
    if program.self_measurement is None:
        return []
    cones = program.self_measurement.cones
    rows = [
        f"  {braces(cone)}, /* {comment_text(switch.name)} */"
        for switch, cone in zip(program.capacitive, cones, strict=True)
    ]
    return rows or ["  {0.0, 0.0}, /* none: C has no empty tables */"]


def see_through_rows(program: Program) -> list[str]:
    """Per range sensor how far off its axis it sees through; empty without a memory."""
    if program.memory is None:
        return []
    rows = [
        f"  {number(cosine)}, /* {comment_text(sensor.name)} */"
        for sensor, cosine in zip(program.tof, program.memory.see_through, strict=True)
    ]
    return rows or ["  0.0, /* none: C has no empty tables */"]


def linear_rows(program: Program) -> str:
    """Where x, y and z are among the task's rows, as an initialiser; -1 for a row that the task lacks."""
    names = program.task_row_names
    return f"{{{', '.join(str(names.index(axis) if axis in names else -1) for axis in 'xyz')}}}"


def _dimension(parameter: Parameter) -> str:
    """C dimension of a parameter: nothing or `[7]`."""
    return f"[{parameter.shape[0]}]" if parameter.shape else ""


def _remark(unit: str, meaning: str) -> str:
    """A comment: the unit in brackets, then the meaning."""
    return f"/* {comment_text(f'[{unit}] {meaning}' if unit else meaning)} */"


def _value(parameter: Parameter, value: float | tuple[float, ...]) -> str:
    """An initialiser of the parameter's shape; a bound is one number for all entries."""
    if not parameter.shape:
        if isinstance(value, tuple):
            raise GenerateError(f"parameter {parameter.name} is one number, and has several values")
        return number(value)
    values = value if isinstance(value, tuple) else (value,) * parameter.shape[0]
    if len(values) != parameter.shape[0]:
        raise GenerateError(
            f"parameter {parameter.name} has {len(values)} values for {parameter.shape[0]} entries"
        )
    return braces(values)


def _check_bodies(program: Program, entries: Iterable[CapsuleEntry | SensorEntry | SelfPointEntry]) -> None:
    """Refuse an entry on a body that does not exist."""
    for entry in entries:
        if not 0 <= entry.body < program.bodies:
            raise GenerateError(
                f"{entry.name} is on body {entry.body}; there are only {program.bodies}, counted from 0"
            )
