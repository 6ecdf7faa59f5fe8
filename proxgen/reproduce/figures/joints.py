"""Joint positions between their limits: figure 7, and figure 14 with both plants."""

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from proxgen.model.robot_model import RobotModel
from proxgen.report import style
from proxgen.report.derive import joint_units, spoken, time_span
from proxgen.report.joints import draw_between_limits
from proxgen.reproduce.figures.runs import Runs, example, others


def figure_07(*, proposed: Runs, model: RobotModel | None = None) -> Figure:
    """Figure 7: joint motion and joint limits during function verification.

    Args:
        proposed: runs of the proposed method.
        model: the arm, whose joints may be prismatic; without it all count as revolute.
    """
    count = len(example(proposed).meta["joint_names"])
    figure = style.new_figure(0.75 + 0.85 * count, style.PRINT_WIDTH)
    panels = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    _draw_joints(panels, proposed, model, style.BLUE)
    panels[-1].set_xlabel("time [s]")
    _legend(figure, [proposed], [("joint position", style.BLUE)])
    figure.align_ylabels()
    return figure


def figure_14(*, kinematic: Runs, dynamic: Runs, model: RobotModel | None = None) -> Figure:
    """Figure 14: joint motion with dynamic obstacles, without and with the robot's dynamics.

    Args:
        kinematic: runs of the proposed method on the plant that follows every command exactly.
        dynamic: the same on the plant with the control cabinet's interpolation and the arm's masses.
        model: the arm, whose joints may be prismatic; without it all count as revolute.
    """
    columns = (("Kinematic plant", kinematic, style.BLUE), ("Dynamic plant", dynamic, style.GREEN))
    count = len(example(kinematic).meta["joint_names"])
    figure = style.new_figure(0.75 + 0.95 * count, style.PRINT_WIDTH)
    panels = figure.subplots(count, 2, sharex=True, sharey="row", squeeze=False)
    for column, (title, runs, colour) in enumerate(columns):
        _draw_joints(panels[:, column], runs, model, colour)
        panels[0, column].set_title(title)
        panels[-1, column].set_xlabel("time [s]")
    for axes in panels[:, 1]:
        axes.set_ylabel("")
    _legend(figure, [kinematic, dynamic], [(title.lower(), colour) for title, _, colour in columns])
    figure.align_ylabels()
    return figure


def _draw_joints(panels: Iterable[Axes], runs: Runs, model: RobotModel | None, colour: str) -> None:
    """One panel per joint: the example's position over those of the other runs, and the limits."""
    log = example(runs)
    lower, upper = np.array(log.meta["q_lower"]), np.array(log.meta["q_upper"])
    units = joint_units(log, model)
    for index, (axes, name) in enumerate(zip(panels, log.meta["joint_names"], strict=True)):
        for other in others(runs):
            axes.plot(other.time, other.q[:, index], color=colour, alpha=0.25, linewidth=0.6)
        draw_between_limits(axes, log.time, log.q[:, index], float(lower[index]), float(upper[index]), colour)
        axes.set_xlim(time_span(log))
        axes.set_ylabel(f"{spoken(name)}\n[{units[index]}]")


def _legend(figure: Figure, all_runs: Sequence[Runs], lines: Sequence[tuple[str, str]]) -> None:
    """What the lines mean, below the panels."""
    entries = [Line2D([], [], color=colour, label=name) for name, colour in lines]
    if any(others(runs) for runs in all_runs):
        entries.append(Line2D([], [], color=style.MUTED, linewidth=0.6, label="other starts"))
    limit = Line2D([], [], color=style.VERMILLION, linestyle=(0, (4, 3)), linewidth=0.8, label="limit")
    figure.legend(handles=[*entries, limit], loc="outside lower center", ncols=len(entries) + 1)
