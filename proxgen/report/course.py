"""The course of a run over time: distance to the target, least distance to obstacles, status per cycle."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from proxgen.controllers.protocol import Status
from proxgen.report import style
from proxgen.report.derive import least_distance, status_spans, time_span, zones
from proxgen.simulation.log import RolloutLog

TITLE = "Course of the run"
CAPTION = (
    "Above: the distance to the present target falls until it is reached and swapped. Middle: true distance "
    "of the nearest link to any obstacle, over the zones of the approach law. Below: how each cycle was "
    "decided."
)


def course_figure(log: RolloutLog, tolerance: float | None = None) -> Figure:
    """Sawtooth, least distance and status, one above the other on one time axis.

    Args:
        log: the run.
        tolerance: below this distance a target is reached [m]; drawn if given.
    """
    figure = style.new_figure(5.6)
    sawtooth, nearest, strip = figure.subplots(3, 1, sharex=True, height_ratios=[1.25, 1.25, 0.22])
    draw_sawtooth(sawtooth, log, tolerance)
    draw_least_distance(nearest, log)
    style.legend_above(nearest, zone_legend(log))
    draw_status(strip, log)
    strip.set_xlabel("time [s]")
    strip.set_title("Status of every cycle", pad=5)
    figure.legend(
        handles=status_legend(log), loc="outside lower center", ncols=3, handlelength=1.2, handleheight=0.9
    )
    figure.align_ylabels([sawtooth, nearest])
    return figure


def draw_sawtooth(
    axes: Axes, log: RolloutLog, tolerance: float | None = None, colour: str = style.BLUE
) -> None:
    """Distance to the present target; every drop to the tolerance is a target reached."""
    axes.plot(log.time, log.target_distance, color=colour)
    reached = np.flatnonzero(np.diff(log.targets_reached))
    (marks,) = axes.plot(
        log.time[reached], log.target_distance[reached], linestyle="none", marker="o", markersize=4.5,
        clip_on=False, zorder=3, color=colour, markerfacecolor=style.PAPER,
        label=f"reached: {int(log.targets_reached[-1])}",
    )  # fmt: skip
    marks.set_in_layout(False)  # none at all would count as one in the corner of the figure
    if tolerance is not None:
        axes.axhline(tolerance, color=style.MUTED, linewidth=0.8, linestyle=(0, (4, 3)))
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(time_span(log))
    axes.set_ylabel("distance [m]")
    axes.set_title("Distance to the target")
    style.legend_above(axes)


def farthest(log: RolloutLog) -> float:
    """Distances beyond are cut off in the figures, as nothing happens there [m]."""
    return 1.55 * zones(log)[0].begin


def draw_zones(axes: Axes, log: RolloutLog, labels: bool = True, shades: bool = True) -> None:
    """The thresholds as lines, and what the controller does below each of them as shades."""
    lowest, _ = axes.get_ylim()
    around = zones(log)
    for zone, end in zip(around, [*(zone.begin for zone in around[1:]), lowest], strict=True):
        if shades:
            axes.axhspan(end, zone.begin, color=zone.shade, linewidth=0.0, zorder=0)
        alarm = zone.shade == style.ALARM
        axes.axhline(zone.begin, color=style.VERMILLION if alarm else style.MUTED, linewidth=0.8, zorder=1)
    if labels:
        texts = [f"{zone.symbol} {zone.begin:.2f} m" for zone in around]
        style.labels_at_right(axes, [zone.begin for zone in around], texts)


def zone_legend(log: RolloutLog) -> list[Patch]:
    """One patch per zone: what the controller does there."""
    return [Patch(facecolor=zone.shade, edgecolor=style.GRID, label=zone.meaning) for zone in zones(log)]


def draw_least_distance(
    axes: Axes, log: RolloutLog, labels: bool = True, shades: bool = True, colour: str = style.INK
) -> None:
    """True distance of whichever link is nearest to any obstacle, over the zones of the approach law."""
    least = least_distance(log)
    axes.set_ylim(min(0.0, float(least.min(initial=0.0)) * 1.1), farthest(log))
    draw_zones(axes, log, labels, shades)
    axes.plot(log.time, np.minimum(least, 2.0 * farthest(log)), color=colour)
    axes.grid(visible=False)
    axes.set_xlim(time_span(log))
    axes.set_ylabel("distance [m]")
    axes.set_title(f"Nearest link (true distance, to its {log.meta['distance_reference']})")


def draw_status(axes: Axes, log: RolloutLog) -> None:
    """A strip in the colours of the statuses; what is rare and short stays visible."""
    begin, end = time_span(log)
    shortest = (end - begin) / 700.0
    for status, spans in status_spans(log).items():
        wide = (
            spans if status is Status.SOLVED else [(begin, max(length, shortest)) for begin, length in spans]
        )
        axes.broken_barh(wide, (0.0, 1.0), facecolor=style.STATUS_COLOURS[status], linewidth=0.0)
    axes.set_ylim(0.0, 1.0)
    axes.set_yticks([])
    axes.grid(visible=False)
    axes.spines["left"].set_visible(False)


def _percent(count: int, cycles: int) -> str:
    """A share to a tenth; what is not nothing is not 0.0 %, and what is not all is not 100.0 %."""
    share = 100.0 * count / cycles
    if count < cycles and share >= 99.95:
        return "> 99.9 %"
    return "< 0.1 %" if 0.0 < share < 0.05 else f"{share:.1f} %"


def status_legend(log: RolloutLog) -> list[Patch]:
    """One patch per status that occurs, with its share of the cycles."""
    entries = []
    for status in status_spans(log):
        count = int((log.status == status).sum())
        text = f"{status.name}  {count} ({_percent(count, log.cycles)})"
        entries.append(Patch(facecolor=style.STATUS_COLOURS[status], label=text))
    return entries
