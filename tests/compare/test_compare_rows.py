"""Self-collision and the methods of the paper's comparison, compiled, against the reference."""

from pathlib import Path

import numpy as np
import pytest

import proxgen
from proxgen.compare import compare_controllers_on, random_states
from proxgen.compare.states import own_gaps
from proxgen.config import load
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Status
from proxgen.controllers.reference import ReferenceController
from proxgen.model import RobotModel, build_model
from proxgen.model.posture import Posture

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"

TOOL_AND_BASE = """
    points: [{name: tip, frame: %s, radius: 50 mm}, {name: base, frame: %s, radius: 80 mm}]
    exclude: [%s]
"""

POINTS = {
    "iiwa7": """
    points: [{name: tool, frame: tcp, radius: 90 mm}, {name: wrist, frame: link_6, radius: 70 mm}]
    exclude: [{capsule: forearm, point: wrist}, {capsule: hand, point: wrist}]
""",
    "planar2": """
    points: [{name: tip, frame: tool, radius: 30 mm}, {name: post, frame: base, position: [0.3, 0.2, 0.1]}]
""",
    "lift4": """
    points: [{name: tip, frame: tool, radius: 50 mm}, {name: elbow, frame: forearm, radius: 60 mm}]
    exclude: [{capsule: upper_arm, point: elbow}]
""",
    "gen3": TOOL_AND_BASE % (
        "end_effector_link", "base_link", "{capsule: spherical_wrist_2_link, point: tip}"
    ),
    "ur10": TOOL_AND_BASE % (
        "tool0",
        "base_link",
        "{capsule: wrist_1_link, point: tip}, {capsule: wrist_2_link, point: tip}, "
        "{capsule: shoulder_link, point: base}, {capsule: upper_arm_link, point: base}",
    ),
    "panda": TOOL_AND_BASE % ("panda_hand_tcp", "panda_link0", "{capsule: panda_link1, point: base}"),
}  # fmt: skip
"""What each arm's own links must not touch, neighbours left out."""


def arm(
    folder: Path, robot: str, *, mode: str = "staged", schedule: str = "paper", reference: str = "axis"
) -> tuple[Config, RobotModel]:
    """An example's arm with self-collision."""
    path = folder / f"{robot}.yaml"
    path.write_text(
        f"extends: {EXAMPLES / robot / robot}.yaml\n"
        f"relaxation: {{mode: {mode}}}\n"
        f"avoidance:\n  schedule: {schedule}\n  distance_reference: {reference}\n"
        f"  self_collision:\n    d_a: 0.15\n{POINTS[robot]}"
    )
    config = load(path)
    return config, build_model(config)


def check(config: Config, model: RobotModel, folder: Path, backend: str, count: int) -> set[Status]:
    """Build, compare on random states, and return the statuses that came up."""
    compiled = proxgen.build(config, folder / "built", backend=backend)
    states = random_states(config, model, count, seed=52)
    result = compare_controllers_on(config, states, compiled, ReferenceController(config, model))
    assert result.verdict == "pass", "\n".join(result.failures)
    return {Status(number) for number in result.scenes[0].status.tolist()}


@pytest.mark.parametrize("backend", ["qpoases", "daqp"])
def test_self_collision_of_the_iiwa(tmp_path: Path, backend: str) -> None:
    """All stages come up, and the fault of a point on an axis."""
    seen = check(*arm(tmp_path, "iiwa7"), tmp_path, backend, 500)
    assert seen >= {Status.SOLVED, Status.REDUCED_REPULSION, Status.REDUCED_CRITICAL}
    assert Status.STOPPED_INFEASIBLE in seen


@pytest.mark.slow
@pytest.mark.parametrize(
    ("robot", "mode", "schedule", "reference", "backend"),
    [
        ("iiwa7", "staged", "damper", "surface", "qpoases"),
        ("iiwa7", "slack", "damper", "axis", "daqp"),
        ("planar2", "staged", "paper", "surface", "daqp"),
        ("lift4", "slack", "paper", "surface", "qpoases"),
        ("gen3", "slack", "paper", "axis", "daqp"),
        ("gen3", "staged", "paper", "axis", "daqp"),
        ("gen3", "staged", "damper", "surface", "qpoases"),
        ("ur10", "slack", "damper", "surface", "qpoases"),
        ("panda", "staged", "paper", "axis", "daqp"),
    ],
)
def test_self_collision_of_any_arm(
    tmp_path: Path, robot: str, mode: str, schedule: str, reference: str, backend: str
) -> None:
    made = arm(tmp_path, robot, mode=mode, schedule=schedule, reference=reference)
    check(*made, tmp_path, backend, 300)


@pytest.mark.parametrize(
    ("method", "schedule", "backend"),
    [
        ("repulsive", "paper", "qpoases"),
        ("repulsive", "damper", "daqp"),
        ("tangential", "paper", "daqp"),
        ("tangential", "damper", "qpoases"),
    ],
)
def test_methods_of_the_comparison(tmp_path: Path, method: str, schedule: str, backend: str) -> None:
    path = tmp_path / "baseline.yaml"
    path.write_text(
        f"extends: {EXAMPLES}/iiwa7/iiwa7.yaml\navoidance: {{method: {method}, schedule: {schedule}}}\n"
    )
    config = load(path)
    seen = check(config, build_model(config), tmp_path, backend, 400)
    assert seen >= {Status.SOLVED, Status.REDUCED_ACTIVE, Status.REDUCED_REPULSION}


def test_random_states_fold_an_arm_with_points(tmp_path: Path) -> None:
    """All parts of the law of self-collision come up."""
    config, model = arm(tmp_path, "iiwa7")
    states = random_states(config, model, 200, seed=53, faults=0.0)
    gaps = np.array([own_gaps(Posture(model, state.q)) for state in states])
    tool_and_upper_arm = gaps[:, 0, 0]
    for low, high in ((0.0, 0.03), (0.03, 0.05), (0.05, 0.07), (0.07, 0.15)):
        assert np.any((low < tool_and_upper_arm) & (tool_and_upper_arm < high))
    assert np.isinf(gaps[:, 1, 1]).all()  # excluded
