"""One test per kind of mistake that several values make together, or one with the URDF; and many at once."""

from collections.abc import Callable

import pytest

Case = tuple[str, str, str]
"""Text of the file, what replaces it, and the problem after `robot.yaml:`, which begins with its line."""

LINKS = "base, column, lower_arm, tip, upper_arm"

CONTRADICTIONS: dict[str, Case] = {
    "d_a not above d_0u": (
        "d_a: 0.30",
        "d_a: 0.25",
        "28: avoidance.d_0u: d_0u = 0.25 m must be less than d_a = 0.25 m (order: d_a > d_0u >= d_0l > d_r)",
    ),
    "d_0l above d_0u": (
        "schedule: paper",
        "d_0l: 26 cm",
        "29: avoidance.d_0l: d_0l = 0.26 m must be at most d_0u = 0.25 m (order: d_a > d_0u >= d_0l > d_r)",
    ),
    "d_r not below the default of d_0l": (
        "schedule: paper",
        "d_r: 0.22",
        "29: avoidance.d_r: d_r = 0.22 m must be less than d_0l = 0.22 m (order: d_a > d_0u >= d_0l > d_r)",
    ),
    "damper distances": (
        "schedule: paper",
        "damper: {influence_distance: 0.2}",
        "29: avoidance.damper.influence_distance: safety_distance = 0.22 m must be less than "
        "influence_distance = 0.2 m (the damper acts between them)",
    ),
    "slack clips": (
        "control:",
        "relaxation: {slack: {minimum: 3}}\ncontrol:",
        "32: relaxation.slack.minimum: minimum = 3 must be less than maximum = 2 "
        "(the ramp lies between them)",
    ),
    "two capsules of one name": (
        "name: lower,",
        "name: upper,",
        "17: capsules.1.name: the name 'upper' is given twice; names must differ",
    ),
    "two cuffs of one name": (
        "  tof:\n",
        "    - {name: wrist, frame: tip, rings: [{offset: 0, radius: 0.1, modules: 1}]}\n  tof:\n",
        "24: skin.cuffs.1.name: the name 'wrist' is given twice; names must differ",
    ),
    "axis without direction": (
        "      frame: lower_arm",
        "      frame: lower_arm\n      axis: [0, 0, 0]",
        "22: skin.cuffs.0.axis: a direction cannot be [0, 0, 0]",
    ),
    "position limits in the wrong order": (
        "[-90 deg, 90 deg]",
        "[90 deg, -90 deg]",
        "12: limits.position.shoulder: the lower limit 1.5708 must be less than the upper limit -1.5708",
    ),
    "viability without acceleration": (
        "acceleration: {shoulder: 10, elbow: 20}",
        "acceleration: null",
        "14: limits.viability: viability needs an acceleration limit to brake with",
    ),
    "posture of a locked joint": (
        "joints: {elbow: 30 deg}",
        "joints: {lift: 0.2}",
        "9: task.posture.joints.lift: joint 'lift' is locked (robot.locked_joints); "
        "it has no posture to follow",
    ),
    "posture outside the limits": (
        "joints: {elbow: 30 deg}",
        "joints: {shoulder: 100 deg}",
        "9: task.posture.joints.shoulder: 1.74533 is outside the limits -1.5708 to 1.5708 of "
        "limits.position.shoulder",
    ),
    "locked outside the limits": (
        "shoulder: [-90 deg, 90 deg]",
        "lift: [0.2, 0.5]",
        "5: robot.locked_joints.lift: 0.1 is outside the limits 0.2 to 0.5 of limits.position.lift",
    ),
    "more tilts than modules": (
        "modules: 4",
        "modules: 1",
        "23: skin.cuffs.0.rings.0.tilt: 2 tilts for 1 modules; give at most one per module",
    ),
    "virtual point beyond the trigger": (
        "  tof:\n",
        "  capacitive: {virtual_distance: 0.12}\n  tof:\n",
        "24: skin.capacitive.virtual_distance: virtual_distance = 0.12 m must be at most "
        "trigger = 0.1 m (a closed switch stands for a point no further than what closed it)",
    ),
    "sensor slower than the timeout": (
        "range: 1 m",
        "rate: 5 Hz",
        "25: skin.tof.rate: readings get as old as 0.2 s (1/rate + latency), "
        "more than timeout = 0.1 s: every cycle would be a fault",
    ),
    "cuff that senses nothing": (
        "  tof:\n    range: 1 m",
        "  tof: null\n  capacitive: null",
        "20: skin.cuffs.0: cuff 'wrist' senses nothing: neither it nor the skin has a 'tof' or 'capacitive'",
    ),
    "memory without range sensors": (
        "  tof:\n    range: 1 m",
        "  tof: null\n  memory: {enabled: true}",
        "25: skin.memory.enabled: there is no range sensor whose points it could keep; switch it off, "
        "or describe the cuffs and their 'tof'",
    ),
    "nothing that could be avoided": (
        "  cuffs:\n    - name: wrist\n      frame: lower_arm\n      rings:\n"
        "        - {offset: 0.2, radius: 6 cm, modules: 4, tilt: [0, 35 deg]}\n",
        "  max_points: 0\n",
        "19: skin.max_points: there are no cuffs, and no place for points from elsewhere: "
        "the arm would avoid nothing",
    ),
    "self-measurement without sensors": (
        "  cuffs:\n    - name: wrist\n      frame: lower_arm\n      rings:\n"
        "        - {offset: 0.2, radius: 6 cm, modules: 4, tilt: [0, 35 deg]}\n",
        "  self_measurement: {enabled: true}\n",
        "19: skin.self_measurement.enabled: there is no sensor whose readings it could discard; "
        "switch it off, or describe the cuffs",
    ),
    "deadline within the period": (
        "rate: 50 Hz",
        "rate: 50 Hz\n  deadline: 10 ms",
        "34: control.deadline: deadline = 0.01 s must be at least one period, 0.02 s at this rate",
    ),
}

NAMES: dict[str, Case] = {
    "tool that the URDF lacks": (
        "tool: tip",
        "tool: tipp",
        f"4: robot.tool: unknown frame 'tipp'; did you mean 'tip'? (allowed: {LINKS})",
    ),
    "frame of a capsule": (
        "frame: upper_arm",
        "frame: uper_arm",
        f"16: capsules.0.frame: unknown frame 'uper_arm'; did you mean 'upper_arm'? (allowed: {LINKS})",
    ),
    "frame of a cuff": (
        "      frame: lower_arm",
        "      frame: hand",
        f"21: skin.cuffs.0.frame: unknown frame 'hand' (allowed: {LINKS})",
    ),
    "joint that the URDF lacks": (
        "acceleration: {shoulder: 10,",
        "acceleration: {sholder: 10,",
        "13: limits.acceleration.sholder: unknown joint 'sholder'; did you mean 'shoulder'? "
        "(allowed: elbow, lift, shoulder)",
    ),
    "joint that is fixed": (
        "joints: {elbow: 30 deg}",
        "joints: {tip_joint: 30 deg}",
        "9: task.posture.joints.tip_joint: joint 'tip_joint' is fixed; it has no position, limit or velocity",
    ),
    "length for a joint that turns": (
        "joints: {elbow: 30 deg}",
        "joints: {elbow: 30 cm}",
        "9: task.posture.joints.elbow: '30 cm': joint 'elbow' is continuous: it turns; give an angle",
    ),
    "angle for a joint that slides": (
        "locked_joints: {lift: 10 cm}",
        "locked_joints: {lift: 10 deg}",
        "5: robot.locked_joints.lift: '10 deg': joint 'lift' is prismatic: it slides; give a length",
    ),
}

CASES = CONTRADICTIONS | NAMES


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_a_mistake_has_its_message(case: Case, expect_problem: Callable[[str, str, str], None]) -> None:
    expect_problem(*case)


def test_all_mistakes_are_reported_at_once(problems_after: Callable[..., list[str]]) -> None:
    found = problems_after(
        ("  rate: 50 Hz", "  rte: 50 Hz"),
        ("  d_0u: 0.25", "  d_0u: 0.25\n  d_0u: 0.26"),
        ("shoulder: [-90 deg, 90 deg]", "shoulder: [-90 deg, 0, 90 deg]"),
        ("range: 1 m", "range: 11 m"),
        ("schedule: paper", "schedule: papr"),
        ("name: arm", "name: My-Arm"),
        ("name: lower,", "name: upper,"),
        ("modules: 4", "modules: 1"),
        ("frame: upper_arm", "frame: uper_arm"),
        ("tool: tip", "tool: tipp"),
    )
    assert [text.split(": ")[0] + ": " + text.split(": ")[1] for text in found] == [
        "robot.yaml:2: robot.name",
        "robot.yaml:4: robot.tool",
        "robot.yaml:12: limits.position.shoulder",
        "robot.yaml:16: capsules.0.frame",
        "robot.yaml:17: capsules.1.name",
        "robot.yaml:23: skin.cuffs.0.rings.0.tilt",
        "robot.yaml:25: skin.tof.range",
        "robot.yaml:29: avoidance.d_0u",
        "robot.yaml:30: avoidance.schedule",
        "robot.yaml:34: control.rte",
    ]


def test_a_contradiction_is_seen_beside_another_mistake_in_the_section(
    problems_after: Callable[..., list[str]],
) -> None:
    found = problems_after(("d_a: 0.30", "d_a: 0.2"), ("schedule: paper", "schedul: paper\n  row_speed: -1"))
    assert [text.split(": ")[1] for text in found] == [
        "avoidance.d_0u",
        "avoidance.schedul",
        "avoidance.row_speed",
    ]


def test_a_wrong_value_makes_no_contradiction_with_its_default(
    problems_after: Callable[..., list[str]],
) -> None:
    # 0.20 is right with what was meant by d_0u; that the default 0.25 is above it is nobody's mistake
    found = problems_after(("d_a: 0.30", "d_a: 0.20"), ("d_0u: 0.25", "d_0u: 0.19 s"))
    assert [text.split(": ")[1] for text in found] == ["avoidance.d_0u"]
