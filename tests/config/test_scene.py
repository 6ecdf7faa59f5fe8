from pathlib import Path

import pytest

from proxgen.config.scene import load_scene, scene_names
from proxgen.errors import ConfigError

SCENES = Path(__file__).parents[2] / "examples" / "scenes"

SCENE = """\
name: room
description: A ball and a box.
obstacles:
  - name: ball
    shape: sphere
    radius: 8 cm
    position: [1, 0, 0.5]
    motion: {direction: [-1, 0, 0], distance: 0.4, speed: 0.2, hold: 3 s, period: 20 s}
  - {name: box, shape: box, size: [0.1, 0.1, 0.4], position: [0.5, 0, 0.2]}
targets:
  - position: [0.5, -0.4, 0.4]
  - position: [0.5, 0.4, 0.4]
    orientation: [180 deg, 0, 0]
start: {shoulder: 30 deg}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with `room.yaml`."""
    monkeypatch.chdir(tmp_path)
    Path("room.yaml").write_text(SCENE)
    return tmp_path


def test_the_scenes_of_the_paper_have_its_numbers() -> None:
    gap, pillar, facing, moving = (load_scene(name) for name in ("gap", "pillar", "facing", "moving"))
    assert [(o.position, o.size) for o in gap.obstacles] == [
        ((0.5, 0.0, 0.1), (0.5, 0.1, 0.2)),
        ((0.5, 0.0, 0.8), (0.5, 0.1, 0.2)),
    ]
    # the half gap is d_0u = 0.25 m
    assert gap.obstacles[1].position[2] - gap.obstacles[0].position[2] - 0.2 == pytest.approx(2 * 0.25)
    assert [t.position for t in gap.targets] == [(0.5, -0.45, 0.45), (0.5, 0.45, 0.45)]
    assert [t.position for t in pillar.targets] == [(0.5, -0.45, 0.4), (0.5, 0.45, 0.4)]
    assert [t.position for t in facing.targets] == [(0.5, -0.45, 0.3), (0.5, 0.45, 0.3)]
    assert facing.obstacles == pillar.obstacles
    assert moving.start == (0.0, 0.5, 0.0, -1.5, 0.0, 1.0, 0.0)
    motions = [o.motion for o in moving.obstacles if o.motion is not None]
    assert [m.distance for m in motions] == [0.40, 0.42, 0.35]
    assert [m.phase for m in motions] == [0.0, 10.0, 5.0]
    assert {(m.speed, m.hold, m.period) for m in motions} == {(0.2, 3.0, 20.0)}


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_scene_is_named_after_its_file(path: Path) -> None:
    scene = load_scene(path)
    assert scene.name == path.stem
    assert scene.description
    assert scene.source == path


def test_a_scene_is_found_by_name_beside_the_robot(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "arm").mkdir()
    (folder / "scenes").mkdir()
    monkeypatch.chdir("/")
    robot = folder / "arm" / "arm.yaml"
    for place in (folder / "scenes", folder / "arm"):  # what is nearer wins
        (place / "room.yaml").write_text(SCENE)
        assert load_scene("room", beside=robot).source == place / "room.yaml"
    assert load_scene("gap", beside=robot).source == SCENES / "gap.yaml"
    (folder / "scenes" / "hall.yaml").write_text(SCENE)
    assert {"hall", "gap", "moving"} <= set(scene_names(robot))


def test_a_robot_is_not_its_own_scene(folder: Path) -> None:
    with pytest.raises(ConfigError, match="unknown scene 'room'"):
        load_scene("room", beside=folder / "room.yaml")


def test_an_unknown_scene_names_the_nearest() -> None:
    with pytest.raises(ConfigError) as caught:
        load_scene("gab")
    known = "facing, gap, moving, pillar, post"
    assert str(caught.value) == f"gab: unknown scene 'gab'; did you mean 'gap'? (allowed: {known})"
    with pytest.raises(ConfigError) as caught:
        load_scene("kitchen")
    assert str(caught.value) == (
        f"kitchen: unknown scene 'kitchen' (allowed: {known}); a file is named with its ending, "
        "such as my_scene.yaml"
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "targets:\n  - position: [0.5, -0.4, 0.4]\n  - position: [0.5, 0.4, 0.4]\n"
            "    orientation: [180 deg, 0, 0]\n",
            "",
            "room.yaml: targets: the key 'targets' is missing "
            "(the next one follows when one is reached, and after the last the first)",
        ),
        (
            "targets:\n  - position: [0.5, -0.4, 0.4]\n  - position: [0.5, 0.4, 0.4]\n"
            "    orientation: [180 deg, 0, 0]\n",
            "targets: []\n",
            "room.yaml:10: targets: expected a list of at least 1 item, found an empty list",
        ),
        ("    radius: 8 cm\n", "", "room.yaml:5: obstacles.0.shape: a sphere needs 'radius'"),
        # it has one, and that is all that is wrong with it
        (
            "    radius: 8 cm\n",
            "    radius: -8 cm\n",
            "room.yaml:6: obstacles.0.radius: -8 cm is out of range "
            "(allowed: greater than 0 and at most 10000 cm)",
        ),
        (
            "    radius: 8 cm\n",
            "    radius: 8 cm\n    length: 1 m\n",
            "room.yaml:7: obstacles.0.length: a sphere has no 'length', it has 'radius'",
        ),
        (
            "shape: sphere",
            "shape: ball",
            "room.yaml:5: obstacles.0.shape: unknown value 'ball' (allowed: box, capsule, sphere)",
        ),
        (
            "period: 20 s",
            "period: 6 s",
            "room.yaml:8: obstacles.0.motion.period: out, hold and back take 7 s, more than period = 6 s",
        ),
        (
            "direction: [-1, 0, 0]",
            "direction: [0, 0, 0]",
            "room.yaml:8: obstacles.0.motion.direction: a direction cannot be [0, 0, 0]",
        ),
        (
            "name: box,",
            "name: ball,",
            "room.yaml:9: obstacles.1.name: the name 'ball' is given twice; names must differ",
        ),
        (
            "position: [0.5, 0.4, 0.4]",
            "postion: [0.5, 0.4, 0.4]",
            "room.yaml:12: targets.1.position: the key 'position' is missing "
            "(of the task point, world frame)\n"
            "room.yaml:12: targets.1.postion: unknown key 'postion'; did you mean 'position'? "
            "(allowed: orientation, position, time)",
        ),
        (
            "name: room\n",
            "name: room\nname: hall\n",
            "room.yaml:2: name: the key 'name' is given twice, first in line 1",
        ),
        (
            "start: {shoulder: 30 deg}",
            "start: [30 kg]",
            "room.yaml:14: start.0: unit 'kg' does not measure a joint position "
            "(allowed: rad, deg, m, cm, mm)",
        ),
    ],
)
def test_a_mistake_has_its_message(folder: Path, old: str, new: str, message: str) -> None:
    assert SCENE.count(old) == 1
    Path("room.yaml").write_text(SCENE.replace(old, new))
    with pytest.raises(ConfigError) as caught:
        load_scene("room.yaml")
    assert str(caught.value) == message


def test_the_start_by_name_or_in_order(folder: Path) -> None:
    scene = load_scene("room.yaml")
    joints = ("lift", "shoulder")
    assert scene.start_positions(joints) == pytest.approx((0.0, 0.523599), abs=1e-6)
    Path("list.yaml").write_text(SCENE.replace("{shoulder: 30 deg}", "[0.1, 0.2]"))
    assert load_scene("list.yaml").start_positions(joints, [0.0, 0.0], [1.0, 1.0]) == (0.1, 0.2)
    Path("none.yaml").write_text(SCENE.replace("start: {shoulder: 30 deg}", ""))
    assert load_scene("none.yaml").start_positions(joints) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("start", "message"),
    [
        (
            "{sholder: 1}",
            "room.yaml:14: start.sholder: unknown controlled joint 'sholder'; did you mean 'shoulder'? "
            "(allowed: lift, shoulder)",
        ),
        (
            "[1, 2, 3]",
            "room.yaml:14: start: 3 joint positions for an arm with 2 joints (lift, shoulder)",
        ),
        (
            "{shoulder: 2.5}",
            "room.yaml:14: start.shoulder: joint 'shoulder' would start at 2.5, outside its limits -2 to 2",
        ),
        ("[-1, 0]", "room.yaml:14: start.0: joint 'lift' would start at -1, outside its limits 0 to 0.5"),
        ("{lift: 3 deg}", "room.yaml:14: start.lift: '3 deg': joint 'lift' slides; give a length"),
        ("[0.1 m, 1 cm]", "room.yaml:14: start.1: '1 cm': joint 'shoulder' turns; give an angle"),
    ],
)
def test_a_start_that_the_arm_cannot_take(folder: Path, start: str, message: str) -> None:
    Path("room.yaml").write_text(SCENE.replace("{shoulder: 30 deg}", start))
    with pytest.raises(ConfigError) as caught:
        load_scene("room.yaml").start_positions(("lift", "shoulder"), (0.0, -2.0), (0.5, 2.0), (True, False))
    assert str(caught.value) == message
