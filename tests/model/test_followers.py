"""Joints that follow a controlled one: their limits hold for it, also from branches beside the arm."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from arms import RECIPES, write_arm

from proxgen.config import load
from proxgen.errors import ConfigError
from proxgen.model import RobotModel, build_model
from proxgen.model.kinematics import to_pin

FINGER = """  <joint name="finger" type="revolute">
    <parent link="link_2"/>
    <child link="tip"/>
    <axis xyz="0 1 0"/>
    <limit lower="{lower}" upper="{upper}" velocity="{velocity}" effort="5"/>
    <mimic joint="{leader}" multiplier="{ratio}" offset="{offset}"/>
  </joint>
  <link name="tip"/>
</robot>"""


def arm(folder: Path, extra: str = "", **finger: object) -> Path:
    """YAML file of an arm of two joints with a finger that follows one, on a branch beside the arm."""
    path = write_arm(RECIPES[0], folder)
    urdf = folder / "chain2.urdf"
    values = {"lower": -2, "upper": 2, "velocity": 9, "leader": "joint_1", "ratio": 1, "offset": 0} | finger
    urdf.write_text(urdf.read_text().replace("</robot>", FINGER.format(**values)))
    path.write_text(path.read_text() + extra)
    return path


def limits_of(model: RobotModel, index: int) -> tuple[float, float, float]:
    """Lower, upper, velocity."""
    return float(model.q_lower[index]), float(model.q_upper[index]), float(model.qdot_limit[index])


def test_the_limits_of_a_joint_on_the_way_that_follows_hold(tmp_path: Path) -> None:
    """mimic5: joint_2 is -0.7 q_1 + 0.1, here within -0.6 and 0.8 and at most at 0.07 rad/s."""
    path = write_arm(next(recipe for recipe in RECIPES if recipe.name == "mimic5"), tmp_path)
    urdf = tmp_path / "mimic5.urdf"
    before, name, after = urdf.read_text().partition('<joint name="joint_2"')
    after = re.sub(
        r'lower="-2.2" upper="2.4" velocity="[^"]*"',
        'lower="-0.6" upper="0.8" velocity="0.07"',
        after,
        count=1,
    )
    urdf.write_text(before + name + after)
    model = build_model(load(path))
    assert limits_of(model, 1) == pytest.approx((-1.0, 1.0, 0.1))
    for q in (model.q_lower, model.q_upper):
        start = [0.0 if name != "joint_1" else q[k] for k, name in enumerate(model.joint_names)]
        joint = model.pin_model.joints[model.pin_model.getJointId("joint_2")]
        assert -0.6 - 1e-12 <= to_pin(model, np.array(start))[joint.idx_q] <= 0.8 + 1e-12


def test_the_limits_of_a_joint_on_a_branch_that_follows_hold(tmp_path: Path) -> None:
    own = build_model(load(write_arm(RECIPES[0], tmp_path)))
    model = build_model(load(arm(tmp_path, ratio=2, offset=-0.4, lower=-2, upper=1, velocity=0.5)))
    assert limits_of(model, 0) == limits_of(own, 0)
    assert limits_of(model, 1) == pytest.approx((-0.8, 0.7, 0.25))
    # whatever the file says of the leader
    wider = "limits: {position: {joint_1: [-0.5, 3]}, velocity: {joint_1: 3}}\n"
    folder = tmp_path / "wider"
    folder.mkdir()
    path = arm(folder, wider, ratio=2, offset=-0.4, lower=-2, upper=1, velocity=0.5)
    assert limits_of(build_model(load(path)), 1) == pytest.approx((-0.5, 0.7, 0.25))


@pytest.mark.parametrize(
    "finger",
    [
        {"lower": 0, "upper": 0, "velocity": 0},  # as some URDFs have them, for none
        {"ratio": 0, "lower": 0.1, "upper": 0.2, "velocity": 0.1},  # does not move
    ],
)
def test_followers_without_limits_or_motion_bound_nothing(tmp_path: Path, finger: dict[str, Any]) -> None:
    own = build_model(load(write_arm(RECIPES[0], tmp_path)))
    assert limits_of(build_model(load(arm(tmp_path, **finger))), 1) == limits_of(own, 1)


def test_a_follower_that_is_held_bounds_nothing(tmp_path: Path) -> None:
    own = build_model(load(write_arm(RECIPES[0], tmp_path)))
    path = arm(tmp_path, lower=0.1, upper=0.2)
    path.write_text(path.read_text().replace("tool: tool}", "tool: tool, locked_joints: {finger: 0.15}}"))
    assert limits_of(build_model(load(path)), 1) == limits_of(own, 1)


def test_limits_that_leave_no_room_are_refused(tmp_path: Path) -> None:
    path = arm(tmp_path, "limits: {position: {joint_1: [1, 2]}}\n", ratio=2, lower=-1, upper=1)
    with pytest.raises(ConfigError) as caught:
        build_model(load(path))
    (problem,) = caught.value.problems
    assert problem.key == "limits.position.joint_1"
    assert problem.message == (
        "joint 'joint_1' has no room to move: 'finger', which follows it, allows -0.5 to 0.5 only"
    )


@pytest.mark.parametrize(
    ("extra", "key"),
    [
        ("  - {name: tip, frame: tip, start: [0, 0, 0], end: [0, 0, 0.1], radius: 0.02}\n", "capsules.2"),
        (
            "avoidance: {self_collision: {points: [{name: tip, frame: tip, position: [0, 0, 0.5]}]}}\n",
            "avoidance.self_collision.points.0",
        ),
    ],
    ids=["capsule", "point"],
)
def test_nothing_may_lie_on_a_branch_that_moves_with_the_arm(tmp_path: Path, extra: str, key: str) -> None:
    """It would stand still in the model, so that the arm could drive it into an obstacle."""
    path = arm(tmp_path)
    text = path.read_text()
    at = text.index("skin:") if extra.startswith("  -") else len(text)
    path.write_text(text[:at] + extra + text[at:])
    with pytest.raises(ConfigError) as caught:
        build_model(load(path))
    (problem,) = caught.value.problems
    assert problem.key == f"{key}.frame"
    assert problem.line == path.read_text()[: path.read_text().index("frame: tip")].count("\n") + 1
    assert problem.message.startswith("'tip' moves with joint 'finger', which follows 'joint_1'")
    held = path.read_text().replace("tool: tool}", "tool: tool, locked_joints: {finger: 0.5}}")
    path.write_text(held)
    frame = (model := build_model(load(path))).pin_model.frames[model.pin_model.getFrameId("tip")]
    assert math.acos((frame.placement.rotation.trace() - 1.0) / 2.0) == pytest.approx(0.5)


def test_joints_that_follow_each_other_are_refused(tmp_path: Path) -> None:
    path = write_arm(next(recipe for recipe in RECIPES if recipe.name == "mimic5"), tmp_path)
    urdf = tmp_path / "mimic5.urdf"
    before, name, after = urdf.read_text().partition('<joint name="joint_1"')
    after = after.replace("</joint>", '<mimic joint="joint_2"/></joint>', 1)
    urdf.write_text(before + name + after)
    with pytest.raises(ConfigError, match="joint 'joint_1' mimics 'joint_2', which follows it in turn"):
        build_model(load(path))


def test_a_joint_may_follow_one_that_follows(tmp_path: Path) -> None:
    """joint_1 is 2 q_0 + 0.3 here, and joint_2 -0.7 times that and 0.1."""
    path = write_arm(next(recipe for recipe in RECIPES if recipe.name == "mimic5"), tmp_path)
    urdf = tmp_path / "mimic5.urdf"
    before, name, after = urdf.read_text().partition('<joint name="joint_1"')
    after = after.replace("</joint>", '<mimic joint="joint_0" multiplier="2" offset="0.3"/></joint>', 1)
    urdf.write_text(before + name + after)
    model = build_model(load(path))
    assert model.joint_names == ("joint_0", "joint_3", "joint_4")
    followers = [(drive.index, drive.ratio, drive.offset) for drive in model.drives[1:3]]
    assert followers[0] == (0, 2.0, 0.3)
    assert followers[1] == pytest.approx((0, -1.4, -0.11))


def test_a_joint_without_an_acceleration_limit_has_none(tmp_path: Path) -> None:
    """Where limits are given joint by joint."""
    path = write_arm(RECIPES[0], tmp_path)
    path.write_text(f"{path.read_text()}limits: {{acceleration: {{joint_1: 11}}}}\n")
    np.testing.assert_array_equal(build_model(load(path)).qddot_limit, [1e20, 11.0])


def test_a_held_joint_holds_what_follows_it(tmp_path: Path) -> None:
    """A finger at half of the other one's 0.03 m and 0.002 m, along -y."""
    path = write_arm(next(recipe for recipe in RECIPES if recipe.gripper), tmp_path)
    urdf = tmp_path / "endless4.urdf"
    rule = '<mimic joint="finger_left"'
    assert rule in urdf.read_text()
    urdf.write_text(urdf.read_text().replace(rule, f'{rule} multiplier="0.5" offset="0.002"'))
    path.write_text(
        path.read_text().replace("tool: tool}", "tool: tool, locked_joints: {finger_left: 0.03}}")
    )
    model = build_model(load(path))
    frame = model.pin_model.frames[model.pin_model.getFrameId("right")]
    np.testing.assert_allclose(frame.placement.translation, [0.0, -0.017, 0.0], atol=1e-12)
