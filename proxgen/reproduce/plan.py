"""What is run, as plain data: setups, experiments, starts, comparisons."""

from dataclasses import dataclass
from pathlib import Path

from proxgen.config.examples import examples_directory

IIWA7 = examples_directory() / "iiwa7"

CONFIGURATIONS = {
    "paper": IIWA7 / "iiwa7.yaml",
    "improved": IIWA7 / "iiwa7_improved.yaml",
    "dense": IIWA7 / "iiwa7_dense.yaml",
}
"""The configurations that experiments name."""

METHODS = ("proposed", "repulsive", "tangential")
SCENES = ("pillar", "gap", "facing", "moving")
NOISE, DROPOUT = 0.005, 0.05
"""Of every sensor in the experiments with noise: standard deviation [m], probability of a lost sample."""

FILMED = ("pillar_proposed", "gap_proposed", "moving_dynamic")
"""One for each part of the paper's section V."""


@dataclass(frozen=True)
class Setup:
    """A controller under test.

    Attributes:
        configuration: a name in `Plan.configurations`.
        method: `avoidance.method`.
    """

    configuration: str = "paper"
    method: str = "proposed"

    @property
    def name(self) -> str:
        """Both in one word."""
        return self.configuration if self.method == "proposed" else f"{self.configuration}-{self.method}"


@dataclass(frozen=True)
class Experiment:
    """A setup in a scene, repeated over all starts of the plan.

    Attributes:
        name: key of its results.
        title: in a few words, for tables.
        scene: name of the scene.
        setup: what moves the arm.
        sensing: `skin` or `ideal` (true distances).
        plant: `kinematic`, or `dynamic` behind the model of the cabinet.
        noise: standard deviation of range readings [m].
        dropout: probability that a sample of any sensor is lost.
    """

    name: str
    title: str
    scene: str
    setup: Setup = Setup()
    sensing: str = "skin"
    plant: str = "kinematic"
    noise: float = 0.0
    dropout: float = 0.0


@dataclass(frozen=True)
class Agreement:
    """A comparison of the compiled controller with the reference, in the closed loop of one scene."""

    setup: Setup
    scene: str
    sensing: str

    @property
    def name(self) -> str:
        """Key of its result."""
        return f"agreement-{self.setup.name}-{self.scene}-{self.sensing}"


@dataclass(frozen=True)
class Plan:
    """Everything that one call of `proxgen reproduce` does.

    Attributes:
        name: `full` or `quick`, for the page.
        configurations: YAML file of each configuration.
        experiments: each is run from every start.
        starts: seeds of the perturbations; the same ones for all experiments.
        duration: of a run [s].
        agreements: comparisons of the two controllers.
        agreement_duration: of each of them [s].
        timed_passes: how often the recorded cycles are replayed to time a controller.
        limit_minutes: what the whole is to take at most on two cores.
        films: experiments of which the page has a film, each of the first start.
    """

    name: str
    configurations: dict[str, Path]
    experiments: tuple[Experiment, ...]
    starts: tuple[int, ...]
    duration: float
    agreements: tuple[Agreement, ...]
    agreement_duration: float
    timed_passes: int
    limit_minutes: float
    films: tuple[str, ...] = FILMED

    @property
    def setups(self) -> tuple[Setup, ...]:
        """Every controller that is needed, once."""
        run = [experiment.setup for experiment in self.experiments]
        compared = [agreement.setup for agreement in self.agreements]
        return tuple(dict.fromkeys([*run, *compared]))

    def experiment(self, name: str) -> Experiment:
        """The experiment with a name."""
        return next(experiment for experiment in self.experiments if experiment.name == name)


IMPROVED = Setup("improved")
DENSE = Setup("dense")

EXPERIMENTS = (
    # V.B function verification and V.C comparison: figures 6, 7, 9, 10; 11, 12, 13
    *(Experiment(f"{scene}_{method}", method, scene, Setup(method=method))
      for scene in ("pillar", "gap") for method in METHODS),
    # V.D dynamic obstacles: figures 8, 14, 15
    Experiment("moving_kinematic", "kinematic plant", "moving"),
    Experiment("moving_dynamic", "behind the cabinet", "moving", plant="dynamic"),
    # the paper's configuration with true distances: what better sensors alone would do
    *(Experiment(f"true_{scene}", f"paper, {scene}", scene, sensing="ideal") for scene in SCENES),
    # what the cabinet alone does: no blind spots of the skin beside it
    *(Experiment(f"cabinet_{scene}", f"paper, {scene}, behind the cabinet", scene, sensing="ideal",
                 plant="dynamic")
      for scene in ("pillar", "moving")),
    # beyond the paper
    *(Experiment(f"improved_{scene}", f"improved, {scene}", scene, IMPROVED, "ideal") for scene in SCENES),
    Experiment("dense_moving", "improved and denser", "moving", DENSE),
    *(Experiment(f"noise_{method}", method, "gap", Setup(method=method), noise=NOISE, dropout=DROPOUT)
      for method in METHODS),
)  # fmt: skip
"""All experiments, in the order of the page."""

SETUPS = (*(Setup(method=method) for method in METHODS), IMPROVED, DENSE)


def _agreements(sensings: tuple[str, ...]) -> tuple[Agreement, ...]:
    """Every setup in every scene."""
    return tuple(
        Agreement(setup, scene, sensing) for setup in SETUPS for scene in SCENES for sensing in sensings
    )


def full_plan() -> Plan:
    """Eight starts of 60 s, and all comparisons of 60 s."""
    return Plan(
        "full", CONFIGURATIONS, EXPERIMENTS, tuple(range(1, 9)), 60.0, _agreements(("skin", "ideal")), 60.0,
        timed_passes=5, limit_minutes=25.0,
    )  # fmt: skip


def quick_plan() -> Plan:
    """Two of the starts, still 60 s, so that claims can be judged; short comparisons; one film."""
    return Plan(
        "quick", CONFIGURATIONS, EXPERIMENTS, (1, 2), 60.0, _agreements(("skin",)), 10.0,
        timed_passes=2, limit_minutes=4.0, films=("gap_proposed",),
    )  # fmt: skip
