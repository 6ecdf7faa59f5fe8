"""Distance of every link to its nearest obstacle: what the controller saw, and what is true."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from proxgen.report import style
from proxgen.report.course import draw_zones, farthest
from proxgen.report.derive import spoken, time_span
from proxgen.simulation.log import RolloutLog

SEEN = style.INK
"""Colour of what the controller saw."""

TITLE = "Distance of every link"
CAPTION = (
    "Line: the true distance of each capsule to the nearest obstacle. Dots: the nearest point that the "
    "controller knew of through its sensors; none where it saw nothing. Lines and shades: the thresholds."
)


def links_figure(log: RolloutLog) -> Figure:
    """One panel per capsule on a common time axis, with the four thresholds."""
    names = log.meta["capsule_names"]
    figure = style.new_figure(0.7 + 1.55 * len(names))
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    for index, axes in enumerate(panels):
        draw_link(axes, log, index)
    style.legend_above(panels[0], link_legend())
    panels[-1].set_xlabel("time [s]")
    return figure


def draw_link(axes: Axes, log: RolloutLog, index: int, labels: bool = True, shades: bool = True) -> None:
    """True distance of one link, and the distance that the controller knew of, over the zones.

    Args:
        axes: to draw on.
        log: the run.
        index: of the capsule.
        labels: name the thresholds at the right.
        shades: show what the controller does between the thresholds.
    """
    true = log.reference_distance()[:, index]
    seen = log.controller_distance[:, index]
    seen = np.where(np.isfinite(seen), seen, np.nan)
    lowest = min(0.0, float(true.min(initial=0.0)), float(np.nanmin(seen, initial=0.0)))
    axes.set_ylim(1.1 * lowest, farthest(log))
    draw_zones(axes, log, labels, shades)
    axes.plot(log.time, np.minimum(true, 2.0 * farthest(log)), color=link_colour(index))
    axes.plot(log.time, seen, color=SEEN, linestyle="none", marker=".", markersize=1.8)
    axes.grid(visible=False)
    axes.set_title(spoken(log.meta["capsule_names"][index]))
    axes.set_ylabel("distance [m]")
    axes.set_xlim(time_span(log))


def link_colour(index: int) -> str:
    """The same colour for a link in every figure."""
    return style.LINKS[index % len(style.LINKS)]


def link_legend() -> list[Line2D]:
    """What line and dots mean."""
    return [
        Line2D([], [], color=link_colour(0), label="true"),
        Line2D([], [], color=SEEN, linestyle="none", marker=".", label="as the controller saw it"),
    ]
