"""Several runs in columns: scenes, controllers or sensings that are to be compared by eye."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from proxgen.report import style
from proxgen.report.course import draw_least_distance, draw_sawtooth, draw_status, status_legend
from proxgen.report.derive import time_span
from proxgen.report.path import FRONT, bounds, draw_view
from proxgen.simulation.log import RolloutLog

MOST_COLUMNS = 4

TITLE = "Runs side by side"
CAPTION = "Path from the front, least distance, distance to the target, and status; one column per run."


def side_by_side_figure(logs: Sequence[RolloutLog]) -> Figure:
    """Front view, least distance, distance to the target and status, one column per run, at common scales."""
    corners = [bounds(log, []) for log in logs]
    low = np.min([corner[0] for corner in corners], axis=0)
    high = np.max([corner[1] for corner in corners], axis=0)
    width = style.WIDTH / len(logs)
    height = min(0.85 * width * (high[2] - low[2]) / (high[1] - low[1]), 4.2)
    figure = style.new_figure(height + 4.6)
    panels = figure.subplots(4, len(logs), squeeze=False, height_ratios=[height, 1.7, 1.5, 0.22])
    for column, log in enumerate(logs):
        path, nearest, sawtooth, strip = panels[:, column]
        draw_view(path, log, FRONT, low, high)
        path.set_title(
            "\n".join(log.meta[key] for key in ("scene", "controller")) + f", {log.meta['sensing']} sensing"
        )
        draw_least_distance(nearest, log, labels=column == len(logs) - 1)
        nearest.set_title("Nearest link")
        draw_sawtooth(sawtooth, log)
        sawtooth.set_title("To the target")
        draw_status(strip, log)
        strip.set_xlim(time_span(log))
        strip.set_xlabel("time [s]")
        for axes in panels[1:3, column]:
            axes.tick_params(labelbottom=False)
        if column > 0:
            for axes in panels[:, column]:
                axes.set_ylabel("")
    statuses = {str(entry.get_label()).split()[0]: entry for log in logs for entry in status_legend(log)}
    for name, entry in statuses.items():
        entry.set_label(name)
    figure.legend(handles=list(statuses.values()), loc="outside lower center", ncols=5, handlelength=1.2)
    return figure
