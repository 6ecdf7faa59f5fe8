"""Which figures there are, and what each one says."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from proxgen.report import style
from proxgen.reproduce.figures.joints import figure_07, figure_14
from proxgen.reproduce.figures.links import figure_09, figure_15
from proxgen.reproduce.figures.methods import figure_10, figure_12, figure_13
from proxgen.reproduce.figures.rendered import figure_06, figure_08, figure_11


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper.

    Attributes:
        title: a few words.
        caption: what is to be seen in ours.
        draw: the function that draws it.
    """

    title: str
    caption: str
    draw: Callable[..., Figure]


_STARTS = "Pale: the other starts."
_LINKS = (
    "Line: true distance in one run; pale: range over all starts; dots: what the controller knew of through "
    "its sensors. Grey and red: the thresholds of (13)."
)

_MARKS = (
    "Blue: path of the tool. Balls: targets, the present one with a ring. Bars: from a link's axis to its "
    "nearest obstacle; light blue, yellow, orange, red below d_a, d_0u, d_0l, d_r. Dots: the skin's modules, "
    "in colour where they feel something."
)

FIGURES: dict[int, PaperFigure] = {
    6: PaperFigure(
        "Robot motion during function verification",
        f"Proposed method: the singular start, then one way between the targets. {_MARKS}",
        figure_06,
    ),
    7: PaperFigure(
        "Joint motion and joint limits",
        f"Function verification, proposed method. Dashed: position limits; shaded: beyond them. {_STARTS}",
        figure_07,
    ),
    8: PaperFigure(
        "The robot with dynamic obstacles",
        "Proposed method behind the model of the control cabinet, where the paper has a real robot. Below: "
        f"each obstacle as it comes nearest; above: two seconds earlier. {_MARKS}",
        figure_08,
    ),
    9: PaperFigure(
        "Least distance to the closest obstacle for each link",
        f"Function verification, proposed method. {_LINKS}",
        figure_09,
    ),
    10: PaperFigure(
        "Distance between end-effector and target, three methods",
        "Function verification. The target is swapped when it is reached, which makes the sawtooth; circles "
        f"mark targets reached. {_STARTS}",
        figure_10,
    ),
    11: PaperFigure(
        "The gap between two boxes",
        "What each method does between the targets, with the tool's whole path so far; the end of the run "
        f"where a method reaches no second target. {_MARKS}",
        figure_11,
    ),
    12: PaperFigure(
        "Overall least distance to the closest obstacle, three methods",
        "Gap between two boxes. Line: true distance of the nearest link in one run; pale: range over all "
        "starts. Grey and red: the thresholds of (13).",
        figure_12,
    ),
    13: PaperFigure(
        "Distance between end-effector and target in the gap, three methods",
        f"Gap between two boxes. Circles mark targets reached. {_STARTS}",
        figure_13,
    ),
    14: PaperFigure(
        "Joint motion with dynamic obstacles",
        "Proposed method. Left: every command is followed exactly. Right: commands pass the model of the "
        f"control cabinet, which bounds acceleration and jerk, and move masses. {_STARTS}",
        figure_14,
    ),
    15: PaperFigure(
        "Distance to the closest obstacle for each link, with dynamic obstacles",
        f"Proposed method, on both plants. {_LINKS}",
        figure_15,
    ),
}
"""The paper's data figures, by number."""


def write_figure(path: Path, draw: Callable[[], Figure]) -> Path:
    """Draw a figure in the house style and write it, as PNG, or as SVG if the name ends so."""
    with style.house_style():
        return style.save(draw(), path)
