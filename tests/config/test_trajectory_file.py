"""Trajectories in CSV files: what is read, and every mistake with its line."""

from pathlib import Path

import pytest

from proxgen.config.scene import load_scene
from proxgen.errors import ConfigError


def scene(tmp_path: Path, content: str | bytes | None, targets: str = "way.csv") -> Path:
    """A scene that names a trajectory file."""
    if content is not None:
        (tmp_path / "way.csv").write_bytes(content.encode() if isinstance(content, str) else content)
    path = tmp_path / "scene.yaml"
    path.write_text(f"name: way\ntargets: {targets}\n")
    return path


def test_columns_become_targets(tmp_path: Path) -> None:
    loaded = load_scene(scene(tmp_path, "# a way\ntime, x, y, z\n0, 1, 2, 3\n\n1.5, 4, 5, 6\n"))
    assert [(t.time, t.position, t.orientation) for t in loaded.targets] == [
        (0.0, (1.0, 2.0, 3.0), None),
        (1.5, (4.0, 5.0, 6.0), None),
    ]
    loaded = load_scene(scene(tmp_path, "time,x,y,z,roll,pitch,yaw\n0,1,2,3,0.1,0.2,0.3\n"))
    assert loaded.targets[0].orientation == (0.1, 0.2, 0.3)


def test_times_may_be_written_in_the_scene(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(
        "name: s\ntargets:\n  - {position: [0, 0, 1], time: 500 ms}\n  - {position: [0, 0, 1], time: 1 s}\n"
    )
    assert [target.time for target in load_scene(path).targets] == [0.5, 1.0]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "way.csv: the trajectory cannot be read: No such file or directory"),
        (b"\xff\xfe\x00", "way.csv: the trajectory cannot be read: it is not a text file"),
        ("", "way.csv: the first line must be time,x,y,z or time,x,y,z,roll,pitch,yaw"),
        ("# words\nt,x,y,z\n0,1,2,3\n", "way.csv:2: the first line must be time,x,y,z or "),
        ("time,x,y,z\n", "way.csv: the trajectory has no points"),
        ("time,x,y,z\n0,1,2\n", "way.csv:2: expected 4 finite numbers"),
        ("time,x,y,z\n0,1,2,3\n1,1,2,x\n", "way.csv:3: expected 4 finite numbers"),
        ("time,x,y,z\n0,1,2,nan\n", "way.csv:2: expected 4 finite numbers"),
        ("time,x,y,z\n0,1,2,3\n0,1,2,3\n", "way.csv:3: time = 0 s must be later than before, 0 s"),
        ("time,x,y,z\n-1,1,2,3\n", "way.csv:2: time = -1 s must be at least 0"),
    ],
)
def test_mistakes_have_their_lines(tmp_path: Path, content: str | bytes | None, message: str) -> None:
    with pytest.raises(ConfigError) as caught:
        load_scene(scene(tmp_path, content))
    assert message in str(caught.value)


def test_some_targets_with_times_are_a_mistake(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text("name: s\ntargets:\n  - {position: [0, 0, 1], time: 1 s}\n  - {position: [0, 0, 1]}\n")
    with pytest.raises(ConfigError, match=r"scene.yaml:4: targets.1: all targets have a 'time', or none has"):
        load_scene(path)
    path.write_text(path.read_text().replace("0, 1]}\n", "0, 1], time: 1 s}\n"))
    with pytest.raises(ConfigError, match=r"targets.1.time: time = 1 s must be later than .* before, 1 s"):
        load_scene(path)
