"""Whether joints can be braked in front of their position limits with the acceleration that is configured."""

import numpy as np

from proxgen.config.schema import Config
from proxgen.errors import Problem
from proxgen.model.limits import UNLIMITED
from proxgen.model.robot_model import RobotModel


def hard_braking(config: Config, model: RobotModel) -> Problem | None:
    """The joint that the bounds may brake hardest beyond limits.acceleration, or None if there is none.

    The joint damper brakes from the velocity limit with k_d v_max, the switch (11) within one cycle; the
    acceleration bound gives way to both. With viability no joint needs more than is configured.

    Args:
        config: where the limits were written.
        model: its model, with the limits in use.
    """
    if config.limits.viability:
        return None
    rate = min(config.limits.joint_damper or np.inf, config.control.rate)
    bounded = (model.q_upper < UNLIMITED) & (model.qddot_limit < UNLIMITED)
    excess = np.where(bounded, rate * model.qdot_limit / model.qddot_limit, 0.0)
    worst = int(excess.argmax())
    if excess[worst] <= 1.0 + 1e-9:
        return None
    message = (
        f"in front of a position limit, joint '{model.joint_names[worst]}' may be told to brake with "
        f"{excess[worst]:.3g} times this; if its drive gives no more, it passes the limit "
        "(limits.viability: true brakes earlier)"
    )
    return config.problem("limits.acceleration", message)
