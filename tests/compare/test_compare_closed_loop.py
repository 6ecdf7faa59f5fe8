"""`compare` in the closed loop of the scenes, with equal controllers and with a wrong sign on either side."""

import numpy as np
import pytest
from distorted import Distorted, FollowingDistorted, WrongSign, negated, with_qdot

from proxgen.compare import compare
from proxgen.config.scene import load_scene
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Status
from proxgen.controllers.reference import ReferenceController
from proxgen.errors import CompareError, ConfigError
from proxgen.model import RobotModel


@pytest.mark.parametrize("sensing", ["skin", "ideal"])
def test_equal_controllers_agree_in_a_scene(
    iiwa7_config: Config, iiwa7_model: RobotModel, sensing: str
) -> None:
    """Two scenes, by name and loaded, with progress over both and the logs of both."""
    done: list[tuple[int, int]] = []
    result = compare(
        iiwa7_config,
        ["gap", load_scene("moving", iiwa7_config.source)],
        sensing=sensing,
        duration=1.0,
        progress=lambda *cycles: done.append(cycles),
        candidate=ReferenceController(iiwa7_config, iiwa7_model),
    )
    assert result.verdict == "pass"
    assert [scene.scene for scene in result.scenes] == ["gap", "moving"]
    assert done == [(cycle, 100) for cycle in range(1, 101)]
    for scene in result.scenes:
        assert scene.log is not None
        assert scene.cycles == 50
        np.testing.assert_array_equal(scene.time, scene.log.time)
        np.testing.assert_array_equal(scene.status, scene.log.status)


@pytest.mark.parametrize("side", ["candidate", "reference"])
@pytest.mark.parametrize("what", ["A", "ubA", "H", "qdot"])
def test_a_wrong_sign_on_either_side_fails(
    iiwa7_config: Config, iiwa7_model: RobotModel, what: str, side: str
) -> None:
    """5 s of the gap: the hand comes near the boxes after 2 s."""
    change = with_qdot(factor=-1.0) if what == "qdot" else negated(what, 2)
    right = ReferenceController(iiwa7_config, iiwa7_model)
    wrong = FollowingDistorted(ReferenceController(iiwa7_config, iiwa7_model), change)
    candidate, reference = (wrong, right) if side == "candidate" else (right, wrong)
    result = compare(iiwa7_config, ["gap"], duration=5.0, candidate=candidate, reference=reference)
    assert result.verdict == "fail"
    assert result.failures[0].startswith("gap, cycle ")
    assert any(f" {what}[" in sentence for sentence in result.failures)


@pytest.mark.parametrize("side", ["candidate", "reference"])
def test_a_wrong_row_inside_either_controller_fails(
    iiwa7_config: Config, iiwa7_model: RobotModel, side: str
) -> None:
    right, wrong = ReferenceController(iiwa7_config, iiwa7_model), WrongSign(iiwa7_config, iiwa7_model, 2)
    candidate, reference = (wrong, right) if side == "candidate" else (right, wrong)
    result = compare(iiwa7_config, ["gap"], duration=5.0, candidate=candidate, reference=reference)
    assert result.verdict == "fail"
    assert result.scenes[0].greatest("A") > 0.1


def test_a_scene_is_needed(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    controller = ReferenceController(iiwa7_config, iiwa7_model)
    with pytest.raises(CompareError, match="no scene"):
        compare(iiwa7_config, [], candidate=controller)
    with pytest.raises(ConfigError, match="gap"):
        compare(iiwa7_config, ["gab"], candidate=controller)


def test_a_candidate_that_drifts_away_is_still_compared(
    iiwa7_config: Config, iiwa7_model: RobotModel
) -> None:
    """The candidate moves the arm, however wrong it is; matrices of the same states stay equal."""
    slow = Distorted(ReferenceController(iiwa7_config, iiwa7_model), with_qdot(factor=0.5))
    result = compare(iiwa7_config, ["pillar"], duration=2.0, candidate=slow)
    scene = result.scenes[0]
    assert result.verdict == "fail"
    assert scene.greatest("qdot") > 1e-3
    assert scene.greatest("H") == 0.0
    assert scene.greatest("lb") == 0.0
    assert Status.SOLVED in scene.status
