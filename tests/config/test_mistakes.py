"""One test per kind of mistake in a single value of a robot's file, each with its exact message."""

from collections.abc import Callable

import pytest

Case = tuple[str, str, str]
"""Text of the file, what replaces it, and the problem after `robot.yaml:`, which begins with its line."""

SECTIONS = "avoidance, capsules, control, damping, extends, limits, relaxation, robot, skin, solver, task"

KEYS: dict[str, Case] = {
    "unknown key": (
        "  rate: 50 Hz",
        "  rte: 50 Hz",
        "33: control.rte: unknown key 'rte'; did you mean 'rate'? (allowed: deadline, rate)",
    ),
    "unknown section": (
        "solver:",
        "slover:",
        f"30: slover: unknown key 'slover'; did you mean 'solver'? (allowed: {SECTIONS})",
    ),
    "unknown key with nothing near": (
        "control:",
        "colour: red\ncontrol:",
        f"32: colour: unknown key 'colour' (allowed: {SECTIONS})",
    ),
    "key in the wrong section": (
        "control:",
        "virtual_distance: 1\ncontrol:",
        "32: virtual_distance: unknown key 'virtual_distance'; it belongs into 'skin.capacitive' or "
        f"'skin.cuffs[].capacitive' (allowed: {SECTIONS})",
    ),
    "duplicate key": (
        "  d_0u: 0.25",
        "  d_0u: 0.25\n  d_0u: 0.26",
        "29: avoidance.d_0u: the key 'd_0u' is given twice, first in line 28",
    ),
    "missing key": (
        "  tool: tip\n",
        "",
        "1: robot.tool: the key 'tool' is missing (URDF frame whose motion is the task)",
    ),
    "missing key of an item": (
        "offset: 0.2, ",
        "",
        "23: skin.cuffs.0.rings.0.offset: the key 'offset' is missing "
        "(distance of the ring's centre from the cuff's origin, along its axis)",
    ),
}

TYPES: dict[str, Case] = {
    "text for a number": (
        "d_a: 0.30",
        "d_a: far",
        "27: avoidance.d_a: expected a length (a number in m, or with one of the units m, cm, mm), "
        "found 'far'",
    ),
    "truth value for a number": (
        "d_a: 0.30",
        "d_a: true",
        "27: avoidance.d_a: expected a length (a number in m, or with one of the units m, cm, mm), "
        "found true",
    ),
    "nothing for a number": (
        "d_a: 0.30",
        "d_a:",
        "27: avoidance.d_a: expected a length (a number in m, or with one of the units m, cm, mm), "
        "found nothing",
    ),
    "fraction for a whole number": (
        "modules: 4",
        "modules: 4.5",
        "23: skin.cuffs.0.rings.0.modules: expected a whole number, found 4.5",
    ),
    "word for a truth value": (
        "viability: true",
        "viability: on",
        "14: limits.viability: expected true or false, found 'on'; write true",
    ),
    "number for a truth value": (
        "viability: true",
        "viability: 1",
        "14: limits.viability: expected true or false, found 1",
    ),
    "number for a name": (
        "  tool: tip",
        "  tool: 5",
        "4: robot.tool: expected a name or text, found 5",
    ),
    "list for a section": (
        "solver:\n  backend: daqp",
        "solver: [daqp]",
        "30: solver: expected a section with the keys backend, max_iterations, tolerance, found a list of 1",
    ),
    "section without keys": (
        "solver:\n  backend: daqp",
        "solver:",
        "30: solver: expected a section with the keys backend, max_iterations, tolerance, found nothing",
    ),
    "value for a mapping by joint": (
        "locked_joints: {lift: 10 cm}",
        "locked_joints: lift",
        "5: robot.locked_joints: expected a mapping from joint names to values, found 'lift'",
    ),
    "section for a list": (
        "      rings:\n        - {offset: 0.2,",
        "      rings:\n          {offset: 0.2,",
        "22: skin.cuffs.0.rings: expected a list of at least 1 item, found a mapping",
    ),
    "empty list": (
        "tilt: [0, 35 deg]",
        "tilt: []",
        "23: skin.cuffs.0.rings.0.tilt: expected a list of at least 1 item, found an empty list",
    ),
    "too few values": (
        "start: [0, 0, 0], end: [0, 0, 0.3], radius: 5 cm}\n  - {name: lower",
        "start: [0, 0], end: [0, 0, 0.3], radius: 5 cm}\n  - {name: lower",
        "16: capsules.0.start: expected a list of 3 values, found 2",
    ),
    "too many values": (
        "shoulder: [-90 deg, 90 deg]",
        "shoulder: [-90 deg, 0, 90 deg]",
        "12: limits.position.shoulder: expected a list of 2 values, found 3",
    ),
}

VALUES: dict[str, Case] = {
    "out of range": (
        "range: 1 m",
        "range: 11 m",
        "25: skin.tof.range: 11 m is out of range (allowed: greater than 0 and at most 10 m); "
        "did you mean 11 cm or 11 mm?",
    ),
    "degrees without their unit": (
        "tilt: [0, 35 deg]",
        "tilt: [0, 35]",
        "23: skin.cuffs.0.rings.0.tilt.1: 35 rad is out of range "
        "(allowed: at least -1.5708 and at most 1.5708 rad); did you mean 35 deg?",
    ),
    "wrong unit": (
        "d_a: 0.30",
        "d_a: 0.30 s",
        "27: avoidance.d_a: unit 's' does not measure a length (allowed: m, cm, mm)",
    ),
    "unit of a pure number": (
        "control:",
        "damping: {floor: 1 mm}\ncontrol:",
        "32: damping.floor: unit 'mm' does not measure a number (allowed: none, it is a pure number)",
    ),
    "infinite": (
        "d_a: 0.30",
        "d_a: .inf",
        "27: avoidance.d_a: expected a finite length, found inf",
    ),
    "wrong choice": (
        "schedule: paper",
        "schedule: papr",
        "29: avoidance.schedule: unknown value 'papr'; did you mean 'paper'? (allowed: damper, paper)",
    ),
    "choice of another type": (
        "schedule: paper",
        "schedule: 3",
        "29: avoidance.schedule: found 3, allowed: damper, paper",
    ),
    "name that is no C identifier": (
        "name: arm",
        "name: My-Arm",
        "2: robot.name: 'My-Arm' is not allowed: a name begins with a lower-case letter; "
        "then lower-case letters, digits and _ follow",
    ),
    "name that is too long": (
        "name: arm",
        f"name: {'a' * 41}",
        f"2: robot.name: '{'a' * 41}' is too long: at most 40 characters",
    ),
    "name of the runtime": (
        "name: arm",
        "name: pg",
        "2: robot.name: 'pg' is the prefix of other symbols in the library; choose another name",
    ),
    "name that C++ takes for something else": (
        "name: arm",
        "name: double",
        "2: robot.name: 'double' is a word of C++, and would be the controller's namespace there; "
        "choose another name",
    ),
    "name by which the linker finds another library": (
        "name: arm",
        "name: m",
        "2: robot.name: 'm' is the name of a library of the system; choose another name",
    ),
    "row of another kind of task": (
        "kind: position",
        "kind: position\n  rows: [x, rz]",
        "8: task.rows.1: unknown row of a position task 'rz'; did you mean 'z'? (allowed: x, y, z)",
    ),
    "row twice": (
        "kind: position",
        "kind: position\n  rows: [x, x]",
        "8: task.rows.1: row 'x' is given twice",
    ),
}


CASES = KEYS | TYPES | VALUES


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_a_mistake_has_its_message(case: Case, expect_problem: Callable[[str, str, str], None]) -> None:
    expect_problem(*case)


def test_a_value_that_could_not_be_read_is_reported_once(problems_after: Callable[..., list[str]]) -> None:
    found = problems_after(("d_a: 0.30", "d_a: !far 0.30"))
    assert found == ["robot.yaml:27: avoidance.d_a: the tag '!far' is not allowed; write plain values"]
