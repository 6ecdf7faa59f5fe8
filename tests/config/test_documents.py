"""What is made from the schema: the JSON schema, the reference page, the explanation of a file."""

from pathlib import Path
from typing import Any

import jsonschema
import pytest

from proxgen.config import load
from proxgen.config.explain import explain
from proxgen.config.hashing import config_hash
from proxgen.config.json_schema import robot_schema, scene_schema
from proxgen.config.keys import keys_of
from proxgen.config.layers import PRESETS
from proxgen.config.loader import is_scene
from proxgen.config.ranges import RANGES
from proxgen.config.reference_page import configuration_page
from proxgen.config.scene import Scene
from proxgen.config.schema import Config
from proxgen.config.yaml_lines import read_yaml

ROOT = Path(__file__).parents[2]
FILES = sorted((ROOT / "examples").glob("*/*.yaml"))
SCENES = [path for path in FILES if is_scene(path)]
ROBOTS = [path for path in FILES if path not in SCENES]


def accepts(schema: dict[str, Any], content: Any) -> bool:
    """Whether a file's content is right by the schema."""
    return bool(jsonschema.Draft202012Validator(schema).is_valid(content))


def read(path: Path) -> Any:
    """A file's content."""
    root = read_yaml(path).root
    assert root is not None
    return root.plain()


def test_the_schemas_are_schemas() -> None:
    for schema in (robot_schema(), scene_schema()):
        jsonschema.Draft202012Validator.check_schema(schema)


@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
def test_the_schema_accepts_the_robots(path: Path) -> None:
    assert accepts(robot_schema(), read(path))


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_the_schema_accepts_the_scenes(path: Path) -> None:
    assert accepts(scene_schema(), read(path))


@pytest.mark.parametrize(
    "change",
    [
        {"colour": "red"},
        {"robot": {"name": "arm", "urdf": "arm.urdf"}},
        {"avoidance": {"d_a": -1}},
        {"avoidance": {"d_a": "3 s"}},
        {"avoidance": {"schedule": "papr"}},
        {"limits": {"viability": "on"}},
        {"capsules": []},
        {"task": {"axis": [1, 2]}},
    ],
)
def test_the_schema_refuses_mistakes(change: dict[str, Any]) -> None:
    content = read(Path(__file__).parent / "data" / "robot.yaml")
    assert accepts(robot_schema(), content)
    assert not accepts(robot_schema(), content | change)


def test_a_file_that_extends_others_may_leave_out_what_they_have() -> None:
    partial = {"robot": {"name": "other"}, "capsules": [{"name": "upper", "radius": "7 cm"}]}
    assert not accepts(robot_schema(), partial)
    assert accepts(robot_schema(), partial | {"extends": ["robot.yaml", "improved"]})
    assert not accepts(robot_schema(), partial | {"extends": "robot.yaml", "colour": "red"})
    for preset in PRESETS.glob("*.yaml"):
        assert accepts(robot_schema(), read(preset) | {"extends": []})


SETTABLE = {
    "limits.velocity.joint": "qdot_limit",
    "limits.acceleration": "qddot_limit",
    "limits.joint_damper": "joint_damper",
    "limits.tolerance": "limit_tolerance",
    "control.deadline": "max_period",
    "skin.timeout": "sensor_timeout",
    "avoidance.d_a": "d_a",
    "avoidance.d_0u": "d_0u",
    "avoidance.d_0l": "d_0l",
    "avoidance.d_r": "d_r",
    "avoidance.approach_speed": "approach_speed",
    "avoidance.repulse_speed": "repulse_speed",
    "avoidance.damper.influence_distance": "damper_influence",
    "avoidance.damper.safety_distance": "damper_safety",
    "avoidance.damper.gain": "damper_gain",
    "avoidance.damper.repulse_speed": "damper_repulse_speed",
    "avoidance.row_speed": "row_speed",
    "avoidance.active.distance": "d_active",
    "damping.gain": "damping_gain",
    "damping.threshold": "damping_threshold",
    "damping.floor": "damping_floor",
    "relaxation.slack.weight": "slack_weight",
    "relaxation.slack.minimum": "slack_minimum",
    "relaxation.slack.maximum": "slack_maximum",
    "relaxation.slack.active_weight": "slack_active_weight",
    "task.posture.weight": "posture_weight",
    "task.posture.gain": "posture_gain",
    "skin.self_measurement.margin": "self_measurement_margin",
    "skin.memory.age": "memory_age",
    "skin.memory.merge": "memory_merge",
    "skin.memory.margin": "memory_margin",
    "skin.memory.reach": "memory_reach",
    "avoidance.circulation.speed": "circulation_speed",
    "avoidance.circulation.stall_time": "stall_time",
    "avoidance.circulation.stall_fraction": "stall_fraction",
    "avoidance.circulation.release_time": "circulation_release_time",
    "avoidance.circulation.patience": "circulation_patience",
    "avoidance.circulation.time_limit": "circulation_time_limit",
    "avoidance.circulation.blend_time": "circulation_blend_time",
    "avoidance.circulation.bias.0": "circulation_bias_x",
    "avoidance.circulation.bias.1": "circulation_bias_y",
    "avoidance.circulation.bias.2": "circulation_bias_z",
    "avoidance.self_collision.d_a": "self_d_a",
    "avoidance.self_collision.d_0u": "self_d_0u",
    "avoidance.self_collision.d_0l": "self_d_0l",
    "avoidance.self_collision.d_r": "self_d_r",
    "avoidance.tangential.speed": "tangential_speed",
}


@pytest.mark.parametrize(("key", "parameter"), SETTABLE.items())
def test_what_the_file_accepts_the_controller_accepts(key: str, parameter: str) -> None:
    parts = [int(part) if part.isdigit() else part for part in key.split(".")]
    form = next(form for form in keys_of(Config).at(parts) if "x-quantity" in form)
    number = form["anyOf"][0] if "anyOf" in form else form
    least, greatest = RANGES[parameter]
    assert number["minimum"] >= least
    assert number["maximum"] <= greatest


@pytest.mark.parametrize("model", [Config, Scene])
def test_every_key_says_what_it_is_for(model: type[Config] | type[Scene]) -> None:
    keys = keys_of(model)
    for path, section in keys.sections():
        for name, schema in section["properties"].items():
            assert keys.resolved(schema).get("description"), f"{path}.{name} has no description"


def test_the_reference_page_is_up_to_date() -> None:
    page = (ROOT / "docs" / "configuration.md").read_text()
    assert page == configuration_page(), "renew it: proxgen schema --page > docs/configuration.md"


def test_the_reference_page_has_every_key() -> None:
    page = configuration_page()
    for model in (Config, Scene):
        for path, section in keys_of(model).sections():
            assert f"### `{path}`" in page or not path
            for name, schema in section["properties"].items():
                assert f"`{name}`" in page
                for form in keys_of(model).forms(schema):
                    assert form.get("x-range", "") in page


def test_the_variant_of_the_reference_page_loads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = configuration_page().split("```yaml\n")[1].split("```")[0]
    example = ROOT / "examples" / "iiwa7"
    for name in ("iiwa7.yaml", "iiwa7.urdf"):
        (tmp_path / name).write_bytes((example / name).read_bytes())
    (tmp_path / "variant.yaml").write_text(text)
    config = load(tmp_path / "variant.yaml")
    assert [cuff.rings[0].modules for cuff in config.skin.cuffs] == [6, 6, 16]
    assert config.relaxation.mode == "slack"


@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
def test_an_explained_file_is_the_same_configuration(path: Path, tmp_path: Path) -> None:
    config = load(path)
    (tmp_path / config.urdf_path.name).write_bytes(config.urdf_path.read_bytes())
    (tmp_path / "explained.yaml").write_text(explain(config))
    assert config_hash(load(tmp_path / "explained.yaml")) == config_hash(config)


def test_an_explained_file_says_where_its_values_come_from(folder: Path) -> None:
    Path("variant.yaml").write_text("extends: [robot.yaml, improved]\navoidance: {d_a: 0.35}\n")
    lines_of_variant = explain(load("variant.yaml")).splitlines()
    lines = [" ".join(line.split()) for line in lines_of_variant]
    assert "d_a: 0.35 m # variant.yaml:2" in lines
    assert "d_0u: 0.25 m # robot.yaml:28" in lines
    assert "mode: slack # preset improved:12" in lines
    assert "threshold: 0.001 # default" in lines
    assert "tilt: [0.0, 0.6108652381980153] # robot.yaml:23" in lines
    assert "cone: 2.6179938779914944 rad # default (150 deg)" in lines
    assert "lift: 0.1 # robot.yaml:5" in lines
    Path("explained.yaml").write_text("\n".join(lines_of_variant))
    assert load("explained.yaml").model_dump() == load("variant.yaml").model_dump()
