"""Every fault of step 0, the safe stop, and what is kept between cycles."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array, Command, Controller, Measurement, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.errors import ControllerError
from proxgen.model import RobotModel
from proxgen.model.kinematics import body_poses

REST = np.array([0.3, 0.8])
PERIOD = 0.02

Change = Callable[[Measurement], Measurement]


@pytest.fixture
def controller(planar2_config: Config, planar2_model: RobotModel) -> ReferenceController:
    """A planar arm's reference with a deadline of 0.1 s."""
    reference = ReferenceController(planar2_config, planar2_model)
    reference.set_parameters(max_period=0.1)
    return reference


def seen(controller: ReferenceController, time: float) -> Measurement:
    """Nothing in sight, everything fresh."""
    model = controller.model
    ranges = np.array([module.tof.range for module in model.tof_modules if module.tof])
    switches = len(model.capacitive_modules)
    return Measurement(
        time, ranges, np.zeros(switches, dtype=bool), np.zeros(ranges.size), np.zeros(switches)
    )


def put(array: Array | None, index: int, value: float) -> Array:
    """A copy with one entry replaced."""
    assert array is not None
    copy = np.array(array, dtype=float)
    copy[index] = value
    return copy


def step(controller: ReferenceController, time: float, q: Array = REST, xdot: object = (0.0, 0.0)) -> Command:
    """A cycle with nothing in sight."""
    return controller.step(q, np.asarray(xdot, dtype=float), seen(controller, time))


BAD_MEASUREMENTS: dict[str, tuple[Status, Change]] = {
    "time is nan": (Status.FAULT_NOT_FINITE, lambda m: replace(m, time=np.nan)),
    "time is inf": (Status.FAULT_NOT_FINITE, lambda m: replace(m, time=np.inf)),
    "reading is nan": (Status.FAULT_NOT_FINITE, lambda m: replace(m, tof_range=put(m.tof_range, 2, np.nan))),
    "range age is inf": (Status.FAULT_NOT_FINITE, lambda m: replace(m, tof_age=put(m.tof_age, 0, np.inf))),
    "switch age is nan": (
        Status.FAULT_NOT_FINITE,
        lambda m: replace(m, capacitive_age=put(m.capacitive_age, 3, np.nan)),
    ),
    "point is inf": (Status.FAULT_NOT_FINITE, lambda m: replace(m, points=np.array([[0.0, -np.inf, 0.0]]))),
    "reading below 0": (Status.FAULT_READING, lambda m: replace(m, tof_range=put(m.tof_range, 1, -1e-9))),
    "reading beyond the range": (
        Status.FAULT_READING,
        lambda m: replace(m, tof_range=put(m.tof_range, 1, 1.0 + 1e-9)),
    ),
    "range age below 0": (Status.FAULT_READING, lambda m: replace(m, tof_age=put(m.tof_age, 1, -1e-9))),
    "switch age below 0": (
        Status.FAULT_READING,
        lambda m: replace(m, capacitive_age=put(m.capacitive_age, 1, -1e-9)),
    ),
    "time stands still": (Status.FAULT_TIME, lambda m: replace(m, time=0.0)),
    "time goes back": (Status.FAULT_TIME, lambda m: replace(m, time=-1.0)),
    "deadline missed": (Status.FAULT_DEADLINE, lambda m: replace(m, time=0.1001)),
    "stale reading": (Status.FAULT_STALE, lambda m: replace(m, tof_age=put(m.tof_age, 1, 0.1001))),
    "stale switch": (
        Status.FAULT_STALE,
        lambda m: replace(m, capacitive_age=put(m.capacitive_age, 1, 0.1001)),
    ),
}


@pytest.mark.parametrize("name", BAD_MEASUREMENTS)
def test_a_bad_measurement_brakes(controller: ReferenceController, name: str) -> None:
    """From full speed, as much as the acceleration allows: 20 rad/s² for 0.02 s."""
    status, spoil = BAD_MEASUREMENTS[name]
    controller.reset()
    step(controller, 0.0)
    controller.follow(np.array([1.0, -0.3]))
    command = controller.step(REST, np.zeros(2), spoil(seen(controller, PERIOD)))
    assert command.status is status
    assert command.qdot == pytest.approx([0.6, 0.0], abs=1e-14)
    assert command.diagnostics.solves == 0
    assert not command.diagnostics.row_on.any()
    assert np.isnan(command.diagnostics.kkt_residual)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("where", ["q", "xdot"])
def test_a_state_that_is_not_finite_brakes(controller: ReferenceController, where: str, value: float) -> None:
    state = {"q": REST, "xdot": np.zeros(2)}
    state[where] = put(state[where], 1, value)
    controller.follow(np.array([0.9, 0.2]))
    command = controller.step(state["q"], state["xdot"], seen(controller, 0.0))
    assert command.status is Status.FAULT_NOT_FINITE
    assert command.qdot == pytest.approx([0.5, 0.0], abs=1e-14)


def test_what_is_equal_to_its_limit_is_no_fault(controller: ReferenceController) -> None:
    """A cycle after max_period, ages of sensor_timeout, readings of the whole range and of 0."""
    controller.set_parameters(max_period=0.125, sensor_timeout=0.25)
    step(controller, 0.0)
    fine = seen(controller, 0.125)
    ages = np.full(fine.tof_range.size, 0.25), np.full(fine.capacitive.size, 0.25)
    equal = replace(fine, tof_age=ages[0], capacitive_age=ages[1])
    assert controller.step(REST, np.zeros(2), equal).status is Status.SOLVED
    touching = replace(fine, time=0.25, tof_range=put(fine.tof_range, 0, 0.0))
    assert not controller.step(REST, np.zeros(2), touching).status.fault


def test_joint_limits_have_a_tolerance(controller: ReferenceController) -> None:
    """The limits are ±3 and ±2.8 rad, the tolerance 0.1 rad."""
    for time, q in enumerate(([3.1, 0.0], [-3.1, 0.0], [0.0, 2.9], [0.0, -2.9])):
        controller.reset()
        assert step(controller, float(time), np.array(q)).status is Status.SOLVED
        beyond = np.array(q) * (1.0 + 1e-12)
        assert step(controller, time + PERIOD, beyond).status is Status.FAULT_JOINT_LIMIT


def test_beyond_the_limits_only_velocity_and_acceleration_bound_the_stop(
    controller: ReferenceController,
) -> None:
    """Within the tolerance (11) would allow no motion outwards at all; beyond it, it means nothing."""
    controller.follow(np.array([1.0, 0.0]))
    within = step(controller, 0.0, np.array([3.05, 0.0]))
    assert within.diagnostics.ub[0] == 0.0
    controller.reset()
    controller.follow(np.array([1.0, 0.0]))
    beyond = step(controller, 0.0, np.array([3.2, 0.0]))
    assert beyond.status is Status.FAULT_JOINT_LIMIT
    assert (beyond.diagnostics.lb[0], beyond.diagnostics.ub[0]) == pytest.approx((0.6, 1.4))
    assert beyond.qdot[0] == pytest.approx(0.6)


def test_checks_come_in_the_order_of_the_table(controller: ReferenceController) -> None:
    """Everything is wrong at once; then one thing after the other is put right."""
    step(controller, 0.0)
    fine = seen(controller, 0.0)
    bad = replace(fine, time=0.0, tof_range=put(fine.tof_range, 0, -1.0), tof_age=put(fine.tof_age, 0, 0.5))
    outside, nowhere = np.array([9.0, 0.0]), np.array([np.nan, 0.0])
    xdot = np.zeros(2)
    assert controller.step(outside, nowhere, bad).status is Status.FAULT_NOT_FINITE
    assert controller.step(outside, xdot, bad).status is Status.FAULT_JOINT_LIMIT
    assert controller.step(REST, xdot, bad).status is Status.FAULT_READING
    bad = replace(bad, tof_range=fine.tof_range)
    assert controller.step(REST, xdot, bad).status is Status.FAULT_TIME
    bad = replace(bad, time=0.5)
    assert controller.step(REST, xdot, bad).status is Status.FAULT_DEADLINE
    bad = replace(bad, time=0.5 + PERIOD)
    assert controller.step(REST, xdot, bad).status is Status.FAULT_STALE
    assert step(controller, 0.5 + 2.0 * PERIOD).status is Status.SOLVED


@pytest.mark.parametrize(
    ("spoil", "kept"),
    [
        (lambda m: replace(m, time=np.nan), True),
        (lambda m: replace(m, tof_range=put(m.tof_range, 0, np.nan)), True),
        (lambda m: replace(m, time=-5.0), True),
        (lambda m: replace(m, tof_range=put(m.tof_range, 0, -1.0)), False),
        (lambda m: replace(m, tof_age=put(m.tof_age, 0, 1.0)), False),
    ],
)
def test_which_faults_keep_the_previous_time(
    controller: ReferenceController, spoil: Change, kept: bool
) -> None:
    """At 0.12 s the deadline counts from 0 if the time was kept, and from 0.05 s if it was accepted."""
    step(controller, 0.0)
    assert controller.step(REST, np.zeros(2), spoil(seen(controller, 0.05))).status.fault
    expected = Status.FAULT_DEADLINE if kept else Status.SOLVED
    assert step(controller, 0.12).status is expected


def test_after_a_missed_deadline_the_next_cycle_is_on_time(controller: ReferenceController) -> None:
    step(controller, 0.0)
    assert step(controller, 5.0).status is Status.FAULT_DEADLINE
    assert step(controller, 5.0 + PERIOD).status is Status.SOLVED


def test_without_a_deadline_any_pause_is_accepted(controller: ReferenceController) -> None:
    controller.set_parameters(max_period=0.0)
    step(controller, 0.0)
    assert step(controller, 1e6).status is Status.SOLVED


def test_a_point_on_an_axis_has_no_direction(
    controller: ReferenceController, planar2_model: RobotModel
) -> None:
    pose = body_poses(planar2_model, REST)[planar2_model.capsules[1].body]
    for offset, inside in ((0.0, True), (0.9e-6, True), (1.1e-6, False)):
        controller.reset()
        point = pose[:3] @ np.array([0.2, offset, 0.0, 1.0])
        found = controller.step(REST, np.zeros(2), replace(seen(controller, 0.0), points=point[None]))
        assert (found.status is Status.FAULT_OBSTACLE_INSIDE) == inside
        assert found.status.success != inside


def test_the_safe_stop_is_the_next_previous_command(controller: ReferenceController) -> None:
    """Three faults in a row: 1.0, 0.6, 0.2, 0."""
    controller.follow(np.array([1.0, 0.0]))
    speeds = [step(controller, float("nan")).qdot[0] for _ in range(3)]
    assert speeds == pytest.approx([0.6, 0.2, 0.0], abs=1e-14)


def test_reset_forgets_time_and_velocity(controller: ReferenceController) -> None:
    step(controller, 10.0)
    controller.follow(np.array([1.0, 1.0]))
    controller.reset()
    command = step(controller, 0.0)
    assert command.status is Status.SOLVED
    np.testing.assert_allclose(command.diagnostics.ub, [0.4, 0.4], rtol=1e-14)


@pytest.mark.parametrize(
    ("words", "call"),
    [
        ("q must be 2 numbers", lambda c, m: c.step(np.zeros(3), np.zeros(2), m)),
        ("xdot must be 2 numbers", lambda c, m: c.step(REST, np.zeros((2, 1)), m)),
        ("q must be 2 numbers", lambda c, m: c.step("ab", np.zeros(2), m)),
        ("tof_range must be 4", lambda c, m: c.step(REST, np.zeros(2), replace(m, tof_range=np.ones(3)))),
        ("capacitive must be 4", lambda c, m: c.step(REST, np.zeros(2), replace(m, capacitive=np.ones(5)))),
        ("tof_age must be 4", lambda c, m: c.step(REST, np.zeros(2), replace(m, tof_age=np.ones(5)))),
        (
            "capacitive_age must",
            lambda c, m: c.step(REST, np.zeros(2), replace(m, capacitive_age=np.ones(1))),
        ),
        ("shape (P, 3)", lambda c, m: c.step(REST, np.zeros(2), replace(m, points=np.ones(3)))),
        ("16", lambda c, m: c.step(REST, np.zeros(2), replace(m, points=np.ones((17, 3))))),
        ("qdot must be 2 numbers", lambda c, m: c.follow(np.zeros(1))),
    ],
)
def test_wrong_sizes_are_refused(
    controller: ReferenceController, words: str, call: Callable[[ReferenceController, Measurement], object]
) -> None:
    with pytest.raises(ControllerError) as caught:
        call(controller, seen(controller, 0.0))
    assert words in str(caught.value)


def test_it_is_a_controller(controller: ReferenceController) -> None:
    def first_status(some: Controller) -> Status:
        return some.step(REST, np.zeros(2), seen(controller, 0.0)).status

    assert first_status(controller) is Status.SOLVED
