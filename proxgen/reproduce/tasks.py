"""The pieces of work: one run, or one comparison; each in any process, each with a fingerprint."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from proxgen.builder.sources import digest, digest_files, generator_files, runtime_headers, runtime_units
from proxgen.config import load
from proxgen.config.hashing import config_hash
from proxgen.config.scene import load_scene
from proxgen.config.schema import Config
from proxgen.config.variants import variant_name, with_method, with_noise
from proxgen.reproduce.plan import Agreement, Experiment, Plan, Setup
from proxgen.reproduce.store import Store

if TYPE_CHECKING:
    from proxgen.controllers.protocol import Controller

PACKAGE = Path(__file__).parents[1]
_ROOMS = ("controllers", "simulation", "compare")
_OWN = ("tasks.py", "derived.py")


class Task(Protocol):
    """Something to be done once, in whatever process.

    Attributes:
        name: of its record.
        cost: about how long it takes, in units of their own.
    """

    @property
    def name(self) -> str:
        """Of its record."""

    @property
    def cost(self) -> float:
        """About how long it takes, in units that all tasks share."""

    def fingerprint(self) -> str:
        """Digest of everything that its result depends on."""

    def carry_out(self, store: Store) -> None:
        """Do it, and keep the result."""


@dataclass(frozen=True)
class Rollout:
    """One experiment from one start.

    Attributes:
        experiment: what is run.
        configuration: YAML file.
        library: folder of the compiled controller.
        start: seed of the perturbation, and of noise.
        duration: [s].
    """

    experiment: Experiment
    configuration: Path
    library: Path
    start: int
    duration: float

    @property
    def name(self) -> str:
        """Of its record."""
        return f"{self.experiment.name}-{self.start}"

    @property
    def cost(self) -> float:
        """About how long it takes."""
        return self.duration * (1.5 if self.experiment.plant == "dynamic" else 1.0)

    def fingerprint(self) -> str:
        """Digest of everything that its result depends on."""
        what, config = self.experiment, self._config()
        scene = load_scene(what.scene, beside=self.configuration)
        parts = [what.sensing, what.plant, self.start, self.duration]
        return digest([sources(), config_hash(config), scene.model_dump(mode="json"), parts])

    def carry_out(self, store: Store) -> None:
        """Run it, and keep its log and numbers."""
        from proxgen.model import build_model
        from proxgen.reproduce.derived import derived_numbers
        from proxgen.simulation.dynamic_plant import DynamicPlant
        from proxgen.simulation.rollout import run
        from proxgen.simulation.scenery import perturbed

        what, config = self.experiment, self._config()
        model = build_model(config)
        scene, offset = perturbed(load_scene(what.scene, beside=self.configuration), model, self.start)
        plant = DynamicPlant(model) if what.plant == "dynamic" else None
        try:
            log = run(
                config, model, open_controller(self.library), scene, sensing=what.sensing,
                duration=self.duration, seed=self.start, start_offset=offset, plant=plant,
            )  # fmt: skip
        finally:
            if plant is not None:
                plant.close()
        numbers = log.summary() | derived_numbers(log, config)
        store.save(self.name, self.fingerprint(), numbers, log)

    def _config(self) -> Config:
        """The configuration, with the method and the noise of the experiment."""
        what = self.experiment
        config = variant(self.configuration, what.setup.method)
        return with_noise(config, what.noise, what.dropout) if what.noise or what.dropout else config


@dataclass(frozen=True)
class Comparing:
    """One comparison of the compiled controller with the reference.

    Attributes:
        agreement: which controller, where.
        configuration: YAML file.
        library: folder of the compiled controller.
        duration: [s].
    """

    agreement: Agreement
    configuration: Path
    library: Path
    duration: float

    @property
    def name(self) -> str:
        """Of its record."""
        return self.agreement.name

    @property
    def cost(self) -> float:
        """About how long it takes."""
        return 2.5 * self.duration

    def fingerprint(self) -> str:
        """Digest of everything that its result depends on."""
        config = variant(self.configuration, self.agreement.setup.method)
        scene = load_scene(self.agreement.scene, beside=self.configuration)
        parts = [self.agreement.sensing, self.duration]
        return digest([sources(), config_hash(config), scene.model_dump(mode="json"), parts])

    def carry_out(self, store: Store) -> None:
        """Compare, and keep the greatest differences and the verdict."""
        from proxgen.compare import compare

        what = self.agreement
        comparison = compare(
            variant(self.configuration, what.setup.method),
            [load_scene(what.scene, beside=self.configuration)],
            sensing=what.sensing,
            duration=self.duration,
            candidate=open_controller(self.library),
        )
        (numbers,) = comparison.to_json()["scenes"]
        verdict = {"verdict": comparison.verdict, "failures": list(comparison.failures[:5])}
        own = {"setup": what.setup.name, "sensing": what.sensing}
        store.save(self.name, self.fingerprint(), own | numbers | verdict)


Libraries = dict[Setup, Path]
"""Folder of each setup's compiled controller."""


def tasks_of(plan: Plan, libraries: Libraries) -> list[Task]:
    """Everything that a plan does, in its order."""
    runs = [
        Rollout(
            what,
            plan.configurations[what.setup.configuration],
            libraries[what.setup],
            start,
            plan.duration,
        )
        for what in plan.experiments
        for start in plan.starts
    ]
    comparisons = [
        Comparing(
            what,
            plan.configurations[what.setup.configuration],
            libraries[what.setup],
            plan.agreement_duration,
        )
        for what in plan.agreements
    ]
    return [*runs, *comparisons]


def build_libraries(
    plan: Plan, folder: Path, progress: Callable[[int, int], None] | None = None
) -> Libraries:
    """Build the controller of every setup, each in a folder of its own, unless it is up to date.

    Args:
        plan: what is needed.
        folder: for the builds, such as `build`.
        progress: called after each with the number done and of all.

    Raises:
        BuildError: compiler or solver missing, or the compiler refuses.
        ConfigError: a configuration that cannot be used.
    """
    from proxgen.builder import build

    libraries: Libraries = {}
    for setup in plan.setups:
        config = variant(plan.configurations[setup.configuration], setup.method)
        libraries[setup] = build(config, folder / variant_name(config)).library_dir
        if progress:
            progress(len(libraries), len(plan.setups))
    return libraries


def open_controller(library: Path) -> "Controller":
    """The compiled controller in a folder."""
    from proxgen.controllers.compiled import CompiledController

    return CompiledController.load(library)


@cache
def variant(path: Path, method: str) -> Config:
    """A configuration with a method; loaded once per process."""
    return with_method(load(path), method)


@cache
def sources() -> str:
    """Digest of all of proxgen that a result depends on, the compiled runtime included."""
    rooms: list[Path] = [path for room in _ROOMS for path in sorted((PACKAGE / room).rglob("*.py"))]
    own: Sequence[Path] = [Path(__file__).with_name(name) for name in _OWN]
    solvers = [*runtime_units("daqp"), *runtime_units("qpoases")]
    return digest_files([*generator_files(), *rooms, *own, *solvers, *runtime_headers()])
