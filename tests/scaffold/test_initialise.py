"""`init`: for arms of every kind, the files are accepted as they are and describe the arm."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from arms import RECIPES, ArmRecipe
from solid_arms import write_solid_urdf

from proxgen.config import load
from proxgen.config.scene import load_scene
from proxgen.errors import ConfigError, ModelError, ProxgenWarning
from proxgen.model import RobotModel, build_model
from proxgen.model.posture import Posture
from proxgen.scaffold import scaffold
from proxgen.scaffold.shapes import collision_clouds


@pytest.fixture(scope="module", params=RECIPES, ids=lambda recipe: recipe.name)
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[ArmRecipe, Path]:
    """The recipe of an arm, and the file that `init` wrote for it."""
    folder = tmp_path_factory.mktemp(request.param.name)
    urdf = write_solid_urdf(request.param, folder)
    return request.param, scaffold(str(urdf), "tool", folder / "config" / "arm.yaml")


def model_of(path: Path) -> RobotModel:
    """Model of a file."""
    return build_model(load(path))


def test_the_file_is_accepted_and_has_the_chain(made: tuple[ArmRecipe, Path]) -> None:
    recipe, path = made
    config = load(path)
    model = build_model(config)
    assert config.robot.urdf == f"../{recipe.name}.urdf"
    assert model.n == sum(kind != "mimic" for kind in recipe.joints)
    assert [capsule.name for capsule in model.capsules] == [
        f"link_{k + 1}" for k in range(len(recipe.joints))
    ]
    assert 1 <= len(config.skin.cuffs) <= 3
    assert model.m == min(3, model.n)
    assert not list(path.parent.glob(".*"))


def test_capsules_just_contain_the_geometry(made: tuple[ArmRecipe, Path]) -> None:
    config = load(made[1])
    clouds = collision_clouds(config.urdf_path, [capsule.frame for capsule in config.capsules])
    for capsule in config.capsules:
        start, end = np.array(capsule.start), np.array(capsule.end)
        cloud = clouds[capsule.frame]
        fraction = (cloud.points - start) @ (end - start) / max(float((end - start) @ (end - start)), 1e-30)
        nearest = start + np.clip(fraction, 0.0, 1.0)[:, None] * (end - start)
        reach = np.linalg.norm(cloud.points - nearest, axis=1) + cloud.radii
        assert capsule.radius - 2.1e-4 <= reach.max() <= capsule.radius


def test_modules_lie_outside_the_capsules_of_their_links(made: tuple[ArmRecipe, Path]) -> None:
    model = model_of(made[1])
    posture = Posture(model, np.zeros(model.n))
    assert model.modules
    for module in model.modules:
        pose = posture.poses[module.body]
        gaps = posture.gaps((pose[:3, :3] @ module.position + pose[:3, 3])[None])[0]
        own = [gap for gap, capsule in zip(gaps, model.capsules, strict=True) if capsule.body == module.body]
        assert min(own) > 0.005


def test_the_scene_fits_the_arm(made: tuple[ArmRecipe, Path]) -> None:
    """Start within the limits, targets in reach, obstacles outside the arm and near enough to matter."""
    path = made[1]
    config, scene = load(path), load_scene("arm_scene", beside=path)
    model = build_model(config)
    q = np.array(
        scene.start_positions(model.joint_names, model.q_lower.tolist(), model.q_upper.tolist()), dtype=float
    )
    posture = Posture(model, q)
    assert len(scene.targets) == 2
    for obstacle in scene.obstacles:
        gap = posture.gaps(np.array([obstacle.position])).min() - (obstacle.radius or 0.0)
        assert gap > config.avoidance.d_0u
        assert gap < 4.0 * config.avoidance.d_a
    visitor = scene.obstacles[1]
    assert visitor.motion is not None
    near = np.array(visitor.position) + visitor.motion.distance * np.array(visitor.motion.direction)
    assert 0.0 < posture.gaps(near[None]).min() - (visitor.radius or 0.0) < config.avoidance.d_0u


def test_the_same_urdf_gives_the_same_files(made: tuple[ArmRecipe, Path], tmp_path: Path) -> None:
    recipe, path = made
    shutil.copytree(path.parent.parent, tmp_path / "copy")
    again = scaffold(str(tmp_path / "copy" / f"{recipe.name}.urdf"), "tool", tmp_path / "copy/config/b.yaml")
    assert again.read_text() == path.read_text()


def arm(tmp_path: Path, name: str = "chain2") -> Path:
    """URDF of a small arm."""
    return write_solid_urdf(next(recipe for recipe in RECIPES if recipe.name == name), tmp_path)


def test_existing_files_are_kept_unless_told_otherwise(tmp_path: Path) -> None:
    urdf, path = str(arm(tmp_path)), tmp_path / "arm.yaml"
    path.write_text("mine")
    with pytest.raises(ConfigError, match=r"arm\.yaml: the file exists already; --force"):
        scaffold(urdf, "tool", path)
    assert path.read_text() == "mine"
    assert not (tmp_path / "arm_scene.yaml").exists()
    path.unlink()
    (tmp_path / "arm_scene.yaml").write_text("mine too")
    with pytest.raises(ConfigError, match=r"arm_scene\.yaml: the file exists already"):
        scaffold(urdf, "tool", path)
    assert not path.exists()
    scaffold(urdf, "tool", path, force=True)
    assert "mine" not in path.read_text() + (tmp_path / "arm_scene.yaml").read_text()


@pytest.mark.parametrize(
    ("change", "tool", "message"),
    [
        ("|", "tol", "unknown frame 'tol'; did you mean 'tool'?"),
        (
            "|",
            "joint_0",
            "no joint moves the position of the tool frame 'joint_0'; choose a frame further out",
        ),
        ("|", "link_0", "no joint between the base and the tool frame 'link_0' can be controlled"),
        ("wedge.obj|missing.obj", "tool", "the mesh 'missing.obj' does not exist (looked for "),
        ("</robot>|", "tool", "is not well-formed XML"),
        ('<sphere radius="0.07"|<sphere', "tool", "<sphere radius=...> must be a number"),
        ('<axis xyz="|<axis xyz="0 0 0"/><axis xyz="', "tool", 'has the axis "0 0 0", which is no direction'),
    ],
)
def test_mistakes_leave_nothing_behind(tmp_path: Path, change: str, tool: str, message: str) -> None:
    urdf = arm(tmp_path, "long12")
    old, new = change.split("|")
    assert old in urdf.read_text()
    urdf.write_text(urdf.read_text().replace(old, new))
    with pytest.raises(ModelError, match=re.escape(message)) as caught:
        scaffold(str(urdf), tool, tmp_path / "out" / "arm.yaml")
    assert str(urdf) in str(caught.value) or urdf.name in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_millimetres_are_told_from_metres(tmp_path: Path) -> None:
    urdf = arm(tmp_path, "long12")
    urdf.write_text(urdf.read_text().replace(' scale="0.001 0.001 0.001"', ""))
    with pytest.raises(
        ModelError, match=r"radius of the capsule around link 'link_\d+': \d+\.\d+ m is out of ran"
    ):
        scaffold(str(urdf), "tool", tmp_path / "out" / "arm.yaml")
    assert not (tmp_path / "out").exists()


def test_a_missing_urdf_says_where_it_was_looked_for(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"'nowhere\.urdf' does not exist"):
        scaffold("nowhere.urdf", "tool", tmp_path / "arm.yaml")
    with pytest.raises(ModelError, match="Python package 'no_such_package'"):
        scaffold("package://no_such_package/arm.urdf", "tool", tmp_path / "arm.yaml")


def test_missing_limits_are_asked_for_and_never_invented(tmp_path: Path) -> None:
    urdf = arm(tmp_path)
    text = re.sub(r'lower="[^"]*" upper="[^"]*"', "", urdf.read_text(), count=1)
    text = re.sub(r'velocity="[^"]*"', 'velocity="0"', text)
    urdf.write_text(text)
    blanks = "limits.position.joint_0, limits.velocity.joint_0, limits.velocity.joint_1"
    with pytest.warns(ProxgenWarning, match=f"fill in .* at FILL IN: {re.escape(blanks)}"):
        path = scaffold(str(urdf), "tool", tmp_path / "arm.yaml")
    written = path.read_text()
    assert "    joint_0: # FILL IN: [lower, upper] in rad\n" in written
    assert "    joint_1: # FILL IN: in rad/s\n" in written
    with pytest.raises(ConfigError) as caught:
        load(path)
    lines = written.splitlines()
    assert {p.key for p in caught.value.problems} >= {"limits.velocity.joint_0", "limits.velocity.joint_1"}
    assert all("FILL IN" in lines[problem.line - 1] for problem in caught.value.problems)
    filled = written.replace("joint_0: # FILL IN: [lower, upper] in rad", "joint_0: [-2, 2]")
    path.write_text(re.sub(r"# FILL IN: in rad/s", "1.5", filled))
    model = model_of(path)
    assert (model.q_lower[0], model.q_upper[0], *model.qdot_limit) == (-2.0, 2.0, 1.5, 1.5)


def test_an_arm_without_geometry_gets_lines_without_radii(tmp_path: Path) -> None:
    urdf = arm(tmp_path)
    urdf.write_text(re.sub(r"<collision>.*?</collision>", "", urdf.read_text(), flags=re.DOTALL))
    with pytest.warns(ProxgenWarning, match=r"capsules\.0\.radius, capsules\.1\.radius"):
        path = scaffold(str(urdf), "tool", tmp_path / "arm.yaml")
    with pytest.raises(ConfigError, match=r"capsules\.0\.radius"):
        load(path)
    path.write_text(path.read_text().replace("radius: # FILL IN: in m", "radius: 0.05"))
    capsules = model_of(path).capsules
    assert all(np.linalg.norm(capsule.end - capsule.start) > 0.1 for capsule in capsules)


def test_links_without_geometry_are_named(tmp_path: Path) -> None:
    urdf = arm(tmp_path)
    text = urdf.read_text()
    start, end = text.index('<link name="link_1">'), text.index("</link>") + len("</link>")
    urdf.write_text(text[:start] + '<link name="link_1"/>' + text[end:])
    path = scaffold(str(urdf), "tool", tmp_path / "arm.yaml")
    written = path.read_text()
    assert "# No capsule, as the URDF gives them no collision geometry: link_1\n" in written
    assert "    # without geometry: tool\n" in written
    assert [capsule.name for capsule in load(path).capsules] == ["link_2"]


def test_grippers_and_mimics_are_named(tmp_path: Path) -> None:
    written = scaffold(str(arm(tmp_path, "endless4")), "tool", tmp_path / "a.yaml").read_text()
    assert "moves them): finger_left (0.01), finger_right (0.01)\n" in " ".join(written.split("\n  #   "))
    assert "#   joint_0  turns without end, " in written
    written = scaffold(str(arm(tmp_path, "mimic5")), "tool", tmp_path / "b.yaml").read_text()
    assert "# Moved along with others: joint_2 (follows joint_1)\n" in written


def test_a_planar_joint_on_the_way_is_locked(tmp_path: Path) -> None:
    urdf = arm(tmp_path, "skew6")
    text = urdf.read_text()
    ends = '<parent link="floor"/><child link="link_0"/>'
    base = f'<link name="floor"/><joint name="drive" type="planar">{ends}<axis xyz="0 0 1"/></joint>'
    urdf.write_text(text.replace('<link name="link_0"/>', f'<link name="link_0"/>{base}'))
    path = scaffold(str(urdf), "tool", tmp_path / "arm.yaml")
    assert "but not to be controlled: planar.\n  locked_joints:\n    drive: 0\n" in path.read_text()
    assert model_of(path).n == 6


def test_names_that_yaml_would_misread(tmp_path: Path) -> None:
    urdf = arm(tmp_path)
    text = urdf.read_text().replace("link_1", "1: {x}").replace("link_2", "yes").replace("joint_0", "0.5")
    urdf.write_text(text.replace('robot name="chain2"', 'robot name="PG"').replace("joint_1", "a # b"))
    path = scaffold(str(urdf), "tool", tmp_path / "arm.yaml")
    config, scene = load(path), load_scene("arm_scene", beside=path)
    assert config.robot.name == "pg_robot"
    assert [capsule.frame for capsule in config.capsules] == ["1: {x}", "yes"]
    assert [capsule.name for capsule in config.capsules] == ["part_1_x", "yes"]
    assert isinstance(scene.start, dict)
    assert set(scene.start) == {"0.5", "a # b"}
    assert build_model(config).n == 2


def test_the_default_name_is_the_robots(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    arm(tmp_path)
    monkeypatch.chdir(tmp_path)
    assert scaffold("chain2.urdf", "tool") == Path("chain2.yaml")
    assert "  urdf: chain2.urdf\n" in Path("chain2.yaml").read_text()
    assert Path("chain2_scene.yaml").is_file()
