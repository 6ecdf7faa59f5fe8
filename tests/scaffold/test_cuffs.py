"""Cuffs that `init` proposes for an arm whose shoulder lies in its torso, as a humanoid's does."""

import numpy as np
import pytest

from proxgen.config import load
from proxgen.config.scene import load_scene
from proxgen.config.schema import Config
from proxgen.model import build_model
from proxgen.model.posture import Posture
from proxgen.scaffold import scaffold
from proxgen.scaffold.postures import Folding

PARTS = (
    # link, radius and length of its cylinder; type, origin and axis of the joint that moves it
    ("torso", 0.3, 0.5, "prismatic", "0 0 0.5", "0 0 1"),
    ("shoulder", 0.09, 0.1, "revolute", "0.15 0.15 0.4", "0 0 1"),
    ("upper", 0.06, 0.3, "revolute", "0.1 0 0", "0 1 0"),
    ("elbow", 0.05, 0.05, "revolute", "0.3 0 0", "1 0 0"),
    ("forearm", 0.05, 0.3, "revolute", "0 0 0", "0 1 0"),
    ("hand", 0.04, 0.1, "revolute", "0.3 0 0", "1 0 0"),
)


@pytest.fixture(scope="module")
def proposed(tmp_path_factory: pytest.TempPathFactory) -> Config:
    """What `init` writes for it."""
    folder = tmp_path_factory.mktemp("humanoid")
    parts, parent = ['<robot name="humanoid"><link name="base"/>'], "base"
    for name, radius, length, kind, origin, axis in PARTS:
        half = 0.5 * length
        place = f'xyz="0 0 {half}"' if name == "torso" else f'xyz="{half} 0 0" rpy="0 {0.5 * np.pi} 0"'
        shape = f'<origin {place}/><geometry><cylinder radius="{radius}" length="{length}"/></geometry>'
        limits = 'lower="0" upper="0.3"' if kind == "prismatic" else 'lower="-2" upper="2"'
        parts += [
            f'<link name="{name}"><collision>{shape}</collision></link>',
            f'<joint name="{name}_joint" type="{kind}"><parent link="{parent}"/><child link="{name}"/>',
            f'<origin xyz="{origin}"/><axis xyz="{axis}"/><limit {limits} velocity="1" effort="1"/></joint>',
        ]
        parent = name
    (folder / "humanoid.urdf").write_text("".join([*parts, "</robot>"]))
    return load(scaffold(str(folder / "humanoid.urdf"), "hand", folder / "humanoid.yaml"))


def test_a_torso_that_holds_the_shoulder_takes_no_cuffs_from_the_arm(proposed: Config) -> None:
    """It was never clear of the upper arm, so that every posture counted as folded, and no place as free."""
    model = build_model(proposed)
    names = [capsule.name for capsule in model.capsules]
    torso, upper, forearm = (names.index(name) for name in ("torso", "upper", "forearm"))
    pairs = Folding.of(model).pairs
    assert pairs[torso, forearm]
    assert not pairs[torso, upper]
    assert {cuff.frame for cuff in proposed.skin.cuffs} >= {"forearm", "hand"}


def test_it_starts_with_the_arm_outside_the_torso(proposed: Config) -> None:
    model = build_model(proposed)
    scene = load_scene("humanoid_scene", beside=proposed.source)
    q = scene.start_positions(model.joint_names, model.q_lower.tolist(), model.q_upper.tolist())
    posture = Posture(model, np.array(q))
    assert Folding.of(model).clearance(posture) > 0.0
    modules = [
        posture.poses[module.body][:3, :3] @ module.position + posture.poses[module.body][:3, 3]
        for module in model.modules
    ]
    gaps = posture.gaps(np.array(modules))
    assert gaps.min() > 0.0
