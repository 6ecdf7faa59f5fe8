"""The parameters that stay settable at run time, with defaults from the configuration and accepted ranges."""

from collections.abc import Iterable

from proxgen.config.ranges import NONE, RANGES
from proxgen.config.schema import Config
from proxgen.config.settable import addition_parameters
from proxgen.model import RobotModel
from proxgen.program import Parameter


def parameters(config: Config, model: RobotModel) -> tuple[Parameter, ...]:
    """All parameters in the order of the C struct (table of `docs/method.md`)."""
    return (
        *_joint_parameters(config, model),
        *_cycle_parameters(config),
        *_avoidance_parameters(config),
        *_addition_parameters(config),
    )


_ADDITIONS = {
    "self_measurement_margin": ("m", "capsules explain readings up to this distance"),
    "memory_age": ("s", "an older point is forgotten"),
    "memory_merge": ("m", "points no further apart are one"),
    "memory_margin": ("m", "points nearer than a reading by more are seen through"),
    "memory_reach": ("m", "points as near to a capsule's axis are stored"),
    "circulation_speed": ("m/s", "speed along the obstacle"),
    "stall_time": ("s", "blocked for so long, the tool is stuck"),
    "stall_fraction": ("", "less than this part of the wanted progress is blocked"),
    "circulation_release_time": ("s", "clear for so long, the way is free"),
    "circulation_patience": ("s", "without progress for so long, another way round is tried"),
    "circulation_time_limit": ("s", "the task is tried again after this time"),
    "circulation_blend_time": ("s", "time of the change to circulation and back"),
    "circulation_bias_x": ("", "preferred way round, world x"),
    "circulation_bias_y": ("", "preferred way round, world y"),
    "circulation_bias_z": ("", "preferred way round, world z"),
    "self_d_a": ("m", "self points beyond give no row"),
    "self_d_0u": ("m", "upper end of their dead zone"),
    "self_d_0l": ("m", "lower end of their dead zone"),
    "self_d_r": ("m", "full repulsion from them at and below"),
    "tangential_speed": ("m/s", "least speed along the tangent"),
}
"""Unit and meaning of the parameters of additions."""


def _addition_parameters(config: Config) -> list[Parameter]:
    """Those of the additions that the configuration has."""
    return [
        _scalar(name, _ADDITIONS[name][0], value, _ADDITIONS[name][1])
        for name, value in addition_parameters(config).items()
    ]


def _scalar(name: str, unit: str, default: float, meaning: str) -> Parameter:
    """A parameter that is one number."""
    return Parameter(name, (), unit, default, *RANGES[name], meaning)


def _vector(name: str, unit: str, default: Iterable[float], meaning: str) -> Parameter:
    """A parameter with one value per joint."""
    values = tuple(float(value) for value in default)
    return Parameter(name, (len(values),), unit, values, *RANGES[name], meaning)


def _joint_parameters(config: Config, model: RobotModel) -> list[Parameter]:
    """One value per joint: limits and posture."""
    posture = config.task.posture
    preferred = posture.joints if posture else {}
    weights = [posture.weight if posture and name in preferred else 0.0 for name in model.joint_names]
    positions = [preferred.get(name, 0.0) for name in model.joint_names]
    return [
        _vector("q_lower", "rad", model.q_lower, "lower position limits q_lb (11)"),
        _vector("q_upper", "rad", model.q_upper, "upper position limits q_ub (11)"),
        _vector("qdot_limit", "rad/s", model.qdot_limit, "velocity limits (3)"),
        _vector("qddot_limit", "rad/s^2", model.qddot_limit, "acceleration limits; 1e20: none"),
        _vector("posture_weight", "", weights, "weights W of the posture task; 0: none"),
        _vector("posture", "rad", positions, "preferred positions q_p"),
        _scalar("posture_gain", "1/s", posture.gain if posture else 0.0, "gain k of the posture task"),
    ]


def _cycle_parameters(config: Config) -> list[Parameter]:
    """Timing, limits that are one number, damping."""
    limits, damping, control = config.limits, config.damping, config.control
    damper = NONE if limits.joint_damper is None else limits.joint_damper
    return [
        _scalar("joint_damper", "1/s", damper, "velocity per distance to the limit; 1e20: none"),
        _scalar("viability", "", float(limits.viability), "1: limits stay reachable by braking"),
        _scalar("limit_tolerance", "rad", limits.tolerance, "q further outside is a fault"),
        _scalar("period", "s", 1.0 / control.rate, "time dt of a control cycle"),
        _scalar("max_period", "s", control.deadline or 0.0, "longer is a fault; 0: not checked"),
        _scalar("sensor_timeout", "s", config.skin.timeout, "an older reading is a fault"),
        _scalar("damping_gain", "", damping.gain, "g_lambda (15)"),
        _scalar("damping_threshold", "", damping.threshold, "w_0 (15)"),
        _scalar("damping_floor", "", damping.floor, "lambda_min, keeps H positive definite"),
    ]


def _avoidance_parameters(config: Config) -> list[Parameter]:
    """Thresholds (17), speeds (16), the damper schedule, slack weights."""
    avoid, damper, slack = config.avoidance, config.avoidance.damper, config.relaxation.slack
    return [
        _scalar("d_a", "m", avoid.d_a, "obstacles beyond give no row (17)"),
        _scalar("d_0u", "m", avoid.d_0u, "upper end of the dead zone (17)"),
        _scalar("d_0l", "m", avoid.d_0l, "lower end of the dead zone (17)"),
        _scalar("d_r", "m", avoid.d_r, "full repulsion at and below (17)"),
        _scalar("approach_speed", "m/s", avoid.approach_speed, "approach speed at d_a (16)"),
        _scalar("repulse_speed", "m/s", avoid.repulse_speed, "approach speed at d_r (16)"),
        _scalar("damper_influence", "m", damper.influence_distance, "d_i of the damper schedule"),
        _scalar("damper_safety", "m", damper.safety_distance, "d_s of the damper schedule"),
        _scalar("damper_gain", "1/s", damper.gain, "repulsive speed per distance below d_s"),
        _scalar("damper_repulse_speed", "m/s", damper.repulse_speed, "v_r, its bound"),
        _scalar("row_speed", "rad/s", avoid.row_speed, "a row demands no more joint speed"),
        _scalar("d_active", "m", avoid.active.distance, "links nearer than this take part in (7)"),
        _scalar("slack_weight", "", slack.weight, "weight of a capsule's soft row"),
        _scalar("slack_minimum", "", slack.minimum, "lower clip of the ramp of the weights"),
        _scalar("slack_maximum", "", slack.maximum, "upper clip of the ramp of the weights"),
        _scalar("slack_active_weight", "", slack.active_weight, "weight of the soft active row"),
    ]
