"""From URDF to a compared controller with no code of their own: the examples, and arms nobody had in mind."""

from pathlib import Path

import numpy as np
import pytest
from capsule_search import excess, long_search
from kernel_checks import check_against_pinocchio
from package_arms import EXAMPLES, OTHERS, PackageArm

import proxgen
from proxgen.compare import compare
from proxgen.compare.open_loop import compare_controllers_on
from proxgen.compare.states import random_states
from proxgen.config import load
from proxgen.config.urdf import resolve_urdf
from proxgen.controllers.reference import ReferenceController
from proxgen.model import build_model
from proxgen.scaffold import scaffold
from proxgen.scaffold.chain import read_arm
from proxgen.scaffold.fit import FittedCapsule

ROOT = Path(__file__).parents[2]
MEASURES = ("qdot", "H", "A")

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module", params=EXAMPLES + OTHERS, ids=lambda arm: arm.name)
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[PackageArm, Path]:
    """An arm, and the untouched file that `init` wrote for it."""
    arm, folder = request.param, tmp_path_factory.mktemp(request.param.name)
    urdf = arm.urdf if "://" in arm.urdf else str(ROOT / arm.urdf)
    return arm, scaffold(urdf, arm.tool, folder / f"{arm.name}.yaml")


def test_kinematics_equal_pinocchio(made: tuple[PackageArm, Path]) -> None:
    config = load(made[1])
    check_against_pinocchio(config, build_model(config), 50)


def test_compiled_and_reference_agree(made: tuple[PackageArm, Path], tmp_path: Path) -> None:
    """In the closed loop of the scene that `init` wrote, and at random states among crowds of obstacles."""
    path = made[1]
    config = load(path)
    assert config.skin.cuffs
    model = build_model(config)
    compiled = proxgen.build(config, tmp_path / "build")
    scene = path.with_name(f"{path.stem}_scene.yaml")
    closed = compare(config, [scene], duration=10.0, candidate=compiled)
    assert closed.verdict == "pass", closed.failures
    states = random_states(config, model, 200, seed=4)
    opened = compare_controllers_on(config, states, compiled, ReferenceController(config, model))
    assert opened.verdict == "pass", opened.failures


def test_capsules_contain_all_and_no_long_search_finds_less(made: tuple[PackageArm, Path]) -> None:
    arm, path = made
    config = load(path)
    urdf = resolve_urdf(arm.urdf, ROOT)
    clouds = {body.link: body.cloud for body in read_arm(urdf, arm.tool).bodies}
    assert {capsule.frame for capsule in config.capsules} == {k for k, v in clouds.items() if v is not None}
    for capsule in config.capsules:
        fitted = FittedCapsule(np.array(capsule.start), np.array(capsule.end), capsule.radius)
        cloud = clouds[capsule.frame]
        assert cloud is not None
        points = cloud.points if not cloud.radii.any() else inflated(cloud.points, cloud.radii)
        assert excess(points, fitted) < 1e-6
        # The 10 % are for rounding outwards to a tenth of a millimetre, which counts on a finger.
        assert fitted.volume < 1.1 * long_search(points, 5, population=40, rounds=250)


def inflated(points: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Points on the surfaces of balls; the points themselves where the radius is zero."""
    directions = np.random.default_rng(7).normal(size=(400, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    balls = points[radii > 0.0][:, None] + radii[radii > 0.0][:, None, None] * directions
    return np.vstack([points[radii == 0.0], balls.reshape(-1, 3)])


@pytest.mark.parametrize("name", [arm.name for arm in EXAMPLES])
def test_the_examples_pass_as_they_are(name: str, tmp_path: Path) -> None:
    config = load(ROOT / "examples" / name / f"{name}.yaml")
    scene = ROOT / "examples" / name / f"{name}_scene.yaml"
    if not scene.is_file():
        scene = ROOT / "examples" / "scenes" / {"iiwa7": "gap.yaml", "planar2": "post.yaml"}[name]
    compiled = proxgen.build(config, tmp_path / "build")
    comparison = compare(config, [scene], duration=20.0, candidate=compiled)
    assert comparison.verdict == "pass", comparison.failures
    (numbers,) = comparison.to_json()["scenes"]
    assert numbers["max_abs_qdot_error"] <= 1e-8
    assert max(numbers["max_abs_H_error"], numbers["max_abs_A_error"]) <= 1e-10
    assert numbers["status_mismatches"] == 0
