"""Rules by which claims are judged: plain data that says itself what it asks, and what was measured."""

import operator
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from proxgen.reproduce.results import Results, look_up


@dataclass(frozen=True)
class Unit:
    """How a number is written: what it is in words, scale to the unit, unit, digits behind the point.

    Attributes:
        words: what it is.
        scale: from SI.
        unit: behind it.
        digits: behind the point.
        whole: single values are whole numbers, and only their mean has digits.
    """

    words: str
    scale: float = 1.0
    unit: str = ""
    digits: int = 1
    whole: bool = False

    def write(self, value: float) -> str:
        """A value with its unit."""
        return f"{self.bare(value)} {self.unit}".rstrip()

    def bare(self, value: float) -> str:
        """A value without its unit."""
        text = f"{self.scale * value:.{self.digits}f}"
        return text.lstrip("-") if float(text) == 0.0 else text


UNITS = {
    "targets_reached": Unit("targets reached", whole=True),
    "min_distance_axis_m": Unit("least distance to a link's axis", 1.0, "m", 3),
    "min_distance_surface_m": Unit("least distance to a link's surface", 1.0, "m", 3),
    "time_below_dr_fraction": Unit("time with a link below d_r", 100.0, "%", 2),
    "time_below_d0l_fraction": Unit("time with a link below d_0l", 100.0, "%", 1),
    "link_below_dr_fraction": Unit("time below d_r of the link", 100.0, "%", 2),
    "penetration_samples": Unit("cycles with penetration", digits=0),
    "limit_violations": Unit("cycles outside the joint limits", digits=0),
    "solver_failures": Unit("solver failures", digits=0),
    "mean_abs_dqdot": Unit("mean change of the command", 1e3, "mrad/s", 1),
    "max_abs_dqdot": Unit("greatest change of the command", 1.0, "rad/s", 3),
    "mean_abs_dqdot_seen": Unit("mean change of the command with an obstacle in view", 1e3, "mrad/s", 1),
    "mean_abs_dqdot_clear": Unit("the same with none in view", 1e3, "mrad/s", 1),
    "mean_abs_joint_jump": Unit("mean change of the joints' velocity", 1e3, "mrad/s", 2),
    "sudden_obstacles": Unit("obstacles first seen nearer than d_0u", whole=True),
    "start_manipulability": Unit("manipulability at the start", 1e3, "·10⁻³", 3),
    "escape_time_s": Unit("time to leave the singularity", 1.0, "s", 2),
    "path_per_straight": Unit("tool's path per straight way", digits=2),
    "deflection_m": Unit("greatest deflection of the tool", 1.0, "m", 2),
    "passes_between": Unit("passes between the boxes", whole=True),
    "last_motion_m": Unit("tool's path in the last 10 s", 1.0, "m", 2),
    "mean_us": Unit("mean cycle time", 1.0, "µs", 1),
}
"""By key; a key below it, such as `link_below_dr_fraction.hand`, has the same."""

STATISTICS: dict[str, Callable[[list[float]], float]] = {
    "mean": lambda values: float(np.mean(values)),
    "least": min,
    "greatest": max,
    "sum": sum,
}

_RELATIONS: dict[str, tuple[str, Callable[[float, float], bool]]] = {
    ">=": ("at least", operator.ge),
    "<=": ("at most", operator.le),
    ">": ("more than", operator.gt),
    "<": ("less than", operator.lt),
    "==": ("exactly", operator.eq),
}


def unit_of(key: str) -> Unit:
    """How the number at a key is written."""
    first, _, rest = key.partition(".")
    unit = UNITS[first]
    return replace(unit, words=f"{unit.words} {rest}") if rest else unit


@dataclass(frozen=True)
class Judgement:
    """What a rule says of the data.

    Attributes:
        holds: None if there is nothing to judge by.
        measured: in words.
    """

    holds: bool | None
    measured: str


class Rule(Protocol):
    """Something that is to hold."""

    @property
    def words(self) -> str:
        """What is asked, as a sentence."""

    def judge(self, results: Results) -> Judgement:
        """Whether it holds."""


@dataclass(frozen=True)
class Quantity:
    """One number from all runs of one or more experiments.

    Attributes:
        experiments: their names.
        key: of the number, in each run.
        statistic: over all these runs: mean, least, greatest, sum.
        label: stands for the names of the experiments.
    """

    experiments: tuple[str, ...]
    key: str
    statistic: str = "mean"
    label: str = ""

    @property
    def words(self) -> str:
        """Which number it is."""
        where = self.label or ", ".join(name.replace("_", " ") for name in self.experiments)
        return f"{where}: {self.statistic} {unit_of(self.key).words}"

    def values(self, results: Results) -> list[float]:
        """The number of every run that has it."""
        found = [look_up(run, self.key) for name in self.experiments for run in results.numbers[name]]
        return [float(value) for value in found if value is not None]

    def value(self, results: Results) -> float | None:
        """The statistic; None if no run has the number."""
        values = self.values(results)
        return STATISTICS[self.statistic](values) if values else None

    def written(self, results: Results) -> str:
        """The statistic with its spread."""
        values, unit = self.values(results), unit_of(self.key)
        if not values:
            return "–"
        single = replace(unit, digits=0) if unit.whole and self.statistic != "mean" else unit
        text = single.write(STATISTICS[self.statistic](values))
        if self.statistic != "mean" or len(values) < 2:
            return text
        return f"{mean_and_spread(values, unit)} {unit.unit}".rstrip()


@dataclass(frozen=True)
class Compare:
    """A quantity against a number, or against another quantity."""

    left: Quantity
    relation: str
    right: "Quantity | float"
    factor: float = 1.0

    @property
    def words(self) -> str:
        """What is asked."""
        relation = _RELATIONS[self.relation][0]
        if isinstance(self.right, Quantity):
            part = "" if self.factor == 1.0 else f"{self.factor:g} times "
            return f"{self.left.words}, {relation} {part}that of {self._other()}"
        return f"{self.left.words} {relation} {unit_of(self.left.key).write(self.right)}"

    def _other(self) -> str:
        """The right side, in so far as it is another one."""
        assert isinstance(self.right, Quantity)
        where, _, what = self.right.words.partition(": ")
        return where if what == self.left.words.partition(": ")[2] else self.right.words

    def judge(self, results: Results) -> Judgement:
        """Whether it holds."""
        left, written = self.left.value(results), self.left.written(results)
        right: float | None
        if isinstance(self.right, Quantity):
            right, written = self.right.value(results), f"{written} against {self.right.written(results)}"
        else:
            right = self.right
        if left is None or right is None:
            return Judgement(None, written)
        return Judgement(bool(_RELATIONS[self.relation][1](left, self.factor * right)), written)


@dataclass(frozen=True)
class All:
    """Several rules that all have to hold."""

    rules: tuple[Rule, ...]

    @property
    def words(self) -> str:
        """What is asked."""
        return "; ".join(rule.words for rule in self.rules)

    def judge(self, results: Results) -> Judgement:
        """False if one does not hold, None if one cannot be judged, else True."""
        parts = [rule.judge(results) for rule in self.rules]
        verdicts = [part.holds for part in parts]
        holds = False if False in verdicts else None if None in verdicts else True
        return Judgement(holds, "; ".join(part.measured for part in parts))


@dataclass(frozen=True)
class Either:
    """Rules of which one has to hold."""

    rules: tuple[Rule, ...]

    @property
    def words(self) -> str:
        """What is asked."""
        return "; or ".join(rule.words for rule in self.rules)

    def judge(self, results: Results) -> Judgement:
        """True if one holds, None if none does and one cannot be judged, else False."""
        parts = [rule.judge(results) for rule in self.rules]
        verdicts = [part.holds for part in parts]
        holds = True if True in verdicts else None if None in verdicts else False
        return Judgement(holds, "; ".join(part.measured for part in parts))


@dataclass(frozen=True)
class Agreed:
    """Compiled controller and reference decide the same, in every comparison of the plan."""

    words: str = "every comparison of compiled controller and reference passes its tolerances (1e-8 rad/s)"

    def judge(self, results: Results) -> Judgement:
        """Whether all pass."""
        done = [one for one in results.agreements if "max_abs_qdot_error" in one]
        passed = sum(one["verdict"] == "pass" for one in done)
        greatest = max((one["max_abs_qdot_error"] for one in done), default=0.0)
        missing = len(results.agreements) - len(done)
        measured = f"{passed} of {len(results.agreements)} pass, greatest difference {greatest:.1e} rad/s"
        if missing:
            measured += f"; {missing} not compared: the compiled controller lacks the method or an addition"
        if passed < len(done):
            return Judgement(False, measured)
        return Judgement(None if missing or not done else True, measured)


@dataclass(frozen=True)
class CycleTimes:
    """Mean cycle times of the two methods, replayed one after the other on an otherwise idle machine.

    Attributes:
        way: `c` or `python`: from where the compiled controllers are called.
        longer: True: the proposed method takes longer; None: both are below the paper's times.
    """

    way: str
    longer: bool

    @property
    def words(self) -> str:
        """What is asked."""
        if self.longer:
            return f"mean cycle time of proposed more than that of repulsive (called from {self._caller})"
        return f"mean cycle times at most 7.8 and 4.2 ms (called from {self._caller})"

    @property
    def _caller(self) -> str:
        return {"c": "C", "python": "Python"}[self.way]

    def judge(self, results: Results) -> Judgement:
        """Whether it holds."""
        times = [results.cycle_times[method][self.way] for method in ("proposed", "repulsive")]
        if None in times:
            return Judgement(None, "no compiled controller for both methods")
        proposed, repulsive = (time["mean_us"] for time in times)
        measured = f"{proposed:.2f} and {repulsive:.2f} µs, ratio {proposed / repulsive:.2f}"
        if self.longer:
            return Judgement(proposed > repulsive, f"{measured} (paper: 1.86)")
        return Judgement(proposed <= 7800.0 and repulsive <= 4200.0, measured)


@dataclass(frozen=True)
class InTime:
    """The whole call takes no longer than the plan allows."""

    words: str = "from the first run to the page, at most 25 minutes on two cores (4 with --quick)"

    def judge(self, results: Results) -> Judgement:
        """Only a call that did everything itself can be judged."""
        if results.minutes is None:
            return Judgement(None, "results of an earlier call were used")
        return Judgement(
            results.minutes <= results.plan.limit_minutes,
            f"{results.minutes:.1f} minutes of {results.plan.limit_minutes:g}",
        )


def mean_and_spread(values: list[float], unit: Unit, *, with_range: bool = True) -> str:
    """`8.6 ± 0.7 (8 to 10)`: mean, standard deviation and range, without the unit."""
    text = unit.bare(float(np.mean(values)))
    if len(values) < 2:
        return text
    spread = f"{text} ± {unit.bare(float(np.std(values, ddof=1)))}"
    ends = replace(unit, digits=0) if unit.whole else unit
    return f"{spread} ({ends.bare(min(values))} to {ends.bare(max(values))})" if with_range else spread
