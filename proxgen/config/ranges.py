"""What is accepted for the parameters that stay settable at run time (table of `docs/method.md`).

The ranges are wider than anything that makes sense for an arm, and narrow enough that every QP within them
can be solved and certified in double precision. 1e20 stands for "none".
"""

NONE = 1e20
"""Stands for a limit that does not exist."""

ADDITION_RANGES: dict[str, tuple[float, float]] = {
    "self_measurement_margin": (0.0, 10.0),
    "memory_age": (1e-6, 1e6),
    "memory_merge": (0.0, 10.0),
    "memory_margin": (0.0, 10.0),
    "memory_reach": (1e-6, 100.0),
    "circulation_speed": (1e-6, 10.0),
    "stall_time": (0.0, 1e3),
    "stall_fraction": (0.0, 1.0),
    "circulation_release_time": (0.0, 1e3),
    "circulation_patience": (0.0, 1e3),
    "circulation_time_limit": (1e-6, 1e6),
    "circulation_blend_time": (1e-6, 1e3),
    "circulation_bias_x": (-10.0, 10.0),
    "circulation_bias_y": (-10.0, 10.0),
    "circulation_bias_z": (-10.0, 10.0),
    "self_d_a": (1e-6, 10.0),
    "self_d_0u": (0.0, 10.0),
    "self_d_0l": (0.0, 10.0),
    "self_d_r": (0.0, 10.0),
    "tangential_speed": (1e-6, 10.0),
}
"""For the parameters of additions, each of which exists only where its addition is on."""

RANGES: dict[str, tuple[float, float]] = {
    **ADDITION_RANGES,
    "q_lower": (-NONE, NONE),
    "q_upper": (-NONE, NONE),
    "qdot_limit": (1e-6, 1e3),
    "qddot_limit": (1e-6, NONE),
    "joint_damper": (1e-6, NONE),
    "viability": (0.0, 1.0),
    "limit_tolerance": (0.0, 10.0),
    "period": (1e-6, 10.0),
    "max_period": (0.0, 1e3),
    "sensor_timeout": (1e-6, 1e3),
    "d_a": (1e-6, 10.0),
    "d_0u": (0.0, 10.0),
    "d_0l": (0.0, 10.0),
    "d_r": (0.0, 10.0),
    "approach_speed": (1e-6, 10.0),
    "repulse_speed": (-10.0, 0.0),
    "damper_influence": (1e-6, 10.0),
    "damper_safety": (0.0, 10.0),
    "damper_gain": (1e-6, 1e3),
    "damper_repulse_speed": (-10.0, 0.0),
    "row_speed": (1e-6, 1e3),
    "d_active": (1e-6, 10.0),
    "damping_gain": (0.0, 100.0),
    "damping_threshold": (0.0, 100.0),
    # Where H alone decides, a residual of 1e-14 leaves an error of 1e-14/lambda: 1e-8 rad/s at this floor.
    "damping_floor": (1e-6, 100.0),
    "slack_weight": (1e-3, 1e6),
    "slack_minimum": (1e-3, 10.0),
    "slack_maximum": (1e-3, 10.0),
    "slack_active_weight": (1e-3, 1e6),
    "posture_weight": (0.0, 100.0),
    "posture_gain": (0.0, 100.0),
    "posture": (-1e3, 1e3),
}
"""Least and greatest accepted value per parameter, both included; SI units and radians."""
