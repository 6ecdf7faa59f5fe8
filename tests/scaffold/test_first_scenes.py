"""The scene that `init` writes suits tasks of every kind: what it asks for can be reached."""

from pathlib import Path

import pytest
from package_arms import EXAMPLES, OTHERS

from proxgen.config import load
from proxgen.config.scene import load_scene
from proxgen.controllers.reference import ReferenceController
from proxgen.model import build_model
from proxgen.scaffold import scaffold
from proxgen.simulation.rollout import run

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("name", "kind"), [("panda", "pose"), ("xarm7", "pointing"), ("hand_finger", "position")]
)
def test_targets_are_reached_by_arms_of_every_size(name: str, kind: str, tmp_path: Path) -> None:
    """None of them reached any while targets had no orientation, and the damping was that of a long arm."""
    arm = next(arm for arm in EXAMPLES + OTHERS if arm.name == name)
    first = scaffold(arm.urdf, arm.tool, tmp_path / "arm.yaml")
    path = first.with_name("other.yaml")
    path.write_text(f"extends: arm.yaml\ntask: {{kind: {kind}}}\n")
    config = load(path)
    model = build_model(config)
    scene = load_scene(first.with_name("arm_scene.yaml"))
    assert all(target.orientation is not None for target in scene.targets)
    log = run(config, model, ReferenceController(config, model), scene, sensing="skin", duration=12.0, seed=0)
    assert log.summary()["targets_reached"] >= 3
