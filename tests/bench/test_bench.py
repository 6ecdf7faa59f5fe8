"""What the benchmark records, replays and counts; never how long it took."""

import json
import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from proxgen.bench import Benchmark, run_benchmark
from proxgen.bench.inputs import Inputs, crowded, record
from proxgen.bench.plot import draw
from proxgen.bench.replay import STAGES, compile_replay, instructions_per_cycle, replay
from proxgen.cli import main
from proxgen.config import load
from proxgen.config.scene import load_scene
from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import Status
from proxgen.errors import GenerateError
from proxgen.model import RobotModel, build_model

ROOT = Path(__file__).resolve().parents[2]
KEYS = {"name", "backend", "p50_us", "p99_us", "p999_us", "max_us", "cycles_per_s"}


@pytest.fixture(scope="module")
def benchmark_of_planar2(planar2_config: Config) -> Benchmark:
    """A short benchmark of the small arm."""
    return run_benchmark(planar2_config, [load_scene("post")], duration=4.0, replays=2)


def rows_named(benchmark: Benchmark, word: str) -> Sequence[dict[str, Any]]:
    """Results whose name contains a word."""
    return [row for row in benchmark.results if word in row["name"]]


def test_results_have_the_keys_that_others_rely_on(benchmark_of_planar2: Benchmark) -> None:
    content = json.loads(json.dumps(benchmark_of_planar2.to_json()))
    assert set(content) == {"machine", "results"}
    for row in content["results"]:
        assert set(row) >= KEYS
        assert 0.0 <= row["p50_us"] <= row["p99_us"] <= row["p999_us"] <= row["max_us"]
    assert {row["backend"] for row in content["results"]} == {"daqp", "qpoases"}
    assert len(rows_named(benchmark_of_planar2, "from Python, raw")) == 4
    assert len(rows_named(benchmark_of_planar2, "from Python, recorded arrays, raw")) == 4
    for stage in STAGES:
        assert len(rows_named(benchmark_of_planar2, f": {stage}, raw")) == 4


def test_raw_and_best_are_kept_apart(benchmark_of_planar2: Benchmark) -> None:
    for measured in benchmark_of_planar2.replays:
        assert measured.whole.shape == (2, 200)
        assert np.all(measured.whole > 0.0)
    raw = rows_named(benchmark_of_planar2, "cycle, raw")
    best = rows_named(benchmark_of_planar2, "cycle, best of 2")
    for one, other in zip(raw, best, strict=True):
        assert other["p50_us"] <= one["p50_us"]


def test_heap_calls_are_counted(benchmark_of_planar2: Benchmark) -> None:
    """DAQP makes none; qpOASES many, which shows that the count counts."""
    rows = rows_named(benchmark_of_planar2, "cycle, raw")
    assert {row["backend"] for row in rows} == {"daqp", "qpoases"}
    for row in rows:
        if row["backend"] == "daqp":
            assert row["heap_allocations_per_cycle"] == 0.0
        else:
            assert row["heap_allocations_per_cycle"] > 10.0
        assert row["worst_kkt_residual"] <= 1e-8


def test_plot_is_written(benchmark_of_planar2: Benchmark, tmp_path: Path) -> None:
    target = draw(benchmark_of_planar2, tmp_path / "times.png")
    assert target.read_bytes().startswith(b"\x89PNG")


def test_replay_repeats_the_recorded_run(iiwa7_config: Config, tmp_path: Path) -> None:
    """The same statuses as the controller in Python had, and each stage of the cycle takes its time."""
    model = build_model(iiwa7_config)
    program = compile_replay(iiwa7_config, "daqp", tmp_path)
    controller = CompiledController.load(tmp_path / "controller")
    scene = load_scene("moving")
    inputs = crowded(record(iiwa7_config, model, controller, scene, 6.0), model, iiwa7_config.skin.max_points)
    controller.reset()
    expected = [controller.step(q, xdot, seen).status for q, xdot, seen in inputs.recorded()]
    measured = replay(program, inputs, "daqp", tmp_path, 2)
    assert [Status(status) for status in measured.statuses] == expected
    assert len(set(expected)) >= 3  # among them reduced and stopped cycles
    solve = measured.stages["solve"]
    assert np.median(solve) > np.median(measured.stages["certificate"]) > 0.0


def test_crowding_changes_every_fourth_cycle(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    from proxgen.controllers.reference import ReferenceController

    controller = ReferenceController(iiwa7_config, iiwa7_model)
    plain = record(iiwa7_config, iiwa7_model, controller, load_scene("gap"), 0.4)
    thick = crowded(plain, iiwa7_model, 4)
    assert [len(seen.points) for seen in thick.measurements[:5]] == [4, 0, 0, 0, 4]
    assert replace(thick.measurements[1]).time == plain.measurements[1].time


def test_inputs_just_made_are_equal_arrays_elsewhere(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    from proxgen.controllers.reference import ReferenceController

    controller = ReferenceController(iiwa7_config, iiwa7_model)
    inputs = crowded(record(iiwa7_config, iiwa7_model, controller, load_scene("gap"), 0.2), iiwa7_model, 4)
    pairs = list(zip(inputs.recorded(), inputs.just_made(), strict=True))
    assert len(pairs) == inputs.cycles == 10
    for (*kept_vectors, kept), (*made_vectors, made) in pairs:
        names = ("tof_range", "capacitive", "tof_age", "capacitive_age", "points")
        kept_arrays = [*kept_vectors, *(getattr(kept, name) for name in names)]
        made_arrays = [*made_vectors, *(getattr(made, name) for name in names)]
        assert made.time == kept.time
        for one, other in zip(kept_arrays, made_arrays, strict=True):
            assert np.array_equal(one, other)
            assert one.dtype == other.dtype
            assert not np.shares_memory(one, other)


def test_command_prints_a_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    target = tmp_path / "bench.json"
    words = ["bench", "examples/planar2/planar2.yaml", "--scene", "post", "--duration", "2", "--replays", "1"]
    assert main([*words, "--json", str(target), "--plot", str(tmp_path / "times.png")]) == 0
    printed = capsys.readouterr().out
    assert "post: cycle, raw" in printed
    assert "processor:" in printed
    assert json.loads(target.read_text())["machine"]["robot"].startswith("planar2: 2 joints")
    assert (tmp_path / "times.png").exists()


def test_another_configuration_gets_the_same_inputs(iiwa7_config: Config) -> None:
    """What additions cost: replayed over DAQP on the cycles that were recorded for the first."""
    improved = load(ROOT / "examples" / "iiwa7" / "iiwa7_improved.yaml")
    benchmark = run_benchmark(iiwa7_config, [load_scene("gap")], also=[improved], duration=1.0, replays=1)
    rows = {
        (row["name"], row["backend"]): row
        for row in benchmark.results
        if row["name"].endswith(": cycle, raw")
    }
    assert [name for name, backend in rows if backend == "daqp"] == [
        "gap: cycle, raw",
        "gap crowded: cycle, raw",
        "gap, iiwa7_improved: cycle, raw",
        "gap crowded, iiwa7_improved: cycle, raw",
    ]
    assert rows["gap, iiwa7_improved: cycle, raw", "daqp"]["heap_allocations_per_cycle"] == 0.0
    plain, better = (
        rows[name, "daqp"]["instructions_per_cycle"]
        for name in ("gap: cycle, raw", "gap, iiwa7_improved: cycle, raw")
    )
    assert (plain is None) == (shutil.which("valgrind") is None)
    assert plain is None or 0.0 < plain < better


def test_another_robot_is_refused(iiwa7_config: Config, planar2_config: Config) -> None:
    with pytest.raises(GenerateError, match="planar2 has other joints"):
        run_benchmark(iiwa7_config, [load_scene("gap")], also=[planar2_config], duration=1.0)


def test_without_valgrind_instructions_are_left_out(
    planar2_config: Config, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("proxgen.bench.replay.shutil.which", lambda name: None)
    empty = Inputs("none", np.empty((0, 2)), np.empty((0, 2)), ())
    assert instructions_per_cycle(Path("program"), empty, "step", Path()) is None
