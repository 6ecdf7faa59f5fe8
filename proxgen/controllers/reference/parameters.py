"""The parameters that stay settable at run time: values from the configuration, and what is accepted."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from math import isnan, nan
from typing import Any

import numpy as np

from proxgen.config.ranges import RANGES
from proxgen.config.schema import Config
from proxgen.config.settable import addition_parameters
from proxgen.controllers.protocol import OFF, Array
from proxgen.errors import ControllerError, unknown_name
from proxgen.model.robot_model import RobotModel


@dataclass(frozen=True)
class Parameters:
    """One field per row of the tables in docs/method.md; vectors are (n,). SI units and radians.

    Those of an addition that is off are nan, and not among `as_dict`.
    """

    q_lower: Array
    q_upper: Array
    qdot_limit: Array
    qddot_limit: Array
    joint_damper: float
    viability: float
    limit_tolerance: float
    period: float
    max_period: float
    sensor_timeout: float
    d_a: float
    d_0u: float
    d_0l: float
    d_r: float
    approach_speed: float
    repulse_speed: float
    damper_influence: float
    damper_safety: float
    damper_gain: float
    damper_repulse_speed: float
    row_speed: float
    d_active: float
    damping_gain: float
    damping_threshold: float
    damping_floor: float
    slack_weight: float
    slack_minimum: float
    slack_maximum: float
    slack_active_weight: float
    posture_weight: Array
    posture_gain: float
    posture: Array
    self_measurement_margin: float = nan
    memory_age: float = nan
    memory_merge: float = nan
    memory_margin: float = nan
    memory_reach: float = nan
    circulation_speed: float = nan
    stall_time: float = nan
    stall_fraction: float = nan
    circulation_release_time: float = nan
    circulation_patience: float = nan
    circulation_time_limit: float = nan
    circulation_blend_time: float = nan
    circulation_bias_x: float = nan
    circulation_bias_y: float = nan
    circulation_bias_z: float = nan
    self_d_a: float = nan
    self_d_0u: float = nan
    self_d_0l: float = nan
    self_d_r: float = nan
    tangential_speed: float = nan

    def as_dict(self) -> dict[str, float | Array]:
        """All parameters that there are by name; vectors are copies."""
        return {name: value for name, value in asdict(self).items() if not _absent(value)}


def _absent(value: float | Array) -> bool:
    """Whether a value is that of a parameter which does not exist."""
    return isinstance(value, float) and isnan(value)


def default_parameters(config: Config, model: RobotModel) -> Parameters:
    """The values that a controller starts with (column "from the configuration" of the table)."""
    limits, avoidance, slack = config.limits, config.avoidance, config.relaxation.slack
    damper, damping, posture = config.avoidance.damper, config.damping, config.task.posture
    preferred = posture.joints if posture else {}
    weight = posture.weight if posture else 0.0
    return Parameters(
        q_lower=model.q_lower.astype(float),
        q_upper=model.q_upper.astype(float),
        qdot_limit=model.qdot_limit.astype(float),
        qddot_limit=model.qddot_limit.astype(float),
        joint_damper=OFF if limits.joint_damper is None else limits.joint_damper,
        viability=float(limits.viability),
        limit_tolerance=limits.tolerance,
        period=1.0 / config.control.rate,
        max_period=config.control.deadline or 0.0,
        sensor_timeout=config.skin.timeout,
        d_a=avoidance.d_a,
        d_0u=avoidance.d_0u,
        d_0l=avoidance.d_0l,
        d_r=avoidance.d_r,
        approach_speed=avoidance.approach_speed,
        repulse_speed=avoidance.repulse_speed,
        damper_influence=damper.influence_distance,
        damper_safety=damper.safety_distance,
        damper_gain=damper.gain,
        damper_repulse_speed=damper.repulse_speed,
        row_speed=avoidance.row_speed,
        d_active=avoidance.active.distance,
        damping_gain=damping.gain,
        damping_threshold=damping.threshold,
        damping_floor=damping.floor,
        slack_weight=slack.weight,
        slack_minimum=slack.minimum,
        slack_maximum=slack.maximum,
        slack_active_weight=slack.active_weight,
        posture_weight=np.array([weight if name in preferred else 0.0 for name in model.joint_names]),
        posture_gain=posture.gain if posture else 0.0,
        posture=np.array([preferred.get(name, 0.0) for name in model.joint_names]),
        **addition_parameters(config),
    )


def changed(parameters: Parameters, values: Mapping[str, Any]) -> Parameters:
    """A copy with some values replaced.

    Args:
        parameters: the present ones; they stay as they are.
        values: new values by name: numbers, and sequences of n numbers for the vectors.

    Raises:
        ControllerError: a name that does not exist, a wrong shape, or a value that is not accepted.
    """
    names = parameters.as_dict().keys()
    replacement: dict[str, Any] = {}
    for name, value in values.items():
        if name not in names:
            raise ControllerError(unknown_name("parameter", name, names))
        replacement[name] = _converted(name, value, np.shape(getattr(parameters, name)))
    new = replace(parameters, **replacement)
    _check_orders(new)
    return new


def _converted(name: str, value: Any, shape: tuple[int, ...]) -> float | Array:
    """The value as a float or an array of its own, if it has the shape and each number is accepted."""
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise ControllerError(f"parameter '{name}' must be {_shape_words(shape)}, not {value!r}") from error
    if array.shape != shape:
        raise ControllerError(f"parameter '{name}' must be {_shape_words(shape)}, not shape {array.shape}")
    lower, upper = RANGES[name]
    if not np.all((lower <= array) & (array <= upper)):
        raise ControllerError(f"parameter '{name}' must be within {lower:g} and {upper:g}, not {value!r}")
    if name == "viability" and array not in (0.0, 1.0):
        raise ControllerError(f"parameter 'viability' must be 0 or 1, not {value!r}")
    return array if shape else float(array)


def _shape_words(shape: tuple[int, ...]) -> str:
    """A shape in words."""
    return f"{shape[0]} numbers" if shape else "one number"


def _check_orders(p: Parameters) -> None:
    """Refuse values that are right by themselves, but not together."""
    if not np.all(p.q_lower < p.q_upper):
        raise ControllerError("parameter 'q_lower' must be less than 'q_upper' at every joint")
    if not p.d_a > p.d_0u >= p.d_0l > p.d_r:
        found = f"{p.d_a:g}, {p.d_0u:g}, {p.d_0l:g}, {p.d_r:g}"
        raise ControllerError(f"distances must keep the order d_a > d_0u >= d_0l > d_r, not {found}")
    if not _absent(p.self_d_a) and not p.self_d_a > p.self_d_0u >= p.self_d_0l > p.self_d_r:
        found = f"{p.self_d_a:g}, {p.self_d_0u:g}, {p.self_d_0l:g}, {p.self_d_r:g}"
        order = "self_d_a > self_d_0u >= self_d_0l > self_d_r"
        raise ControllerError(f"distances must keep the order {order}, not {found}")
    if not p.damper_influence > p.damper_safety:
        raise ControllerError("parameter 'damper_influence' must be greater than 'damper_safety'")
