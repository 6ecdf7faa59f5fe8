"""Makes the pictures of the documentation from a run of the compiled controller. `make images` runs it."""

from pathlib import Path

import numpy as np

import proxgen
from proxgen.config.scene import load_scene
from proxgen.model import build_model
from proxgen.report import style
from proxgen.report.course import draw_least_distance, draw_sawtooth
from proxgen.report.derive import spread, typical_leg, with_pedestal
from proxgen.report.path import FRONT, bounds, draw_view, obstacles_of, postures
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.obstacles import ObstacleField
from proxgen.simulation.rollout import run
from proxgen.simulation.world import Camera, World

HERE = Path(__file__).parent
EXAMPLE = HERE.parent.parent / "examples" / "iiwa7" / "iiwa7.yaml"


def main() -> None:
    """Run the gap, and draw arm, path, distance to the target and least distance side by side."""
    config = proxgen.load(EXAMPLE)
    model = build_model(config)
    log = run(config, model, proxgen.build(config), load_scene("gap"), sensing="skin", duration=60.0)
    arm, targets = ArmGeometry(with_pedestal(model)), np.array(log.meta["targets"])
    moment = spread(typical_leg(log), log, 3)[1]
    camera = Camera(target=(0.3, 0.0, 0.42), distance=1.5, width=1100, height=1000)
    with World(ObstacleField(obstacles_of(log)), arm) as world:
        picture = world.render(
            float(log.time[moment]), arm.poses(log.q[moment]), camera=camera, targets=targets
        )
    with style.house_style():
        figure = style.new_figure(3.7, 13.0)
        grid = figure.add_gridspec(2, 3, width_ratios=[1.1, 0.8, 1.7])
        scene = figure.add_subplot(grid[:, 0])
        scene.imshow(picture, interpolation="antialiased")
        scene.set_axis_off()
        front = figure.add_subplot(grid[:, 1])
        draw_view(front, log, FRONT, *bounds(log, []), arms=postures(log, model))
        front.set_title("Path, from the front")
        sawtooth, nearest = figure.add_subplot(grid[0, 2]), figure.add_subplot(grid[1, 2])
        draw_sawtooth(sawtooth, log, config.task.tolerance)
        sawtooth.tick_params(labelbottom=False)
        draw_least_distance(nearest, log)
        nearest.set_title("Nearest link to the boxes")
        nearest.set_xlabel("time [s]")
        style.save(figure, HERE / "gap.png")


if __name__ == "__main__":
    main()
