"""Figures 6, 8 and 11: which moments are shown, and that pictures show them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from made_up import BALL, make_arm_log, make_log
from matplotlib.figure import Figure

from proxgen.model import RobotModel
from proxgen.report import style
from proxgen.reproduce import figures
from proxgen.reproduce.figures import rendered

pytestmark = pytest.mark.usefixtures("small")


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small pictures are rendered soon."""
    monkeypatch.setattr(rendered, "_SIZE", (60, 50))


def titles(figure: Figure) -> list[str]:
    """Titles of the pictures."""
    return [axes.get_title(loc="left") for axes in figure.axes if axes.images]


def images(figure: Figure) -> list[Any]:
    """The pictures as arrays."""
    return [np.asarray(axes.images[0].get_array()) for axes in figure.axes if axes.images]


def test_function_verification_begins_at_the_start_and_follows_one_way(planar2_model: RobotModel) -> None:
    log = make_arm_log(planar2_model)
    with style.house_style():
        figure = figures.figure_06(proposed=[log, log], model=planar2_model)
    # The last complete way between targets is cycles 100 to 149.
    assert titles(figure)[0] == "a)  t = 0.0 s"
    assert titles(figure)[1] == "b)  t = 2.0 s"
    assert titles(figure)[-1] == "f)  t = 3.0 s"
    pictures = images(figure)
    assert all(picture.shape == (50, 60, 3) for picture in pictures)
    assert all((one != pictures[0]).any() for one in pictures[1:])


def test_every_moving_obstacle_is_shown_as_it_comes_nearest(planar2_model: RobotModel) -> None:
    motion = make_log().meta["obstacles"][1]["motion"] | {"direction": [0, 0, -1], "distance": 0.3}
    # One comes down from the beginning for 1.5 s; the other one rests when the run begins, and comes at 2 s.
    early = BALL | {"name": "early_ball", "position": [0.4, 0.3, 0.7], "motion": motion}
    late = BALL | {"name": "late", "position": [0.4, -0.3, 0.7], "motion": motion | {"phase": 18.0}}
    log = make_arm_log(planar2_model, obstacles=[late, early])
    log = replace(log, q=np.zeros_like(log.q))  # so that only the obstacles decide
    with style.house_style():
        found = titles(figures.figure_08(dynamic=log, model=planar2_model))
    assert len(found) == 4
    assert found[2] == "c)  t = 1.5 s (early ball)"
    assert found[3] == "d)  t = 3.5 s (late)"
    assert found[:2] == ["a)  t = 0.0 s", "b)  t = 1.5 s"]


def test_without_a_moving_obstacle_the_nearest_moment_is_shown(planar2_model: RobotModel) -> None:
    log = make_arm_log(planar2_model, obstacles=make_log().meta["obstacles"][:1])
    nearest = log.time[log.true_axis_distance.min(axis=1).argmin()]
    with style.house_style():
        found = titles(figures.figure_08(dynamic=log, model=planar2_model))
    assert found[1] == f"b)  t = {nearest:.1f} s (nearest)"


def test_the_gap_shows_the_middle_of_a_way_or_where_a_method_is_stuck(planar2_model: RobotModel) -> None:
    log = make_arm_log(planar2_model)
    stuck = replace(log, targets_reached=np.zeros_like(log.targets_reached))
    with style.house_style():
        figure = figures.figure_11(proposed=log, tangential=[log], repulsive=stuck, model=planar2_model)
    found = titles(figure)
    assert found[0] == "a)  Singular start"
    assert found[1].startswith("b)  Proposed, t = 2.")
    assert found[2].startswith("c)  Tangential, t = 2.")
    assert found[3] == f"d)  Repulsive, t = {log.time[-1]:.1f} s"


def test_every_figure_of_the_catalogue_is_the_function_of_its_number() -> None:
    assert sorted(figures.FIGURES) == list(range(6, 16))
    for number, entry in figures.FIGURES.items():
        assert entry.draw is getattr(figures, f"figure_{number:02d}")
        assert entry.title
        assert entry.caption.endswith(".")
