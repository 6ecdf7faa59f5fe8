"""What a comparison of the two controllers found: errors against tolerances as figure, table, sentence."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from proxgen.compare import Comparison
from proxgen.report import style
from proxgen.report.page import Verdict
from proxgen.report.tables import Row

TITLE = "Errors of every cycle against their tolerances"
CAPTION = (
    "Left: the greatest difference between the compiled controller and the reference per quantity, one mark "
    "per scene, and the tolerance as a bar: all marks must lie to the left of theirs. Right: the difference "
    "of the velocity in every cycle; at the lower edge both agree to the last bit."
)
_LEAST = 1e-18
"""What is smaller is drawn here: a logarithmic axis has no zero."""

_QUANTITIES = (
    ("qdot", "velocity q̇", "rad/s"),
    ("slack", "slack", "m/s"),
    ("H", "H", ""),
    ("g", "g", ""),
    ("A", "A", ""),
    ("ubA", "ubA", "m/s"),
    ("lb", "lb", "rad/s"),
    ("ub", "ub", "rad/s"),
    ("distance", "distances", "m"),
    ("kkt_residual", "KKT residual", ""),
    ("bound_penetration", "outside the bounds", "rad/s"),
)
_MARKERS = "osD^vPX"


def agreement_figure(comparison: Comparison) -> Figure:
    """Greatest errors per quantity beside their tolerances, and the velocity's error over time."""
    figure = style.new_figure(4.5)
    greatest, course = figure.subplots(1, 2, width_ratios=[1.0, 1.15])
    handles = []
    places = np.arange(len(_QUANTITIES))[::-1]
    for index, scene in enumerate(comparison.scenes):
        look: dict[str, Any] = {
            "color": style.SERIES[index % len(style.SERIES)],
            "marker": _MARKERS[index % len(_MARKERS)],
        }
        values = [max(min(scene.greatest(name), 1e3), _LEAST) for name, _, _ in _QUANTITIES]
        lift = 0.25 - 0.5 * (index + 0.5) / len(comparison.scenes)
        greatest.plot(values, places + lift, linestyle="none", markersize=5.5, alpha=0.85, **look)
        error = np.clip(scene.errors["qdot"], _LEAST, 1e3)
        course.plot(scene.time, error, linestyle="none", markersize=2.0, alpha=0.6, **look)
        handles.append(Line2D([], [], linestyle="none", markersize=5.5, label=scene.scene, **look))
    for (name, _, _), place in zip(_QUANTITIES, places, strict=True):
        tolerance = comparison.tolerances.of(name)
        greatest.plot(
            [tolerance, tolerance], [place - 0.36, place + 0.36], color=style.VERMILLION, linewidth=2.0
        )
    greatest.set_yticks(places, [f"{title} [{unit}]" if unit else title for _, title, unit in _QUANTITIES])
    greatest.set_title("Greatest error")
    greatest.set_xlabel("|compiled − reference|")
    course.axhline(comparison.tolerances.qdot, color=style.VERMILLION, linewidth=1.2)
    course.set_title("Velocity, every cycle")
    course.set_xlabel("time [s]")
    course.set_ylabel("max |Δq̇| [rad/s]")
    greatest.set_xscale("log")
    course.set_yscale("log")
    tolerance_line = Line2D([], [], color=style.VERMILLION, linewidth=2.0, label="tolerance")
    figure.legend(handles=[*handles, tolerance_line], loc="outside lower center", ncols=len(handles) + 1)
    return figure


def agreement_table(comparison: Comparison) -> list[Row]:
    """The numbers of `proxgen compare --json`, one column per scene, each held against its tolerance."""
    tolerances = comparison.tolerances
    limits: tuple[tuple[str, str, str, float], ...] = (
        ("Greatest difference of the velocity", "max_abs_qdot_error", "rad/s", tolerances.of("qdot")),
        ("Greatest difference of H", "max_abs_H_error", "", tolerances.of("H")),
        ("Greatest difference of A", "max_abs_A_error", "", tolerances.of("A")),
        ("Greatest KKT residual", "max_kkt_residual", "", tolerances.of("kkt_residual")),
    )
    scenes = [scene.to_json() for scene in comparison.scenes]
    rows = [Row("Cycles", "cycles", [f"{scene['cycles']}" for scene in scenes], [None] * len(scenes))]
    for title, key, unit, limit in limits:
        cells = [f"{scene[key]:.2g} {unit}".strip() for scene in scenes]
        good: list[bool | None] = [scene[key] <= limit for scene in scenes]
        rows.append(Row(f"{title} (at most {limit:g})", key, cells, good))
    mismatches = [scene["status_mismatches"] for scene in scenes]
    rows.append(
        Row(
            "Cycles with different statuses (none allowed)",
            "status_mismatches",
            [str(count) for count in mismatches],
            [count == 0 for count in mismatches],
        )
    )
    return rows


def verdict(comparison: Comparison) -> Verdict:
    """The comparison in one sentence."""
    cycles = sum(scene.cycles for scene in comparison.scenes)
    names = ", ".join(scene.scene for scene in comparison.scenes)
    if comparison.verdict == "pass":
        worst = max(scene.greatest("qdot") for scene in comparison.scenes)
        agree = f"The compiled controller and the reference agree in all {cycles} cycles ({names})"
        return Verdict(True, f"{agree}: velocities to {worst:.1g} rad/s, and every status.")
    findings = sum(scene.findings for scene in comparison.scenes)
    return Verdict(False, f"{findings} findings in {cycles} cycles ({names}): the two controllers differ.")
