"""Makes the pictures and films of the documentation from runs. `make images` runs it."""

from pathlib import Path

import proxgen
from proxgen.config.scene import load_scene
from proxgen.model import build_model
from proxgen.model.robot_model import RobotModel
from proxgen.report import style
from proxgen.report.course import draw_least_distance, draw_sawtooth
from proxgen.report.derive import spread, typical_leg
from proxgen.report.film import write_film
from proxgen.report.path import FRONT, bounds, draw_view, postures
from proxgen.report.stage import Stage, fitting_camera
from proxgen.report.stills import draw_still
from proxgen.simulation.log import RolloutLog
from proxgen.simulation.rollout import run

HERE = Path(__file__).parent
EXAMPLES = HERE.parent.parent / "examples" / "iiwa7"

FILMS = (
    ("gap", "iiwa7.yaml", "skin", 3.0, 21.0),
    ("pillar", "iiwa7.yaml", "skin", 3.0, 19.0),
    ("moving", "iiwa7.yaml", "skin", 0.0, 20.0),
    ("facing", "iiwa7_improved.yaml", "ideal", 3.0, 22.0),
)
"""Scene, configuration, sensing, and the part that is shown [s], without the way from the upright start."""


def main() -> None:
    """One film per scene, and a drawing of the run in the gap."""
    for scene, file, sensing, start, end in FILMS:
        config = proxgen.load(EXAMPLES / file)
        model = build_model(config)
        duration = 60.0 if scene == "gap" else end
        log = run(config, model, proxgen.build(config), load_scene(scene), sensing=sensing, duration=duration)
        write_film(HERE / f"{scene}.gif", log, model, start=start, end=end)
        if scene == "gap":
            draw_gap(log, model, config.task.tolerance)


def draw_gap(log: RolloutLog, model: RobotModel, tolerance: float) -> None:
    """Arm, path, distance to the target and least distance side by side."""
    leg = typical_leg(log)
    with style.house_style():
        figure = style.new_figure(3.7, 13.0)
        grid = figure.add_gridspec(2, 3, width_ratios=[1.1, 0.8, 1.7])
        scene = figure.add_subplot(grid[:, 0])
        camera = fitting_camera(log, model, 550, 500, cycles=(leg.first, leg.last))
        with Stage(log, model, camera) as stage:
            draw_still(scene, stage, spread(leg, log, 3)[1], leg.first)
        front = figure.add_subplot(grid[:, 1])
        draw_view(front, log, FRONT, *bounds(log, []), arms=postures(log, model))
        front.set_title("Path, from the front")
        sawtooth, nearest = figure.add_subplot(grid[0, 2]), figure.add_subplot(grid[1, 2])
        draw_sawtooth(sawtooth, log, tolerance)
        sawtooth.tick_params(labelbottom=False)
        draw_least_distance(nearest, log)
        nearest.set_title("Nearest link to the boxes")
        nearest.set_xlabel("time [s]")
        style.save(figure, HERE / "gap.png")


if __name__ == "__main__":
    main()
