"""Numbers as text: the summary of runs, and a comparison's errors against its tolerances."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from proxgen.report.derive import label, microseconds
from proxgen.simulation.log import RolloutLog


@dataclass(frozen=True)
class Row:
    """A row of a table.

    Attributes:
        title: what it says.
        key: where the number stands in the JSON file.
        cells: one text per column.
        good: per column: True or False where the number is as it must be or not, None where nothing is asked.
    """

    title: str
    key: str
    cells: list[str]
    good: list[bool | None]


@dataclass(frozen=True)
class ClaimRow:
    """A claim beside the conditions under which it holds.

    Attributes:
        title: what is claimed.
        place: where.
        parts: conditions: what is asked, what was measured, whether it is so (None: nobody can say).
        verdict: in a word or two.
        good: the same as True, False or None.
    """

    title: str
    place: str
    parts: list[tuple[str, str, bool | None]]
    verdict: str
    good: bool | None


@dataclass(frozen=True)
class Card:
    """The few numbers of a run that one looks at first: pairs of number and meaning."""

    title: str
    numbers: list[tuple[str, str]]


def number(value: Any, unit: str = "", digits: int = 3) -> str:
    """A number with its unit, short; a dash where there is none."""
    if value is None:
        return "–"
    if isinstance(value, str):
        return value
    text = f"{value:d}" if isinstance(value, int) else f"{value:.{digits}g}"
    return f"{text} {unit}" if unit else text


def millimetres(value: float | None) -> str:
    """A distance in metres with millimetre digits."""
    return "–" if value is None else f"{value:.3f} m"


def percent(value: float) -> str:
    """A fraction as percentage."""
    return f"{100.0 * value:.1f} %"


def _is_zero(value: Any) -> bool:
    return bool(value == 0)


_SUMMARY: tuple[tuple[str, str, Callable[[Any], str], Callable[[Any], bool] | None], ...] = (
    ("Controller", "controller", number, None),
    ("Back end", "backend", number, None),
    ("Sensing", "sensing", number, None),
    ("Seed", "seed", number, None),
    ("Duration", "duration_s", lambda v: f"{v:g} s", None),
    ("Cycles", "cycles", number, None),
    ("Targets reached", "targets_reached", number, None),
    ("Least distance, obstacle to a link's axis", "min_distance_axis_m", millimetres, None),
    ("Least distance, obstacle to a link's surface", "min_distance_surface_m", millimetres, None),
    ("Time with some link below d_r", "time_below_dr_fraction", percent, None),
    ("Cycles with penetration", "penetration_samples", number, _is_zero),
    ("Mean change of the command per cycle", "mean_abs_dqdot", lambda v: number(v, "rad/s"), None),
    ("Greatest change of the command per cycle", "max_abs_dqdot", lambda v: number(v, "rad/s"), None),
    ("Cycles in which the solver failed", "solver_failures", number, _is_zero),
    ("Cycles outside the joint limits", "limit_violations", number, _is_zero),
    ("Cycle time, median", "cycle_us.p50", microseconds, None),
    ("Cycle time, 99 %", "cycle_us.p99", microseconds, None),
    ("Cycle time, 99.9 %", "cycle_us.p999", microseconds, None),
    ("Cycle time, greatest", "cycle_us.max", microseconds, None),
)


def summary_table(logs: Sequence[RolloutLog]) -> list[Row]:
    """The numbers of `proxgen run --json`, one column per run."""
    summaries = [log.summary() for log in logs]
    rows = []
    for title, key, show, check in _SUMMARY:
        values = [_look_up(summary, key) for summary in summaries]
        good = [None if check is None else check(value) for value in values]
        rows.append(Row(title, key, [show(value) for value in values], good))
    statuses = sorted({name for summary in summaries for name in summary["status_counts"]})
    for name in statuses:
        counts = [summary["status_counts"].get(name, 0) for summary in summaries]
        rows.append(
            Row(
                f"Cycles {name}",
                f"status_counts.{name}",
                [str(count) for count in counts],
                [None] * len(logs),
            )
        )
    return rows


def cards(logs: Sequence[RolloutLog]) -> list[Card]:
    """What one looks at first, per run."""
    return [_card(log) for log in logs]


def _card(log: RolloutLog) -> Card:
    summary = log.summary()
    return Card(
        label(log),
        [
            (str(summary["targets_reached"]), f"targets reached in {summary['duration_s']:g} s"),
            (millimetres(summary["min_distance_axis_m"]), "least distance to a link's axis"),
            (percent(summary["time_below_dr_fraction"]), "of the time some link below d_r"),
            (str(summary["solver_failures"]), "solver failures"),
            (str(summary["penetration_samples"]), "cycles with penetration"),
            (microseconds(summary["cycle_us"]["p50"]), "median cycle time, through Python"),
        ],
    )


def _look_up(summary: dict[str, Any], key: str) -> Any:
    """The value at a dotted key."""
    value: Any = summary
    for part in key.split("."):
        value = value[part]
    return value
