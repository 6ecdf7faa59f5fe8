"""Physical quantities as they may be written in a YAML file: a plain SI number, or a number with a unit.

`0.3`, `0.3 m`, `30 cm` and `300 mm` are the same length; `25 deg` and `0.4363 rad` nearly the same angle.
Every quantity is held in SI units and radians after loading. A key is declared as
`Annotated[float, Length(gt=0.0, le=1.0)]`: the annotation knows the units, the range, the sentence that
says what is wrong with a value, and its JSON schema.
"""

import math
import re
from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from proxgen.errors import shortened

DEGREE = math.pi / 180.0

_NUMBER_AND_UNIT = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([A-Za-z/^0-9]*)\s*$")


@dataclass(frozen=True)
class Quantity:
    """A number with a unit and a range; base of the kinds below.

    Attributes:
        gt: the value must be greater [SI unit], or None.
        ge: the value must be at least this [SI unit], or None.
        lt: the value must be less [SI unit], or None.
        le: the value must be at most this [SI unit], or None.
    """

    gt: float | None = None
    ge: float | None = None
    lt: float | None = None
    le: float | None = None

    kind: ClassVar[str] = "number"
    units: ClassVar[dict[str, float]] = {}
    """The units that may be written, and the factor to SI; the first one is the SI unit."""

    @property
    def si_unit(self) -> str:
        """The unit of a plain number; empty for a pure number."""
        return next(iter(self.units), "")

    @property
    def range_text(self) -> str:
        """The range in words, such as `greater than 0 and at most 1 m`; empty if there is none."""
        return self._range(self.si_unit)

    def parse(self, value: Any) -> float:
        """Turn a YAML scalar into a number in SI units.

        Args:
            value: an int, a float, or a text such as `25 deg`.

        Raises:
            ValueError: not a number, a unit that does not measure this kind of quantity, or out of range.
        """
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise ValueError(f"expected {self._a_kind()}{self._how()}, found {describe_value(value)}")
        number, unit = self._split(value)
        try:
            si = float(number) * self.units.get(unit, 1.0)
        except OverflowError:
            si = math.inf
        if not math.isfinite(si):
            raise ValueError(f"expected a finite {self.kind}, found {describe_value(value)}")
        if not self._within(si):
            shown = f"{value} {unit}" if isinstance(value, int | float) and unit else f"{value}"
            raise ValueError(
                f"{shown} is out of range (allowed: {self._range(unit)}){self._other_unit(value, unit)}"
            )
        return si

    def _split(self, value: int | float | str) -> tuple[float | int | str, str]:
        """Number and unit of what was written; a plain number has the SI unit."""
        if not isinstance(value, str):
            return value, self.si_unit
        match = _NUMBER_AND_UNIT.match(value)
        if match is None:
            raise ValueError(f"expected {self._a_kind()}{self._how()}, found {describe_value(value)}")
        number, unit = match.groups()
        if unit and unit not in self.units:
            allowed = (
                f"allowed: {', '.join(self.units)}" if self.units else "allowed: none, it is a pure number"
            )
            raise ValueError(f"unit '{shortened(unit)}' does not measure {self._a_kind()} ({allowed})")
        return number, unit or self.si_unit

    def _a_kind(self) -> str:
        """The kind with its article."""
        return f"{'an' if self.kind[0] in 'aeiou' else 'a'} {self.kind}"

    def _how(self) -> str:
        """In which form the quantity may be written."""
        return (
            f" (a number in {self.si_unit}, or with one of the units {', '.join(self.units)})"
            if self.units
            else ""
        )

    def _within(self, si: float) -> bool:
        """Whether the value lies in the range."""
        return (
            (self.gt is None or si > self.gt)
            and (self.ge is None or si >= self.ge)
            and (self.lt is None or si < self.lt)
            and (self.le is None or si <= self.le)
        )

    def _range(self, unit: str) -> str:
        """The range in words, in the given unit."""
        words = (
            ("greater than", self.gt),
            ("at least", self.ge),
            ("less than", self.lt),
            ("at most", self.le),
        )
        factor = self.units.get(unit, 1.0)
        parts = [f"{word} {bound / factor:.6g}" for word, bound in words if bound is not None]
        return f"{' and '.join(parts)} {unit}".strip() if parts else ""

    def _other_unit(self, value: int | float | str, unit: str) -> str:
        """A hint if the same number would be in range in another unit, as 25 for 25 deg."""
        number = float(self._split(value)[0])
        fitting = [
            f"{number:.6g} {other}"
            for other, factor in self.units.items()
            if factor != self.units[unit] and self._within(number * factor)
        ]
        return f"; did you mean {' or '.join(fitting)}?" if fitting else ""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Validation is `parse` alone."""
        return core_schema.no_info_plain_validator_function(
            self.parse, serialization=core_schema.plain_serializer_function_ser_schema(lambda value: value)
        )

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """A number within the range, or a number with a unit."""
        bounds = {
            "exclusiveMinimum": self.gt,
            "minimum": self.ge,
            "exclusiveMaximum": self.lt,
            "maximum": self.le,
        }
        number: dict[str, Any] = {"type": "number"} | {k: v for k, v in bounds.items() if v is not None}
        if not self.units:
            return number | {"x-quantity": self.kind, "x-range": self.range_text}
        units = "|".join(re.escape(unit) for unit in self.units)
        text = {"type": "string", "pattern": rf"^\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*({units})?\s*$"}
        return {
            "anyOf": [number, text],
            "x-quantity": self.kind,
            "x-unit": self.si_unit,
            "x-units": list(self.units),
            "x-range": self.range_text,
        }


class Number(Quantity):
    """A pure number."""


class Count(Quantity):
    """A whole number."""

    kind = "whole number"

    def parse(self, value: Any) -> int:
        """Turn a YAML scalar into an int; the rules of `Quantity.parse`, without fractions."""
        if isinstance(value, bool) or not isinstance(value, int):
            raise ValueError(f"expected {self._a_kind()}, found {describe_value(value)}")
        super().parse(value)
        return value

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """An integer within the range."""
        return super().__get_pydantic_json_schema__(schema, handler) | {"type": "integer"}


class Length(Quantity):
    """A length or position."""

    kind = "length"
    units: ClassVar[dict[str, float]] = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}


class Angle(Quantity):
    """An angle."""

    kind = "angle"
    units: ClassVar[dict[str, float]] = {"rad": 1.0, "deg": DEGREE}


class Time(Quantity):
    """A duration."""

    kind = "time"
    units: ClassVar[dict[str, float]] = {"s": 1.0, "ms": 1e-3, "us": 1e-6}


class Frequency(Quantity):
    """A frequency."""

    kind = "frequency"
    units: ClassVar[dict[str, float]] = {"Hz": 1.0, "kHz": 1e3}


class Speed(Quantity):
    """A linear speed."""

    kind = "speed"
    units: ClassVar[dict[str, float]] = {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3}


class AngularSpeed(Quantity):
    """An angular speed."""

    kind = "angular speed"
    units: ClassVar[dict[str, float]] = {"rad/s": 1.0, "deg/s": DEGREE}


class Rate(Quantity):
    """A gain: speed per distance, or angular speed per angle."""

    kind = "rate"
    units: ClassVar[dict[str, float]] = {"1/s": 1.0, "/s": 1.0}


class JointPosition(Quantity):
    """A position of a revolute or a prismatic joint; whether the unit fits is checked against the URDF."""

    kind = "joint position"
    units: ClassVar[dict[str, float]] = {"rad": 1.0, "deg": DEGREE, "m": 1.0, "cm": 1e-2, "mm": 1e-3}


class JointSpeed(Quantity):
    """A speed of a revolute or a prismatic joint."""

    kind = "joint speed"
    units: ClassVar[dict[str, float]] = {
        "rad/s": 1.0,
        "deg/s": DEGREE,
        "m/s": 1.0,
        "cm/s": 1e-2,
        "mm/s": 1e-3,
    }


class JointAcceleration(Quantity):
    """An acceleration of a revolute or a prismatic joint."""

    kind = "joint acceleration"
    units: ClassVar[dict[str, float]] = {"rad/s^2": 1.0, "deg/s^2": DEGREE, "m/s^2": 1.0}


def unit_of(value: Any) -> str:
    """The unit that was written with a value, empty if there is none."""
    match = _NUMBER_AND_UNIT.match(value) if isinstance(value, str) else None
    return match.group(2) if match else ""


def against_its_motion(value: Any, *, prismatic: bool) -> str | None:
    """What a joint does and takes, where a value for it is written in a unit of the other kind; else None."""
    unit = unit_of(value)
    if not unit or (unit.partition("/")[0] in {"m", "cm", "mm"}) == prismatic:
        return None
    return "slides; give a length" if prismatic else "turns; give an angle"


def describe_value(value: Any) -> str:
    """A few words for what was found in a YAML file: `nothing`, `'abc'`, `a list of 3`, `a mapping`."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}" if value else "an empty list"
    return shortened(f"{value}" if isinstance(value, int | float) else f"'{value}'")
