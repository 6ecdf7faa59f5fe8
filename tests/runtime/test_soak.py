"""The scripts around the runtime's tests: what they make of their findings, and of missing tools."""

from pathlib import Path

import numpy as np
import pytest
from scripts import ROOT, load_script, run_with_tools

SOAK = load_script(ROOT / "runtime" / "tests" / "soak.py")
FUZZ = ROOT / "runtime" / "fuzz" / "fuzz.py"
CYCLES = 20_000


def problems(changed: dict[str, dict[int, int]], heap_calls: int = 0) -> list[str]:
    """What is found where both back ends solved all cycles but every tenth, except for some statuses."""
    records = {}
    for name in SOAK.BACKENDS:
        status = np.where(np.arange(CYCLES) % 10 == 0, 8.0, 0.0)
        for cycle, value in changed.get(name, {}).items():
            status[cycle] = value
        records[name] = SOAK.Record(status, np.zeros((CYCLES, 7)))
    found: list[str] = SOAK.problems(records, heap_calls)
    return found


def test_nothing_is_found_where_nothing_is_wrong() -> None:
    assert problems({}) == []
    assert problems({"daqp": {3: 17}, "qpoases": {3: 17}}) == []


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"daqp": {1: 9}}, "daqp solves 99.9944 % of the feasible problems"),
        ({"daqp": {1: 1}}, "daqp solves 99.9944 %"),
        ({"qpoases": {1: 9, 2: 2}}, "qpoases solves 99.9889 %"),
        ({"daqp": {1: 8}}, "disagree about feasibility in 1 cycles"),
        ({"qpoases": {10: 9}}, "disagree about feasibility in 1 cycles"),
    ],
)
def test_problems_are_found(changed: dict[str, dict[int, int]], message: str) -> None:
    assert any(message in problem for problem in problems(changed))


def test_one_problem_in_ten_thousand_is_forgiven_to_qpoases() -> None:
    assert problems({"qpoases": {1: 2}}) == []


def test_heap_use_is_found() -> None:
    assert problems({}, heap_calls=4) == ["DAQP used the heap 4 times"]


def test_fuzzing_says_what_it_needs(tmp_path: Path) -> None:
    done = run_with_tools(FUZZ, tmp_path, "--check")
    assert done.returncode == 1
    assert done.stderr.endswith("apt-get install clang\n")
    for name in ("clang", "clang++"):
        (tmp_path / name).write_text(f"#!/bin/sh\necho {tmp_path} version 19.1\n")
        (tmp_path / name).chmod(0o755)
    done = run_with_tools(FUZZ, tmp_path, "--check")
    assert done.stderr.endswith("apt-get install libclang-rt-19-dev\n")
