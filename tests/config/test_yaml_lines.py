from pathlib import Path
from typing import Any

import pytest

from proxgen.config.yaml_lines import MAX_VALUES, parse_yaml, read_yaml

FILE = Path("f.yaml")


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 1e-3),
        ("1E5", 1e5),
        ("-.5", -0.5),
        ("+3.", 3.0),
        ("0x1F", 31),
        ("0o17", 15),
        ("017", 17),
        ("-12", -12),
        ("true", True),
        ("FALSE", False),
        ("~", None),
        ("", None),
        ("-.inf", float("-inf")),
        # what YAML 1.1 takes for a truth value, a number to base 60, a date: plain texts
        ("on", "on"),
        ("no", "no"),
        ("1:30", "1:30"),
        ("2020-01-01", "2020-01-01"),
        ("1_000", "1_000"),
        ("25 deg", "25 deg"),
        ("'5'", "5"),
        ("!!str 5", "5"),
        ("!!float 5", 5.0),
        ("[1, [2.5, x]]", [1, [2.5, "x"]]),
        ("{a: 1, true: 2}", {"a": 1, "true": 2}),
    ],
)
def test_values_are_those_of_yaml_1_2(text: str, value: Any) -> None:
    document = parse_yaml(f"key: {text}", FILE)
    assert document.problems == []
    assert document.root is not None
    read = document.root.plain()["key"]
    assert read == value
    assert type(read) is type(value)


def test_every_key_and_item_has_its_line() -> None:
    text = "a: 1\nb:\n  c: [1,\n      2]\n  d:\n    - e: 5\n    - 6\n"
    root = parse_yaml(text, FILE).root
    assert root is not None
    assert {path: mark.line for path, mark in root.marks().items()} == {
        "a": 1, "b": 2, "b.c": 3, "b.c.0": 3, "b.c.1": 4, "b.d": 5, "b.d.0": 6, "b.d.0.e": 6, "b.d.1": 7,
    }  # fmt: skip


def test_an_alias_stands_for_its_value() -> None:
    root = parse_yaml("a: &x {b: 1}\nc: *x\n", FILE).root
    assert root is not None
    assert root.plain() == {"a": {"b": 1}, "c": {"b": 1}}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "f.yaml: the file is empty"),
        ("# only a comment\n", "f.yaml: the file is empty"),
        ("- 1\n", "f.yaml:1: expected keys with values (such as `robot:`) at the top of the file"),
        (
            "<robot/>\n",
            "f.yaml:1: expected keys with values (such as `robot:`) at the top of the file; this is XML, "
            "and `proxgen init` makes a YAML file from a URDF",
        ),
        ("a: 1\nb: 2\na: 3\n", "f.yaml:3: a: the key 'a' is given twice, first in line 1"),
        ("a:\n  b: 1\n  b: 1\n", "f.yaml:3: a.b: the key 'b' is given twice, first in line 2"),
        ("a:\n\tb: 1\n", "f.yaml:2: not valid YAML: a tab; indentation must be made of spaces"),
        (
            "a: b: c\n",
            "f.yaml:1: not valid YAML: mapping values are not allowed here "
            "(a ':' too many, or the indentation is wrong)",
        ),
        (
            "a:\n  b: 1\n   c: 2\n",
            "f.yaml:3: not valid YAML: mapping values are not allowed here "
            "(a ':' too many, or the indentation is wrong)",
        ),
        (
            "a:\n  b: {c: 1}\n   d: 2\n",
            "f.yaml:3: not valid YAML: indented by 3 spaces, "
            "but the keys of the section that begins in line 2 by 2",
        ),
        (
            "a:\n  b: 1\n - c\n",
            "f.yaml:3: not valid YAML: indented by 1 spaces, "
            "but the keys of the section that begins in line 1 by 0",
        ),
        (
            "a: 1\n- b\n",
            "f.yaml:2: not valid YAML: a list item ('-') among the keys of the section that begins in line 1",
        ),
        (
            "a: 1\nb: 'open' it\n",
            "f.yaml:2: not valid YAML: text after a value that has ended, "
            "in the section that begins in line 1",
        ),
        (
            "a: 1\nb: [1, 2], 3\n",
            "f.yaml:2: not valid YAML: ',' after a value that has ended, "
            "in the section that begins in line 1",
        ),
        ("a:\n  b: 1\n  c 1\n  d: 2\n", "f.yaml:3: not valid YAML: no ':' after the key"),
        (
            "a:\n  [1, 2\nb: 3\n",
            "f.yaml:3: not valid YAML: expected ',' or ']', but got ':' "
            "(while parsing a flow sequence, which begins in line 2)",
        ),
        (
            "a: 'open\n",
            "f.yaml:2: not valid YAML: found unexpected end of stream "
            "(while scanning a quoted scalar, which begins in line 1)",
        ),
        ("a: *x\n", "f.yaml:1: not valid YAML: found undefined alias 'x'"),
        ("a: &x\n  - *x\n", "f.yaml:1: a.0: an alias contains itself"),
        (
            "a: 1\n---\nb: 2\n",
            "f.yaml:2: not valid YAML: a second document begins here ('---'); one is allowed",
        ),
        ("a: 1\nb: \x07\n", "f.yaml:2: not valid YAML: the character U+0007 is not allowed"),
        (
            "a: !!python/object/apply:os.system ['true']\n",
            "f.yaml:1: a: the tag '!!python/object/apply:os.system' is not allowed; write plain values",
        ),
        ("a: !unit 3\n", "f.yaml:1: a: the tag '!unit' is not allowed; write plain values"),
        ("a: !!int x\n", "f.yaml:1: a: 'x' is not of type int; write plain values"),
        ("<<: {a: 1}\n", "f.yaml:1: merge keys ('<<') are not supported; use 'extends' or an alias"),
        ("? [a]\n: 1\n", "f.yaml:1: a key must be a plain name, not a list or a mapping"),
        ("a: " + "9" * 5000, "f.yaml:1: a: a number of this many digits cannot be read"),
        ("[" * 1000, "f.yaml: not valid YAML: nested too deeply"),
    ],
)
def test_what_is_wrong_with_the_text_is_said(text: str, message: str) -> None:
    assert [str(problem) for problem in parse_yaml(text, FILE).problems] == [message]


def test_aliases_of_aliases_do_not_fill_the_memory() -> None:
    levels = "".join(f"k{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]\n" for i in range(1, 10))
    problems = parse_yaml(f"k0: &a0 [1]\n{levels}", FILE).problems
    assert [problem.message for problem in problems] == [
        f"not valid YAML: its aliases stand for more than {MAX_VALUES} values"
    ]


def test_a_file_that_is_not_there_names_its_neighbour(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text("a: 1")
    problems = read_yaml(tmp_path / "robt.yaml").problems
    assert str(problems[0]) == (
        f"{tmp_path}/robt.yaml: the file does not exist; did you mean '{tmp_path}/robot.yaml'?"
    )


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    assert str(read_yaml(tmp_path).problems[0]) == f"{tmp_path}: this is a folder; a YAML file is needed"


def test_an_impossible_path_is_a_problem() -> None:
    assert "cannot be read" in read_yaml(Path("a\0b")).problems[0].message


def test_text_that_is_not_utf_8_is_named_by_its_line(tmp_path: Path) -> None:
    (tmp_path / "f.yaml").write_bytes("a: 1\nb: Stück\n".encode("latin-1"))
    assert str(read_yaml(tmp_path / "f.yaml").problems[0]) == f"{tmp_path}/f.yaml:2: the text is not UTF-8"


def test_a_byte_order_mark_is_no_problem(tmp_path: Path) -> None:
    (tmp_path / "f.yaml").write_bytes(b"\xef\xbb\xbfa: 1\n")
    root = read_yaml(tmp_path / "f.yaml").root
    assert root is not None
    assert root.plain() == {"a": 1}
