"""Where the tool went: three views to one scale and one in space, with obstacles, targets and the arm."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D
from numpy.typing import NDArray

from proxgen.model.robot_model import RobotModel
from proxgen.report import style
from proxgen.report.derive import least_distance, spread, typical_leg, with_pedestal
from proxgen.report.outlines import box_faces, capsule_outline, obstacle_outline, round_surface
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.log import RolloutLog
from proxgen.simulation.obstacles import Obstacle

Array = NDArray[np.float64]

AXIS_NAMES = ("x", "y", "z")
FRONT, SIDE, TOP = (1, 2), (0, 2), (1, 0)
"""Views as (right, up) axes; in the top view x points down, so that it lies below the front view."""

_ARMS = 5

TITLE = "Path of the tool"
CAPTION = (
    "Three views to one scale, and one in space. The path is drawn in a warning colour where the true "
    "distance of some link to an obstacle is below d_r. The arm is shown at five moments of one way, later "
    "ones darker. Obstacles that move are dashed at the far end of their way."
)
_SOLID: dict[str, Any] = {"facecolor": style.OBSTACLE, "edgecolor": style.OBSTACLE_EDGE, "linewidth": 0.9}
_AT_REST = _SOLID | {"alpha": 0.75}
_FAR_END = _SOLID | {"alpha": 0.3, "linestyle": (0, (3, 2))}


def path_figure(log: RolloutLog, model: RobotModel | None = None) -> Figure:
    """First-angle drawing: front view, side view to its right, top view below, and a view in space.

    Args:
        log: the run.
        model: the arm; drawn at some moments of one way between two targets if given.
    """
    arms = postures(log, model) if model is not None else []
    low, high = bounds(log, arms)
    size = high - low
    scale = 0.86 * style.WIDTH / (size[1] + size[0])
    figure = style.new_figure(0.95 + scale * (size[2] + size[0]))
    grid = figure.add_gridspec(2, 2, width_ratios=[size[1], size[0]], height_ratios=[size[2], size[0]])
    views = ((FRONT, grid[0, 0], "Front"), (SIDE, grid[0, 1], "Side"), (TOP, grid[1, 0], "Top"))
    for view, place, title in views:
        axes = figure.add_subplot(place)
        draw_view(axes, log, view, low, high, arms)
        axes.set_title(title)
    space = figure.add_subplot(grid[1, 1], projection="3d")
    assert isinstance(space, Axes3D)
    _draw_space(space, log, low, high, arms)
    figure.legend(handles=path_legend(log, bool(arms)), loc="outside lower center", ncols=6)
    return figure


@dataclass(frozen=True)
class Posture:
    """The arm's capsules in the world: ends of their axes, each (L, 3), and radii (L,) [m]."""

    starts: Array
    ends: Array
    radii: Array


def postures(log: RolloutLog, model: RobotModel) -> list[Posture]:
    """The arm at some moments of a typical way between targets."""
    geometry = ArmGeometry(with_pedestal(model))
    moments = spread(typical_leg(log), log, _ARMS)
    return [Posture(*geometry.axes(geometry.poses(log.q[moment])), geometry.radius) for moment in moments]


def obstacles_of(log: RolloutLog) -> list[Obstacle]:
    """The obstacles that the log describes."""
    return [Obstacle.from_plain(plain) for plain in log.meta["obstacles"]]


def centres(obstacle: Obstacle) -> list[Array]:
    """Where an obstacle is at rest and, if it moves, at the far end of its way."""
    if obstacle.motion is None:
        return [obstacle.position]
    return [obstacle.position, obstacle.position + obstacle.motion.distance * obstacle.motion.direction]


def bounds(log: RolloutLog, arms: Sequence[Posture]) -> tuple[Array, Array]:
    """Lower and upper corner (3,) of all that is drawn, with a margin [m]."""
    points = [log.tool_position, np.array(log.meta["targets"]).reshape(-1, 3), np.zeros((1, 3))]
    points += [ends for arm in arms for ends in (arm.starts, arm.ends)]
    for obstacle in obstacles_of(log):
        for centre in centres(obstacle):
            planes = [obstacle_outline(obstacle, centre, view) for view in (FRONT, SIDE)]
            reach = np.zeros((2, 3))
            reach[:, 0] = planes[1][:, 0].min(), planes[1][:, 0].max()
            reach[:, 1] = planes[0][:, 0].min(), planes[0][:, 0].max()
            reach[:, 2] = planes[0][:, 1].min(), planes[0][:, 1].max()
            points.append(reach)
    cloud = np.concatenate(points)
    low, high = cloud.min(axis=0) - 0.08, cloud.max(axis=0) + 0.08
    half = 0.5 * (high - low)
    middle, half = low + half, np.maximum(half, 0.4 * half.max())
    return middle - half, middle + half


def draw_view(
    axes: Axes, log: RolloutLog, view: tuple[int, int], low: Array, high: Array,
    arms: Sequence[Posture] = (),
) -> None:  # fmt: skip
    """One view along an axis: obstacles and arm to scale, the path, the targets."""
    right, up = view
    plane = [right, up]
    for number, arm in enumerate(arms):
        shade = 0.06 + 0.16 * number / max(len(arms) - 1, 1)
        for start, end, radius in zip(arm.starts, arm.ends, arm.radii, strict=True):
            outline = capsule_outline(start[plane], end[plane], radius)
            axes.add_patch(Polygon(outline, facecolor=style.MUTED, alpha=shade, linewidth=0.0))
            axes.add_patch(
                Polygon(outline, fill=False, edgecolor=style.MUTED, alpha=2.0 * shade, linewidth=0.7)
            )
    for obstacle in obstacles_of(log):
        for number, centre in enumerate(centres(obstacle)):
            look = _AT_REST if number == 0 else _FAR_END
            axes.add_patch(Polygon(obstacle_outline(obstacle, centre, view), **look))
    lines = LineCollection(
        list(_segments(log.tool_position[:, plane])), colors=_path_colours(log), linewidths=1.1
    )
    axes.add_collection(lines)
    axes.plot(*log.tool_position[0, plane], marker="s", color=style.INK, markersize=4.5, linestyle="none")
    targets = np.array(log.meta["targets"]).reshape(-1, 3)
    axes.plot(*targets[:, plane].T, marker="*", color=style.GREEN, markersize=12, linestyle="none", zorder=5)
    axes.set_aspect("equal")
    axes.set_xlim(low[right], high[right])
    axes.set_ylim((low[up], high[up]) if up == 2 else (high[up], low[up]))
    axes.set_xlabel(f"{AXIS_NAMES[right]} [m]")
    axes.set_ylabel(f"{AXIS_NAMES[up]} [m]")


def path_legend(log: RolloutLog, arms: bool) -> list[Line2D | Patch]:
    """What the marks of a view mean."""
    d_r = log.meta["thresholds"]["d_r"]
    entries: list[Line2D | Patch] = [
        Line2D([], [], color=style.BLUE, label="path of the tool"),
        Line2D([], [], color=style.VERMILLION, label=f"some link nearer than $d_r$ = {d_r:g} m"),
        Line2D([], [], color=style.INK, marker="s", markersize=4.5, linestyle="none", label="start"),
        Line2D([], [], color=style.GREEN, marker="*", markersize=11, linestyle="none", label="targets"),
        Patch(facecolor=style.OBSTACLE, edgecolor=style.OBSTACLE_EDGE, label="obstacles"),
    ]
    return [*entries, Patch(facecolor=style.MUTED, alpha=0.3, label="arm on one way")] if arms else entries


def _segments(points: Array) -> Array:
    """Pieces of a polyline, (T - 1, 2, dimension)."""
    return np.stack([points[:-1], points[1:]], axis=1)


def _path_colours(log: RolloutLog) -> list[str]:
    """Colour of each piece of the path: the tool's own, or a warning where some link is below d_r."""
    near = least_distance(log)[1:] < log.meta["thresholds"]["d_r"]
    return [style.VERMILLION if below else style.BLUE for below in near.tolist()]


def _draw_space(axes: Axes3D, log: RolloutLog, low: Array, high: Array, arms: Sequence[Posture]) -> None:
    """The same in space, seen from the front and a little from above."""
    for obstacle in obstacles_of(log):
        if obstacle.shape == "box":
            faces = box_faces(obstacle, obstacle.position)
            axes.add_collection3d(Poly3DCollection(faces, **_SOLID | {"alpha": 0.35}))
        else:
            surface = round_surface(obstacle, obstacle.position)
            axes.plot_surface(*surface, color=style.OBSTACLE, alpha=0.45, linewidth=0.0)
    for arm in arms[:: max(len(arms) // 2, 1)]:
        axes.add_collection3d(
            Line3DCollection(
                np.stack([arm.starts, arm.ends], axis=1), colors=style.MUTED, linewidths=4.0, alpha=0.35
            )
        )
    if log.cycles > 1:
        segments = _segments(log.tool_position)
        axes.add_collection3d(Line3DCollection(segments, colors=_path_colours(log), linewidths=1.0))
    targets = np.array(log.meta["targets"]).reshape(-1, 3)
    axes.scatter(*targets.T, marker="*", s=90, color=style.GREEN, depthshade=False)
    for setter, name, index in ((axes.set_xlim, "x", 0), (axes.set_ylim, "y", 1), (axes.set_zlim, "z", 2)):
        setter(low[index], high[index])
        getattr(axes, f"set_{name}label")(f"{name} [m]")
        getattr(axes, f"{name}axis").set_major_locator(MaxNLocator(5))
    axes.set_box_aspect(high - low)
    axes.view_init(elev=20.0, azim=-35.0)
    axes.set_title("In space", loc="left")
