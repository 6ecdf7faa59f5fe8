"""The way back from beyond a joint limit that docs/tune.md describes, with both controllers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import Controller, Measurement, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.model import RobotModel


@pytest.fixture(params=["compiled", "reference"])
def either(
    request: pytest.FixtureRequest, library: Path, planar2_config: Config, planar2_model: RobotModel
) -> Controller:
    """The planar arm by one controller and by the other."""
    if request.param == "compiled":
        return CompiledController.load(library)
    return ReferenceController(planar2_config, planar2_model)


@pytest.mark.parametrize("start", [[3.25, 0.5], [-3.25, -0.5], [0.3, 2.95], [-3.2, 2.9]])
def test_a_joint_beyond_its_limit_is_stopped_for_ever_until_it_is_led_back(
    either: Controller, planar2_model: RobotModel, nothing: Measurement, start: list[float]
) -> None:
    """The arm has as many joints as task rows, so that the tool has to give way."""
    q, lower, upper = np.array(start), planar2_model.q_lower, planar2_model.q_upper
    for cycle in range(5):
        command = either.step(q, np.full(2, 0.1), replace(nothing, time=0.02 * cycle))
        assert command.status is Status.FAULT_JOINT_LIMIT
        np.testing.assert_array_equal(command.qdot, 0.0)

    beyond = np.maximum(lower - q, q - upper)
    either.set_parameters(
        limit_tolerance=beyond.max() + 0.01,
        posture_weight=np.where(beyond > 0.0, 1.0, 0.0),
        posture_gain=1.0,
        posture=np.clip(q, lower + 0.05, upper - 0.05),
    )
    for cycle in range(5, 400):
        command = either.step(q, np.zeros(2), replace(nothing, time=0.02 * cycle))
        assert command.status is Status.SOLVED
        assert np.all(command.qdot[q > upper] <= 0.0)
        assert np.all(command.qdot[q < lower] >= 0.0)
        q = q + 0.02 * command.qdot
        if np.all((q > lower) & (q < upper)):
            break
    else:
        pytest.fail(f"still outside: {q}")
    either.set_parameters(limit_tolerance=0.1, posture_weight=np.zeros(2))
    command = either.step(q, np.zeros(2), replace(nothing, time=10.0))
    assert command.status is Status.SOLVED
