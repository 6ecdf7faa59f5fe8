"""Joint limits where the drive is not what the controller counts on: bounded and late."""

import numpy as np
import pytest

from proxgen.config.schema import Config
from proxgen.controllers.reference.objective import bounds
from proxgen.controllers.reference.parameters import Parameters, changed, default_parameters
from proxgen.model import RobotModel

SERVO = 1e-3
DRIVE_ACCELERATION = 10.0
LATENESS = 0.035


def furthest(p: Parameters) -> float:
    """How far the first joint comes beyond its limit [rad] when it is always told to go as fast as it may.

    Its drive follows commands `LATENESS` late, with at most `DRIVE_ACCELERATION`.
    """
    q, speed, command, worst = np.zeros(2), 0.0, np.zeros(2), -np.inf
    per_cycle = round(p.period / SERVO)
    late = [0.0] * round(LATENESS / SERVO)
    for step in range(3000):
        if step % per_cycle == 0:
            command = bounds(q, command, p)[1]
        late.append(float(command[0]))
        most = DRIVE_ACCELERATION * SERVO
        speed += float(np.clip(late.pop(0) - speed, -most, most))
        q = q + np.array([SERVO * speed, 0.0])
        worst = max(worst, float(q[0] - p.q_upper[0]))
    return worst


@pytest.mark.parametrize(
    ("acceleration", "viability", "beyond"),
    [
        (20.0, 0.0, 0.015),  # the damper asks for 5 /s of 3.14 rad/s
        (10.0, 0.0, 0.015),  # the acceleration bound gives way to it
        (10.0, 1.0, 0.0),
        (20.0, 1.0, 0.015),  # counts on what the drive does not give
    ],
)
def test_viability_with_the_acceleration_of_the_drive_keeps_the_limit(
    planar2_config: Config, planar2_model: RobotModel, acceleration: float, viability: float, beyond: float
) -> None:
    values = {
        "qdot_limit": np.full(2, np.pi),
        "qddot_limit": np.full(2, acceleration),
        "viability": viability,
    }
    p = changed(default_parameters(planar2_config, planar2_model), values)
    assert furthest(p) == pytest.approx(beyond, abs=1e-3)
