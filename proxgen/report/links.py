"""Distance of every link to its nearest obstacle: what the controller saw, and what is true."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from proxgen.report import style
from proxgen.report.course import draw_zones, farthest
from proxgen.report.derive import time_span
from proxgen.simulation.log import RolloutLog

TITLE = "Distance of every link"
CAPTION = (
    "Black: the true distance of each capsule to the nearest obstacle. Dots: the nearest point that the "
    "controller knew of through its sensors; none where it saw nothing. Lines and shades: the thresholds."
)


def links_figure(log: RolloutLog) -> Figure:
    """One panel per capsule on a common time axis, with the four thresholds."""
    names = log.meta["capsule_names"]
    figure = style.new_figure(0.7 + 1.55 * len(names))
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    true = log.reference_distance()
    seen = np.where(np.isfinite(log.controller_distance), log.controller_distance, np.nan)
    for index, (axes, name) in enumerate(zip(panels, names, strict=True)):
        lowest = min(
            0.0, float(true[:, index].min(initial=0.0)), float(np.nanmin(seen[:, index], initial=0.0))
        )
        axes.set_ylim(1.1 * lowest, farthest(log))
        draw_zones(axes, log)
        axes.plot(log.time, np.minimum(true[:, index], 2.0 * farthest(log)), color=style.INK)
        axes.plot(log.time, seen[:, index], color=style.BLUE, linestyle="none", marker=".", markersize=2.2)
        axes.grid(visible=False)
        axes.set_title(name)
        axes.set_ylabel("distance [m]")
        axes.set_xlim(time_span(log))
    style.legend_above(
        panels[0],
        [
            Line2D([], [], color=style.INK, label="true"),
            Line2D([], [], color=style.BLUE, linestyle="none", marker=".", label="as the controller saw it"),
        ],
    )
    panels[-1].set_xlabel("time [s]")
    return figure
