"""Numbers that the claims are about, on logs that are made up for them."""

from dataclasses import replace

import numpy as np
import pytest
from made_up import BOX, make_log

from proxgen.config.schema import Config
from proxgen.reproduce.derived import derived_numbers
from proxgen.simulation.log import RolloutLog


def walk(points: list[tuple[float, float, float]], reached: list[int]) -> RolloutLog:
    """A log whose tool is at these points, and has reached so many targets there."""
    log = make_log(cycles=len(points))
    targets = np.array([[0.5, 0.5, 0.4], [0.5, -0.5, 0.4]])
    return replace(
        log,
        tool_position=np.array(points),
        targets_reached=np.array(reached),
        target_position=targets[np.array(reached) % 2],
        meta=log.meta | {"targets": targets.tolist()},
    )


def test_path_and_deflection_count_from_the_first_target_on(planar2_config: Config) -> None:
    points = [(9.0, 0.0, 0.0), (0.5, 0.5, 0.4), (0.8, 0.0, 0.4), (0.5, -0.5, 0.4), (0.5, -0.5, 0.4)]
    numbers = derived_numbers(walk(points, [0, 1, 1, 2, 2]), planar2_config)
    assert numbers["path_per_straight"] == pytest.approx(2.0 * np.hypot(0.3, 0.5))
    assert numbers["deflection_m"] == pytest.approx(0.3)
    none = derived_numbers(walk(points, [0, 0, 0, 0, 0]), planar2_config)
    assert (none["path_per_straight"], none["deflection_m"]) == (None, None)


def test_only_crossings_between_the_boxes_are_passes(planar2_config: Config) -> None:
    above = BOX | {"name": "above", "position": [0.5, 0.0, 0.8]}
    inside, over, beside = (0.5, 0.5), (0.5, 1.2), (1.2, 0.5)
    points = [
        (x, side, z) for x, z in (inside, over, beside, inside) for side in (-0.3, 0.3)
    ]  # each crosses once, and the ways back to the other side cross once more: in, over, beside
    log = walk(points, [0] * 8)
    boxed = replace(log, meta=log.meta | {"obstacles": [above, BOX]})
    assert derived_numbers(boxed, planar2_config)["passes_between"] == 3
    assert derived_numbers(log, planar2_config)["passes_between"] == 0  # a ball is no second box


def test_changes_of_the_command_where_constraints_switch(planar2_config: Config) -> None:
    log = make_log(joints=1, capsules=1, cycles=6)
    seen = np.array([np.inf, np.inf, 0.2, 0.2, np.inf, np.inf])[:, None]
    qdot = np.array([0.0, 0.1, 0.4, 0.4, 0.8, 0.8])[:, None]
    numbers = derived_numbers(replace(log, controller_distance=seen, qdot=qdot), planar2_config)
    assert numbers["mean_abs_dqdot_seen"] == pytest.approx(0.15)
    assert numbers["mean_abs_dqdot_clear"] == pytest.approx(0.125)
    assert numbers["mean_abs_dqdot_switching"] == pytest.approx(0.35)
    assert numbers["mean_abs_dqdot_steady"] == pytest.approx(0.025)
    assert numbers["sudden_obstacles"] == 1
    never = replace(log, controller_distance=np.full((6, 1), np.inf), qdot=qdot)
    assert derived_numbers(never, planar2_config)["mean_abs_dqdot_seen"] is None


def test_nothing_is_in_view_only_if_no_link_has_anything(planar2_config: Config) -> None:
    """The first link has something in the first two cycles, the second one in the middle two."""
    log = make_log(joints=1, capsules=2, cycles=6)
    far = np.inf
    seen = np.array([[0.2, far], [0.2, 0.2], [far, 0.2], [far, far], [far, far], [far, far]])
    qdot = np.cumsum([0.1, 0.1, 0.1, 0.4, 0.4, 0.4])[:, None]
    numbers = derived_numbers(replace(log, controller_distance=seen, qdot=qdot), planar2_config)
    assert numbers["mean_abs_dqdot_seen"] == pytest.approx(0.1)
    assert numbers["mean_abs_dqdot_clear"] == pytest.approx(0.4)


def test_the_last_motion_is_that_of_ten_seconds(planar2_config: Config) -> None:
    """600 cycles of 20 ms at 1 mm each: 499 steps between the last 500."""
    points = [(0.001 * index, 0.0, 0.4) for index in range(600)]
    numbers = derived_numbers(walk(points, [0] * 600), planar2_config)
    assert numbers["last_motion_m"] == pytest.approx(0.499)


def test_time_to_leave_a_singularity(planar2_config: Config) -> None:
    log = make_log(cycles=100)
    w = np.where(np.arange(100) < 30, 0.0, 0.1)
    numbers = derived_numbers(replace(log, manipulability=w), planar2_config)
    assert numbers["escape_time_s"] == pytest.approx(0.6)
    assert numbers["start_manipulability"] == 0.0
    stuck = derived_numbers(replace(log, manipulability=0.0 * w), planar2_config)
    assert stuck["escape_time_s"] == pytest.approx(2.0)


def test_time_below_thresholds_by_link(planar2_config: Config) -> None:
    log = make_log(capsules=2, cycles=4)
    distance = np.array([[0.16, 0.30], [0.16, 0.21], [0.30, 0.23], [0.30, 0.30]])  # d_0l is 0.22 m
    numbers = derived_numbers(replace(log, true_axis_distance=distance), planar2_config)
    assert numbers["link_below_dr_fraction"] == {"link_0": 0.5, "link_1": 0.0}
    assert numbers["time_below_d0l_fraction"] == 0.5


def test_what_the_arm_does_is_not_what_it_is_told(planar2_config: Config) -> None:
    log = make_log(joints=1, cycles=4)
    q = np.array([0.0, 0.02, 0.02, 0.04])[:, None]
    numbers = derived_numbers(replace(log, q=q), planar2_config)
    assert numbers["mean_abs_joint_jump"] == pytest.approx(1.0)
