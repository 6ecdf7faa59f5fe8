import math
from pathlib import Path

import pytest
from pydantic import ValidationError

from proxgen.config import Config, load
from proxgen.config.loader import is_scene
from proxgen.config.scene import Scene, load_scene
from proxgen.config.schema import Avoidance
from proxgen.errors import Problem

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_values_are_in_si_units(folder: Path) -> None:
    config = load("robot.yaml")
    assert config.limits.position["shoulder"] == pytest.approx((-math.pi / 2, math.pi / 2))
    assert config.robot.locked_joints == {"lift": 0.1}
    assert config.capsules[0].radius == 0.05
    assert config.limits.acceleration == {"shoulder": 10.0, "elbow": 20.0}
    assert config.skin.cuffs[0].rings[0].tilt == pytest.approx((0.0, math.radians(35.0)))


def test_defaults_are_the_papers(folder: Path) -> None:
    avoidance = load("robot.yaml").avoidance
    assert (avoidance.d_a, avoidance.d_0u, avoidance.d_0l, avoidance.d_r) == (0.30, 0.25, 0.22, 0.17)
    assert (avoidance.approach_speed, avoidance.repulse_speed) == (0.2, -0.2)


def test_the_place_of_every_value_is_known(folder: Path) -> None:
    config = load("robot.yaml")
    text = Path("robot.yaml").read_text().splitlines()
    assert "d_a" in text[config.line_of("avoidance.d_a") - 1]
    assert "name: lower" in text[config.line_of("capsules.1.frame") - 1]
    assert config.line_of("avoidance.damper.gain") == config.line_of("avoidance")  # a default
    assert config.line_of("damping.gain") == 0  # not even the section is written
    assert config.source == Path("robot.yaml")
    assert config.urdf_path == folder / "arm.urdf"
    line = config.line_of("robot.tool")
    assert config.problem("robot.tool", "is odd") == Problem(Path("robot.yaml"), line, "robot.tool", "is odd")


def test_a_changed_copy_remembers_its_origin(folder: Path) -> None:
    config = load("robot.yaml")
    changed = config.model_copy(update={"avoidance": Avoidance(d_a=0.4)})
    assert changed.urdf_path == config.urdf_path
    assert changed.line_of("robot.name") == config.line_of("robot.name")


def test_a_configuration_cannot_be_changed(folder: Path) -> None:
    config = load("robot.yaml")
    with pytest.raises(ValidationError):
        config.robot = config.robot  # type: ignore[misc]


def test_the_urdf_is_found_from_any_folder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "elsewhere").mkdir()
    monkeypatch.chdir(folder / "elsewhere")
    assert load("../robot.yaml").urdf_path == folder / "arm.urdf"
    assert load(folder / "robot.yaml").urdf_path == folder / "arm.urdf"


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*/*.yaml")), ids=lambda path: path.stem)
def test_every_example_loads(path: Path) -> None:
    if is_scene(path):
        assert isinstance(load_scene(path), Scene)
    else:
        assert isinstance(load(path), Config)


def test_the_iiwa_is_the_papers() -> None:
    config = load(EXAMPLES / "iiwa7" / "iiwa7.yaml")
    assert [sum(ring.modules for ring in cuff.rings) for cuff in config.skin.cuffs] == [12, 12, 8]
    assert config.capsules[2].end == (0.0, 0.0, 0.206)
    assert config.skin.capacitive is not None
    assert config.skin.capacitive.cone == pytest.approx(2 * math.radians(75.0))
    assert config.relaxation.mode == "staged"
    # what the file says about avoidance is what the paper says, and so are the defaults
    assert config.avoidance == Avoidance()
