"""Which configurations may ask for more braking than they count on."""

from dataclasses import replace

import numpy as np
import pytest

from proxgen.config.schema import Config
from proxgen.config.variants import override
from proxgen.model import RobotModel, build_model
from proxgen.model.braking import hard_braking


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ({}, None),  # joint_2: 5 /s of 2.5 rad/s, and 20 rad/s^2
        ({"limits.acceleration": 12.5}, None),
        ({"limits.acceleration": 10.0}, "joint 'joint_2' may be told to brake with 1.25 times this"),
        ({"limits.acceleration": 10.0, "limits.viability": True}, None),
        (
            {"limits.acceleration": {"joint_1": 4.0}},
            "joint 'joint_1' may be told to brake with 2.5 times this",
        ),
        ({"limits.acceleration": None}, None),  # counts on nothing
        (
            {"limits.joint_damper": None},
            "joint 'joint_2' may be told to brake with 6.25 times this",
        ),  # 1/cycle
        ({"limits.joint_damper": None, "limits.viability": True}, None),
    ],
)
def test_which_joint_may_brake_too_hard(
    planar2_config: Config, limits: dict[str, object], words: str | None
) -> None:
    config = override(planar2_config, limits)
    found = hard_braking(config, build_model(config))
    assert (found is None) == (words is None)
    if found is not None and words is not None:
        assert found.key == "limits.acceleration"
        assert words in found.message


def test_a_joint_without_limits_needs_no_braking(planar2_config: Config, planar2_model: RobotModel) -> None:
    config = override(planar2_config, {"limits.acceleration": 10.0})
    endless = replace(planar2_model, q_upper=np.full(2, 1e20), qddot_limit=np.full(2, 10.0))
    assert hard_braking(config, endless) is None
