"""The robot in its scenes, rendered: figures 6, 8 and 11."""

from collections.abc import Sequence
from dataclasses import dataclass
from string import ascii_lowercase

import numpy as np
from matplotlib.figure import Figure

from proxgen.model.robot_model import RobotModel
from proxgen.report import style
from proxgen.report.derive import spoken, spread, time_span, typical_leg
from proxgen.report.path import obstacles_of
from proxgen.report.stage import Stage, fitting_camera
from proxgen.report.stills import draw_still
from proxgen.reproduce.figures.runs import Runs, example
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.log import RolloutLog
from proxgen.simulation.obstacles import ObstacleField

_COLUMNS = 3
_SIZE = (540, 450)
"""Of one picture [pixels]."""
_TRAIL = 6.0
"""How long the tool's path stays in the picture [s]."""


@dataclass(frozen=True)
class Moment:
    """One picture: a cycle of a run, the cycle at which the tool's path begins, and a title."""

    log: RolloutLog
    cycle: int
    since: int
    title: str


def figure_06(*, proposed: Runs, model: RobotModel) -> Figure:
    """Figure 6: the robot's motion during function verification, from the singular start to the targets.

    Args:
        proposed: runs of the proposed method in the scene with the pillar; the first one is shown.
        model: the arm.
    """
    log = example(proposed)
    leg = typical_leg(log)
    moments = [0, *spread(leg, log, 5)]
    names = [
        f"{letter})  t = {log.time[cycle]:.1f} s"
        for letter, cycle in zip(ascii_lowercase, moments, strict=False)
    ]
    starts = [0, *[leg.first] * (len(moments) - 1)]
    return _pictures([Moment(log, *which) for which in zip(moments, starts, names, strict=True)], model)


def figure_08(*, dynamic: Runs, model: RobotModel) -> Figure:
    """Figure 8: the robot with dynamic obstacles, before and while each of them is nearest.

    Args:
        dynamic: runs of the proposed method in the scene with moving obstacles; the first one is shown.
        model: the arm.
    """
    log = example(dynamic)
    near = _nearest_moments(log, model)
    before = round(2.0 / log.meta["period"])
    pictures = [(max(cycle - before, 0), "") for _, cycle in near]
    pictures += [(cycle, f" ({name})") for name, cycle in near]
    trail = round(_TRAIL / log.meta["period"])
    moments = [
        Moment(log, cycle, max(cycle - trail, 0), f"{letter})  t = {log.time[cycle]:.1f} s{text}")
        for letter, (cycle, text) in zip(ascii_lowercase, pictures, strict=False)
    ]
    return _pictures(moments, model, columns=len(near))


def figure_11(*, proposed: Runs, tangential: Runs, repulsive: Runs, model: RobotModel) -> Figure:
    """Figure 11: the gap between two boxes: the start that all methods share, and what each of them does.

    Args:
        proposed: runs of the proposed method in the scene with the gap; the first one is shown.
        tangential: of the tangential method.
        repulsive: of the repulsive method.
        model: the arm.
    """
    first = example(proposed)
    moments = [Moment(first, 0, 0, "a)  Singular start")]
    methods = (("b)  Proposed", proposed), ("c)  Tangential", tangential), ("d)  Repulsive", repulsive))
    for name, runs in methods:
        log = example(runs)
        cycle = _between_targets(log)
        moments.append(Moment(log, cycle, 0, f"{name}, t = {log.time[cycle]:.1f} s"))
    return _pictures(moments, model, columns=2)


def _pictures(moments: Sequence[Moment], model: RobotModel, columns: int = _COLUMNS) -> Figure:
    """Pictures in rows, all from one place."""
    columns = max(min(columns, len(moments)), 1)
    rows = -(-len(moments) // columns)
    first = moments[0].log
    camera = fitting_camera(first, model, *_SIZE)
    width = style.PRINT_WIDTH / columns
    figure = style.new_figure(rows * (width * _SIZE[1] / _SIZE[0] + 0.3), style.PRINT_WIDTH)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes in panels[len(moments) :]:
        axes.set_axis_off()
    for axes, moment in zip(panels, moments, strict=False):
        with Stage(moment.log, model, camera) as stage:
            draw_still(axes, stage, moment.cycle, moment.since)
        axes.set_title(moment.title)
    return figure


def _nearest_moments(log: RolloutLog, model: RobotModel) -> list[tuple[str, int]]:
    """Each moving obstacle's name and the cycle in which it first comes nearest to the arm, in order of time.

    Only its first period counts, so that the pictures follow one upon the other.
    """
    obstacles, arm = obstacles_of(log), ArmGeometry(model)
    moving = [index for index, obstacle in enumerate(obstacles) if obstacle.motion is not None]
    if not moving:
        return [("nearest", int(log.reference_distance().min(axis=1).argmin()))]
    periods = [motion.period for obstacle in obstacles if (motion := obstacle.motion) is not None]
    cycles = np.flatnonzero(log.time <= min(max(periods), time_span(log)[1]))[::5]
    field = ObstacleField(obstacles)
    distances = [
        field.near_segments(float(log.time[cycle]), *arm.axes(arm.poses(log.q[cycle]))).distance.min(axis=0)
        for cycle in cycles.tolist()
    ]
    nearest = np.array(distances).argmin(axis=0)
    found = [(spoken(obstacles[index].name), int(cycles[nearest[index]])) for index in moving]
    return sorted(found, key=lambda pair: pair[1])


def _between_targets(log: RolloutLog) -> int:
    """The middle of a way between two targets; the end of the run where no such way was completed."""
    leg = typical_leg(log)
    if leg.first == 0:
        return log.cycles - 1
    return spread(leg, log, 3)[1]
