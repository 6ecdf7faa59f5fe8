"""Arms that are not in the repository: URDF and YAML made from a seed, so that nothing assumes the iiwa.

Every arm is a random chain with skew axes and placements, with capsules on its moving links and a cuff on the
last one. Some have branches, continuous, prismatic or mimic joints.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class ArmRecipe:
    """What kind of arm to make."""

    name: str
    seed: int
    joints: tuple[str, ...]
    task: str = "{kind: position}"
    gripper: bool = False
    extra: str = ""


RECIPES = (
    ArmRecipe("chain2", 1, ("revolute", "revolute"), "{kind: position, rows: [x, z]}"),
    ArmRecipe("slider3", 2, ("prismatic", "revolute", "prismatic")),
    ArmRecipe("skew6", 3, ("revolute",) * 6, "{kind: pose}"),
    ArmRecipe("pointer5", 4, ("revolute",) * 5, "{kind: pointing, axis: [0, 0.6, 0.8]}"),
    ArmRecipe("endless4", 5, ("continuous", "revolute", "continuous", "revolute"), gripper=True),
    ArmRecipe("mimic5", 6, ("revolute", "revolute", "mimic", "prismatic", "revolute")),
    ArmRecipe("long12", 7, ("revolute",) * 12, "{kind: pose}"),
    ArmRecipe("soft7", 8, ("revolute",) * 7, extra="relaxation: {mode: slack}\n"),
    ArmRecipe(
        "near7",
        9,
        ("revolute",) * 7,
        extra="avoidance: {distance_reference: surface, schedule: damper, active: {enabled: false}}\n",
    ),
)


def _xyz(values: np.ndarray) -> str:
    """Numbers as a URDF attribute."""
    return " ".join(f"{value:.6f}" for value in values)


def _joint(name: str, kind: str, index: int, rng: np.random.Generator) -> str:
    """One joint of the chain with a random placement and axis."""
    axis = rng.normal(size=3)
    offset = 0.08 * rng.normal(size=3) + np.array([0.0, 0.0, 0.2])
    urdf_kind = "revolute" if kind == "mimic" else kind
    limit = "" if kind == "continuous" else 'lower="-2.2" upper="2.4" '
    limit = 'lower="-0.3" upper="0.4" ' if kind == "prismatic" else limit
    mimic = '\n    <mimic joint="joint_1" multiplier="-0.7" offset="0.1"/>' if kind == "mimic" else ""
    return f"""  <joint name="{name}" type="{urdf_kind}">
    <parent link="link_{index}"/>
    <child link="link_{index + 1}"/>
    <origin xyz="{_xyz(offset)}" rpy="{_xyz(rng.uniform(-1.5, 1.5, 3))}"/>
    <axis xyz="{_xyz(axis / np.linalg.norm(axis))}"/>
    <limit {limit}velocity="{rng.uniform(0.8, 2.5):.4f}" effort="50"/>{mimic}
  </joint>
  <link name="link_{index + 1}"/>
"""


_GRIPPER = """  <joint name="finger_left" type="prismatic">
    <parent link="link_2"/>
    <child link="left"/>
    <axis xyz="0 1 0"/>
    <limit lower="0.01" upper="0.04" velocity="0.1" effort="5"/>
  </joint>
  <link name="left"/>
  <joint name="finger_right" type="prismatic">
    <parent link="link_2"/>
    <child link="right"/>
    <axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.04" velocity="0.1" effort="5"/>
    <mimic joint="finger_left"/>
  </joint>
  <link name="right"/>
"""


def write_arm(recipe: ArmRecipe, folder: Path) -> Path:
    """Write URDF and YAML of an arm.

    Returns:
        The YAML file.
    """
    rng = np.random.default_rng(recipe.seed)
    count = len(recipe.joints)
    links = "".join(_joint(f"joint_{i}", kind, i, rng) for i, kind in enumerate(recipe.joints))
    tool = f"""  <joint name="tool_joint" type="fixed">
    <parent link="link_{count}"/>
    <child link="tool"/>
    <origin xyz="0.02 -0.03 0.15" rpy="0.3 0.2 -0.4"/>
  </joint>
  <link name="tool"/>
"""
    gripper = _GRIPPER if recipe.gripper else ""
    urdf = f'<robot name="{recipe.name}">\n  <link name="link_0"/>\n{links}{tool}{gripper}</robot>\n'
    (folder / f"{recipe.name}.urdf").write_text(urdf)
    capsules = "".join(
        f"  - {{name: link_{i}, frame: link_{i}, start: [0, 0, 0], end: [0, 0, 0.2], radius: 0.05}}\n"
        for i in range(1, count + 1)
    )
    config = folder / f"{recipe.name}.yaml"
    config.write_text(
        f"robot: {{name: {recipe.name}, urdf: {recipe.name}.urdf, tool: tool}}\n"
        f"task: {recipe.task}\n"
        f"capsules:\n{capsules}"
        "skin:\n  cuffs:\n"
        f"    - {{name: hand, frame: link_{count}, axis: [0.1, 0.2, 1.0], rings: "
        "[{offset: 0.1, radius: 0.07, modules: 5, tilt: [0, 0.5]}]}\n"
        f"{recipe.extra}"
    )
    return config
