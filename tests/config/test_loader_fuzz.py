"""Whatever a file holds, the loader returns a configuration or raises a ConfigError with words in it."""

import copy
import json
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from proxgen.config import load
from proxgen.config.loader import validate
from proxgen.config.origin import Origin
from proxgen.config.scene import Scene, load_scene
from proxgen.config.schema import Config
from proxgen.config.yaml_lines import parse_yaml
from proxgen.errors import ConfigError, Problem

FILE = Path("robot.yaml")
ROBOT = (Path(__file__).parent / "data" / "robot.yaml").read_text()
LINES = ROBOT.splitlines()
PIECES = [
    "{", "}", "[", "]", ": ", "- ", "\n", "\t", " ", "'", '"', "#", "&a ", "*a", "!x ", "!!int ", "---",
    "...", "null", "true", "1e999", ".nan", "-1", "25 deg", "0x", "<<: ", "? ", "|", ">", "%", "@", "ß",
    "\x00", ",",
]  # fmt: skip
SCALARS = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=8), st.sampled_from(PIECES)
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=8,
)
DAMAGES = st.tuples(st.integers(0, len(ROBOT)), st.integers(0, 12), st.sampled_from(PIECES))
"""A place in the file, how much is taken away there, and what is put there instead."""


def assert_in_words(problems: list[Problem] | tuple[Problem, ...], lines: int) -> None:
    """Every problem has a message of its own, and a line of the file (0 for the file as a whole)."""
    assert problems
    for problem in problems:
        assert problem.message
        assert "pydantic" not in str(problem)
        assert "Input should" not in problem.message
        assert 0 <= problem.line <= lines + 1


@given(st.text())
def test_any_text(text: str) -> None:
    document = parse_yaml(text, FILE)
    if document.root is None:
        assert_in_words(document.problems, text.count("\n") + 1)
        return
    config, problems = validate(document.root.plain(), Config, Origin(FILE, document.root.marks()))
    assert config is not None or problems


@given(st.lists(DAMAGES, max_size=4))
@settings(max_examples=200)
def test_a_file_with_damaged_places(
    tmp_path_factory: pytest.TempPathFactory, damages: list[tuple[int, int, str]]
) -> None:
    text = ROBOT
    for place, length, piece in damages:
        text = text[:place] + piece + text[place + length :]
    file = tmp_path_factory.getbasetemp() / "damaged.yaml"
    file.write_bytes(text.encode())
    try:
        load(file)
    except ConfigError as error:
        assert_in_words(error.problems, text.count("\n") + 1)


@given(st.permutations(range(len(LINES))), st.integers(0, len(LINES)))
def test_a_file_with_lines_out_of_order(order: list[int], count: int) -> None:
    text = "\n".join(LINES[index] for index in order[:count])
    document = parse_yaml(text, FILE)
    if document.root is not None:
        _, problems = validate(document.root.plain(), Config, Origin(FILE, document.root.marks()))
        assert_in_words(problems, count)


@given(st.data())
@settings(max_examples=300)
def test_a_file_with_other_values(data: st.DataObject) -> None:
    content = copy.deepcopy(yaml.safe_load(ROBOT))
    for _ in range(data.draw(st.integers(1, 3))):
        place: Any = content
        while True:
            keys = list(place) if isinstance(place, dict) else list(range(len(place)))
            if not keys:
                break
            key = data.draw(st.sampled_from(keys))
            if not isinstance(place[key], dict | list) or data.draw(st.booleans()):
                place[key] = data.draw(VALUES)
                break
            place = place[key]
    config, problems = validate(content, Config, Origin(FILE))
    if config is None:
        assert_in_words(problems, 0)


NAMES = st.text(max_size=20) | st.sampled_from(
    [
        "~nobody/arm.urdf",
        "package://",
        "package://a/b",
        "package://../a",
        "x" * 5000 + ".yaml",
        "a\0.yaml",
        "/",
        ".",
    ]
)


@given(urdf=NAMES, base=NAMES | VALUES)
def test_any_names_of_other_files(tmp_path_factory: pytest.TempPathFactory, urdf: str, base: Any) -> None:
    content = yaml.safe_load(ROBOT)
    content["robot"]["urdf"], content["extends"] = urdf, base
    file = tmp_path_factory.getbasetemp() / "names.yaml"
    file.write_text(json.dumps(content))
    with pytest.raises(ConfigError) as caught:
        load(file)
    assert_in_words(caught.value.problems, 1)


@given(NAMES)
def test_any_name_of_a_scene(name: str) -> None:
    with pytest.raises(ConfigError):
        load_scene(name, beside=Path("robot.yaml"))


@given(VALUES)
def test_any_values_as_a_scene(value: Any) -> None:
    scene, problems = validate({"name": "x", "targets": value, "start": value}, Scene, Origin(FILE))
    assert scene is not None or problems
