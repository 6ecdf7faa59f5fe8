"""Distance of every link to its nearest obstacle: figure 9, and figure 15 with both plants."""

from collections.abc import Iterable, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from proxgen.report import style
from proxgen.report.derive import spoken
from proxgen.report.links import draw_link, link_colour, link_legend
from proxgen.reproduce.figures.runs import Runs, draw_range, every, example, note_least, range_legend


def figure_09(*, proposed: Runs) -> Figure:
    """Figure 9: least distance to the closest obstacle for each link during function verification.

    Args:
        proposed: runs of the proposed method.
    """
    return _links_figure([("", proposed)])


def figure_15(*, kinematic: Runs, dynamic: Runs) -> Figure:
    """Figure 15: distance to the closest obstacle for each link, with dynamic obstacles, on both plants.

    Args:
        kinematic: runs of the proposed method on the plant that follows every command exactly.
        dynamic: the same on the plant with the control cabinet's interpolation and the arm's masses.
    """
    return _links_figure([("Kinematic plant", kinematic), ("Dynamic plant", dynamic)])


def _links_figure(columns: Sequence[tuple[str, Runs]]) -> Figure:
    """A row of panels per link, a column per kind of run."""
    count = len(example(columns[0][1]).meta["capsule_names"])
    figure = style.new_figure(0.95 + 1.45 * count, style.PRINT_WIDTH)
    panels = figure.subplots(count, len(columns), sharex=True, sharey="row", squeeze=False)
    for column, (heading, runs) in enumerate(columns):
        _draw_column(panels[:, column], heading, runs, labels=column == len(columns) - 1)
        panels[-1, column].set_xlabel("time [s]")
    for axes in panels[:, 1:].ravel():
        axes.set_ylabel("")
    entries = [*link_legend(), *range_legend(columns[0][1], link_colour(0))]
    figure.legend(handles=entries, loc="outside lower center", ncols=len(entries), handlelength=1.4)
    figure.align_ylabels()
    return figure


def _draw_column(panels: Iterable[Axes], heading: str, runs: Runs, labels: bool) -> None:
    """One panel per link: the example's distances over the range of all runs."""
    log = example(runs)
    for index, (axes, name) in enumerate(zip(panels, log.meta["capsule_names"], strict=True)):
        draw_link(axes, log, index, labels, shades=False)
        distances = [run.reference_distance()[:, index] for run in every(runs)]
        draw_range(axes, runs, distances, link_colour(index))
        note_least(axes, distances)
        axes.set_title(f"{heading}: {spoken(name)}" if heading else spoken(name))
