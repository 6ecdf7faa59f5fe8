"""A million random cycles with each back end: `make soak`, or `python runtime/tests/soak.py [CYCLES]`.

What must hold in every cycle is checked by `random_cycles.c`, with the controller of the iiwa 7:

- Optimised builds. Uses of the heap are counted. qpOASES starts each cycle from the velocity that DAQP had
  found, so that both decide about the same problems; then their statuses and commands are compared.
- Builds with AddressSanitizer and UndefinedBehaviorSanitizer, and parameters from anywhere in their ranges.
"""

import re
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from proxgen.builder.program import compile_program
from proxgen.builder.toolchain import run
from proxgen.controllers.protocol import Status
from proxgen.errors import ProxgenError

ROOT = Path(__file__).resolve().parents[2]
BACKENDS = ("daqp", "qpoases")
JOINTS = 7
SANITIZED = ["-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
SEED = "7"
LEAST_SOLVED = {"daqp": 1.0, "qpoases": 0.9999}
"""Part of the feasible problems that has to be solved."""


@dataclass(frozen=True)
class Record:
    """What a back end decided, cycle by cycle.

    Attributes:
        status: (T,).
        qdot: (T, n) [rad/s].
    """

    status: NDArray[np.float64]
    qdot: NDArray[np.float64]


def random_cycles(backend: str, folder: Path, cycles: int, options: Sequence[str], sanitize: bool) -> str:
    """Compile in a folder and run the random cycles of one back end; returns what they print.

    Raises:
        BuildError: a promise was broken, or a sanitizer has found something; with what was said.
    """
    target = folder / f"{backend}{'-sanitized' if sanitize else ''}"
    main, generated = ROOT / "runtime" / "tests" / "random_cycles.c", ROOT / "generated" / "iiwa7"
    program = compile_program(main, generated, backend, target, SANITIZED if sanitize else [])
    return run([str(program), str(cycles), SEED, *options], f"random cycles with {backend} failed")


def read(path: Path) -> Record:
    """The record of a run."""
    values = np.fromfile(path).reshape(-1, 2 + JOINTS)
    return Record(values[:, 0], values[:, 2:])


def problems(records: dict[str, Record], heap_calls: int) -> list[str]:
    """What falls short of the promises, in words."""
    found = [f"DAQP used the heap {heap_calls} times"] if heap_calls else []
    statuses = np.array([records[name].status for name in BACKENDS])
    best = np.where(statuses.min(axis=0) < Status.STOPPED_INFEASIBLE, statuses.min(axis=0), np.inf)
    for name, status in zip(BACKENDS, statuses, strict=True):
        solved = np.mean(status[np.isfinite(best)] == best[np.isfinite(best)])
        if not solved >= LEAST_SOLVED[name]:
            found.append(f"{name} solves {100.0 * solved:.4f} % of the feasible problems")
    infeasible = statuses == Status.STOPPED_INFEASIBLE
    disagree = np.sum(infeasible[0] != infeasible[1])
    if disagree:
        found.append(f"the back ends disagree about feasibility in {disagree} cycles")
    return found


def main(cycles: int) -> int:
    """Run everything; 1 if a promise does not hold."""
    with tempfile.TemporaryDirectory(prefix="proxgen-soak-") as name:
        folder = Path(name)
        paths = {backend: folder / f"{backend}.record" for backend in BACKENDS}
        follow: dict[str, list[str]] = {"daqp": [], "qpoases": ["--follow", str(paths["daqp"])]}
        said = {}
        for backend, path in paths.items():
            options = ["--record", str(path), *follow[backend]]
            said[backend] = random_cycles(backend, folder, cycles, options, sanitize=False)
            print(said[backend], end="", flush=True)
        records = {backend: read(path) for backend, path in paths.items()}
        same = records["daqp"].status == records["qpoases"].status
        difference = np.abs(records["daqp"].qdot - records["qpoases"].qdot)[same].max()
        print(
            f"statuses differ in {np.sum(~same)} cycles, commands elsewhere by at most {difference:.1e} rad/s"
        )
        for backend in BACKENDS:
            text = random_cycles(backend, folder, cycles, ["--extreme"], sanitize=True)
            print(f"with sanitizers, {text}", end="", flush=True)
    (heap_calls,) = re.findall(r"heap: (\d+) calls", said["daqp"])
    found = problems(records, int(heap_calls))
    for problem in found:
        print(f"failed: {problem}", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    try:
        sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000))
    except ProxgenError as problem:
        sys.exit(f"proxgen: {problem}")
