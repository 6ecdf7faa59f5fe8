"""A million random cycles with each back end: `make soak`, or `python runtime/tests/soak.py CYCLES CONFIG`.

What must hold in every cycle is checked by `random_cycles.c`, with the controller of the iiwa 7 or another:

- Optimised builds. Uses of the heap are counted. qpOASES starts each cycle from the velocity that DAQP had
  found, so that both decide about the same problems; then their statuses and commands are compared. Once
  with parameters within a factor of ten of the default ones, once with parameters from anywhere in their
  ranges.
- Of every fiftieth cycle, and of all in which statuses or commands differ or a back end gives up, the stages
  are judged anew: by the reference's search for proofs (`feasibility_margin`), and where that is not sharp
  enough in rational arithmetic, without rounding.
- Builds with AddressSanitizer and UndefinedBehaviorSanitizer, and parameters from anywhere in their ranges.
"""

import json
import re
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import proxgen
from proxgen.builder.program import compile_program
from proxgen.builder.toolchain import run
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Status
from proxgen.controllers.reference.exact import meets_exactly
from proxgen.controllers.reference.feasibility import feasibility_margin
from proxgen.controllers.reference.parameters import Parameters
from proxgen.controllers.reference.relaxation import STAGES, stage_rows
from proxgen.controllers.reference.row_order import RowOrder
from proxgen.errors import ProxgenError

ROOT = Path(__file__).resolve().parents[2]
MAIN = ROOT / "runtime" / "tests" / "random_cycles.c"
BACKENDS = ("daqp", "qpoases")
SANITIZED = ["-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
SEED = "7"
MOST_MISSED = {"daqp": 0.0, "qpoases": 1e-4}
"""Part of the feasible problems that may be missed."""

APART = 1e-8
"""Commands that differ by more [rad/s] are disputed."""

MOST_APART = 1e-5
"""Part of the feasible problems, ties apart, in which they may: multipliers of 1e6 and more make them."""

TOLERANCE = 1e-8
"""Rows that exclude each other by less [m/s] are a tie (docs/method.md, step 6)."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Record:
    """What a back end decided, cycle by cycle.

    Attributes:
        status: (T,).
        residual: (T,) of the certificate; nan where nothing was solved.
        qdot: (T, n) [rad/s].
    """

    status: Array
    residual: Array
    qdot: Array


@dataclass(frozen=True)
class Problem:
    """What decides a cycle.

    Attributes:
        values: arrays by their names in `random_cycles.c`, write_problem.
        parameters: in force in that cycle.
    """

    values: dict[str, Array]
    parameters: Parameters


def read_record(path: Path, joints: int) -> Record:
    """The record of a run."""
    values = np.fromfile(path).reshape(-1, 2 + joints)
    return Record(values[:, 0], values[:, 1], values[:, 2:])


def read_problems(path: Path, manifest: dict[str, Any], self_collision: bool) -> Iterator[Problem]:
    """The problems that a run has written."""
    sizes: dict[str, int] = manifest["dimensions"]
    n, rows, capsules = sizes["joints"], sizes["rows"], sizes["capsules"]
    shapes: dict[str, tuple[int, ...]] = {
        each["name"]: tuple(each["shape"]) for each in manifest["parameters"]
    }
    layout = {f"parameter {name}": shape for name, shape in shapes.items()}
    layout |= {
        "row_on": (rows,),
        "distance": (capsules,),
        "self_distance": (capsules if self_collision else 0,),
    }
    layout |= {"ubA": (rows,), "lb": (n,), "ub": (n,), "A": (rows, n), "H": (n, n), "g": (n,)}
    ends = np.cumsum([int(np.prod(shape)) for shape in layout.values()])
    for line in np.fromfile(path).reshape(-1, ends[-1]):
        parts = zip(layout.items(), np.split(line, ends[:-1]), strict=True)
        values = {name: part.reshape(shape) for (name, shape), part in parts}
        chosen: dict[str, Any] = {name: values.pop(f"parameter {name}") for name in shapes}
        chosen |= {name: float(value) for name, value in chosen.items() if not value.shape}
        yield Problem(values, Parameters(**chosen))


def stages(problem: Problem, order: RowOrder) -> Iterator[tuple[Status, Array, Array]]:
    """Rows and right-hand sides of the stages; one that is as the one before is among them."""
    values = problem.values
    ladder = order.ladder(values["distance"], values["self_distance"], problem.parameters)
    for status in STAGES:
        kept, b = stage_rows(status, values["row_on"] > 0.5, values["ubA"], ladder)
        yield status, values["A"][kept], b[kept]


def feasibility(A: Array, b: Array, lb: Array, ub: Array) -> str:
    """`feasible`, `infeasible`, or `tie`: rows that exclude each other by no more than the tolerance."""
    _, least, most = feasibility_margin(A, b, lb, ub, TOLERANCE)
    if least > TOLERANCE or most <= 0.0:
        return "infeasible" if least > TOLERANCE else "feasible"
    if meets_exactly(A, b, lb, ub):
        return "feasible"
    return "tie" if meets_exactly(A, b, lb, ub, TOLERANCE) else "infeasible"


def judge(problem: Problem, order: RowOrder, decided: Sequence[float]) -> list[str]:
    """What each decision of a cycle is worth.

    `right`; `tied`: a stage is a tie, and decides; `missed`: a stage before it is feasible; `wrong`: it is
    a stage that is not feasible.
    """
    verdicts: dict[Status, str] = {}
    for status, A, b in stages(problem, order):
        verdicts[status] = feasibility(A, b, problem.values["lb"], problem.values["ub"])
        if verdicts[status] == "feasible":
            break
    first = min((status for status, verdict in verdicts.items() if verdict == "feasible"), default=np.inf)
    words = []
    for status in map(Status, map(int, decided)):
        if status > first:
            words.append("missed")
        elif verdicts.get(status) == "infeasible":
            words.append("wrong")
        else:
            words.append("tied" if "tie" in verdicts.values() and status != first else "right")
    return words


def apart(records: dict[str, Record]) -> Array:
    """(T,) how far commands differ [rad/s]; 0 where statuses do."""
    first, second = (records[name] for name in BACKENDS)
    return np.where(first.status == second.status, np.abs(first.qdot - second.qdot).max(axis=1), 0.0)


def listed(records: dict[str, Record], step: int = 50) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Cycles to judge: each `step`-th without a fault, and all disputed ones; and (T,) which are disputed."""
    statuses = np.array([records[name].status for name in BACKENDS])
    disputed = (statuses[0] != statuses[1]) | (statuses == Status.STOPPED_SOLVER).any(axis=0)
    disputed |= apart(records) > APART
    sampled = np.arange(disputed.size) % step == 0
    return np.flatnonzero((sampled | disputed) & (statuses <= Status.STOPPED_SOLVER).all(axis=0)), disputed


def problems(
    judged: dict[str, Counter[str]], cycles: int, heap_calls: int, disputed_faults: int = 0
) -> list[str]:
    """What falls short of the promises, in words.

    Args:
        judged: per back end, how many cycles were right, tied, missed, wrong; and apart, though not tied.
        cycles: with a QP, all of the run.
        heap_calls: of DAQP.
        disputed_faults: cycles that are a fault for one back end only.
    """
    found = [f"DAQP used the heap {heap_calls} times"] if heap_calls else []
    if disputed_faults:
        found.append(f"{disputed_faults} cycles are a fault for one back end only")
    for name in BACKENDS:
        if judged[name]["wrong"]:
            found.append(f"{name} solved what is infeasible in {judged[name]['wrong']} cycles")
        if judged[name]["missed"] > MOST_MISSED[name] * cycles:
            found.append(f"{name} missed {judged[name]['missed']} of {cycles} feasible problems")
    if judged[BACKENDS[0]]["apart"] > MOST_APART * cycles:
        found.append(f"commands differ in {judged[BACKENDS[0]]['apart']} of {cycles} feasible problems")
    return found


class Soak:
    """The runs of one configuration, in a folder of their own."""

    def __init__(self, config: Config, folder: Path, cycles: int) -> None:
        self.config, self.folder, self.cycles = config, folder, cycles
        self.generated = proxgen.generate(config, folder / "generated")
        self.manifest = json.loads((self.generated / "manifest.json").read_text())

    def run(self, backend: str, *options: str, sanitize: bool = False) -> str:
        """Compile and run the random cycles of one back end; returns what they print.

        Raises:
            BuildError: a promise was broken, or a sanitizer has found something; with what was said.
        """
        target = self.folder / f"{backend}{'-sanitized' if sanitize else ''}"
        if not target.exists():
            compile_program(MAIN, self.generated, backend, target, SANITIZED if sanitize else [])
        return run([str(target), str(self.cycles), SEED, *options], f"random cycles with {backend} failed")

    def compare(self, *options: str) -> list[str]:
        """Both back ends on the same problems; what falls short."""
        paths = {backend: self.folder / f"{backend}.record" for backend in BACKENDS}
        said = self.run("daqp", *options, "--record", str(paths["daqp"]))
        (heap_calls,) = re.findall(r"heap: (\d+) calls", said)
        follow = ["--record", str(paths["qpoases"]), "--follow", str(paths["daqp"])]
        print(said, self.run("qpoases", *options, *follow), sep="", end="", flush=True)
        joints = self.manifest["dimensions"]["joints"]
        records = {name: read_record(path, joints) for name, path in paths.items()}
        differ, distance = records["daqp"].status != records["qpoases"].status, apart(records)
        print(f"statuses differ in {np.sum(differ)} cycles; commands elsewhere by at most")
        print(f"{distance.max():.1e} rad/s, and by more than {APART} in {np.sum(distance > APART)} cycles")
        faults = {name: record.status > Status.STOPPED_SOLVER for name, record in records.items()}
        judged = self.judge(records, options)
        best = np.minimum(records["daqp"].status, records["qpoases"].status)
        feasible = int(np.sum(best < Status.STOPPED_INFEASIBLE))
        return problems(judged, feasible, int(heap_calls), int(np.sum(faults["daqp"] != faults["qpoases"])))

    def judge(self, records: dict[str, Record], options: Sequence[str]) -> dict[str, Counter[str]]:
        """Judge the sample and what is disputed; prints what comes out."""
        cycles, disputed = listed(records)
        judged: dict[str, Counter[str]] = {name: Counter() for name in BACKENDS}
        if self.config.relaxation.mode == "slack":  # always feasible
            for name in BACKENDS:
                judged[name]["missed"] = int(np.sum(records[name].status == Status.STOPPED_SOLVER))
            return judged
        at, written = self.folder / "at", self.folder / "problems"
        at.write_text("\n".join(map(str, cycles)))
        self.run("daqp", *options, "--at", str(at), "--problems", str(written))
        order = RowOrder.of(self.config)
        read, differ = read_problems(written, self.manifest, order.self_collision), apart(records) > APART
        for cycle, problem in zip(cycles, read, strict=True):
            decided = [records[name].status[cycle] for name in BACKENDS]
            worth = judge(problem, order, decided)
            for name, word in zip(BACKENDS, worth, strict=True):
                judged[name][word] += 1
                judged[name]["apart"] += bool(differ[cycle] and word != "tied")
        for name in BACKENDS:
            print(f"judged {len(cycles)} cycles ({np.sum(disputed)} disputed): {name} {dict(judged[name])}")
        return judged


def main(cycles: int, path: Path) -> int:
    """Run everything; 1 if a promise does not hold."""
    found = []
    with tempfile.TemporaryDirectory(prefix="proxgen-soak-") as name:
        soak = Soak(proxgen.load(path), Path(name), cycles)
        for options in ((), ("--extreme",)):
            print(f"== {path.stem}, parameters {'anywhere' if options else 'near the default'}", flush=True)
            found += soak.compare(*options)
        for backend in BACKENDS:
            print("== with sanitizers,", soak.run(backend, "--extreme", sanitize=True), end="", flush=True)
    for problem in found:
        print(f"failed: {problem}", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    try:
        config = sys.argv[2] if len(sys.argv) > 2 else ROOT / "examples" / "iiwa7" / "iiwa7.yaml"
        sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000, Path(config)))
    except ProxgenError as problem:
        sys.exit(f"proxgen: {problem}")
