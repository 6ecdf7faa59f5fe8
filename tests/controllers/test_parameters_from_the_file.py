"""Every run-time parameter comes from its own key: both sides, with values that are all different.

Which key an addition's parameter comes from is worked out once for both sides, so that comparing them shows
nothing; and many defaults are equal, so that two keys in each other's place would not show either.
"""

from pathlib import Path

import numpy as np
from reference_tools import variant

from proxgen.config.ranges import RANGES
from proxgen.config.schema import Config
from proxgen.controllers.reference import ReferenceController
from proxgen.model import RobotModel
from proxgen.symbolic import build_program
from proxgen.symbolic.parameters import parameters

EVERYTHING = """
task: {posture: {joints: {joint_2: 0.31}, gain: 1.32, weight: 0.033}}
limits:
  position: {joint_1: [-1.11, 1.12], joint_2: [-1.13, 1.14]}
  velocity: {joint_1: 1.15, joint_2: 1.16}
  acceleration: {joint_1: 11.7, joint_2: 11.8}
  joint_damper: 1.9
  viability: true
  tolerance: 0.021
control: {rate: 40, deadline: 0.22}
skin:
  timeout: 0.23
  self_measurement: {enabled: true, margin: 0.024}
  memory: {enabled: true, age: 2.5, merge: 0.026, margin: 0.027, reach: 0.28}
avoidance:
  d_a: 0.44
  d_0u: 0.43
  d_0l: 0.42
  d_r: 0.41
  approach_speed: 0.45
  repulse_speed: -0.46
  row_speed: 4.7
  active: {distance: 0.48}
  damper: {influence_distance: 0.52, safety_distance: 0.51, gain: 5.3, repulse_speed: -0.54}
  circulation:
    enabled: true
    speed: 0.61
    stall_time: 0.62
    stall_fraction: 0.63
    release_time: 0.64
    patience: 0.65
    time_limit: 6.6
    blend_time: 0.67
    bias: [0.68, -0.69, 0.71]
  self_collision:
    d_a: 0.084
    d_0u: 0.083
    d_0l: 0.082
    d_r: 0.081
    points: [{name: tip, frame: tool, position: [0.5, 0, 0]}]
damping: {gain: 0.91, threshold: 0.092, floor: 0.0093}
relaxation: {slack: {weight: 94, minimum: 0.95, maximum: 9.6, active_weight: 97}}
"""

EXPECTED: dict[str, object] = {
    "posture": [0.0, 0.31], "posture_gain": 1.32, "posture_weight": [0.0, 0.033],
    "q_lower": [-1.11, -1.13], "q_upper": [1.12, 1.14],
    "qdot_limit": [1.15, 1.16], "qddot_limit": [11.7, 11.8],
    "joint_damper": 1.9, "viability": 1.0, "limit_tolerance": 0.021,
    "period": 0.025, "max_period": 0.22, "sensor_timeout": 0.23,
    "self_measurement_margin": 0.024,
    "memory_age": 2.5, "memory_merge": 0.026, "memory_margin": 0.027, "memory_reach": 0.28,
    "d_a": 0.44, "d_0u": 0.43, "d_0l": 0.42, "d_r": 0.41, "approach_speed": 0.45, "repulse_speed": -0.46,
    "row_speed": 4.7, "d_active": 0.48,
    "damper_influence": 0.52, "damper_safety": 0.51, "damper_gain": 5.3, "damper_repulse_speed": -0.54,
    "circulation_speed": 0.61, "stall_time": 0.62, "stall_fraction": 0.63, "circulation_release_time": 0.64,
    "circulation_patience": 0.65, "circulation_time_limit": 6.6, "circulation_blend_time": 0.67,
    "circulation_bias_x": 0.68, "circulation_bias_y": -0.69, "circulation_bias_z": 0.71,
    "self_d_a": 0.084, "self_d_0u": 0.083, "self_d_0l": 0.082, "self_d_r": 0.081,
    "damping_gain": 0.91, "damping_threshold": 0.092, "damping_floor": 0.0093,
    "slack_weight": 94.0, "slack_minimum": 0.95, "slack_maximum": 9.6, "slack_active_weight": 97.0,
}  # fmt: skip
"""All but that of the tangential method, which goes with no addition."""


def check(config: Config, model: RobotModel, expected: dict[str, object]) -> None:
    """The reference's parameters, and the defaults of generated code."""
    reference = ReferenceController(config, model).parameters
    generated = {parameter.name: parameter for parameter in parameters(config, model)}
    assert set(reference) == set(generated) == set(expected)
    for name, value in expected.items():
        np.testing.assert_array_equal(reference[name], np.array(value), err_msg=name)
        np.testing.assert_array_equal(generated[name].default, np.array(value), err_msg=name)
        assert (generated[name].lower, generated[name].upper) == RANGES[name], name


def test_every_parameter_comes_from_its_own_key(tmp_path: Path) -> None:
    written = [number for value in EXPECTED.values() for number in np.ravel(np.array(value)).tolist()]
    assert len(set(written)) == len(written) - 1, "two values are equal, besides those of joint_1's posture"
    check(*variant(tmp_path, EVERYTHING, "planar2"), EXPECTED)


def test_the_speed_of_the_tangential_method(tmp_path: Path) -> None:
    config, model = variant(tmp_path, "avoidance: {method: tangential, tangential: {speed: 0.123}}")
    found = ReferenceController(config, model).parameters
    defaults = {parameter.name: parameter.default for parameter in parameters(config, model)}
    assert found["tangential_speed"] == defaults["tangential_speed"] == 0.123
    assert set(RANGES) - set(EXPECTED) == {"tangential_speed"}


def test_what_is_chosen_when_the_code_is_generated(tmp_path: Path) -> None:
    """Values that are no parameters, each unlike its default."""
    skin = "skin: {max_points: 5, memory: {enabled: true, capacity: 7}}"
    text = f"solver: {{max_iterations: 37, tolerance: 1e-7}}\n{skin}"
    program = build_program(*variant(tmp_path, text, "planar2"))
    assert (program.max_iterations, program.tolerance, program.max_points) == (37, 1e-7, 5)
    assert program.memory is not None and program.memory.capacity == 7
