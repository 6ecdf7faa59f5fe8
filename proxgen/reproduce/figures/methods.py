"""The three methods over time: distance to the target (figures 10 and 13), least distance (figure 12)."""

from matplotlib.figure import Figure

from proxgen.report import style
from proxgen.report.course import draw_least_distance, draw_sawtooth
from proxgen.report.derive import least_distance
from proxgen.reproduce.figures.runs import (
    Runs,
    draw_range,
    every,
    example,
    mean_and_spread,
    note_least,
    others,
    range_legend,
)


def figure_10(*, proposed: Runs, tangential: Runs, repulsive: Runs) -> Figure:
    """Figure 10: distance between end-effector and target during function verification, three methods.

    Args:
        proposed: runs of the proposed method in the scene with the pillar.
        tangential: of the tangential method.
        repulsive: of the repulsive method.
    """
    return _sawtooth_figure({"proposed": proposed, "tangential": tangential, "repulsive": repulsive})


def figure_12(*, proposed: Runs, tangential: Runs, repulsive: Runs) -> Figure:
    """Figure 12: overall least distance to the closest obstacle in the gap, three methods.

    Args:
        proposed: runs of the proposed method in the scene with the gap.
        tangential: of the tangential method.
        repulsive: of the repulsive method.
    """
    methods = {"proposed": proposed, "tangential": tangential, "repulsive": repulsive}
    figure = style.new_figure(5.4, style.PRINT_WIDTH)
    panels = figure.subplots(len(methods), 1, sharex=True, sharey=True)
    for axes, (name, runs) in zip(panels, methods.items(), strict=True):
        colour = style.METHODS[name]
        draw_least_distance(axes, example(runs), shades=False, colour=colour)
        distances = [least_distance(run) for run in every(runs)]
        draw_range(axes, runs, distances, colour)
        note_least(axes, distances)
        axes.set_title(name.capitalize())
    panels[-1].set_xlabel("time [s]")
    if others(proposed):
        handles = range_legend(proposed, style.MUTED)
        figure.legend(handles=handles, loc="outside lower center", handlelength=1.4)
    return figure


def figure_13(*, proposed: Runs, tangential: Runs, repulsive: Runs) -> Figure:
    """Figure 13: distance between end-effector and target in the gap, three methods.

    Args:
        proposed: runs of the proposed method in the scene with the gap.
        tangential: of the tangential method.
        repulsive: of the repulsive method.
    """
    return _sawtooth_figure({"proposed": proposed, "tangential": tangential, "repulsive": repulsive})


def _sawtooth_figure(methods: dict[str, Runs]) -> Figure:
    """One panel per method: the example over the other starts, and how many targets were reached."""
    figure = style.new_figure(4.9, style.PRINT_WIDTH)
    panels = figure.subplots(len(methods), 1, sharex=True, sharey=True)
    for axes, (name, runs) in zip(panels, methods.items(), strict=True):
        colour = style.METHODS[name]
        for other in others(runs):
            axes.plot(other.time, other.target_distance, color=colour, alpha=0.22, linewidth=0.6)
        draw_sawtooth(axes, example(runs), colour=colour)
        axes.get_legend().remove()
        reached = [float(run.targets_reached[-1]) for run in every(runs)]
        count = mean_and_spread(reached, 1 if len(reached) > 1 else 0)
        axes.set_title(f"{name.capitalize()}: {count} targets reached")
    panels[-1].set_xlabel("time [s]")
    return figure
