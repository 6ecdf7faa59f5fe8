"""The compiled controllers against the reference: any arm, both back ends, all kinds of states."""

from pathlib import Path

import pytest

import proxgen
from proxgen.compare import compare, compare_controllers_on, random_states
from proxgen.config import load
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Status
from proxgen.controllers.reference import ReferenceController
from proxgen.model import RobotModel, build_model


def check(config: Config, model: RobotModel, folder: Path, backend: str, count: int) -> set[Status]:
    """Builds, compares, and returns the statuses that came up."""
    compiled = proxgen.build(config, folder, backend=backend)
    states = random_states(config, model, count, seed=51)
    result = compare_controllers_on(config, states, compiled, ReferenceController(config, model))
    assert result.verdict == "pass", "\n".join(result.failures)
    return {Status(number) for number in result.scenes[0].status.tolist()}


@pytest.mark.parametrize("backend", ["qpoases", "daqp"])
def test_iiwa_on_random_states(
    iiwa7_config: Config, iiwa7_model: RobotModel, tmp_path: Path, backend: str
) -> None:
    seen = check(iiwa7_config, iiwa7_model, tmp_path / "built", backend, 2000)
    stages = {status for status in Status if status.success} | {Status.STOPPED_INFEASIBLE}
    assert stages <= seen
    assert {status for status in Status if status.fault} - {Status.FAULT_DEADLINE} <= seen


@pytest.mark.parametrize("backend", ["qpoases", "daqp"])
def test_planar_arm_on_random_states(
    planar2_config: Config, planar2_model: RobotModel, tmp_path: Path, backend: str
) -> None:
    """Its switches stand for points at exactly d_0u, where rounding must not decide."""
    check(planar2_config, planar2_model, tmp_path / "built", backend, 2000)


def test_an_arm_with_more_than_64_rows(planar2_config: Config, tmp_path: Path) -> None:
    """Nothing anywhere counts on few capsules."""
    capsules = "\n".join(
        f"  - {{name: c{i}, frame: link_{1 + i % 2}, start: [{6 * i} mm, 0, 0], "
        f"end: [{6 * i + 10} mm, 0, 0], radius: 30 mm}}"
        for i in range(66)
    )
    path = tmp_path / "planar2.yaml"
    path.write_text(f"extends: {planar2_config.source}\ncapsules:\n{capsules}\n")
    config = load(path)
    check(config, build_model(config), tmp_path / "built", "daqp", 200)


@pytest.mark.slow
def test_any_arm_on_random_states(any_config: Config, any_model: RobotModel, tmp_path: Path) -> None:
    check(any_config, any_model, tmp_path / "built", "daqp", 500)


@pytest.mark.slow
@pytest.mark.parametrize("sensing", ["skin", "ideal"])
def test_iiwa_in_the_closed_loop(
    iiwa7_config: Config, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sensing: str
) -> None:
    """As `proxgen compare` does it: the compiled controller is built if none is given."""
    monkeypatch.chdir(tmp_path)
    result = compare(iiwa7_config, ["gap", "moving"], sensing=sensing, duration=16.0)
    assert result.verdict == "pass", "\n".join(result.failures)
    for scene in result.scenes:
        assert scene.cycles == 800
        assert scene.status_mismatches == 0
        assert scene.greatest("qdot") <= 1e-8
        assert max(scene.greatest("H"), scene.greatest("A")) <= 1e-10
        assert scene.greatest("kkt_residual") <= 1e-8
