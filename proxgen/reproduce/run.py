"""From a plan to results: build, run what is missing, time, collect."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from proxgen.errors import ReproduceError
from proxgen.reproduce.films import film_in, films_of
from proxgen.reproduce.plan import Experiment, Plan, Setup
from proxgen.reproduce.pool import carry_out_all, cores
from proxgen.reproduce.results import Results
from proxgen.reproduce.store import Numbers, Store
from proxgen.reproduce.tasks import Task, build_libraries, tasks_of
from proxgen.reproduce.timing import Timing
from proxgen.reproduce.units import UNITS, mean_and_spread

if TYPE_CHECKING:
    from proxgen.reproduce.page import Outcome

Progress = Callable[[int, int], None]
"""Called with the work done and all of it."""

TIMED = ("proposed", "repulsive")
"""Methods whose cycle times stand side by side."""

_BUILD, _REPORT = 400.0, 1200.0
"""Cost of a build, and of the report, in the units of tasks: simulated seconds of the compiled controller."""


@dataclass
class Meter:
    """Adds up what is done, for one progress bar over everything."""

    total: float
    show: Progress | None
    done: float = 0.0

    def advance(self, cost: float) -> None:
        """Some work is done."""
        self.done += cost
        if self.show:
            self.show(round(min(self.done, self.total)), round(self.total))


def reproduce(
    plan: Plan,
    directory: Path,
    *,
    builds: Path = Path("build"),
    workers: int | None = None,
    progress: Progress | None = None,
    say: Callable[[str], None] | None = None,
) -> "Outcome":
    """Do what a plan says, unless it is done already, and write the report.

    Args:
        plan: experiments, comparisons, starts.
        directory: for the page, `reproduce.json`, figures, and finished work in `runs/`.
        builds: where the controllers are built.
        workers: processes; one per core if None.
        progress: called as the work proceeds.
        say: called with a line for every experiment that is finished.

    Returns:
        Results, verdicts, and the page.

    Raises:
        BuildError: compiler or solver missing.
        ReproduceError: some runs failed; the others are kept.
        SimulationError: the folder cannot be written.
    """
    from proxgen.reproduce.page import write_page

    begin = time.monotonic()
    tell, workers, store = say or (lambda line: None), workers or cores(), Store(directory / "runs")
    _make_folder(store.directory)
    libraries = dict.fromkeys(plan.setups, builds)  # what follows only asks these tasks what they cost
    planned = tasks_of(plan, libraries)
    total = sum(task.cost for task in [*planned, *films_of(plan, planned)])
    meter = Meter(len(plan.setups) * _BUILD + total + _REPORT, progress)
    libraries = build_libraries(plan, builds, lambda done, all_of_them: meter.advance(_BUILD))
    tasks = tasks_of(plan, libraries)
    timing = Timing(
        plan.configurations["paper"],
        {method: libraries[Setup("paper", method)] for method in TIMED},
        min(plan.duration, 60.0),
        plan.timed_passes,
    )
    films = films_of(plan, tasks)
    everything: list[Task] = [*tasks, *films, timing]
    fingerprints = {task.name: task.fingerprint() for task in everything}
    missing = [task for task in everything if store.find(task.name, fingerprints[task.name]) is None]
    meter.total = len(plan.setups) * _BUILD + sum(task.cost for task in everything) + _REPORT
    meter.advance(sum(task.cost for task in everything if task not in missing))
    herald = _Herald(plan, store, fingerprints, {task.name for task in missing}, tell)

    def done(task: Task) -> None:
        meter.advance(task.cost)
        herald.note(task)

    for phase, processes in ((tasks, workers), (films, workers), ([timing], 1)):
        carry_out_all([task for task in phase if task in missing], store, processes, done)
    results = collect(plan, store, fingerprints)
    outcome = write_page(results, directory, begin if len(missing) == len(everything) else None)
    meter.advance(_REPORT)
    return outcome


def collect(plan: Plan, store: Store, fingerprints: dict[str, str]) -> Results:
    """All numbers of a plan that is done.

    Raises:
        ReproduceError: something is missing, such as a record that was removed meanwhile.
    """
    found: dict[str, Numbers] = {}
    for name, fingerprint in fingerprints.items():
        numbers = store.find(name, fingerprint)
        if numbers is None:
            raise ReproduceError("a result has disappeared", {name: f"no record of it in {store.directory}"})
        found[name] = numbers
    return Results(
        plan,
        store,
        {what.name: [found[f"{what.name}-{start}"] for start in plan.starts] for what in plan.experiments},
        [found[what.name] for what in plan.agreements],
        found["cycle_times"],
        films={name: film_in(found[f"film-{name}"]) for name in plan.films},
    )


@dataclass
class _Herald:
    """Says what came out of an experiment when the last of its runs is done."""

    plan: Plan
    store: Store
    fingerprints: dict[str, str]
    missing: set[str]
    tell: Callable[[str], None]

    def note(self, task: Task) -> None:
        """A task is done."""
        self.missing.discard(task.name)
        for experiment in self.plan.experiments:
            names = [f"{experiment.name}-{start}" for start in self.plan.starts]
            if task.name in names and not self.missing.intersection(names):
                self.tell(self._line(experiment, names))

    def _line(self, experiment: Experiment, names: list[str]) -> str:
        """The two numbers that one looks at first."""
        runs = [self.store.find(name, self.fingerprints[name]) or {} for name in names]
        targets = mean_and_spread([float(run["targets_reached"]) for run in runs], UNITS["targets_reached"])
        nearest = [run["min_distance_axis_m"] for run in runs]
        least = np.min([np.inf if distance is None else distance for distance in nearest])
        return f"{experiment.name}: {targets} targets, least distance {least:.3f} m"


def _make_folder(directory: Path) -> None:
    """The folder for results.

    Raises:
        ReproduceError: it cannot be made.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ReproduceError(f"cannot make the folder {directory}: {error.strerror or error}", {}) from error
