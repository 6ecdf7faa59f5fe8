"""The paper's figures: complete for any arm, with units, the example in front of the spread."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_up import make_log
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import imread

from proxgen.report import style
from proxgen.reproduce import figures
from proxgen.reproduce.figures.runs import mean_and_spread
from proxgen.simulation.log import RolloutLog

pytestmark = pytest.mark.usefixtures("coarse")

METHODS = ("proposed", "tangential", "repulsive")
OVER_TIME = (7, 9, 10, 12, 13, 14, 15)


def runs(count: int, **options: Any) -> list[RolloutLog]:
    """The same made-up run several times, each a little further from the obstacles than the one before."""
    log = make_log(**options)
    shifted = []
    for number in range(count):
        distance = log.true_axis_distance + 0.01 * number
        shifted.append(replace(log, q=log.q + 0.1 * number, true_axis_distance=distance))
    return shifted


def draw(number: int, starts: int = 3, joints: int = 3, capsules: int = 2) -> Figure:
    """A figure of made-up runs."""
    logs = runs(starts, joints=joints, capsules=capsules)
    names = {7: ("proposed",), 9: ("proposed",), 14: ("kinematic", "dynamic"), 15: ("kinematic", "dynamic")}
    with style.house_style():
        return figures.FIGURES[number].draw(**dict.fromkeys(names.get(number, METHODS), logs))


def panels(figure: Figure) -> list[Axes]:
    """Axes on which something is drawn over time."""
    return [axes for axes in figure.axes if axes.lines]


@pytest.mark.parametrize(("joints", "capsules"), [(2, 1), (7, 3), (9, 5)])
def test_every_joint_and_link_has_its_panels(joints: int, capsules: int) -> None:
    for number, count in ((7, joints), (9, capsules), (14, 2 * joints), (15, 2 * capsules)):
        assert len(panels(draw(number, 1, joints, capsules))) == count


@pytest.mark.parametrize("number", [10, 12, 13])
def test_every_method_has_its_panel_and_colour(number: int) -> None:
    found = panels(draw(number))
    assert [axes.get_title(loc="left").split(":")[0].lower() for axes in found] == list(METHODS)
    colours = [{line.get_color() for line in axes.lines} for axes in found]
    for name, used in zip(METHODS, colours, strict=True):
        assert style.METHODS[name] in used
        assert not used & {style.METHODS[other] for other in METHODS if other != name}


@pytest.mark.parametrize("number", OVER_TIME)
def test_axes_have_units_and_files_are_written(tmp_path: Path, number: int) -> None:
    figure = draw(number)
    below = {axes.get_xlabel() for axes in panels(figure)} - {""}
    left = {axes.get_ylabel() for axes in panels(figure)} - {""}
    assert below == {"time [s]"}
    assert left
    assert all(label.endswith(("[m]", "[rad]")) for label in left)
    picture = imread(figures.write_figure(tmp_path / "figure.png", lambda: draw(number)))
    assert picture.shape[1] == round(style.DPI * style.WIDTH)
    assert picture.std() > 0.01
    svg = figures.write_figure(tmp_path / "figure.svg", lambda: draw(number)).read_text(encoding="utf-8")
    assert "<svg" in svg
    assert str(tmp_path) not in svg


def test_prismatic_joints_are_in_metres(planar2_model: Any) -> None:
    model = replace(planar2_model, drives=tuple(replace(d, prismatic=True) for d in planar2_model.drives))
    figure = figures.figure_07(proposed=make_log(joints=2), model=model)
    assert [axes.get_ylabel().split("\n")[1] for axes in panels(figure)] == ["[m]", "[m]"]


def test_other_starts_are_drawn_behind_the_example() -> None:
    first, *_ = panels(draw(7, starts=4))
    data = [line for line in first.lines if len(np.asarray(line.get_xdata())) > 2]
    assert len(data) == 4
    assert [line.get_alpha() for line in data] == [0.25, 0.25, 0.25, None]
    np.testing.assert_array_equal(np.asarray(data[-1].get_ydata()), make_log().q[:, 0])


def test_the_shade_spans_all_starts() -> None:
    axes, *_ = panels(draw(9, starts=3))
    (shade,) = axes.collections
    least = make_log().true_axis_distance[:, 0].min()
    heights = np.asarray(shade.get_paths()[0].vertices)[:, 1]
    assert heights.min() == pytest.approx(least)
    assert heights.max() == pytest.approx(make_log().true_axis_distance[:, 0].max() + 0.02)


def test_one_start_has_no_spread() -> None:
    axes, *_ = panels(draw(9, starts=1))
    assert not axes.collections
    assert "±" not in " ".join(text.get_text() for text in axes.texts)


def test_thresholds_are_those_of_the_log() -> None:
    axes, *_ = panels(draw(15))
    levels = {float(np.asarray(line.get_ydata())[0]) for line in axes.lines if len(line.get_xdata()) == 2}  # type: ignore[arg-type]
    assert levels == set(make_log().meta["thresholds"].values())


def test_a_method_that_reaches_nothing_leaves_no_margin() -> None:
    log = make_log()
    stuck = replace(log, targets_reached=np.zeros_like(log.targets_reached))
    lefts = []
    for last in (log, stuck):
        with style.house_style():
            figure = figures.figure_13(proposed=log, tangential=log, repulsive=last)
            figure.draw_without_rendering()
        lefts.append(figure.axes[0].get_position().x0)
    assert lefts[1] == pytest.approx(lefts[0], abs=1e-3)


def test_mean_and_spread() -> None:
    assert mean_and_spread([8.0], 0) == "8"
    assert mean_and_spread([1.0, 2.0, 3.0], 1) == "2.0 ± 1.0"


def test_starts_of_different_length_are_compared_as_far_as_both_go() -> None:
    logs = [make_log(cycles=100), make_log(cycles=60)]
    (axes,) = panels(figures.figure_09(proposed=[make_log(capsules=1, cycles=c) for c in (100, 60)]))
    assert np.asarray(axes.collections[0].get_paths()[0].vertices)[:, 0].max() == pytest.approx(59 * 0.02)
    assert len(panels(figures.figure_10(proposed=logs, tangential=logs, repulsive=logs))) == 3
