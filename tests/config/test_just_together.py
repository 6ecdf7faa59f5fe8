"""Values that just go together are accepted: where two may be equal, they are."""

import re
from pathlib import Path

import pytest

from proxgen.config import load
from proxgen.config.ranges import RANGES
from proxgen.errors import ConfigError

PLANAR = Path(__file__).resolve().parents[2] / "examples" / "planar2" / "planar2.yaml"

EQUAL = {
    "dead zone without width": "avoidance: {d_a: 0.3, d_0u: 0.2, d_0l: 0.2, d_r: 0.0}",
    "that of self-collision": "avoidance: {self_collision: {d_a: 0.3, d_0u: 0.2, d_0l: 0.2, d_r: 0.0}}",
    "virtual point at the trigger": "skin: {capacitive: {trigger: 0.1, virtual_distance: 0.1}}",
    "deadline of one period": "control: {rate: 50, deadline: 0.02}",
    "reading as old as the timeout": "skin: {timeout: 0.125, tof: {rate: 16, latency: 0.0625}}",
    "posture at a limit": "limits: {position: {joint_1: [-1, 1]}}\ntask: {posture: {joints: {joint_1: 1}}}",
}


@pytest.mark.parametrize("name", EQUAL)
def test_values_that_just_go_together(name: str, tmp_path: Path) -> None:
    path = tmp_path / "equal.yaml"
    path.write_text(f"extends: {PLANAR}\n{EQUAL[name]}\n")
    assert load(path).robot.name == "planar2"


def test_thresholds_of_self_collision_keep_their_order(tmp_path: Path) -> None:
    path = tmp_path / "order.yaml"
    path.write_text(f"extends: {PLANAR}\navoidance: {{self_collision: {{d_r: 0.06}}}}\n")
    with pytest.raises(ConfigError, match=r"d_r = 0\.06 m must be less than d_0l = 0\.05 m"):
        load(path)


def test_ranges_of_parameters_are_those_of_the_method() -> None:
    """The column `accepted` of docs/method.md: greater than 0, at least 0, at most 0."""
    page = (PLANAR.parents[2] / "docs" / "method.md").read_text()
    checked = set()
    for line in re.findall(r"^\| `.*\|$", page, re.M):
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        names = re.findall(r"`(\w+)`", cells[0])
        accepted = [part.strip() for part in cells[-1].split(",")]
        for name, word in zip(
            names, accepted if len(accepted) == len(names) else accepted * len(names), strict=False
        ):
            if name in RANGES and re.fullmatch(r"[>≥≤] [\de.-]+", word):
                sign, limit = word[0], float(word[1:])
                lower, upper = RANGES[name]
                assert (
                    (upper == limit) if sign == "≤" else (lower > limit if sign == ">" else lower == limit)
                ), name
                checked.add(name)
    assert len(checked) >= 32, sorted(set(RANGES) - checked)
