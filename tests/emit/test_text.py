import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxgen.emit.text import (
    WIDTH,
    block_comment,
    braces,
    comment_text,
    identifier,
    number,
    plain,
    string,
)
from proxgen.errors import GenerateError


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_is_read_back_to_the_same_bits(value: float) -> None:
    assert float(number(value)) == value


@pytest.mark.parametrize(
    ("value", "text"),
    [(5, "5.0"), (0.1, "0.1"), (-1e20, "-1e+20"), (1 / 3, "0.3333333333333333"), (1e-8, "1e-08")],
)
def test_a_number_is_a_double_literal(value: float, text: str) -> None:
    assert number(value) == text


def test_numpy_numbers_are_written_as_plain_ones() -> None:
    assert number(np.float64(0.25)) == "0.25"


def test_negative_zero_is_written_as_zero() -> None:
    assert number(-0.0) == "0.0"


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_number_without_a_literal_is_refused(value: float) -> None:
    with pytest.raises(GenerateError, match="cannot be written as a C number"):
        number(value)


def test_braces_list_numbers() -> None:
    assert braces([1, 2.5]) == "{1.0, 2.5}"


@pytest.mark.parametrize("name", ["q", "iiwa7", "a_2", "row_0"])
def test_identifiers_pass(name: str) -> None:
    assert identifier(name) == name


@pytest.mark.parametrize("name", ["", "7dof", "two words", "int", "class", "a__b", "end_", "_a", "naïve"])
def test_what_is_no_identifier_in_c_and_cpp_is_refused(name: str) -> None:
    with pytest.raises(GenerateError, match="cannot be a name in C"):
        identifier(name)


def test_a_comment_cannot_be_ended_from_inside() -> None:
    assert comment_text("a */ b /* c\n  d") == "a * / b / * c d"
    assert comment_text("joint*\\") == "joint* /"
    assert comment_text("end ??/") == "end ? ?/"
    assert comment_text("right\u202eleft \u00e9") == "right?left \u00e9"


def test_a_long_comment_is_wrapped_and_items_are_indented() -> None:
    text = block_comment(["word " * 40, "", "  " + "item " * 40])
    lines = text.splitlines()
    assert all(len(line) <= WIDTH for line in lines)
    assert lines[0].startswith("/* word") and lines[1].startswith(" * word")
    assert " *" in lines and " *   item item item" in text and " *       item" in text
    assert lines[-1] == " */"


def test_a_short_comment_is_one_line() -> None:
    assert block_comment(["short"]) == "/* short */"


def test_strings_are_escaped() -> None:
    assert string('say "hi" \\ there') == '"say \\"hi\\" \\\\ there"'
    with pytest.raises(GenerateError, match="C string"):
        string("zwei\nZeilen")


def test_plain_numbers_are_short() -> None:
    assert plain((1 / 3, -0.0, 1e20)) == "0.333333, 0, 1e+20"
