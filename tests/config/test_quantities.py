import math
import re
from functools import cache
from typing import Annotated, Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter

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
    Quantity,
    Rate,
    Speed,
    Time,
    describe_value,
    unit_of,
)

KINDS: list[type[Quantity]] = [
    Number, Length, Angle, Time, Frequency, Speed, AngularSpeed, Rate,
    JointPosition, JointSpeed, JointAcceleration,
]  # fmt: skip


@pytest.mark.parametrize(
    ("quantity", "value", "expected"),
    [
        (Length(), "300 mm", 0.3),
        (Length(), "30cm", 0.3),
        (Length(), "-1.5e-1 m", -0.15),
        (Length(), "0.3", 0.3),
        (Length(), 2, 2.0),
        (Angle(), "180 deg", math.pi),
        (Time(), "2 ms", 2e-3),
        (Time(), "5 us", 5e-6),
        (Frequency(), "1 kHz", 1e3),
        (Speed(), "20 cm/s", 0.2),
        (AngularSpeed(), "90 deg/s", math.pi / 2),
        (Rate(), "5 /s", 5.0),
        (Rate(), "5 1/s", 5.0),
        (JointAcceleration(), "180 deg/s^2", math.pi),
        (JointSpeed(), "10 mm/s", 0.01),
        (JointPosition(), "5 cm", 0.05),
        (Number(), "1e-3", 1e-3),
        (Count(), 7, 7),
    ],
)
def test_units_are_understood(quantity: Quantity, value: Any, expected: float) -> None:
    result = quantity.parse(value)
    assert result == pytest.approx(expected, rel=1e-15)
    assert type(result) is type(expected)


LENGTHS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
TURN = 2.0 * math.pi / 360.0
UNITS: dict[type[Quantity], dict[str, float]] = {
    Number: {},
    Length: LENGTHS,
    Angle: {"rad": 1.0, "deg": TURN},
    Time: {"s": 1.0, "ms": 0.001, "us": 1e-6},
    Frequency: {"Hz": 1.0, "kHz": 1000.0},
    Speed: {f"{unit}/s": factor for unit, factor in LENGTHS.items()},
    AngularSpeed: {"rad/s": 1.0, "deg/s": TURN},
    Rate: {"1/s": 1.0, "/s": 1.0},
    JointPosition: {"rad": 1.0, "deg": TURN, **LENGTHS},
    JointSpeed: {"rad/s": 1.0, "deg/s": TURN, **{f"{unit}/s": factor for unit, factor in LENGTHS.items()}},
    JointAcceleration: {"rad/s^2": 1.0, "deg/s^2": TURN, "m/s^2": 1.0},
}


@pytest.mark.parametrize("kind", KINDS)
def test_every_unit_has_its_factor(kind: type[Quantity]) -> None:
    assert set(kind.units) == set(UNITS[kind])
    for unit, factor in UNITS[kind].items():
        assert kind().parse(f"3 {unit}") == pytest.approx(3.0 * factor, rel=1e-15)


@pytest.mark.parametrize(
    ("limits", "inside", "outside"),
    [
        ({"gt": 1.0}, (1.0 + 1e-12, 2.0), (1.0, 0.9)),
        ({"ge": 1.0}, (1.0, 2.0), (1.0 - 1e-12, 0.9)),
        ({"lt": 1.0}, (1.0 - 1e-12, 0.0), (1.0, 1.1)),
        ({"le": 1.0}, (1.0, 0.0), (1.0 + 1e-12, 1.1)),
    ],
)
def test_ends_of_ranges(
    limits: dict[str, float], inside: tuple[float, ...], outside: tuple[float, ...]
) -> None:
    """Whether the end itself is within."""
    quantity = Length(**limits)
    for value in inside:
        assert quantity.parse(value) == value
    for value in outside:
        with pytest.raises(ValueError, match="is out of range"):
            quantity.parse(value)


@pytest.mark.parametrize(
    ("quantity", "value", "message"),
    [
        (Length(), "3 deg", "unit 'deg' does not measure a length (allowed: m, cm, mm)"),
        (Number(), "3 m", "unit 'm' does not measure a number (allowed: none, it is a pure number)"),
        (
            Length(),
            "wide",
            "expected a length (a number in m, or with one of the units m, cm, mm), found 'wide'",
        ),
        (Number(), None, "expected a number, found nothing"),
        (Angle(), "3 m", "unit 'm' does not measure an angle (allowed: rad, deg)"),
        (Number(), True, "expected a number, found true"),
        (Number(), [1], "expected a number, found a list of 1"),
        (Number(), {}, "expected a number, found a mapping"),
        (Number(), math.nan, "expected a finite number, found nan"),
        (Length(), "1e999 m", "expected a finite length, found '1e999 m'"),
        (Number(), 10**400, "expected a finite number, found " + "1" + "0" * 56 + "..."),
        (Length(gt=0.0, le=1.0), 0, "0 m is out of range (allowed: greater than 0 and at most 1 m)"),
        (
            Length(gt=0.0, le=1.0),
            75,
            "75 m is out of range (allowed: greater than 0 and at most 1 m); did you mean 75 cm or 75 mm?",
        ),
        (Length(ge=0.0), "-5 mm", "-5 mm is out of range (allowed: at least 0 mm)"),
        (
            Angle(ge=0.0, lt=math.pi / 2),
            "90 deg",
            "90 deg is out of range (allowed: at least 0 and less than 90 deg)",
        ),
        (
            Angle(ge=0.0, lt=math.pi / 2),
            25,
            "25 rad is out of range (allowed: at least 0 and less than 1.5708 rad); did you mean 25 deg?",
        ),
        (Count(ge=1), 0, "0 is out of range (allowed: at least 1)"),
        (Count(), 3.0, "expected a whole number, found 3.0"),
        (Count(), "3", "expected a whole number, found '3'"),
    ],
)
def test_what_is_wrong_with_a_value_is_said(quantity: Quantity, value: Any, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        quantity.parse(value)


@pytest.mark.parametrize("kind", KINDS)
@given(
    value=st.one_of(st.text(), st.integers(), st.floats(), st.none(), st.booleans(), st.lists(st.integers()))
)
def test_any_value_is_a_finite_number_or_a_sentence(kind: type[Quantity], value: Any) -> None:
    try:
        assert math.isfinite(kind().parse(value))
    except ValueError as error:
        assert str(error)


@cache
def validator_of(quantity: Quantity) -> jsonschema.Draft202012Validator:
    """Checks a value against the JSON schema of a quantity."""
    return jsonschema.Draft202012Validator(TypeAdapter(Annotated[float, quantity]).json_schema())


@pytest.mark.parametrize("kind", KINDS)
@given(number=st.floats(min_value=-1e6, max_value=1e6), data=st.data())
def test_json_schema_and_parser_accept_the_same(
    kind: type[Quantity], number: float, data: st.DataObject
) -> None:
    quantity = kind(ge=-10.0, lt=10.0)
    validator = validator_of(quantity)
    for unit in ["", *kind.units]:
        value: Any = f"{number:.6g} {unit}" if unit else number
        try:
            quantity.parse(value)
            accepted = True
        except ValueError:
            accepted = False
        valid = validator.is_valid(value)
        # the schema cannot compare a text with the range; it must never refuse what is right
        assert valid or not accepted
        if not isinstance(value, str):
            assert valid == accepted


def test_units_in_a_text() -> None:
    assert [unit_of(value) for value in ("3 deg", "3", 3, "deg", None)] == ["deg", "", "", "", ""]


def test_long_texts_are_cut() -> None:
    assert len(describe_value("x" * 500)) == 60
