"""URDF and configuration to RobotModel."""

import re
from itertools import product
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from arms import RECIPES, write_arm

from proxgen.config import load
from proxgen.config.schema import Config
from proxgen.errors import ConfigError
from proxgen.model import RobotModel, build_model
from proxgen.model.frames import snapped
from proxgen.model.held import held_outside
from proxgen.model.kinematics import body_poses, to_pin, tool_pose


def test_iiwa_has_the_published_reach_and_limits(iiwa7_model: RobotModel) -> None:
    assert iiwa7_model.n == 7
    np.testing.assert_allclose(tool_pose(iiwa7_model, np.zeros(7))[:3, 3], [0.0, 0.0, 1.346], atol=1e-12)
    degrees = np.degrees(iiwa7_model.q_upper)
    np.testing.assert_allclose(degrees, [170, 120, 170, 120, 170, 120, 175], atol=1e-6)
    np.testing.assert_allclose(
        np.degrees(iiwa7_model.qdot_limit), [98, 98, 100, 130, 140, 180, 180], atol=1e-6
    )


def test_iiwa_joint_4_turns_about_minus_y(iiwa7_model: RobotModel) -> None:
    q = np.zeros(7)
    q[3] = np.pi / 2
    # a positive turn about -y takes the forearm and hand (0.606 m) from +z to -x
    np.testing.assert_allclose(tool_pose(iiwa7_model, q)[:3, 3], [-0.606, 0.0, 0.74], atol=1e-12)


def test_skin_counts_and_directions(iiwa7_model: RobotModel) -> None:
    assert len(iiwa7_model.modules) == 12 + 12 + 8
    assert len(iiwa7_model.tof_modules) == len(iiwa7_model.capacitive_modules) == 32
    for module in iiwa7_model.modules:
        assert np.linalg.norm(module.normal) == pytest.approx(1.0, abs=1e-15)
        # every module looks outwards: away from the z axis of its link
        assert module.normal[:2] @ module.position[:2] > 0.0


def test_full_and_reduced_model_agree(any_config: Config, any_model: RobotModel) -> None:
    """Locking other branches and following mimic joints changes nothing for the tool."""
    full = pin.buildModelFromUrdf(str(any_config.urdf_path), mimic=True)
    data = full.createData()
    rng = np.random.default_rng(11)
    for _ in range(50):
        q = rng.uniform(-2.0, 2.0, any_model.n)
        configuration = pin.neutral(full)
        for name, value in zip(any_model.joint_names, q, strict=True):
            joint = full.joints[full.getJointId(name)]
            entry = [np.cos(value), np.sin(value)] if joint.nq == 2 else [value]
            configuration[joint.idx_q : joint.idx_q + joint.nq] = entry
        pin.framesForwardKinematics(full, data, configuration)
        expected = data.oMf[full.getFrameId(any_config.robot.tool)].homogeneous
        np.testing.assert_allclose(tool_pose(any_model, q), expected, atol=1e-10)


def test_transmission_is_the_derivative_of_the_joint_positions(any_model: RobotModel) -> None:
    rng = np.random.default_rng(12)
    q, qdot = rng.uniform(-1.0, 1.0, (2, any_model.n))
    step = 1e-6
    difference = pin.difference(
        any_model.pin_model, to_pin(any_model, q - step * qdot), to_pin(any_model, q + step * qdot)
    )
    np.testing.assert_allclose(difference / (2 * step), any_model.transmission @ qdot, atol=1e-8)


def test_gripper_is_locked_within_its_limits(tmp_path: Path) -> None:
    recipe = next(recipe for recipe in RECIPES if recipe.gripper)
    config = load(write_arm(recipe, tmp_path))
    model = build_model(config)
    assert model.joint_names == ("joint_0", "joint_1", "joint_2", "joint_3")
    frame = model.pin_model.frames[model.pin_model.getFrameId("left")]
    # locked at 0.01, the end of its range that is nearest to zero
    np.testing.assert_allclose(frame.placement.translation, [0.0, 0.01, 0.0], atol=1e-12)
    # and the other finger, which mimics it, opposite to it
    frame = model.pin_model.frames[model.pin_model.getFrameId("right")]
    np.testing.assert_allclose(frame.placement.translation, [0.0, -0.01, 0.0], atol=1e-12)


def test_poses_of_a_prismatic_joint_move_along_its_axis(tmp_path: Path) -> None:
    recipe = next(recipe for recipe in RECIPES if recipe.name == "slider3")
    model = build_model(load(write_arm(recipe, tmp_path)))
    before, after = (body_poses(model, np.array([x, 0.2, 0.0]))[1] for x in (0.0, 0.3))
    travel = after[:3, 3] - before[:3, 3]
    assert np.linalg.norm(travel) == pytest.approx(0.3, abs=1e-12)
    np.testing.assert_allclose(before[:3, :3], after[:3, :3], atol=1e-15)


def test_snapping_removes_only_rounding() -> None:
    nearly = pin.rpy.rpyToMatrix(1.57079632679, 0.0, 0.0)
    exact = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    assert not np.array_equal(nearly, exact)
    assert np.array_equal(snapped(nearly), exact)
    meant = pin.rpy.rpyToMatrix(1.5707, 0.0, 0.0)
    assert np.array_equal(snapped(meant), meant)


def test_snapped_rotations_stay_rotations() -> None:
    """As in the xArm's URDF: 1.5708 leaves products of 1.3e-11, and entries that differ from 1 by 7e-12."""
    angles = (0.0, 1.5708, -1.5708, 3.14159, 1.57079632679, 3.1415926535, 0.3, 8e-12, 1.2e-11)
    for rpy in product(angles, repeat=3):
        raw = pin.rpy.rpyToMatrix(*rpy)
        clean = snapped(raw)
        np.testing.assert_allclose(clean.T @ clean, np.eye(3), rtol=0, atol=5e-15)
        np.testing.assert_allclose(clean, raw, rtol=0, atol=2e-11)


@pytest.mark.parametrize(
    ("change", "key", "message"),
    [
        ("tool: tool|tool: tol", "robot.tool", "did you mean 'tool'?"),
        ("frame: link_2,|frame: lnk_2,", "capsules.1.frame", "did you mean 'link_2'?"),
        ("rows: [x, z]|rows: [x, rx]", "task.rows.1", "unknown row of a position task 'rx'"),
        (
            "capsules:|limits: {velocity: {joint_9: 1}}\ncapsules:",
            "limits.velocity.joint_9",
            "joint_0, joint_1",
        ),
        (
            "tool: tool}|tool: tool, locked_joints: {joint_7: 0}}",
            "robot.locked_joints.joint_7",
            "unknown joint 'joint_7'",
        ),
        ("tool: tool}|tool: link_0}", "robot.tool", "no moving joint between the base and the tool frame"),
        (
            "end: [0, 0, 0.2], radius: 0.05|end: [0, 0, 0.2], radius: 0.7",
            "skin.cuffs.0",
            "5 of the 5 modules of cuff 'hand' lie inside the capsule 'link_1' of another link",
        ),
    ],
)
def test_mistakes_name_key_line_and_nearest(tmp_path: Path, change: str, key: str, message: str) -> None:
    path = write_arm(RECIPES[0], tmp_path)
    old, new = change.split("|")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(ConfigError) as caught:
        build_model(load(path))
    (problem,) = caught.value.problems
    assert problem.key == key
    assert message in problem.message
    assert problem.file == path
    assert problem.line > 0


def test_all_mistakes_are_reported_at_once(tmp_path: Path) -> None:
    path = write_arm(RECIPES[0], tmp_path)
    text = path.read_text().replace("tool: tool}", "tool: tol}").replace("frame: link_1,", "frame: lnk_1,")
    path.write_text(text.replace("frame: link_2,", "frame: lnk_2,", 1))
    with pytest.raises(ConfigError) as caught:
        build_model(load(path))
    assert {problem.key for problem in caught.value.problems} == {
        "robot.tool",
        "capsules.0.frame",
        "capsules.1.frame",
    }


def test_missing_velocity_limit_is_asked_for(tmp_path: Path) -> None:
    path = write_arm(RECIPES[0], tmp_path)
    urdf = tmp_path / f"{RECIPES[0].name}.urdf"
    text = urdf.read_text()
    start = text.index('velocity="')
    urdf.write_text(text[:start] + 'velocity="0"' + text[text.index('" effort', start) + 1 :])
    with pytest.raises(ConfigError, match=r"joint 'joint_0' no velocity limit above 0; set limits\.velocity"):
        build_model(load(path))


def test_infinite_limits_are_no_limits(tmp_path: Path) -> None:
    path = write_arm(RECIPES[0], tmp_path)
    urdf = tmp_path / f"{RECIPES[0].name}.urdf"
    urdf.write_text(urdf.read_text().replace('lower="-2.2" upper="2.4"', 'lower="-inf" upper="inf"', 1))
    with pytest.raises(ConfigError, match=r"joint 'joint_0' no position limits; set limits\.position"):
        build_model(load(path))


def test_limits_without_room_are_shown(tmp_path: Path) -> None:
    path = write_arm(RECIPES[0], tmp_path)
    urdf = tmp_path / f"{RECIPES[0].name}.urdf"
    urdf.write_text(urdf.read_text().replace('lower="-2.2" upper="2.4"', 'lower="2.2" upper="-2.4"', 1))
    told = r"joint 'joint_0' position limits without room, 2\.2 to -2\.4; set limits\.position\.joint_0"
    with pytest.raises(ConfigError, match=told):
        build_model(load(path))


def test_joints_that_are_held_outside_their_limits_are_told(tmp_path: Path) -> None:
    path = write_arm(RECIPES[0], tmp_path)
    text = path.read_text()
    for position, count in ((2.4, 0), (2.4001, 1), (-2.3, 1)):
        path.write_text(text.replace("robot: {", f"robot: {{locked_joints: {{joint_1: {position}}}, ", 1))
        config = load(path)
        assert config.robot.locked_joints == {"joint_1": position}
        told = [problem.message for problem in held_outside(config)]
        assert len(told) == count
        assert all("joint 'joint_1' is held at" in message and "-2.2 to 2.4" in message for message in told)


def test_broken_urdf_is_a_config_error(tmp_path: Path) -> None:
    path = write_arm(RECIPES[0], tmp_path)
    (tmp_path / f"{RECIPES[0].name}.urdf").write_text("<robot><link></robot>")
    with pytest.raises(ConfigError, match="not well-formed XML"):
        build_model(load(path))


def test_a_urdf_that_makes_no_sense_says_why(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = write_arm(RECIPES[0], tmp_path)
    urdf = tmp_path / f"{RECIPES[0].name}.urdf"
    urdf.write_text(urdf.read_text().replace('<child link="link_1"/>', ""))
    with pytest.raises(ConfigError, match=r"Joint \[joint_0\] is missing a parent and/or child link"):
        build_model(load(path))
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            r'<axis xyz="[^"]*"',
            '<axis xyz="0 0 0"',
            "joint 'joint_0' has the axis \"0 0 0\", which is no direction",
        ),
        (
            r'<axis xyz="[^"]*"',
            '<axis xyz="1 nan 0"',
            "joint 'joint_0' has the axis \"1 nan 0\", which is no direc",
        ),
        (r'upper="[^"]*"', 'upper="2 rad"', '<limit upper="2 rad">: a number is needed'),
    ],
)
def test_numbers_that_mean_nothing_are_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    """An axis without direction became not-a-number in the kinematics."""
    path = write_arm(RECIPES[0], tmp_path)
    urdf = tmp_path / f"{RECIPES[0].name}.urdf"
    urdf.write_text(re.sub(old, new, urdf.read_text(), count=1))
    with pytest.raises(ConfigError, match=re.escape(f"cannot be read as a URDF: {message}")):
        build_model(load(path))


def test_axes_of_any_length_mean_their_direction(tmp_path: Path) -> None:
    path = write_arm(RECIPES[1], tmp_path)
    urdf = tmp_path / f"{RECIPES[1].name}.urdf"
    before = build_model(load(path))
    stretched = re.sub(
        r'<axis xyz="([^"]*)"',
        lambda match: f'<axis xyz="{" ".join(str(7.0 * float(word)) for word in match[1].split())}"',
        urdf.read_text(),
    )
    urdf.write_text(stretched)
    after = build_model(load(path))
    q = np.array([0.2, 1.1, -0.25])
    np.testing.assert_allclose(body_poses(after, q), body_poses(before, q), atol=1e-6)


def test_limits_may_be_missing_altogether_if_the_file_has_them(tmp_path: Path) -> None:
    path = write_arm(RECIPES[0], tmp_path)
    urdf = tmp_path / f"{RECIPES[0].name}.urdf"
    urdf.write_text(re.sub(r"<limit [^>]*/>", "", urdf.read_text()))
    limits = "{position: {joint_0: [-1, 1], joint_1: [-2, 2]}, velocity: {joint_0: 1.5, joint_1: 2}}"
    path.write_text(f"{path.read_text()}limits: {limits}\n")
    model = build_model(load(path))
    np.testing.assert_array_equal(model.q_upper, [1.0, 2.0])
    np.testing.assert_array_equal(model.qdot_limit, [1.5, 2.0])


def test_floating_joint_in_the_chain_is_refused(tmp_path: Path) -> None:
    path = write_arm(RECIPES[0], tmp_path)
    urdf = tmp_path / f"{RECIPES[0].name}.urdf"
    urdf.write_text(urdf.read_text().replace('type="revolute"', 'type="floating"', 1))
    with pytest.raises(ConfigError, match="revolute, continuous, prismatic"):
        build_model(load(path))


def test_link_wins_where_a_joint_has_the_same_name(tmp_path: Path) -> None:
    """Pinocchio refuses to look such a frame up by its name alone."""
    path = write_arm(RECIPES[0], tmp_path)
    urdf = tmp_path / f"{RECIPES[0].name}.urdf"
    expected = build_model(load(path))
    urdf.write_text(urdf.read_text().replace('"tool_joint"', '"tool"').replace('"joint_0"', '"link_1"'))
    model = build_model(load(path))
    np.testing.assert_array_equal(model.tool_in_body, expected.tool_in_body)
    np.testing.assert_array_equal(model.modules[0].position, expected.modules[0].position)
    assert model.joint_names[0] == "link_1"
