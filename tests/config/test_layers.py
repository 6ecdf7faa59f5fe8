from pathlib import Path

import pytest

from proxgen.config import load
from proxgen.config.hashing import config_hash
from proxgen.config.layers import PRESETS, preset_names
from proxgen.config.origin import Mark
from proxgen.config.scene import load_scene
from proxgen.config.schema import Config
from proxgen.errors import ConfigError


def variant(text: str, name: str = "variant.yaml") -> Config:
    """Write a file beside `robot.yaml` and load it."""
    Path(name).parent.mkdir(parents=True, exist_ok=True)
    Path(name).write_text(text)
    return load(name)


def test_a_variant_says_only_what_is_different(folder: Path) -> None:
    base, changed = load("robot.yaml"), variant("extends: robot.yaml\navoidance: {d_a: 0.35}\n")
    assert changed.avoidance.d_a == 0.35
    assert changed.model_dump(exclude={"avoidance"}) == base.model_dump(exclude={"avoidance"})
    assert changed.avoidance.d_0u == base.avoidance.d_0u
    assert changed.urdf_path == base.urdf_path


def test_every_value_knows_the_file_it_comes_from(folder: Path) -> None:
    marks = variant("extends: [robot.yaml, improved]\navoidance: {d_a: 0.35}\n").origin.marks
    assert marks["avoidance.d_a"] == Mark(Path("variant.yaml"), 2)
    assert marks["avoidance.d_0u"] == Mark(Path("robot.yaml"), 28)
    assert marks["relaxation.mode"].file == Path("preset improved")
    assert "damping.gain" not in marks


def test_what_comes_later_wins(folder: Path) -> None:
    Path("other.yaml").write_text("avoidance: {d_a: 0.4, schedule: damper}\n")
    assert variant("extends: [robot.yaml, other.yaml]\n").avoidance.d_a == 0.4
    assert variant("extends: [other.yaml, robot.yaml]\n").avoidance.d_a == 0.30
    both = variant("extends: [other.yaml, robot.yaml]\navoidance: {schedule: damper}\n")
    assert (both.avoidance.d_a, both.avoidance.schedule) == (0.30, "damper")


def test_extensions_of_extensions_and_paths_relative_to_each_file(folder: Path) -> None:
    config = variant("extends: ../robot.yaml\nlimits: {tolerance: 0.2}\n", "deep/variant.yaml")
    assert config.urdf_path == folder / "arm.urdf"
    deeper = variant("extends: ../variant.yaml\n", "deep/down/variant.yaml")
    assert deeper.limits.tolerance == 0.2
    assert deeper.urdf_path == folder / "arm.urdf"


def test_items_with_names_are_merged_by_name(folder: Path) -> None:
    config = variant(
        "extends: robot.yaml\n"
        "capsules:\n"
        "  - {name: lower, radius: 7 cm}\n"
        "  - {name: tip, frame: tip, start: [0, 0, 0], end: [0, 0, 0], radius: 2 cm}\n"
    )
    assert [(c.name, c.radius) for c in config.capsules] == [("upper", 0.05), ("lower", 0.07), ("tip", 0.02)]
    assert config.capsules[1].end == (0.0, 0.0, 0.3)
    assert config.line_of("capsules.1.radius") == 3
    assert config.origin.marks["capsules.1.end"] == Mark(Path("robot.yaml"), 17)


def test_other_lists_are_replaced_and_an_empty_one_empties(folder: Path) -> None:
    config = variant(
        "extends: robot.yaml\n"
        "skin:\n  cuffs:\n    - name: wrist\n      rings: [{offset: 0, radius: 0.1, modules: 2}]\n"
    )
    assert len(config.skin.cuffs[0].rings) == 1
    assert config.skin.cuffs[0].rings[0].tilt == 0.0
    assert variant("extends: robot.yaml\nskin: {cuffs: []}\n").skin.cuffs == ()


def test_null_takes_something_away(folder: Path) -> None:
    assert variant("extends: robot.yaml\ntask: {posture: null}\n").task.posture is None


def test_the_hash_is_that_of_the_resolved_values(folder: Path) -> None:
    assert config_hash(variant("extends: robot.yaml\n")) == config_hash(load("robot.yaml"))


def test_scenes_extend_scenes(folder: Path) -> None:
    Path("a.yaml").write_text(
        "name: a\nobstacles: [{name: ball, shape: sphere, radius: 0.1, position: [1, 0, 0]}]\n"
        "targets: [{position: [0, 0, 1]}]\n"
    )
    Path("b.yaml").write_text("extends: a.yaml\nname: b\nobstacles: [{name: ball, radius: 0.2}]\n")
    scene = load_scene("b.yaml")
    assert (scene.name, scene.obstacles[0].radius, len(scene.targets)) == ("b", 0.2, 1)


@pytest.mark.parametrize("name", preset_names())
def test_presets_are_valid_beside_a_robot(name: str, folder: Path) -> None:
    config = variant(f"extends: [robot.yaml, {name}]\nlimits: {{viability: false}}\n")
    assert {mark.file for mark in config.origin.marks.values()} == {
        Path("robot.yaml"),
        Path("variant.yaml"),
        Path(f"preset {name}"),
    }
    assert (PRESETS / f"{name}.yaml").is_file()


def test_the_preset_paper_is_the_method_as_published(folder: Path) -> None:
    config = variant("extends: [robot.yaml, paper]\nlimits: {viability: false}\n")
    avoidance = config.avoidance
    assert (avoidance.d_a, avoidance.d_0u, avoidance.d_0l, avoidance.d_r) == (0.30, 0.25, 0.22, 0.17)
    assert (avoidance.approach_speed, avoidance.repulse_speed, avoidance.schedule) == (0.2, -0.2, "paper")
    assert (config.damping.gain, config.damping.threshold) == (0.1, 0.001)
    assert (config.limits.acceleration, config.limits.joint_damper) == (None, None)
    assert config.relaxation.mode == "staged"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "extends: impoved\n",
            "variant.yaml:1: extends: unknown preset 'impoved'; did you mean 'improved'? "
            "(allowed: improved, paper); a file is named with its ending, .yaml",
        ),
        (
            "extends: [robot.yaml, robt.yaml]\n",
            "variant.yaml:1: extends.1: the file 'robt.yaml' does not exist; did you mean 'robot.yaml'?",
        ),
        (
            "extends: 5\n",
            "variant.yaml:1: extends: expected the name of a preset or of a file (presets: improved, paper)",
        ),
        (
            "extends: [robot.yaml, variant.yaml]\n",
            "variant.yaml:1: extends.1: the file 'variant.yaml' extends itself "
            "(variant.yaml -> variant.yaml)",
        ),
        # a mistake is reported in the file that makes it
        (
            "extends: [robot.yaml, broken.yaml]\n",
            "broken.yaml:2: avoidance.d_a: expected a finite length, found inf",
        ),
        ("extends: [robot.yaml, empty.yaml]\n", "empty.yaml: the file is empty"),
        # of values that contradict each other, the one that the file itself writes is named
        (
            "extends: robot.yaml\navoidance:\n  d_a: 0.2\n",
            "variant.yaml:3: avoidance.d_a: d_0u = 0.25 m must be less than d_a = 0.2 m "
            "(order: d_a > d_0u >= d_0l > d_r)",
        ),
        (
            "extends: [robot.yaml, circle.yaml]\n",
            "circle.yaml:1: extends: the file 'variant.yaml' extends itself "
            "(variant.yaml -> circle.yaml -> variant.yaml)",
        ),
    ],
)
def test_what_is_wrong_with_a_variant_is_said(folder: Path, text: str, message: str) -> None:
    Path("broken.yaml").write_text("avoidance:\n  d_a: .inf\n")
    Path("empty.yaml").write_text("")
    Path("circle.yaml").write_text("extends: variant.yaml\n")
    with pytest.raises(ConfigError) as caught:
        variant(text)
    assert message in str(caught.value).splitlines()


def test_a_base_that_two_files_share_is_reported_once(folder: Path) -> None:
    Path("broken.yaml").write_text("extends: robot.yaml\navoidance:\n  d_a: .inf\n  d_a: 1\n")
    for name in ("left.yaml", "right.yaml"):
        Path(name).write_text("extends: broken.yaml\n")
    with pytest.raises(ConfigError) as caught:
        variant("extends: [left.yaml, right.yaml]\n")
    assert len(caught.value.problems) == 2
