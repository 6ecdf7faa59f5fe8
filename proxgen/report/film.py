"""Pictures of the arm at some moments of one way between two targets."""

import numpy as np
from matplotlib.figure import Figure

from proxgen.model.robot_model import RobotModel
from proxgen.report import style
from proxgen.report.derive import spread, typical_leg, with_pedestal
from proxgen.report.path import obstacles_of
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.log import RolloutLog
from proxgen.simulation.obstacles import ObstacleField
from proxgen.simulation.world import Camera, World

_MOMENTS = 4

TITLE = "The arm on one way between two targets"
CAPTION = "Rendered at equal steps along the tool's path. Obstacles and capsules as the simulation has them."


def film_figure(log: RolloutLog, model: RobotModel, camera: Camera | None = None) -> Figure:
    """Rendered pictures side by side, at equal steps along the tool's path.

    Args:
        log: the run.
        model: the arm that ran.
        camera: where the pictures are taken from; the world's own choice if None.
    """
    view = camera or Camera(width=760, height=680, distance=1.75)
    moments = spread(typical_leg(log), log, _MOMENTS)
    geometry, field = ArmGeometry(with_pedestal(model)), ObstacleField(obstacles_of(log))
    targets = np.array(log.meta["targets"]).reshape(-1, 3)
    figure = style.new_figure(0.35 + style.WIDTH / len(moments) * view.height / view.width)
    panels = figure.subplots(1, len(moments), squeeze=False)[0]
    with World(field, geometry) as world:
        for axes, moment in zip(panels, moments, strict=True):
            time = float(log.time[moment])
            axes.imshow(world.render(time, geometry.poses(log.q[moment]), camera=view, targets=targets))
            axes.set_title(f"t = {time:.2f} s")
            axes.set_axis_off()
    return figure
