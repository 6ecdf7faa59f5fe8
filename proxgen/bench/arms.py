"""Arms of any size, as URDF and YAML, and inputs for them: what the scaling is measured with."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from proxgen.bench.inputs import Inputs
from proxgen.config import load
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Measurement
from proxgen.model import RobotModel

REACH = 1.2
"""Length of every arm [m], whatever its joints."""

_RINGS = 4


@dataclass(frozen=True)
class Size:
    """How large an arm is.

    Attributes:
        joints: number of revolute joints, about z and y in turns.
        sensors: number of modules, each with a range sensor and a switch; a multiple of 4.
        capsules: number of links that avoid; at most one per joint.
    """

    joints: int = 7
    sensors: int = 32
    capsules: int = 3


def write_arm(size: Size, folder: Path) -> Config:
    """Write URDF and YAML of an arm, and load them.

    Four rings of modules sit on its last link and on one in the middle; capsules are spread along the arm.

    Args:
        size: of the arm.
        folder: where the files go.
    """
    name, n = f"arm{size.joints}_{size.sensors}_{size.capsules}", size.joints
    length = REACH / n
    (folder / f"{name}.urdf").write_text(_urdf(name, n, length))
    bodies = sorted({round(place) for place in np.linspace(n, 1, size.capsules)})
    capsules = "".join(
        f"  - {{name: link_{body}, frame: link_{body}, start: [0, 0, 0], end: [0, 0, {length:.6f}], "
        "radius: 0.06}\n"
        for body in bodies
    )
    middle = max(n // 2, 1)
    cuffs = "".join(
        f"    - {{name: {cuff}, frame: link_{body}, rings: ["
        + ", ".join(
            f"{{offset: {length * place:.6f}, radius: 0.08, modules: {size.sensors // _RINGS}}}"
            for place in (0.3, 0.7)
        )
        + "]}\n"
        for cuff, body in (("middle", middle), ("last", n))
    )
    config = folder / f"{name}.yaml"
    rows = "rows: [x, z]" if n == 2 else "rows: [x, y, z]"
    config.write_text(
        f"robot: {{name: {name}, urdf: {name}.urdf, tool: tool}}\n"
        f"task: {{kind: position, {rows}}}\n"
        f"capsules:\n{capsules}"
        f"skin:\n  cuffs:\n{cuffs}"
        "limits: {acceleration: 20.0, joint_damper: 5.0}\n"
        "solver: {backend: daqp}\n"
    )
    return load(config)


def made_up_inputs(model: RobotModel, cycles: int, seed: int = 0) -> Inputs:
    """Cycles in which the same share of the sensors sees something, whatever their number.

    Half of the range sensors see something between 0.15 m and their range, one switch of sixteen is closed.

    Args:
        model: the arm.
        cycles: how many; the joints move smoothly.
        seed: of everything.
    """
    rng = np.random.default_rng(seed)
    tof, switches = model.tof_modules, model.capacitive_modules
    limit = np.array([module.tof.range for module in tof if module.tof])
    phase, speed = rng.uniform(0.0, 2.0 * np.pi, model.n), rng.uniform(0.2, 1.0, model.n)
    time = 0.02 * np.arange(cycles)
    measurements = tuple(
        Measurement(
            moment,
            np.where(rng.random(len(tof)) < 0.5, rng.uniform(0.15, 1.0, len(tof)) * limit, limit),
            rng.random(len(switches)) < 1.0 / 16.0,
        )
        for moment in time
    )
    return Inputs(
        name=model.name,
        q=1.2 * np.sin(phase + np.outer(time, speed)),
        xdot=rng.uniform(-0.15, 0.15, (cycles, model.m)),
        measurements=measurements,
    )


def _urdf(name: str, joints: int, length: float) -> str:
    """A chain along z, with axes z and y in turns."""
    chain = "".join(
        f'  <joint name="joint_{index}" type="revolute">\n'
        f'    <parent link="link_{index - 1}"/><child link="link_{index}"/>\n'
        f'    <origin xyz="0 0 {0.3 if index == 1 else length:.6f}"/>\n'
        f'    <axis xyz="{"0 0 1" if index % 2 else "0 1 0"}"/>\n'
        '    <limit lower="-2.8" upper="2.8" velocity="2" effort="100"/>\n'
        f'  </joint>\n  <link name="link_{index}"/>\n'
        for index in range(1, joints + 1)
    )
    tool = (
        '  <joint name="tool_joint" type="fixed">\n'
        f'    <parent link="link_{joints}"/><child link="tool"/>\n'
        f'    <origin xyz="0 0 {length:.6f}"/>\n  </joint>\n  <link name="tool"/>\n'
    )
    return f'<robot name="{name}">\n  <link name="link_0"/>\n{chain}{tool}</robot>\n'
