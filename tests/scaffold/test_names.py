"""Identifiers from whatever a URDF calls its parts."""

import pytest
from pydantic import TypeAdapter

from proxgen.config.reserved import RESERVED_NAMES
from proxgen.config.section import Name
from proxgen.scaffold.names import distinct, identifier, robot_name, shortened


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("iiwa7", "iiwa7"),
        ("LBR iiwa 14 R820", "lbr_iiwa_14_r820"),
        ("2dof_planar", "part_2dof_planar"),
        ("link.0/tip-end", "link_0_tip_end"),
        ("__x__", "x"),
        ("Gelenk äöü", "gelenk_aou"),
        ("手", "part"),
        ("", "part"),
        ("a" * 60, "a" * 40),
        ("a" * 39 + "_b", "a" * 39),
    ],
)
def test_identifier(text: str, name: str) -> None:
    assert identifier(text) == name
    TypeAdapter(Name).validate_python(identifier(text))


def test_robot_names_avoid_those_of_the_runtime() -> None:
    for reserved in RESERVED_NAMES:
        assert robot_name(reserved.upper()) == f"{reserved}_robot"
    assert robot_name("3-axis") == "robot_3_axis"


def test_names_of_a_list_differ() -> None:
    names = distinct(["Link", "link", "link_2", "LINK", *["x" * 50] * 3])
    assert names == ["link", "link_2", "link_2_2", "link_3", "x" * 40, "x" * 38 + "_2", "x" * 38 + "_3"]
    for name in names:
        TypeAdapter(Name).validate_python(name)


def test_an_ending_is_never_cut() -> None:
    assert shortened("a" * 40, "_cuff") == "a" * 35 + "_cuff"
    assert shortened("a" * 34 + "_bcdef", "_cuff") == "a" * 34 + "_cuff"
