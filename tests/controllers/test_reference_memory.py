"""Memory of seen points: what is stored, merged, forgotten, seen through; and what it is good for."""

from pathlib import Path

import numpy as np
import pytest
from reference_tools import silence, variant

from proxgen.controllers.protocol import Array, Command, Measurement, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.controllers.reference.geometry import Capsules
from proxgen.controllers.reference.kinematics import Arm
from proxgen.controllers.reference.memory import PointMemory
from proxgen.controllers.reference.places import Places
from proxgen.model import RobotModel

MEMORY = "skin: {memory: {enabled: true, capacity: 4}}\n"
STRAIGHT = np.zeros(7)
FOREARM = 12  # the first range sensor of the forearm's first ring; all look along x, 60 degrees apart


@pytest.fixture
def controller(tmp_path: Path) -> ReferenceController:
    return ReferenceController(*variant(tmp_path, MEMORY))


def seeing(model: RobotModel, time: float, **readings: float) -> Measurement:
    """A skin of which single sensors, `s12` for number 12, read something."""
    found = silence(model, time)
    for name, reading in readings.items():
        found.tof_range[int(name[1:])] = reading
    return found


def cycle(controller: ReferenceController, time: float, q: Array = STRAIGHT, **readings: float) -> Command:
    """One cycle at rest; `s12=0.15` is what sensor 12 reads."""
    return controller.step(q, np.zeros(3), seeing(controller.model, time, **readings))


def test_a_seen_point_stays_an_obstacle_where_it_was(controller: ReferenceController) -> None:
    """Seen once at 0.15 m; then the forearm turns by 30 degrees about its axis, and the cone has left it."""
    first = cycle(controller, 0.0, s12=0.15).diagnostics
    assert (first.memory_points, first.distance[1]) == (1, pytest.approx(0.23))
    turned = STRAIGHT.copy()
    turned[4] = np.radians(30.0)
    later = cycle(controller, 0.02, turned).diagnostics
    assert later.memory_points == 1
    np.testing.assert_allclose(later.nearest_point[1], first.nearest_point[1])
    assert later.row_on[1]


def test_it_is_forgotten_when_it_is_old(controller: ReferenceController) -> None:
    turned = STRAIGHT.copy()
    turned[4] = np.radians(30.0)
    cycle(controller, 0.0, s12=0.15)
    assert cycle(controller, 9.99, turned).diagnostics.memory_points == 1
    assert cycle(controller, 10.0, turned).diagnostics.memory_points == 1  # not older than memory_age
    assert cycle(controller, 10.01, turned).diagnostics.memory_points == 0


def test_it_is_forgotten_when_a_sensor_sees_through_it(controller: ReferenceController) -> None:
    """The same sensor sees further by more than the margin, or nothing; by less, it is another point."""
    cycle(controller, 0.0, s12=0.15)
    assert cycle(controller, 0.02, s12=0.249).diagnostics.memory_points == 2
    assert cycle(controller, 0.04, s12=0.36).diagnostics.memory_points == 1  # 0.15 and 0.249 are gone
    assert cycle(controller, 0.06).diagnostics.memory_points == 0


def test_only_the_middle_of_the_cone_sees_through(controller: ReferenceController) -> None:
    """Half of the cone is believed: up to 5 degrees from the axis the point is gone, beyond it stays."""
    for angle, left in ((3.0, 0), (7.0, 1)):
        controller.reset()
        cycle(controller, 0.0, s12=0.15)
        turned = STRAIGHT.copy()
        turned[4] = np.arctan2(
            0.15 * np.tan(np.radians(angle)), 0.23
        )  # seen from the sensor, not from the axis
        assert cycle(controller, 0.02, turned).diagnostics.memory_points == left


def test_points_are_merged_and_the_newest_place_counts(controller: ReferenceController) -> None:
    cycle(controller, 0.0, s12=0.15)
    later = cycle(controller, 5.0, s12=0.18).diagnostics
    assert later.memory_points == 1
    turned = STRAIGHT.copy()
    turned[4] = np.radians(30.0)
    assert cycle(controller, 14.0, turned).diagnostics.distance[1] == pytest.approx(0.26)


def test_of_full_slots_the_oldest_gives_way(controller: ReferenceController) -> None:
    """Four slots, and the upper arm's and the forearm's sensors see six points one after the other."""
    for index, sensor in enumerate(("s12", "s13", "s14", "s15", "s16", "s17")):
        command = cycle(controller, 0.02 * index, STRAIGHT, **{sensor: 0.15})
        # what the sensors before it saw is seen through at once, unless they still see it
        assert command.diagnostics.memory_points == 1
    controller.reset()
    names = ["s12", "s13", "s14", "s15", "s16", "s17"]
    full = cycle(controller, 0.0, STRAIGHT, **dict.fromkeys(names, 0.15)).diagnostics
    assert full.memory_points == 4


def memory_of(model: RobotModel, capacity: int = 3) -> tuple[PointMemory, Arm]:
    """A memory by itself, and the arm stretched out."""
    arm = Arm(model)
    arm.move_to(STRAIGHT)
    return PointMemory(model, Capsules(model), capacity, 0.5), arm


def test_slots_are_used_in_their_order(controller: ReferenceController) -> None:
    """The first free one; then that of the earliest time, and the first of those."""
    model, p = controller.model, controller._parameters
    memory, arm = memory_of(model)
    blind = np.zeros(len(model.tof_modules))
    far = np.array([[0.3, 0.0, z] for z in (0.4, 0.6, 0.8, 1.0, 1.2)])
    memory.update(0.0, arm, blind, far[:2], p)
    memory.update(0.5, arm, blind, far[2:3], p)
    np.testing.assert_array_equal(memory.points, far[:3])
    memory.update(1.0, arm, blind, far[3:4], p)
    np.testing.assert_array_equal(memory.points, far[[3, 1, 2]])
    memory.update(1.5, arm, blind, far[4:5], p)
    np.testing.assert_array_equal(memory.points, far[[3, 4, 2]])
    memory.update(10.6, arm, blind, np.empty((0, 3)), p)
    np.testing.assert_array_equal(memory.points, far[[3, 4]])
    memory.update(10.7, arm, blind, far[:1], p)
    np.testing.assert_array_equal(memory.points, far[[3, 4, 0]])


def test_of_several_near_points_the_nearest_is_renewed(controller: ReferenceController) -> None:
    model, p = controller.model, controller._parameters
    memory, arm = memory_of(model)
    blind = np.zeros(len(model.tof_modules))
    memory.update(0.0, arm, blind, np.array([[0.3, 0.0, 0.60], [0.3, 0.0, 0.65]]), p)
    memory.update(1.0, arm, blind, np.array([[0.3, 0.0, 0.63]]), p)
    np.testing.assert_array_equal(memory.points, [[0.3, 0.0, 0.60], [0.3, 0.0, 0.63]])


def test_what_is_far_away_is_not_stored(controller: ReferenceController) -> None:
    model, p = controller.model, controller._parameters
    memory, arm = memory_of(model)
    blind = np.zeros(len(model.tof_modules))
    memory.update(0.0, arm, blind, np.array([[0.501, 0.0, 0.6], [0.499, 0.0, 0.6]]), p)
    np.testing.assert_array_equal(memory.points, [[0.499, 0.0, 0.6]])


def test_where_the_arm_is_there_is_no_obstacle(controller: ReferenceController) -> None:
    """A stored point that the arm has moved into is forgotten, and never a fault."""
    cycle(controller, 0.0, s12=0.15)
    place = controller._eyes._memory.points[0] if controller._eyes._memory else np.zeros(3)
    model, arm = controller.model, Arm(controller.model)
    for angle in np.linspace(0.0, 0.6, 61):
        q = STRAIGHT.copy()
        q[1] = angle
        q[4] = np.radians(30.0)
        command = cycle(controller, 0.02 + angle, q)
        arm.move_to(q)
        inside = Capsules(model).surface_distance(arm, place[None]).min() <= 0.0
        assert command.status is not Status.FAULT_OBSTACLE_INSIDE
        if inside:
            break
    assert inside
    assert command.diagnostics.memory_points == 0


def test_noise_does_not_fill_the_memory(controller: ReferenceController) -> None:
    """One wall point seen 500 times with 5 mm of noise stays one or two points."""
    rng = np.random.default_rng(51)
    for index in range(500):
        found = cycle(controller, 0.02 * index, s12=0.15 + rng.normal(0.0, 0.005)).diagnostics
    assert found.memory_points == 1


def test_switches_and_given_points_are_not_stored(controller: ReferenceController) -> None:
    seen = silence(controller.model, 0.0, np.array([[0.25, 0.0, 0.9]]))
    seen.capacitive[FOREARM] = True
    command = controller.step(STRAIGHT, np.zeros(3), seen)
    assert np.isfinite(command.diagnostics.distance).any()
    assert command.diagnostics.memory_points == 0


def test_a_fault_leaves_it_and_a_reset_empties_it(controller: ReferenceController) -> None:
    cycle(controller, 0.0, s12=0.15, s13=0.15)
    broken = seeing(controller.model, 0.02, s12=np.nan)
    assert controller.step(STRAIGHT, np.zeros(3), broken).status is Status.FAULT_NOT_FINITE
    assert cycle(controller, 0.04, s12=0.15, s13=0.15).diagnostics.memory_points == 2
    controller.reset()
    turned = STRAIGHT.copy()
    turned[4] = np.radians(30.0)
    assert cycle(controller, 0.0, turned).diagnostics.memory_points == 0


def test_readings_of_the_arm_are_not_stored_but_see_through(controller: ReferenceController) -> None:
    """A reading that gave no point, because the arm explains it, frees what was remembered before it."""
    model, p = controller.model, controller._parameters
    memory, arm = memory_of(model)
    readings = np.zeros(len(model.tof_modules))
    readings[FOREARM] = 0.15
    every = np.arange(len(readings))
    seen = Places(model.tof_modules).points(arm, every, readings)[FOREARM : FOREARM + 1]
    memory.update(0.0, arm, readings, seen, p)
    np.testing.assert_array_equal(memory.points, seen)
    readings[FOREARM] = 0.30
    memory.update(0.02, arm, readings, np.empty((0, 3)), p)
    assert len(memory.points) == 0
