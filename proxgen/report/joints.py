"""Joint positions and velocities with their limits: one row of two panels per joint."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from proxgen.model.robot_model import RobotModel
from proxgen.report import style
from proxgen.report.derive import joint_units, spoken, time_span
from proxgen.simulation.log import RolloutLog

Array = NDArray[np.float64]

_UNLIMITED = 1e10

TITLE = "Joint positions and velocities"
CAPTION = "Base to tool from top to bottom. Dashed: limits. Shaded: beyond them."


def joints_figure(log: RolloutLog, model: RobotModel | None = None) -> Figure:
    """Positions on the left, commanded velocities on the right, base to tool from top to bottom."""
    names = log.meta["joint_names"]
    figure = style.new_figure(0.7 + 1.05 * len(names))
    panels = figure.subplots(len(names), 2, sharex=True, squeeze=False)
    lower, upper, speed = (np.array(log.meta[key]) for key in ("q_lower", "q_upper", "qdot_limit"))
    for index, (name, unit) in enumerate(zip(names, joint_units(log, model), strict=True)):
        position, velocity = panels[index]
        draw_between_limits(
            position, log.time, log.q[:, index], float(lower[index]), float(upper[index]), style.BLUE
        )
        draw_between_limits(
            velocity, log.time, log.qdot[:, index], -float(speed[index]), float(speed[index]), style.GREEN
        )
        position.set_xlim(time_span(log))
        position.set_ylabel(f"{spoken(name)}\n[{unit}]")
        velocity.set_ylabel(f"[{unit}/s]")
    panels[0, 0].set_title("Position, limits dashed")
    panels[0, 1].set_title("Commanded velocity, limits dashed")
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    figure.align_ylabels()
    return figure


def draw_between_limits(
    axes: Axes, time: Array, values: Array, lower: float, upper: float, colour: str
) -> None:
    """One quantity over time, scaled to its limits if it has any.

    Args:
        axes: to draw on.
        time: (T,) [s].
        values: (T,) the quantity.
        lower: its limit; none if far below every value that occurs.
        upper: the same above.
        colour: of the line.
    """
    axes.plot(time, values, color=colour)
    if lower < -_UNLIMITED or upper > _UNLIMITED:
        return
    margin = 0.12 * (upper - lower)
    bottom = min(lower - margin, float(values.min()))
    top = max(upper + margin, float(values.max()))
    axes.axhspan(upper, top, color=style.ALARM, alpha=0.5, linewidth=0.0)
    axes.axhspan(bottom, lower, color=style.ALARM, alpha=0.5, linewidth=0.0)
    for limit in (lower, upper):
        axes.axhline(limit, color=style.VERMILLION, linewidth=0.8, linestyle=(0, (4, 3)))
    axes.set_ylim(bottom, top)
