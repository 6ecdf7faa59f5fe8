"""What the numbers did: singularity measures and certificate over time, and how long the cycles took."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from proxgen.report import style
from proxgen.report.derive import label, microseconds, time_span
from proxgen.simulation.log import RolloutLog

_LEAST = 1e-18
"""What is smaller is drawn here: a logarithmic axis has no zero."""
_PERCENTILES = ((50.0, "p50"), (99.0, "p99"), (99.9, "p99.9"))

NUMERICS_TITLE = "Singularity and certificate"
NUMERICS_CAPTION = (
    "The manipulability vanishes in a singular configuration; the damping then rises from its floor. The "
    "certificate recomputes stationarity, feasibility and complementarity of every solved problem."
)
TIMING_TITLE = "Distribution of the cycle times"
TIMING_CAPTION = (
    "Wall time of one call of step() from Python, logarithmic in both directions; lines at three percentiles."
)


def numerics_figure(log: RolloutLog, tolerance: float | None = None) -> Figure:
    """Manipulability (14), damping (15) and the certificate's residual, over time.

    Args:
        log: the run.
        tolerance: greatest residual that is certified; drawn if given.
    """
    figure = style.new_figure(4.6)
    panels = figure.subplots(3, 1, sharex=True)
    rows = (
        ("Manipulability w (14)", np.maximum(log.manipulability, 1e-6), style.BLUE, "w"),
        ("Damping λ (15)", log.damping, style.ORANGE, "λ"),
        ("Residual of the optimality conditions (certificate)", log.kkt_residual, style.GREEN, "residual"),
    )
    for axes, (title, values, colour, name) in zip(panels, rows, strict=True):
        axes.semilogy(log.time, np.maximum(values, _LEAST), color=colour)
        axes.set_title(title)
        axes.set_ylabel(name)
        axes.set_xlim(time_span(log))
    if tolerance is not None:
        panels[2].axhline(tolerance, color=style.VERMILLION, linewidth=0.9, linestyle=(0, (4, 3)))
        panels[2].annotate(
            f"tolerance {tolerance:g}", (0.995, tolerance), (0, -3), va="top", ha="right", fontsize=8,
            xycoords=("axes fraction", "data"), textcoords="offset points",
        )  # fmt: skip
    panels[-1].set_xlabel("time [s]")
    figure.align_ylabels()
    return figure


def timing_figure(logs: Sequence[RolloutLog]) -> Figure:
    """Distribution of the cycle times on a logarithmic axis, one panel per run, with three percentiles."""
    figure = style.new_figure(0.7 + 1.9 * len(logs))
    panels = figure.subplots(len(logs), 1, sharex=True, squeeze=False)[:, 0]
    every = np.concatenate([log.cycle_us for log in logs])
    bins = np.geomspace(0.8 * every.min(), 2.0 * every.max(), 90).tolist()
    for axes, log in zip(panels, logs, strict=True):
        _draw_histogram(axes, log, bins)
    panels[-1].set_xlabel("time per cycle [µs]")
    return figure


def _draw_histogram(axes: Axes, log: RolloutLog, bins: list[float]) -> None:
    axes.hist(log.cycle_us, bins=bins, color=style.SKY, edgecolor=style.PAPER, linewidth=0.3)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(bottom=0.7)
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    top = axes.get_ylim()[1]
    axes.set_ylim(0.7, top**1.22)
    for level, (percent, name) in enumerate(_PERCENTILES):
        value = float(np.percentile(log.cycle_us, percent))
        axes.axvline(value, color=style.VERMILLION, linewidth=1.0)
        axes.annotate(
            f"{name}  {microseconds(value)}", (value, 0.97 - 0.13 * level), (4, 0), va="top", fontsize=8.5,
            xycoords=("data", "axes fraction"), textcoords="offset points",
            bbox={"facecolor": style.PAPER, "edgecolor": "none", "pad": 1.0},
        )  # fmt: skip
    axes.set_ylabel("cycles")
    axes.set_title(label(log))
