"""Pictures of the arm at some moments of one way between two targets."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from proxgen.model.robot_model import RobotModel
from proxgen.report import style
from proxgen.report.derive import spread, typical_leg
from proxgen.report.overlay import Overlay
from proxgen.report.stage import Stage, fitting_camera
from proxgen.simulation.log import RolloutLog

_MOMENTS = 4
_SIZE = (420, 380)
"""Of one picture [pixels]."""
_SCALE = 2.0
"""Pictures are rendered this many times larger, then made smaller, for smooth edges."""

TITLE = "The arm on one way between two targets"
CAPTION = (
    "Rendered at equal steps along the tool's path, which is blue. Bars join links to the nearest obstacle: "
    "light blue, yellow, orange, red as the distance falls below one threshold after the other. Dots are the "
    "skin's modules, in colour where they feel something. The target with a ring is the present one."
)


def stills_figure(log: RolloutLog, model: RobotModel) -> Figure:
    """Rendered pictures side by side, at equal steps along the tool's path.

    Args:
        log: the run.
        model: the arm that ran.
    """
    leg = typical_leg(log)
    moments = spread(leg, log, _MOMENTS)
    camera = fitting_camera(log, model, *_SIZE, cycles=(leg.first, leg.last))
    figure = style.new_figure(0.35 + style.WIDTH / len(moments) * camera.height / camera.width)
    panels = figure.subplots(1, len(moments), squeeze=False)[0]
    with Stage(log, model, camera) as stage:
        for axes, moment in zip(panels, moments, strict=True):
            draw_still(axes, stage, moment, leg.first)
    return figure


def draw_still(axes: Axes, stage: Stage, cycle: int, since: int) -> None:
    """One cycle as a picture.

    Args:
        axes: to draw on.
        stage: the scene.
        cycle: which moment.
        since: the tool's path begins at this cycle.
    """
    overlay = Overlay(stage.shoot(cycle, _SCALE), _SCALE)
    draw_moment(overlay, stage, cycle, since)
    axes.imshow(overlay.picture(), interpolation="antialiased")
    axes.set_title(f"t = {stage.log.time[cycle]:.1f} s")
    axes.set_axis_off()


def draw_moment(overlay: Overlay, stage: Stage, cycle: int, since: int) -> None:
    """What every picture of a run shows: path of the tool, skin, distances, the target that is pursued."""
    overlay.path(stage.log.tool_position[since : cycle + 1], style.BLUE)
    overlay.modules(stage.modules(cycle))
    for gap in stage.gaps(cycle):
        overlay.gap(gap)
    overlay.ring(stage.log.target_position[cycle], style.GREEN)
