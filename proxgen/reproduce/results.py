"""What came out: numbers of every experiment over its starts, and the logs behind them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from proxgen.reproduce.plan import Plan
from proxgen.reproduce.store import Numbers, Store
from proxgen.simulation.log import RolloutLog


@dataclass(frozen=True)
class Results:
    """All numbers of a plan.

    Attributes:
        plan: what was run.
        store: where the logs are.
        numbers: per experiment one entry per start, in the order of the plan: the keys of
            `RolloutLog.summary` and of `derived_numbers`.
        agreements: one entry per comparison: setup, scene, sensing, verdict, failures, and the keys of
            `proxgen compare --json`.
        cycle_times: of the timing (`timing.py`).
        minutes: how long it took; None if results of an earlier call were used.
        films: some experiments' first runs (WebP).
    """

    plan: Plan
    store: Store
    numbers: Mapping[str, Sequence[Numbers]]
    agreements: Sequence[Numbers]
    cycle_times: Numbers
    minutes: float | None = None
    films: Mapping[str, bytes] = field(default_factory=dict, repr=False)
    _logs: dict[str, list[RolloutLog]] = field(default_factory=dict, repr=False)

    def logs(self, experiment: str) -> list[RolloutLog]:
        """The logs of an experiment, one per start; read once.

        Raises:
            SimulationError: one cannot be read any more.
        """
        if experiment not in self._logs:
            names = [f"{experiment}-{start}" for start in self.plan.starts]
            self._logs[experiment] = [self.store.log(name) for name in names]
        return self._logs[experiment]


def look_up(numbers: Numbers, key: str) -> Any:
    """The value at a dotted key, such as `cycle_us.p50`."""
    value: Any = numbers
    for part in key.split("."):
        value = value[part]
    return value
