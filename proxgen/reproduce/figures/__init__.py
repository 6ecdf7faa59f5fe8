"""The figures of the paper's experimental section, in its order and with its axes, for any arm.

Each function takes the logs of its experiment by name, one log or a list over perturbed starts, and returns
the figure; `write_figure` writes one, and `FIGURES` says what each shows.
"""

from proxgen.reproduce.figures.catalogue import FIGURES, PaperFigure, write_figure
from proxgen.reproduce.figures.joints import figure_07, figure_14
from proxgen.reproduce.figures.links import figure_09, figure_15
from proxgen.reproduce.figures.methods import figure_10, figure_12, figure_13
from proxgen.reproduce.figures.rendered import figure_06, figure_08, figure_11
from proxgen.reproduce.figures.runs import Runs

__all__ = [
    "FIGURES",
    "PaperFigure",
    "Runs",
    "figure_06",
    "figure_07",
    "figure_08",
    "figure_09",
    "figure_10",
    "figure_11",
    "figure_12",
    "figure_13",
    "figure_14",
    "figure_15",
    "write_figure",
]
