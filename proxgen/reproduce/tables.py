"""Tables of the page: claims with their verdicts, numbers over the starts, cycle times, agreement."""

from collections.abc import Sequence

from proxgen.report.tables import ClaimRow, Row, millimetres
from proxgen.reproduce.claims import Verdict
from proxgen.reproduce.plan import METHODS, SCENES
from proxgen.reproduce.results import Results, look_up
from proxgen.reproduce.rules import STATISTICS
from proxgen.reproduce.units import UNITS, mean_and_spread

_ROWS = (
    ("Targets reached", "targets_reached", "mean", None),
    ("Least distance to a link's axis", "min_distance_axis_m", "mean", None),
    ("the least of all starts", "min_distance_axis_m", "least", None),
    ("Time with some link below d_r", "time_below_dr_fraction", "mean", None),
    ("Time with some link below d_0l", "time_below_d0l_fraction", "mean", None),
    ("Cycles with penetration, all starts", "penetration_samples", "sum", 0.0),
    ("Tool's path per straight way", "path_per_straight", "mean", None),
    ("Mean change of the command per cycle", "mean_abs_dqdot", "mean", None),
    ("Greatest change of the command, all starts", "max_abs_dqdot", "greatest", None),
    ("Mean change of the joints' velocity per cycle", "mean_abs_joint_jump", "mean", None),
    ("Cycles with solver failure, all starts", "solver_failures", "sum", 0.0),
    ("Cycles outside the joint limits, all starts", "limit_violations", "sum", 0.0),
)
"""Title, key, statistic over the starts, and what it has to be."""


def claims_table(verdicts: Sequence[Verdict]) -> list[ClaimRow]:
    """A row per claim: where it stands, the conditions of its rule, what was measured, verdict."""
    return [
        ClaimRow(
            f"{number}. {verdict.claim.text}",
            verdict.claim.place,
            [(part.words, part.measured, part.holds) for part in verdict.judgement.parts],
            verdict.word,
            verdict.judgement.holds,
        )
        for number, verdict in enumerate(verdicts, start=1)
    ]


def experiments_table(results: Results, names: Sequence[str]) -> list[Row]:
    """The numbers of some experiments over all starts, one column each."""
    rows = []
    for title, key, statistic, wanted in _ROWS:
        unit, cells, good = UNITS[key], [], []
        for name in names:
            values = [float(v) for run in results.numbers[name] if (v := look_up(run, key)) is not None]
            value = STATISTICS[statistic](values) if values else None
            good.append(None if wanted is None or value is None else value == wanted)
            if value is None:
                cells.append("–")
            elif statistic == "mean":
                cells.append(f"{mean_and_spread(values, unit, with_range=False)} {unit.unit}".rstrip())
            else:
                cells.append(unit.write(value))
        rows.append(Row(title, key, cells, good))
    return rows


def times_table(results: Results) -> list[Row]:
    """Cycle times of two methods, beside those of the paper."""
    paper = {"proposed": "7.8 ms", "repulsive": "4.2 ms"}
    times = results.cycle_times
    rows = [Row("Paper: mean, MATLAB, i5-6300HQ", "", [paper.get(method, "–") for method in times], [])]
    for way, caller in (("c", "called from C"), ("python", "called from Python")):
        for key, title in (
            ("mean_us", "mean"),
            ("p50_us", "median"),
            ("p99_us", "99 %"),
            ("p999_us", "99.9 %"),
            ("max_us", "greatest"),
        ):
            found = [times[method][way] for method in times]
            cells = [f"{one[key]:.2f} µs" for one in found]
            rows.append(Row(f"{title}, {caller}", f"cycle_times.{way}.{key}", cells, []))
    return [Row(row.title, row.key, row.cells, [None] * len(row.cells)) for row in rows]


def agreement_table(results: Results) -> list[Row]:
    """Greatest difference of the velocity, per setup and scene."""
    rows = []
    pairs = dict.fromkeys((one["setup"], one["sensing"]) for one in results.agreements)
    for setup, sensing in pairs:
        cells, good = [], []
        for scene in SCENES:
            found = [
                one
                for one in results.agreements
                if (one["setup"], one["sensing"], one["scene"]) == (setup, sensing, scene)
            ]
            cells.append(f"{found[0]['max_abs_qdot_error']:.1e} rad/s" if found else "–")
            good.append(found[0]["verdict"] == "pass" if found else None)
        rows.append(Row(f"{setup}, {sensing}", "max_abs_qdot_error", cells, good))
    return rows


def headline(verdicts: Sequence[Verdict]) -> str:
    """How many claims hold, do not, and could not be judged."""
    words = [verdict.word for verdict in verdicts]
    parts = [f"{words.count('holds')} of {len(words)} hold"]
    others = {"does not hold": "do not", "not judged": "cannot be judged"}
    parts += [f"{words.count(word)} {text}" for word, text in others.items() if word in words]
    return ", ".join(parts)


def methods_targets(results: Results, scene: str) -> list[tuple[str, str]]:
    """Targets and least distance of each method in a scene, for a card."""
    numbers = []
    for method in METHODS:
        runs = results.numbers[f"{scene}_{method}"]
        targets = [float(run["targets_reached"]) for run in runs]
        text = mean_and_spread(targets, UNITS["targets_reached"], with_range=False)
        distances = [run["min_distance_axis_m"] for run in runs if run["min_distance_axis_m"] is not None]
        numbers.append((text, f"targets, {method}; least {millimetres(min(distances, default=None))}"))
    return numbers
