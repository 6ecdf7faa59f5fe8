"""Physical quantities as they may be written in a YAML file: a plain SI number, or a number with a unit.

`0.3`, `0.3 m`, `30 cm` and `300 mm` are the same length; `25 deg` and `0.4363 rad` nearly the same angle.
Every quantity is held in SI units and radians after loading.
"""

import re
from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

UNITS: dict[str, dict[str, float]] = {
    "length": {"m": 1.0, "cm": 1e-2, "mm": 1e-3},
    "angle": {"rad": 1.0, "deg": 0.017453292519943295},
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6},
    "frequency": {"Hz": 1.0, "kHz": 1e3},
    "speed": {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3},
    "angular speed": {"rad/s": 1.0, "deg/s": 0.017453292519943295},
    "rate": {"1/s": 1.0, "/s": 1.0},
    "joint acceleration": {"rad/s^2": 1.0, "deg/s^2": 0.017453292519943295, "m/s^2": 1.0},
    "joint speed": {"rad/s": 1.0, "deg/s": 0.017453292519943295, "m/s": 1.0, "mm/s": 1e-3},
    "joint position": {"rad": 1.0, "deg": 0.017453292519943295, "m": 1.0, "mm": 1e-3, "cm": 1e-2},
}
"""Per quantity: the units that may be written, and the factor to SI. The first one is the SI unit."""

_NUMBER_AND_UNIT = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([A-Za-z/^0-9]*)\s*$")


def parse_quantity(value: Any, kind: str) -> float:
    """Turn a YAML scalar into a number in SI units.

    Args:
        value: an int, a float, or a text such as `25 deg`.
        kind: a key of `UNITS`.

    Returns:
        The value in the SI unit of `kind`.

    Raises:
        ValueError: not a number, or a unit that does not measure this kind of quantity.
    """
    units = UNITS[kind]
    allowed = ", ".join(units)
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"expected a {kind} (a number, or a number with one of the units {allowed})")
    if isinstance(value, int | float):
        return float(value)
    match = _NUMBER_AND_UNIT.match(value)
    if match is None:
        raise ValueError(f"'{value}' is not a {kind} (a number, or a number with one of the units {allowed})")
    number, unit = match.groups()
    if unit and unit not in units:
        raise ValueError(f"unit '{unit}' does not measure a {kind} (allowed: {allowed})")
    return float(number) * units.get(unit, 1.0)


def _quantity(kind: str) -> Any:
    si_unit = next(iter(UNITS[kind]))
    schema = {
        "anyOf": [{"type": "number"}, {"type": "string", "pattern": _NUMBER_AND_UNIT.pattern}],
        "description": f"{kind} [{si_unit}], or with one of the units {', '.join(UNITS[kind])}",
        "x-unit": si_unit,
    }
    return Annotated[
        float,
        BeforeValidator(lambda value: parse_quantity(value, kind)),
        WithJsonSchema(schema),
    ]


Length = _quantity("length")
Angle = _quantity("angle")
Time = _quantity("time")
Frequency = _quantity("frequency")
Speed = _quantity("speed")
AngularSpeed = _quantity("angular speed")
Rate = _quantity("rate")
JointAcceleration = _quantity("joint acceleration")
JointSpeed = _quantity("joint speed")
JointPosition = _quantity("joint position")
