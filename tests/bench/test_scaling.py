"""Arms of any size and their times; never how long it took."""

import json
from pathlib import Path

import numpy as np
import pytest

from proxgen.bench.arms import REACH, Size, made_up_inputs, write_arm
from proxgen.bench.plot import draw
from proxgen.bench.scaling import PARTS, Scaling, run_scaling, straight_line
from proxgen.cli import main
from proxgen.controllers.protocol import Status
from proxgen.controllers.reference import ReferenceController
from proxgen.model import build_model
from proxgen.model.kinematics import tool_pose


@pytest.mark.parametrize("size", [Size(2, 8, 1), Size(7, 32, 3), Size(7, 512, 7), Size(12, 64, 12)])
def test_arms_are_as_large_as_they_are_asked_for(size: Size, tmp_path: Path) -> None:
    model = build_model(write_arm(size, tmp_path))
    assert model.n == size.joints
    assert len(model.tof_modules) == len(model.capacitive_modules) == size.sensors
    assert len(model.capsules) == size.capsules
    assert tool_pose(model, np.zeros(model.n))[2, 3] == pytest.approx(0.3 + REACH, abs=1e-5)


def test_inputs_are_accepted_and_bring_obstacles(tmp_path: Path) -> None:
    """No faults; rows are on, so that there is something to solve; the share that sees is always the same."""
    for size in (Size(), Size(sensors=128)):
        config = write_arm(size, tmp_path)
        model = build_model(config)
        inputs = made_up_inputs(model, 60)
        controller = ReferenceController(config, model)
        commands = [
            controller.step(q, xdot, seen)
            for q, xdot, seen in zip(inputs.q, inputs.xdot, inputs.measurements, strict=True)
        ]
        statuses = {command.status for command in commands}
        assert not {status for status in statuses if status.fault} - {Status.FAULT_OBSTACLE_INSIDE}
        assert sum(command.status.success for command in commands) > 30
        assert any(command.diagnostics.row_on.any() for command in commands)
        seeing = np.mean([seen.tof_range < 1.0 for seen in inputs.measurements])
        assert seeing == pytest.approx(0.5, abs=0.05)


def test_straight_line() -> None:
    slope, explained = straight_line([8, 16, 512], np.array([26.0, 50.0, 1538.0]))
    assert slope == pytest.approx(3.0)
    assert explained == pytest.approx(1.0)
    assert straight_line([1, 2, 3], np.array([1.0, 4.0, 1.0]))[1] == pytest.approx(0.0)


def test_times_of_small_sweeps(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two arms, timed, drawn and printed."""
    steps: list[tuple[int, int]] = []
    scaling = run_scaling(
        {"joints": (2, 7), "sensors": (32,)},
        cycles=100,
        replays=1,
        progress=lambda done, total: steps.append((done, total)),
    )
    assert steps == [(1, 2), (2, 2)]  # 7 joints and 32 sensors are the same arm
    assert scaling.sweeps["joints"]["value"] == [2.0, 7.0]
    assert all(time > 0.0 for time in scaling.sweeps["joints"]["cycle"])
    assert {row["name"] for row in scaling.results} >= {f"7 joints: {part}, raw" for part in PARTS}
    sweeps = scaling.sweeps | {"sensors": {key: [1.0, 2.0, 4.0] for key in ("value", *PARTS)}}
    whole = Scaling(scaling.machine, scaling.results, sweeps)
    assert draw(whole, tmp_path / "scaling.png").read_bytes().startswith(b"\x89PNG")
    monkeypatch.setattr("proxgen.bench.scaling.run_scaling", lambda **_: whole)
    assert main(["bench", "--scaling", "--json", str(tmp_path / "scaling.json")]) == 0
    assert "1000.0 ns per sensor" in capsys.readouterr().out
    assert json.loads((tmp_path / "scaling.json").read_text())["scaling"]["joints"]["value"] == [2.0, 7.0]
