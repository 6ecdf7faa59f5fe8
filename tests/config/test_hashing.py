from pathlib import Path

import pytest

from proxgen.config import load
from proxgen.config.hashing import config_hash


def change(old: str, new: str, file: str = "robot.yaml") -> str:
    """Change a file, return the new hash of the configuration, and change it back."""
    before = Path(file).read_text()
    assert old in before
    Path(file).write_text(before.replace(old, new))
    result = config_hash(load("robot.yaml"))
    Path(file).write_text(before)
    return result


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("d_a: 0.30", "d_a: 0.3  # a comment"),
        ("d_a: 0.30", "d_a: 30 cm"),
        ("  d_a: 0.30\n  d_0u: 0.25\n", "  d_0u: 0.25\n  d_a: 0.30\n"),
        ("d_a: 0.30", "d_a: 0.30\n  d_r: 0.17"),
        ("urdf: arm.urdf", "urdf: ./arm.urdf"),
    ],
    ids=["comment", "unit", "order", "default written", "path"],
)
def test_what_makes_no_difference(folder: Path, old: str, new: str) -> None:
    assert change(old, new) == config_hash(load("robot.yaml"))


@pytest.mark.parametrize(
    ("old", "new", "file"),
    [
        ("d_a: 0.30", "d_a: 0.31", "robot.yaml"),
        ("name: arm", "name: other", "robot.yaml"),
        ("rate: 50 Hz", "rate: 51 Hz", "robot.yaml"),
        ('upper="2"', 'upper="2.1"', "arm.urdf"),
    ],
)
def test_what_makes_a_difference(folder: Path, old: str, new: str, file: str) -> None:
    assert change(old, new, file) != config_hash(load("robot.yaml"))


def test_the_hash_does_not_depend_on_the_folder(
    folder: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    other = tmp_path_factory.mktemp("other")
    for name in ("robot.yaml", "arm.urdf"):
        (other / name).write_bytes((folder / name).read_bytes())
    assert config_hash(load(other / "robot.yaml")) == config_hash(load("robot.yaml"))
    assert len(config_hash(load("robot.yaml"))) == 64
