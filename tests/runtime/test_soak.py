"""The scripts around the runtime's tests: what they make of their findings, and of missing tools."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scripts import ROOT, load_script, run_with_tools

from proxgen.config import load
from proxgen.controllers.reference.parameters import default_parameters
from proxgen.model import build_model

SOAK = load_script(ROOT / "runtime" / "tests" / "soak.py")
FUZZ = ROOT / "runtime" / "fuzz" / "fuzz.py"
CONFIG = load(ROOT / "examples" / "iiwa7" / "iiwa7.yaml")
CYCLES = 20_000


@pytest.fixture(scope="module")
def soak(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A soak of the iiwa 7, short."""
    return SOAK.Soak(CONFIG, tmp_path_factory.mktemp("soak"), CYCLES)


def problems(judged: dict[str, dict[str, int]], heap_calls: int = 0, faults: int = 0) -> list[str]:
    """What is found in a run of 20,000 feasible cycles."""
    counters = {name: Counter({"right": 400}) + Counter(judged.get(name, {})) for name in SOAK.BACKENDS}
    found: list[str] = SOAK.problems(counters, CYCLES, heap_calls, faults)
    return found


def test_nothing_is_found_where_nothing_is_wrong() -> None:
    assert problems({}) == []
    assert problems({"daqp": {"tied": 3}, "qpoases": {"missed": 2, "tied": 1}}) == []


@pytest.mark.parametrize(
    ("judged", "message"),
    [
        ({"daqp": {"missed": 1}}, "daqp missed 1 of 20000 feasible problems"),
        ({"qpoases": {"missed": 3}}, "qpoases missed 3 of 20000 feasible problems"),
        ({"qpoases": {"wrong": 1}}, "qpoases solved what is infeasible in 1 cycles"),
        ({"daqp": {"apart": 1}}, "commands differ in 1 of 20000 feasible problems"),
    ],
)
def test_problems_are_found(judged: dict[str, dict[str, int]], message: str) -> None:
    assert problems(judged) == [message]


def test_heap_use_and_different_faults_are_found() -> None:
    assert problems({}, heap_calls=4) == ["DAQP used the heap 4 times"]
    assert problems({}, faults=2) == ["2 cycles are a fault for one back end only"]


@pytest.mark.parametrize(
    ("excess", "verdict"),
    [(-1e-30, "feasible"), (0.0, "feasible"), (1e-30, "tie"), (1e-9, "tie"), (3e-8, "infeasible")],
)
def test_feasibility_is_told_without_rounding(excess: float, verdict: str) -> None:
    """x ≤ -excess and -x ≤ -excess, scaled so that a single point or none is left."""
    A, b = np.array([[1.0, 3.0], [-1.0, -3.0]]), np.array([-excess, -excess])
    box = np.full(2, 1.0)
    assert SOAK.feasibility(A, b, -box, box) == verdict


def problem(b: list[float]) -> Any:
    """Three capsules' rows that ask for x_0 ≤ b, and nothing else."""
    values = {
        "row_on": np.array([1.0, 1.0, 1.0, 0.0]),
        "ubA": np.array([*b, 1e20]),
        "self_distance": np.zeros(0),
    }
    values |= {"distance": np.array([0.1, 0.24, 0.28]), "A": np.tile([1.0, 0.0], (4, 1))}
    values |= {"lb": np.full(2, -0.1), "ub": np.full(2, 0.1)}
    return SOAK.Problem(values, default_parameters(CONFIG, build_model(CONFIG)))


@pytest.mark.parametrize(
    ("b", "decided", "words"),
    [
        ([0.0, 0.0, 0.0], [0, 1, 9], ["right", "missed", "missed"]),
        ([0.0, 0.0, -0.2], [0, 2, 8], ["wrong", "right", "missed"]),
        ([0.0, 0.0, -0.1 - 1e-9], [0, 2, 3], ["tied", "right", "missed"]),
        ([-0.2, 0.0, 0.0], [2, 3, 8], ["wrong", "right", "missed"]),
    ],
)
def test_a_decision_is_judged_by_the_stages_before_it(
    b: list[float], decided: list[int], words: list[str]
) -> None:
    assert SOAK.judge(problem(b), SOAK.RowOrder.of(CONFIG), decided) == words


def test_cycles_are_judged_where_statuses_or_commands_differ() -> None:
    status, qdot, residual = np.array([0.0, 0.0, 3.0, 0.0, 9.0]), np.zeros((5, 7)), np.zeros(5)
    moved = qdot.copy()
    moved[1, 3] = 2e-8
    moved[2, 0] = 0.5e-8
    other = np.where(np.arange(5) == 3, 8.0, status)
    records = {"daqp": SOAK.Record(status, residual, qdot), "qpoases": SOAK.Record(other, residual, moved)}
    cycles, disputed = SOAK.listed(records, step=100)
    assert cycles.tolist() == [0, 1, 3, 4]
    assert disputed.tolist() == [False, True, False, True, True]


@pytest.mark.slow
@pytest.mark.parametrize("options", [(), ("--extreme",)], ids=["near the default", "anywhere"])
def test_a_short_soak_finds_nothing(options: tuple[str, ...], soak: Any) -> None:
    assert soak.compare(*options) == []


def test_fuzzing_says_what_it_needs(tmp_path: Path) -> None:
    done = run_with_tools(FUZZ, tmp_path, "--check")
    assert done.returncode == 1
    assert done.stderr.endswith("apt-get install clang\n")
    for name in ("clang", "clang++"):
        (tmp_path / name).write_text(f"#!/bin/sh\necho {tmp_path} version 19.1\n")
        (tmp_path / name).chmod(0o755)
    done = run_with_tools(FUZZ, tmp_path, "--check")
    assert done.stderr.endswith("apt-get install libclang-rt-19-dev\n")
