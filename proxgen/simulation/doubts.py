"""What makes a run pointless from its start: an arm inside an obstacle, targets out of its reach."""

from collections.abc import Iterator

import numpy as np

from proxgen.config.scene import Scene
from proxgen.model.robot_model import RobotModel
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.scenery import Array, surroundings

_ROUNDING = 1e-9


def doubts(scene: Scene, model: RobotModel) -> list[str]:
    """Sentences about what cannot go well; none if nothing of the kind is seen.

    Args:
        scene: as loaded.
        model: the arm.

    Raises:
        ConfigError: the scene's start does not fit the arm's joints or limits.
    """
    return [*_contacts(scene, model), *_out_of_reach(scene, model)]


def _contacts(scene: Scene, model: RobotModel) -> Iterator[str]:
    """Per obstacle that the arm is in at the start, the capsule that is deepest in it."""
    around, arm = surroundings(scene, model), ArmGeometry(model)
    axes = arm.axes(arm.poses(around.start))
    gaps = around.field.near_segments(0.0, *axes).distance - arm.radius[:, None]
    for index, obstacle in enumerate(around.field.obstacles):
        slot = int(np.argmin(gaps[:, index]))
        if gaps[slot, index] < 0.0:
            capsule, depth = model.capsules[slot].name, -1000.0 * gaps[slot, index]
            yield f"the arm starts with capsule '{capsule}' {depth:.0f} mm inside obstacle '{obstacle.name}'"


def _out_of_reach(scene: Scene, model: RobotModel) -> Iterator[str]:
    """The first target that is further away than the stretched arm is long, and how many more there are."""
    centre, reach = _reach(model)
    rows = ["xyz".index(row) for row in model.task_rows if row in "xyz"]
    targets = np.array([target.position for target in scene.targets]).reshape(-1, 3)
    distance = np.linalg.norm((targets - centre)[:, rows], axis=1)
    far = np.flatnonzero(distance > reach + _ROUNDING)
    if len(far):
        more = f" (and {len(far) - 1} more like it)" if len(far) > 1 else ""
        place = f"{distance[far[0]]:.3g} m from the first joint"
        yield f"targets.{far[0]} is {place}{more}; the arm reaches {reach:.3g} m at most"


def _reach(model: RobotModel) -> tuple[Array, float]:
    """Where the first joint is, (3,), and a distance from it that the task point cannot exceed [m]."""
    reach, body = float(np.linalg.norm(model.tool_in_body[:3, 3])), model.tool_body
    chain = model.pin_model
    while True:
        drive, parent = model.drives[body - 1], chain.parents[body]
        place = np.array(chain.jointPlacements[body].translation)
        if drive.prismatic:
            ends = np.array([model.q_lower[drive.index], model.q_upper[drive.index]])
            reach += float(np.abs(drive.ratio * ends + drive.offset).max())
        if parent == 0:
            return place, reach
        reach += float(np.linalg.norm(place))
        body = parent
