"""What both controllers take from the model, against pybullet's reading of the URDF and the YAML's words.

`proxgen compare` cannot see an error here: capsules, sensors, self points and tool are the same for both.
Every frame that carries something is turned and moved against its link.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pybullet
import pytest
from arms import RECIPES, ArmRecipe, write_arm
from numpy.typing import NDArray

from proxgen.config import load
from proxgen.config.schema import Config, Cuff, Ring
from proxgen.model import RobotModel, build_model
from proxgen.model.frames import axis_basis
from proxgen.model.kinematics import body_poses, tool_pose
from proxgen.model.posture import Posture

Array = NDArray[np.float64]

CUFFS = """\
    - name: hand
      frame: mount_{last}
      origin: [0.01, 0.02, -0.03]
      axis: [0.3, -0.5, 0.8]
      rings:
        - {{offset: 0.1, radius: 0.07, modules: 5, tilt: [0, 0.5, -0.3], stagger: 0.25}}
        - {{offset: -0.08, radius: 0.2, modules: 3, tilt: 0.2}}
    - name: foot
      frame: mount_0
      axis: [2, 0.1, 0]
      rings: [{{offset: 0.6, radius: 0.3, modules: 2}}]
      tof: {{range: 0.4}}
      capacitive: {{trigger: 0.12, virtual_distance: 0.11}}
"""

SELF_COLLISION = """\
self_collision: {{points: [{{name: fist, frame: mount_{last}, position: [0.3, -0.2, 0.1], radius: 0.04}}, \
{{name: knob, frame: mount_0, position: [0.3, -0.2, 0.1]}}], \
exclude: [{{capsule: link_1, point: knob}}], d_r: 0.0, d_0l: 0.001}}"""


def on_mounts(recipe: ArmRecipe, folder: Path) -> Config:
    """A made-up arm whose capsules, cuffs and self points sit on frames of their own."""
    path, rng, count = write_arm(recipe, folder), np.random.default_rng(recipe.seed), len(recipe.joints)
    mounts = "".join(_mount(index, rng) for index in range(count + 1))
    urdf = path.with_suffix(".urdf")
    urdf.write_text(urdf.read_text().replace("</robot>", f"{mounts}</robot>"))
    text = path.read_text().replace("tool: tool}", "tool: tool, tool_offset: [0.03, -0.05, 0.07]}")
    text = re.sub(r"link_(\d+), start: \[0, 0, 0\]", r"mount_\1, start: [0.01, -0.02, 0.0\1]", text)
    text = re.sub(r"    - \{name: hand.*\n", CUFFS.format(last=count), text)
    own = SELF_COLLISION.format(last=count)
    if "avoidance: {" in text:
        text = text.replace("avoidance: {", f"avoidance: {{{own}, ")
    else:
        text += f"avoidance: {{{own}}}\n"
    path.write_text(text)
    return load(path)


def _mount(index: int, rng: np.random.Generator) -> str:
    """A frame that is fixed to a link, moved and turned."""
    xyz, rpy = (" ".join(map(str, rng.uniform(-size, size, 3))) for size in (0.1, 2.5))
    return f"""  <joint name="fix_{index}" type="fixed">
    <parent link="link_{index}"/>
    <child link="mount_{index}"/>
    <origin xyz="{xyz}" rpy="{rpy}"/>
  </joint>
  <link name="mount_{index}"/>
"""


class Outside:
    """The whole robot as pybullet reads it."""

    def __init__(self, config: Config) -> None:
        self._client = pybullet.connect(pybullet.DIRECT)
        self._body = pybullet.loadURDF(str(config.urdf_path), useFixedBase=True, physicsClientId=self._client)
        count = pybullet.getNumJoints(self._body, physicsClientId=self._client)
        about = [pybullet.getJointInfo(self._body, i, physicsClientId=self._client) for i in range(count)]
        self._joints = {info[1].decode(): info[0] for info in about}
        self._links = {info[12].decode(): info[0] for info in about}

    def move(self, names: tuple[str, ...], q: Array) -> None:
        """Put joints where q says, and those that follow or are locked where the URDFs of `arms.py` say."""
        positions = dict(zip(names, q.tolist(), strict=True)) | {"finger_left": 0.01, "finger_right": 0.01}
        if "joint_2" not in names and "joint_2" in self._joints:
            positions["joint_2"] = -0.7 * positions["joint_1"] + 0.1
        for name, position in positions.items():
            if name in self._joints:
                pybullet.resetJointState(
                    self._body, self._joints[name], position, physicsClientId=self._client
                )

    def pose(self, link: str) -> Array:
        """Pose of a link's frame in the root link, 4x4."""
        if link == "link_0":
            return np.eye(4)
        state = pybullet.getLinkState(
            self._body, self._links[link], computeForwardKinematics=True, physicsClientId=self._client
        )
        pose = np.eye(4)
        pose[:3, :3] = np.reshape(pybullet.getMatrixFromQuaternion(state[5]), (3, 3))
        pose[:3, 3] = state[4]
        return pose

    def close(self) -> None:
        pybullet.disconnect(self._client)


Twins = tuple[Config, RobotModel, Outside]


@pytest.fixture(scope="module", params=RECIPES, ids=lambda recipe: recipe.name)
def twins(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Twins]:
    """An arm as proxgen and as pybullet know it."""
    config = on_mounts(request.param, tmp_path_factory.mktemp(request.param.name))
    outside = Outside(config)
    yield config, build_model(config), outside
    outside.close()


def postures(twins: Twins, count: int = 5) -> Iterator[list[Array]]:
    """Poses of the bodies at random positions, at which pybullet's arm is, too."""
    _, model, outside = twins
    rng = np.random.default_rng(31)
    for q in rng.uniform(-2.0, 2.0, (count, model.n)):
        outside.move(model.joint_names, q)
        yield body_poses(model, q)


def carried(pose: Array, point: object) -> Array:
    """A point of a frame in the world."""
    moved: Array = pose[:3, :3] @ np.asarray(point, dtype=float) + pose[:3, 3]
    return moved


def test_the_tool_is_where_pybullet_has_it(twins: Twins) -> None:
    _, model, outside = twins
    for q in np.random.default_rng(30).uniform(-2.0, 2.0, (5, model.n)):
        outside.move(model.joint_names, q)
        pose = outside.pose("tool")
        np.testing.assert_allclose(tool_pose(model, q)[:3, :3], pose[:3, :3], atol=1e-6)
        np.testing.assert_allclose(tool_pose(model, q)[:3, 3], carried(pose, [0.03, -0.05, 0.07]), atol=1e-6)


def test_capsules_and_self_points_lie_in_their_frames(twins: Twins) -> None:
    config, model, outside = twins
    for poses in postures(twins):
        for wanted, capsule in zip(config.capsules, model.capsules, strict=True):
            frame = outside.pose(wanted.frame)
            np.testing.assert_allclose(
                carried(poses[capsule.body], capsule.start), carried(frame, wanted.start), atol=1e-6
            )
            np.testing.assert_allclose(
                carried(poses[capsule.body], capsule.end), carried(frame, wanted.end), atol=1e-6
            )
        for point, place in zip(config.avoidance.self_collision.points, model.self_points, strict=True):
            expected = carried(outside.pose(point.frame), point.position)
            np.testing.assert_allclose(carried(poses[place.body], place.position), expected, atol=1e-6)


def test_gaps_of_self_points_are_those_of_the_surfaces(twins: Twins) -> None:
    """From the points' places by pybullet, along the axes of the capsules as pybullet has them."""
    config, model, outside = twins
    part = np.linspace(0.0, 1.0, 2001)[:, None]
    q = np.random.default_rng(33).uniform(-2.0, 2.0, model.n)
    outside.move(model.joint_names, q)
    gaps = Posture(model, q).own_gaps()
    for row, point in enumerate(config.avoidance.self_collision.points):
        place = carried(outside.pose(point.frame), point.position)
        for slot, capsule in enumerate(config.capsules):
            frame = outside.pose(capsule.frame)
            start, end = carried(frame, capsule.start), carried(frame, capsule.end)
            least = np.linalg.norm(start + part * (end - start) - place, axis=1).min()
            assert gaps[row, slot] == pytest.approx(least - capsule.radius - point.radius, abs=1e-5)


def test_pairs_of_self_collision(twins: Twins) -> None:
    """Not with the capsule of the own link, nor with what is excluded; the radii are as written."""
    _, model, _ = twins
    fist, knob = model.self_points
    count = len(model.capsules)
    assert fist.capsules == (*[True] * (count - 1), False)
    assert knob.capsules == (False, *[True] * (count - 1))
    assert [(p.name, p.radius) for p in model.self_points] == [("fist", 0.04), ("knob", 0.0)]


def test_distances_are_measured_to_what_is_asked_for(twins: Twins) -> None:
    config, model, _ = twins
    to_surface = config.avoidance.distance_reference == "surface"
    assert to_surface == (model.name == "near7")
    assert [c.radius for c in model.capsules] == [0.05] * len(model.capsules)
    assert [c.reference_radius for c in model.capsules] == [0.05 if to_surface else 0.0] * len(model.capsules)


def turned_about(axis: Array, angle: float, vector: Array) -> Array:
    """A vector turned about an axis by pybullet."""
    quaternion = pybullet.getQuaternionFromAxisAngle((axis / np.linalg.norm(axis)).tolist(), angle)
    matrix = np.reshape(pybullet.getMatrixFromQuaternion(quaternion), (3, 3))
    turned: Array = matrix @ vector
    return turned


def module_of(cuff: Cuff, ring: Ring, index: int) -> tuple[Array, Array]:
    """Place and direction of a module: turned about the axis, then tilted towards it."""
    axis = np.array(cuff.axis) / np.linalg.norm(cuff.axis)
    start = [1.0, 0.0, 0.0] if abs(axis[0]) < 0.9 else [0.0, 1.0, 0.0]
    first = np.cross(axis, np.cross(start, axis))  # what is normal to the axis of x, or of y
    angle = 2.0 * np.pi * (index + ring.stagger) / ring.modules
    radial = turned_about(axis, angle, first / np.linalg.norm(first))
    tilts = ring.tilt if isinstance(ring.tilt, tuple) else (ring.tilt,)
    normal = turned_about(np.cross(radial, axis), tilts[index % len(tilts)], radial)
    return np.array(cuff.origin) + ring.offset * axis + ring.radius * radial, normal


def test_modules_sit_and_look_as_their_cuffs_say(twins: Twins) -> None:
    config, model, outside = twins
    expected = [
        (f"{cuff.name}.{number}.{index}", cuff.frame, *module_of(cuff, ring, index))
        for cuff in config.skin.cuffs
        for number, ring in enumerate(cuff.rings)
        for index in range(ring.modules)
    ]
    assert [module.name for module in model.modules] == [name for name, *_ in expected]
    assert len(expected) == 10
    for poses in postures(twins, 2):
        for module, (_, frame, position, normal) in zip(model.modules, expected, strict=True):
            pose, there = outside.pose(frame), poses[module.body]
            np.testing.assert_allclose(carried(there, module.position), carried(pose, position), atol=1e-6)
            np.testing.assert_allclose(there[:3, :3] @ module.normal, pose[:3, :3] @ normal, atol=1e-6)


def test_a_cuff_may_have_sensors_of_its_own(twins: Twins) -> None:
    _, model, _ = twins
    found = [(m.tof.range, m.capacitive.virtual_distance) for m in model.modules if m.tof and m.capacitive]
    assert found == [(1.0, 0.08)] * 8 + [(0.4, 0.11)] * 2


@pytest.mark.parametrize(
    "axis", [(0.0, 0.0, 2.0), (0.0, 0.6, 0.8), (-0.3, 0.5, -0.8), (5.0, 0.0, 0.0), (-9.0, 1.0, 2.0)]
)
def test_basis_of_an_axis(axis: tuple[float, float, float]) -> None:
    """Right-handed, third column along the axis, the first what of x (y, if x is close) is normal to it."""
    basis, direction = axis_basis(np.array(axis)), np.array(axis) / np.linalg.norm(axis)
    np.testing.assert_allclose(basis.T @ basis, np.eye(3), atol=1e-15)
    assert np.linalg.det(basis) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(basis[:, 2], direction, atol=1e-15)
    seed = int(abs(direction[0]) >= 0.9)
    assert basis[seed, 0] > 0.0
    assert basis[seed, 1] == pytest.approx(0.0, abs=1e-15)  # x lies between the axis and the first column


def test_rounding_does_not_decide_where_a_basis_begins() -> None:
    """At 0.9, and a little below, the basis begins with y."""
    for x in (0.9 - 1e-15, 0.9, 0.9 + 1e-15):
        assert axis_basis(np.array([x, 0.0, np.sqrt(1.0 - x * x)]))[1, 0] == pytest.approx(1.0, abs=1e-15)
    assert axis_basis(np.array([0.899, 0.0, np.sqrt(1.0 - 0.899**2)]))[1, 0] == 0.0


def test_a_pointing_task_counts_its_rotations_about_the_basis_of_its_axis(twins: Twins) -> None:
    config, model, _ = twins
    if config.task.kind == "pointing":
        assert model.task_frame is not None
        np.testing.assert_array_equal(model.task_frame, axis_basis(np.array([0.0, 0.6, 0.8])))
    else:
        assert model.task_frame is None
