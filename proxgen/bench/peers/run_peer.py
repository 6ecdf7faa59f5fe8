"""Times one peer on recorded states; runs in the peer's environment, where proxgen itself is not installed.

    python run_peer.py MODULE PROBLEM.npz RESULT.npz

PROBLEM holds `arm` (JSON, see `problem.describe_arm`), `q`, `xdot`, `points` and `target`; MODULE is a file
beside this one, whose `open_solver(arm)` gives a function from one cycle's four arrays to a joint velocity.
RESULT gets `times` [s] and `qdot`, nan where the peer found no answer, and `versions`, as JSON.
"""

import importlib
import json
import sys
import time
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

WARM_UP = 50
"""Cycles before the first that counts, so that no peer is charged for imports and caches."""


def main(module: str, source: Path, target: Path) -> None:
    """Read the problem, time every cycle, write the result."""
    problem = np.load(source)
    solve = importlib.import_module(module).open_solver(json.loads(str(problem["arm"])))
    cycles = [problem[name] for name in ("q", "xdot", "points", "target")]
    count = len(cycles[0])
    times, qdot = np.empty(count), np.full((count, cycles[0].shape[1]), np.nan)
    for index in [*range(min(WARM_UP, count)), *range(count)]:
        given = [array[index] for array in cycles]
        begin = time.perf_counter_ns()
        answer = _answer(solve, given)
        times[index] = (time.perf_counter_ns() - begin) * 1e-9
        qdot[index] = np.nan if answer is None else answer
    installed = {found.metadata["Name"]: found.version for found in metadata.distributions()}
    np.savez(target, times=times, qdot=qdot, versions=json.dumps(installed))


def _answer(solve: Any, given: list[Any]) -> Any:
    """A joint velocity, or None: that a peer's QP is infeasible it says in an exception of its own."""
    try:
        return solve(*given)
    except Exception:
        return None


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))
