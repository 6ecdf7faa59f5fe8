"""How figures look: one palette, one set of sizes, one way to write a file. Nothing here knows what is drawn.

Colours follow Okabe and Ito (2008), which people with any colour vision can tell apart; where order matters
(severity, nearness) they also grow darker, so that a black-and-white print still reads.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from proxgen.controllers.protocol import Status
from proxgen.files import write_whole

INK = "#1f2933"
MUTED = "#7b8794"
GRID = "#e4e7eb"
PAPER = "#ffffff"
STEEL = "#b8c4d0"
BLUE = "#0072b2"
ORANGE = "#e69f00"
VERMILLION = "#d55e00"
GREEN = "#009e73"
SKY = "#56b4e9"
PURPLE = "#cc79a7"

SERIES = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILLION, INK, "#8c6d1f")
"""Colours of things that have no order, such as links or controllers."""

LINKS = (BLUE, GREEN, PURPLE, "#8c6d1f", SKY, VERMILLION)
"""Colours of the links, base to tool, then again from the start; they stand out from the zones' shades."""

METHODS = {"proposed": BLUE, "tangential": GREEN, "repulsive": PURPLE}
"""Colours of the methods that the paper compares."""

OBSTACLE = "#f2b98a"
OBSTACLE_EDGE = "#a85a1c"

APPROACH, STANDSTILL, REPULSION, ALARM = "#e6f0f8", "#fff5cf", "#ffe0c2", "#f9c5b4"
"""Shades of the zones around an obstacle, from far to near."""

ZONE_LINES = {APPROACH: SKY, STANDSTILL: "#f0e442", REPULSION: ORANGE, ALARM: VERMILLION}
"""The colour of a line in each zone: what its shade is a tint of."""

STATUS_COLOURS: dict[Status, str] = {
    Status.SOLVED: "#c9ddea",
    Status.REDUCED_ACTIVE: "#f0e442",
    Status.REDUCED_DISTANT: "#e69f00",
    Status.REDUCED_REPULSION: "#d55e00",
    Status.REDUCED_CRITICAL: "#8f3a00",
    Status.STOPPED_INFEASIBLE: "#cc79a7",
    Status.STOPPED_SOLVER: "#7d2b5c",
    Status.FAULT_NOT_FINITE: "#000000",
    Status.FAULT_JOINT_LIMIT: "#222222",
    Status.FAULT_READING: "#333333",
    Status.FAULT_STALE: "#444444",
    Status.FAULT_TIME: "#555555",
    Status.FAULT_DEADLINE: "#666666",
    Status.FAULT_OBSTACLE_INSIDE: "#111111",
}

WIDTH = 10.5
"""Width of a figure [inch]; at `DPI` it fills the page's column on a fine screen."""
PRINT_WIDTH = 7.2
"""Width of a figure that is to be printed across both columns of a paper [inch]; letters keep their size."""
DPI = 150

_RC: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "text.color": INK,
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9.5,
    "axes.labelcolor": INK,
    "axes.edgecolor": MUTED,
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.facecolor": PAPER,
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "lines.linewidth": 1.3,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "figure.facecolor": PAPER,
    "savefig.facecolor": PAPER,
    "path.simplify": True,
}


@contextmanager
def house_style() -> Iterator[None]:
    """Within it, figures are made in the report's style; the user's own settings are untouched."""
    with rc_context(_RC):
        yield


def new_figure(height: float, width: float = WIDTH) -> Figure:
    """An empty figure whose parts are placed without overlaps; sizes in inch."""
    return Figure(figsize=(width, height), layout="constrained")  # not pyplot: no screen, no global state


def save(figure: Figure, path: Path) -> Path:
    """Write the figure as PNG, or as SVG if the name ends so, whole or not at all.

    Narrow figures get a finer grid, so that on a page all pictures have at least as many pixels across.
    """
    buffer, dpi = BytesIO(), DPI * max(1.0, WIDTH / figure.get_figwidth())
    # Without the version of matplotlib and the date the same figure gives the same bytes.
    if path.suffix == ".svg":
        with rc_context({"svg.hashsalt": "proxgen"}):
            figure.savefig(buffer, format="svg", dpi=dpi, metadata={"Date": None, "Creator": None})
    else:
        figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return write_whole(path, buffer.getvalue())


def legend_above(axes: Axes, handles: Sequence[Any] | None = None, columns: int = 8) -> None:
    """A one-line legend at the upper right, outside of the data, on the line of the title."""
    options = {} if handles is None else {"handles": list(handles)}
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=columns, borderaxespad=0.2, handlelength=1.4,
        columnspacing=1.2, **options,
    )  # fmt: skip


def labels_at_right(axes: Axes, values: Sequence[float], texts: Sequence[str], size: float = 8.0) -> None:
    """Texts to the right of horizontal lines, moved apart where the lines lie close together.

    Args:
        axes: limits and size must be final.
        values: heights of the lines, descending, in data units.
        texts: one per line.
        size: of the letters [points].
    """
    low, high = axes.get_ylim()
    figure = axes.get_figure()
    height = axes.get_position().height * (figure.get_figheight() if isinstance(figure, Figure) else 1.0)
    gap = 1.25 * size / 72.0 / height * (high - low)
    places = list(values)
    for index in range(1, len(places)):
        places[index] = min(places[index], places[index - 1] - gap)
    shift = (sum(values) - sum(places)) / max(len(places), 1)
    for place, text in zip(places, texts, strict=True):
        axes.annotate(
            text, (1.0, place + shift), (5, 0), va="center", fontsize=size, color=INK,
            xycoords=("axes fraction", "data"), textcoords="offset points", annotation_clip=False,
        )  # fmt: skip
