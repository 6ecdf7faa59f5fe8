"""A run as a sequence of pictures, for films."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from proxgen.model.robot_model import RobotModel
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.log import RolloutLog
from proxgen.simulation.obstacles import Obstacle, ObstacleField
from proxgen.simulation.world import Camera, World


def frames(
    log: RolloutLog,
    model: RobotModel,
    *,
    rate: float = 10.0,
    start: float = 0.0,
    end: float | None = None,
    camera: Camera | None = None,
) -> Iterator[NDArray[np.uint8]]:
    """Render a run by pybullet's software renderer, picture by picture.

    Args:
        log: the run.
        model: the arm that ran.
        rate: pictures per second of the run; the cycle nearest in time is drawn [Hz].
        start: time of the first picture [s].
        end: no picture at or after this time; the end of the run if None [s].
        camera: where the pictures are taken from.

    Yields:
        (height, width, 3) RGB.
    """
    field, arm = (
        ObstacleField([Obstacle.from_plain(plain) for plain in log.meta["obstacles"]]),
        ArmGeometry(model),
    )
    targets = np.array(log.meta["targets"], dtype=float).reshape(-1, 3)
    stop = log.cycles * log.meta["period"] if end is None else end
    with World(field, arm) as world:
        for time in np.arange(start, stop, 1.0 / rate):
            index = min(round(float(time) / log.meta["period"]), log.cycles - 1)
            yield world.render(
                float(log.time[index]), arm.poses(log.q[index]), camera=camera, targets=targets
            )
