"""What figures derive from a log."""

from dataclasses import replace

import numpy as np
import pytest
from made_up import make_log

from proxgen.controllers.protocol import Status
from proxgen.model import RobotModel
from proxgen.report.derive import (
    Leg,
    joint_units,
    label,
    least_distance,
    legs,
    microseconds,
    spread,
    status_spans,
    typical_leg,
    with_pedestal,
)


def test_label_names_scene_controller_and_sensing() -> None:
    assert label(make_log()) == "made_up, compiled (daqp), skin sensing"
    assert label(make_log(controller="reference", backend="none")) == "made_up, reference, skin sensing"


def test_least_distance_follows_the_reference() -> None:
    axis, surface = make_log(), make_log(distance_reference="surface")
    assert least_distance(axis) == pytest.approx(axis.true_axis_distance.min(axis=1))
    assert least_distance(surface) == pytest.approx(surface.true_surface_distance.min(axis=1))


def test_least_distance_without_an_obstacle_is_infinite() -> None:
    log = make_log()
    log = replace(log, true_axis_distance=np.full_like(log.true_axis_distance, np.inf))
    assert np.isinf(least_distance(log)).all()


def test_legs_cover_all_cycles_once() -> None:
    found = legs(make_log(cycles=130))
    assert found == [Leg(0, 49), Leg(50, 99), Leg(100, 129)]
    assert typical_leg(make_log(cycles=130)) == Leg(50, 99)
    assert typical_leg(make_log(cycles=30)) == Leg(0, 29)


def test_spread_divides_the_path_evenly() -> None:
    log = make_log(cycles=100)
    line = np.zeros((100, 3))
    line[:, 1] = np.minimum(np.arange(100), 60)  # stands still at the end
    moments = spread(Leg(0, 99), replace(log, tool_position=line), 4)
    assert moments == [0, 20, 40, 60]


def test_spread_of_an_arm_that_stands_still_is_one_moment() -> None:
    log = make_log(cycles=10)
    assert spread(Leg(3, 9), replace(log, tool_position=np.zeros((10, 3))), 4) == [3]


def test_status_spans_add_up_to_the_run() -> None:
    spans = status_spans(make_log(cycles=200))
    assert list(spans) == [Status.SOLVED, Status.STOPPED_INFEASIBLE]
    assert spans[Status.STOPPED_INFEASIBLE][0] == pytest.approx((1.2, 0.02))
    assert sum(length for parts in spans.values() for _, length in parts) == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.8251, "0.825 µs"), (4.0, "4.00 µs"), (51.24, "51.2 µs"), (12986.4, "12986 µs"), (0.0, "0 µs")],
)
def test_microseconds_have_three_digits_and_no_exponent(value: float, text: str) -> None:
    assert microseconds(value) == text


def test_units_follow_the_joints(any_model: RobotModel) -> None:
    log = make_log(joints=any_model.n)
    prismatic = {drive.index for drive in any_model.drives if drive.prismatic}
    assert joint_units(log, any_model) == [
        "m" if index in prismatic else "rad" for index in range(any_model.n)
    ]
    assert joint_units(log, None) == ["rad"] * any_model.n


def test_pedestal_reaches_from_the_floor_to_the_first_joint(iiwa7_model: RobotModel) -> None:
    drawn = with_pedestal(iiwa7_model)
    assert drawn.capsules[1:] == iiwa7_model.capsules
    assert drawn.capsules[0].body == 0
    assert drawn.capsules[0].end == pytest.approx([0.0, 0.0, 0.34])


def test_an_arm_whose_first_joint_is_at_the_origin_needs_no_pedestal(any_model: RobotModel) -> None:
    first = np.array(any_model.pin_model.jointPlacements[1].translation)
    assert (with_pedestal(any_model) is any_model) == (np.linalg.norm(first) < 0.05)
