"""Rules by which claims are judged: plain data that says itself what it asks, and what was measured."""

import operator
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from proxgen.reproduce.results import Results, look_up
from proxgen.reproduce.units import mean_and_spread, unit_of

STATISTICS: dict[str, Callable[[list[float]], float]] = {
    "mean": lambda values: float(np.mean(values)),
    "least": min,
    "greatest": max,
    "sum": sum,
}

_RELATIONS: dict[str, tuple[str, Callable[[float, float], bool]]] = {
    ">=": ("≥", operator.ge),
    "<=": ("≤", operator.le),
    ">": (">", operator.gt),
    "<": ("<", operator.lt),
    "==": ("=", operator.eq),
}


@dataclass(frozen=True)
class Part:
    """One condition of a rule: what is asked, what was measured, whether it holds (None: nobody can say)."""

    words: str
    measured: str
    holds: bool | None


@dataclass(frozen=True)
class Judgement:
    """What a rule says of the data.

    Attributes:
        holds: None if there is nothing to judge by.
        parts: its conditions.
    """

    holds: bool | None
    parts: tuple[Part, ...]


class Rule(Protocol):
    """Something that is to hold."""

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
    def where(self) -> str:
        """Which experiments."""
        return self.label or ", ".join(name.replace("_", " ") for name in self.experiments)

    @property
    def what(self) -> str:
        """Which number."""
        over = {"mean": "mean", "sum": "all runs", "least": "least of all runs"}
        return f"{unit_of(self.key).words}, {over.get(self.statistic, 'greatest of all runs')}"

    def values(self, results: Results) -> list[float]:
        """The number of every run that has it."""
        found = [look_up(run, self.key) for name in self.experiments for run in results.numbers[name]]
        return [float(value) for value in found if value is not None]

    def value(self, results: Results) -> float | None:
        """The statistic; None if no run has the number."""
        values = self.values(results)
        return STATISTICS[self.statistic](values) if values else None

    def written(self, results: Results) -> str:
        """The statistic; a mean with its spread."""
        values, unit = self.values(results), unit_of(self.key)
        if not values:
            return "–"
        if self.statistic == "mean" and len(values) > 1:
            return f"{mean_and_spread(values, unit)} {unit.unit}".rstrip()
        single = replace(unit, digits=0) if unit.whole and self.statistic != "mean" else unit
        return single.write(STATISTICS[self.statistic](values))


@dataclass(frozen=True)
class Compare:
    """A quantity against a number, or against another quantity, perhaps times a factor."""

    left: Quantity
    relation: str
    right: Quantity | float
    factor: float = 1.0

    @property
    def words(self) -> str:
        """What is asked."""
        sign, left = _RELATIONS[self.relation][0], self.left
        if not isinstance(self.right, Quantity):
            unit = unit_of(left.key)
            return f"{left.where}: {left.what} {sign} {unit.scale * self.right:g} {unit.unit}".rstrip()
        times = "" if self.factor == 1.0 else f"{self.factor:g} × "
        if left.what == self.right.what:
            return f"{left.what}: {left.where} {sign} {times}{self.right.where}"
        return f"{left.where}: {left.what} {sign} {times}{self.right.what}"

    def judge(self, results: Results) -> Judgement:
        """Whether it holds."""
        left, written = self.left.value(results), self.left.written(results)
        right: float | None
        if isinstance(self.right, Quantity):
            right, written = self.right.value(results), f"{written}, against {self.right.written(results)}"
        else:
            right = self.right
        known = left is not None and right is not None
        holds = bool(_RELATIONS[self.relation][1](left, self.factor * right)) if known else None  # type: ignore[arg-type, operator]
        return Judgement(holds, (Part(self.words, written, holds),))


@dataclass(frozen=True)
class All:
    """Several rules that all have to hold."""

    rules: tuple[Rule, ...]

    def judge(self, results: Results) -> Judgement:
        """False if one does not hold, None if one cannot be judged, else True."""
        judged = [rule.judge(results) for rule in self.rules]
        verdicts = [one.holds for one in judged]
        holds = False if False in verdicts else None if None in verdicts else True
        return Judgement(holds, tuple(part for one in judged for part in one.parts))


@dataclass(frozen=True)
class Either:
    """Rules of which one has to hold."""

    rules: tuple[Rule, ...]

    def judge(self, results: Results) -> Judgement:
        """True if one holds, None if none does and one cannot be judged, else False."""
        judged = [rule.judge(results) for rule in self.rules]
        verdicts = [one.holds for one in judged]
        holds = True if True in verdicts else None if None in verdicts else False
        parts = []
        for index, one in enumerate(judged):
            for number, part in enumerate(one.parts):
                joint = "" if index == 0 else "and " if number else "or "
                needed = one.holds is True or holds is not True
                parts.append(replace(part, words=joint + part.words, holds=part.holds if needed else None))
        return Judgement(holds, tuple(parts))


@dataclass(frozen=True)
class Agreed:
    """Compiled controller and reference decide the same, in every comparison of the plan."""

    words: str = "every comparison of compiled controller and reference within its tolerances (1e-8 rad/s)"

    def judge(self, results: Results) -> Judgement:
        """Whether all pass."""
        passed = sum(one["verdict"] == "pass" for one in results.agreements)
        greatest = max((one["max_abs_qdot_error"] for one in results.agreements), default=0.0)
        measured = f"{passed} of {len(results.agreements)}, greatest difference {greatest:.1e} rad/s"
        holds = passed == len(results.agreements) if results.agreements else None
        return Judgement(holds, (Part(self.words, measured, holds),))


PAPER_TIMES = {"proposed": 7800.0, "repulsive": 4200.0}
"""Mean cycle times of the paper (section V.B) [us]."""


@dataclass(frozen=True)
class CycleTimes:
    """Mean cycle times of two methods that take turns on an otherwise idle machine.

    Attributes:
        way: `c` or `python`: from where the compiled controllers are called.
        longer: True: the proposed method takes longer; False: both take at most what they did in the paper.
    """

    way: str
    longer: bool

    @property
    def words(self) -> str:
        """What is asked."""
        asked = "proposed > repulsive" if self.longer else "proposed ≤ 7.8 ms and repulsive ≤ 4.2 ms"
        return f"mean cycle time, called from {'C' if self.way == 'c' else 'Python'}: {asked}"

    def judge(self, results: Results) -> Judgement:
        """Whether it holds."""
        times = {method: results.cycle_times[method][self.way] for method in PAPER_TIMES}
        proposed, repulsive = (times[method]["mean_us"] for method in PAPER_TIMES)
        measured = f"{proposed:.2f} and {repulsive:.2f} µs, ratio {proposed / repulsive:.2f} (paper: 1.86)"
        within = all(times[method]["mean_us"] <= limit for method, limit in PAPER_TIMES.items())
        holds = proposed > repulsive if self.longer else within
        return Judgement(holds, (Part(self.words, measured, holds),))


@dataclass(frozen=True)
class InTime:
    """The whole call takes no longer than the plan allows."""

    def judge(self, results: Results) -> Judgement:
        """Only a call that did everything itself can be judged."""
        limit, minutes = results.plan.limit_minutes, results.minutes
        words = f"builds, runs and this page take ≤ {limit:g} minutes on two cores"
        if minutes is None:
            return Judgement(None, (Part(words, "results of an earlier call were used", None),))
        holds = minutes <= limit
        return Judgement(holds, (Part(words, f"{minutes:.1f} minutes", holds),))
