"""The log: saved whole and read back, and figures that follow from its arrays."""

from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from proxgen.controllers.protocol import Status
from proxgen.errors import SimulationError
from proxgen.simulation.log import RolloutLog

SUMMARY_KEYS = {
    "scene", "controller", "backend", "sensing", "seed", "duration_s", "cycles", "targets_reached",
    "min_distance_axis_m", "min_distance_surface_m", "time_below_dr_fraction", "penetration_samples",
    "mean_abs_dqdot", "max_abs_dqdot", "status_counts", "solver_failures", "limit_violations", "cycle_us",
}  # fmt: skip


def made_log(**changes: Any) -> RolloutLog:
    """Ten cycles of a two-joint arm with two capsules, two range sensors and one switch."""
    T, n = 10, 2
    axis = np.full((T, 2), 0.5)
    axis[3] = [0.16, 0.4]
    axis[4] = [0.03, 0.02]
    qdot = np.zeros((T, n))
    qdot[2:] = [0.1, -0.3]
    status = np.full(T, Status.SOLVED, dtype=np.int64)
    status[[1, 2]], status[5] = Status.STOPPED_SOLVER, Status.REDUCED_ACTIVE
    q = np.zeros((T, n))
    q[6, 0], q[7, 1], q[8, 1] = 1.0 + 1e-10, -1.0 - 2e-9, 1.5
    arrays: dict[str, Any] = {
        "time": np.arange(T) * 0.02,
        "q": q,
        "qdot": qdot,
        "xdot": np.ones((T, 3)),
        "tool_position": np.ones((T, 3)),
        "tool_rotation": np.tile(np.eye(3), (T, 1, 1)),
        "target_index": np.zeros(T, dtype=np.int64),
        "target_position": np.ones((T, 3)),
        "target_distance": np.linspace(1.0, 0.0, T),
        "targets_reached": np.repeat([0, 3], T // 2),
        "tof_range": np.ones((T, 2)),
        "capacitive": np.zeros((T, 1), dtype=bool),
        "status": status,
        "controller_distance": np.full((T, 2), np.inf),
        "true_axis_distance": axis,
        "true_surface_distance": axis - [0.05, 0.01],
        "manipulability": np.ones(T),
        "damping": np.ones(T),
        "kkt_residual": np.full(T, np.nan),
        "cycle_us": np.arange(1.0, T + 1.0),
        "meta": {
            "scene": "made", "controller": "test", "backend": "none", "sensing": "ideal", "seed": 3,
            "period": 0.02, "thresholds": {"d_r": 0.17}, "distance_reference": "axis",
            "q_lower": [-1.0, -1.0], "q_upper": [1.0, 1.0],
        },
    }  # fmt: skip
    return RolloutLog(**arrays | changes)


def test_summary_has_exactly_the_keys_of_the_command_line() -> None:
    assert set(made_log().summary()) == SUMMARY_KEYS
    assert set(made_log().summary()["cycle_us"]) == {"p50", "p99", "p999", "max"}


def test_figures_follow_from_the_arrays() -> None:
    summary = made_log().summary()
    assert summary["cycles"] == 10
    assert summary["duration_s"] == pytest.approx(0.2)
    assert summary["targets_reached"] == 3
    assert summary["min_distance_axis_m"] == pytest.approx(0.02)
    assert summary["min_distance_surface_m"] == pytest.approx(-0.02)
    assert summary["time_below_dr_fraction"] == pytest.approx(0.2)
    assert summary["penetration_samples"] == 1
    assert summary["max_abs_dqdot"] == pytest.approx(0.3)
    assert summary["mean_abs_dqdot"] == pytest.approx(0.4 / 20)
    assert summary["status_counts"] == {"REDUCED_ACTIVE": 1, "SOLVED": 7, "STOPPED_SOLVER": 2}
    assert summary["solver_failures"] == 2
    assert summary["limit_violations"] == 2  # 1e-10 is rounding
    assert summary["cycle_us"]["max"] == 10.0
    assert summary["cycle_us"]["p50"] == pytest.approx(5.5)
    assert summary["cycle_us"]["p99"] == pytest.approx(9.91)
    assert summary["cycle_us"]["p999"] == pytest.approx(9.991)


def test_a_first_command_is_a_change_from_rest() -> None:
    log = made_log(qdot=np.full((10, 2), 0.4))
    assert log.summary()["max_abs_dqdot"] == pytest.approx(0.4)
    assert log.summary()["mean_abs_dqdot"] == pytest.approx(0.04)


def test_the_distance_reference_decides_what_is_below_d_r() -> None:
    log = made_log()
    on_surface = replace(log, meta=log.meta | {"distance_reference": "surface", "thresholds": {"d_r": 0.45}})
    assert on_surface.summary()["time_below_dr_fraction"] == pytest.approx(0.2)
    assert made_log(meta=log.meta | {"thresholds": {"d_r": 0.01}}).summary()["time_below_dr_fraction"] == 0.0


def test_without_obstacles_there_is_no_least_distance() -> None:
    far = np.full((10, 2), np.inf)
    summary = made_log(true_axis_distance=far, true_surface_distance=far).summary()
    assert summary["min_distance_axis_m"] is None
    assert summary["min_distance_surface_m"] is None
    assert summary["penetration_samples"] == 0
    assert summary["time_below_dr_fraction"] == 0.0


def test_a_log_comes_back_as_it_was_saved(tmp_path: Path) -> None:
    log, path = made_log(), tmp_path / "run.npz"
    log.save(path)
    again = RolloutLog.load(path)
    for field in fields(log):
        if field.name != "meta":
            saved, loaded = getattr(log, field.name), getattr(again, field.name)
            assert saved.dtype == loaded.dtype
            np.testing.assert_array_equal(saved, loaded)
    assert again.meta == log.meta
    assert again.summary() == log.summary()
    assert [file.name for file in tmp_path.iterdir()] == ["run.npz"]


def test_a_log_is_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "run.npz"
    made_log().save(path)
    before = path.read_bytes()

    def fails(file: Any, **arrays: Any) -> None:
        file.write(b"half a log")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", fails)
    with pytest.raises(SimulationError, match="No space left"):
        made_log().save(path)
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["run.npz"]


def test_what_is_not_a_log_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SimulationError, match="cannot read"):
        RolloutLog.load(tmp_path / "missing.npz")
    text = tmp_path / "text.npz"
    text.write_text("not a log")
    with pytest.raises(SimulationError, match="not a rollout log"):
        RolloutLog.load(text)
    other = tmp_path / "other.npz"
    np.savez(other, a=np.zeros(3))
    with pytest.raises(SimulationError, match="not a rollout log"):
        RolloutLog.load(other)
    cut = tmp_path / "cut.npz"
    made_log().save(cut)
    cut.write_bytes(cut.read_bytes()[:-300])
    with pytest.raises(SimulationError, match="not a rollout log"):
        RolloutLog.load(cut)
    with pytest.raises(SimulationError, match="cannot write"):
        made_log().save(text / "below_a_file.npz")
