"""The reference's run-time parameters: where they come from, what is refused, when they take effect."""

from dataclasses import replace

import numpy as np
import pytest

from proxgen.config.ranges import ADDITION_RANGES, RANGES
from proxgen.config.schema import Config
from proxgen.controllers.protocol import OFF, Diagnostics, Measurement
from proxgen.controllers.reference import ReferenceController
from proxgen.errors import ControllerError
from proxgen.model import RobotModel


@pytest.fixture
def controller(planar2_config: Config, planar2_model: RobotModel) -> ReferenceController:
    """A planar arm's reference."""
    return ReferenceController(planar2_config, planar2_model)


def first_qp(controller: ReferenceController) -> Diagnostics:
    """The QP of a first cycle with nothing in sight."""
    seen = Measurement(0.0, np.ones(4), np.zeros(4, dtype=bool))
    return controller.step(np.array([0.3, 0.8]), np.zeros(2), seen).diagnostics


def test_a_reference_says_what_it_is(controller: ReferenceController) -> None:
    assert repr(controller) == (
        "ReferenceController(robot='planar2', joints=2, task_rows=2, capsules=2, tof=4, capacitive=4)"
    )


def test_parameters_come_from_the_configuration(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    found = ReferenceController(iiwa7_config, iiwa7_model).parameters
    assert set(found) == set(RANGES) - set(ADDITION_RANGES)
    assert (found["d_a"], found["d_0u"], found["d_0l"], found["d_r"]) == (0.30, 0.25, 0.22, 0.17)
    assert (found["period"], found["max_period"], found["joint_damper"]) == (0.02, 0.0, 5.0)
    np.testing.assert_array_equal(found["q_upper"], iiwa7_model.q_upper)
    np.testing.assert_array_equal(found["posture_weight"], np.zeros(7))


def test_parameters_of_a_posture(planar2_config: Config, planar2_model: RobotModel) -> None:
    posture = {"joints": {"joint_2": 0.5}, "gain": 1.5, "weight": 0.01}
    document = planar2_config.task.model_dump() | {"posture": posture}
    task = type(planar2_config.task).model_validate(document)
    found = ReferenceController(planar2_config.model_copy(update={"task": task}), planar2_model).parameters
    np.testing.assert_array_equal(found["posture"], [0.0, 0.5])
    np.testing.assert_array_equal(found["posture_weight"], [0.0, 0.01])
    assert found["posture_gain"] == 1.5


def test_limits_that_are_absent_stand_as_1e20(planar2_config: Config, planar2_model: RobotModel) -> None:
    limits = planar2_config.limits.model_copy(update={"joint_damper": None, "acceleration": None})
    free = replace(planar2_model, qddot_limit=np.full(2, OFF), q_upper=np.full(2, OFF))
    controller = ReferenceController(planar2_config.model_copy(update={"limits": limits}), free)
    assert controller.parameters["joint_damper"] == OFF
    found = first_qp(controller)
    np.testing.assert_array_equal(found.ub, planar2_model.qdot_limit)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"aproach_speed": 0.3}, "did you mean 'approach_speed'"),
        ({"d_a": 0.12}, "order d_a > d_0u >= d_0l > d_r"),
        ({"d_r": 0.1}, "order"),
        ({"d_0l": 0.121}, "order"),
        ({"damper_safety": 0.4}, "damper_influence"),
        ({"q_lower": [3.0, -1.0]}, "q_lower"),
        ({"q_lower": [0.0]}, "2 numbers"),
        ({"qdot_limit": 1.0}, "2 numbers"),
        ({"qdot_limit": [1.0, 0.0]}, "qdot_limit"),
        ({"posture": [0.0, np.inf]}, "posture"),
        ({"period": [0.02]}, "one number"),
        ({"period": "fast"}, "one number"),
        ({"period": 0.0}, "period"),
        ({"period": float("nan")}, "period"),
        ({"viability": 0.5}, "0 or 1"),
        ({"damping_floor": 0.9e-6}, "damping_floor"),
        ({"repulse_speed": 0.1}, "repulse_speed"),
        ({"approach_speed": 0.0}, "approach_speed"),
        ({"limit_tolerance": -0.1}, "limit_tolerance"),
    ],
)
def test_a_refused_set_of_parameters_changes_nothing(
    controller: ReferenceController, values: dict[str, object], words: str
) -> None:
    before = dict(controller.parameters)
    with pytest.raises(ControllerError) as caught:
        controller.set_parameters(row_speed=0.5, **values)
    assert words in str(caught.value)
    for name, value in controller.parameters.items():
        np.testing.assert_array_equal(value, before[name])


def test_parameters_take_effect_together(controller: ReferenceController) -> None:
    """An order that each value alone would break."""
    controller.set_parameters(d_a=0.6, d_0u=0.5, d_0l=0.4, d_r=0.3)
    assert controller.parameters["d_r"] == 0.3
    controller.set_parameters(qdot_limit=[0.1, 0.2])
    np.testing.assert_array_equal(first_qp(controller).ub, [0.1, 0.2])


def test_parameters_cannot_be_changed_from_outside(controller: ReferenceController) -> None:
    values = controller.parameters
    limits = values["qdot_limit"]
    assert isinstance(limits, np.ndarray)
    limits[:] = 0.0
    with pytest.raises(TypeError):
        values["period"] = 1.0  # type: ignore[index]
    np.testing.assert_array_equal(controller.parameters["qdot_limit"], [2.0, 2.5])
