"""One run, or several from perturbed starts: what is drawn as example, what as spread."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch
from numpy.typing import NDArray

from proxgen.report.course import farthest
from proxgen.simulation.log import RolloutLog

Array = NDArray[np.float64]

Runs = RolloutLog | Sequence[RolloutLog]
"""One run, or one experiment from perturbed starts; the first one is the example that is drawn in full."""


def every(runs: Runs) -> list[RolloutLog]:
    """All runs, the example first."""
    return [runs] if isinstance(runs, RolloutLog) else list(runs)


def example(runs: Runs) -> RolloutLog:
    """The run that is drawn in full."""
    return every(runs)[0]


def others(runs: Runs) -> list[RolloutLog]:
    """All runs but the example."""
    return every(runs)[1:]


def mean_and_spread(values: Sequence[float], digits: int) -> str:
    """`8.6 ± 0.7`: mean and standard deviation; the value alone if there is one."""
    if len(values) == 1:
        return f"{values[0]:.{digits}f}"
    return f"{np.mean(values):.{digits}f} ± {np.std(values, ddof=1):.{digits}f}"


def draw_range(axes: Axes, runs: Runs, values: Sequence[Array], colour: str) -> None:
    """Shade what lies between the least and the greatest value of all runs at each time.

    Args:
        axes: to draw on.
        runs: whose values they are; nothing is drawn for a single one.
        values: distances per run, (T,) [m].
        colour: of the shade.
    """
    if len(values) < 2:
        return
    first = example(runs)
    cycles = min(len(value) for value in values)
    stacked = np.minimum(np.stack([value[:cycles] for value in values]), 2.0 * farthest(first))
    axes.fill_between(
        first.time[:cycles], stacked.min(axis=0), stacked.max(axis=0), color=colour, alpha=0.25,
        linewidth=0.0, zorder=1.5,
    )  # fmt: skip


def note_least(axes: Axes, distances: Sequence[Array]) -> None:
    """Write the least distance of all runs into the lower right corner, where no line should ever be."""
    least = mean_and_spread([float(distance.min(initial=np.inf)) for distance in distances], 3)
    axes.text(
        0.99, 0.05, f"least {least} m", transform=axes.transAxes, ha="right", va="bottom", fontsize=8.5,
    )  # fmt: skip


def range_legend(runs: Runs, colour: str) -> list[Patch]:
    """What the shade of `draw_range` means; nothing for a single run."""
    count = len(every(runs))
    return [Patch(color=colour, alpha=0.3, linewidth=0.0, label=f"range of {count} starts")][: count - 1]
