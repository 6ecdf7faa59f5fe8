"""A first scene of the robot's own size: two targets, a post beside the way, a visitor."""

from dataclasses import dataclass

import numpy as np

from proxgen.model.frames import roll_pitch_yaw
from proxgen.model.posture import Posture
from proxgen.model.robot_model import Array
from proxgen.scaffold.postures import neighbours

_DIRECTIONS = 16

Line = tuple[Array, Array]
"""Origin and direction, (3,) each."""


@dataclass(frozen=True)
class Thresholds:
    """Distances of the law (13), to the capsules' surfaces, of a robot's size [m]."""

    d_a: float
    d_0u: float
    d_0l: float
    d_r: float


@dataclass(frozen=True)
class Ball:
    """A sphere in the scene.

    Attributes:
        position: (3,) centre at rest [m].
        radius: [m].
        direction: (3,) of its motion, unit vector; zeros if it stands still.
        distance: how far it moves [m].
    """

    position: Array
    radius: float
    direction: Array
    distance: float


@dataclass(frozen=True)
class Aim:
    """A target: the tool's pose in some posture, so that tasks of every kind can reach it.

    Attributes:
        position: (3,) [m].
        orientation: (3,) roll, pitch, yaw [rad].
    """

    position: Array
    orientation: Array


@dataclass(frozen=True)
class SceneProposal:
    """What the scene file says.

    Attributes:
        start: (n,) joint positions [rad or m].
        targets: where the tool goes, back and forth.
        post: stands beside the way.
        visitor: comes towards the arm and goes back.
    """

    start: Array
    targets: tuple[Aim, ...]
    post: Ball
    visitor: Ball


def propose_scene(start: Posture, rows: tuple[str, ...], size: float, limits: Thresholds) -> SceneProposal:
    """Place targets and obstacles around a start posture.

    Args:
        start: where the arm starts; the visitor comes to where its sensors look.
        rows: the task's position rows; obstacles are placed where the tool can move.
        size: length of the stretched arm [m].
        limits: thresholds; the obstacles come that near.

    Returns:
        Targets on both sides of the start, reachable by postures nearby; a post within d_a of the way but not
        within d_0u; a visitor that comes closer than d_0l to the arm at the start.
    """
    chosen = ["xyz".index(row) for row in rows]
    along, ends = _targets(start, chosen, size)
    way = [start, *ends, *(Posture(start.model, 0.5 * (start.q + end.q)) for end in ends)]
    radius = round(float(np.clip(0.06 * size, 0.02, 0.08)), 3)
    beside = [(start.tool, direction) for direction in _across(along, chosen)]
    distance, (origin, aside) = _shortest(beside, way, radius + 0.6 * limits.d_a + 0.4 * limits.d_0u, size)
    post = Ball(np.round(origin + distance * aside, 3) + 0.0, radius, np.zeros(3), 0.0)
    lines = _seen(start, chosen) or beside
    apart = [line for line in lines if line[1] @ aside < 0.5]
    far, (origin, outwards) = _shortest(apart or lines, way, radius + 1.2 * limits.d_a, size)
    near = _first((origin, outwards), [start], radius + 0.5 * (limits.d_0l + limits.d_r), size)
    return SceneProposal(
        start.q,
        tuple(_aim(end) for end in ends),
        post,
        Ball(
            np.round(origin + far * outwards, 3) + 0.0,
            radius,
            np.round(-outwards, 3) + 0.0,
            round(max(far - near, 0.1 * limits.d_a), 3),
        ),
    )


def _aim(end: Posture) -> Aim:
    """The tool's pose in a posture, rounded."""
    orientation = roll_pitch_yaw(end.tool_pose[:3, :3])
    return Aim(np.round(end.tool, 3) + 0.0, np.round(orientation, 3) + 0.0)


def _shortest(lines: list[Line], way: list[Posture], clearance: float, size: float) -> tuple[float, Line]:
    """The line along which the arm is first that far away, and how far that is."""
    return min(((_first(line, way, clearance, size), line) for line in lines), key=lambda choice: choice[0])


def _seen(start: Posture, chosen: list[int]) -> list[Line]:
    """Lines along which a sensor looks at the start, within what the task moves in: origin and direction."""
    lines, other = [], [axis for axis in range(3) if axis not in chosen]
    for module in start.model.modules:
        pose = start.poses[module.body]
        normal = pose[:3, :3] @ module.normal
        if np.linalg.norm(normal[other]) < 0.2:
            lines.append((pose[:3, :3] @ module.position + pose[:3, 3], normal))
    return lines


def _targets(start: Posture, chosen: list[int], size: float) -> tuple[Array, list[Posture]]:
    """The direction in which the tool moves most freely, and two postures that reach out both ways."""
    candidates = neighbours(start)
    offsets = np.zeros((len(candidates), 3))
    offsets[:, chosen] = np.array([posture.tool - start.tool for posture in candidates])[:, chosen]
    offsets[np.linalg.norm(offsets, axis=1) > 0.35 * size] = 0.0
    along = np.linalg.svd(offsets, full_matrices=False)[2][0]
    sideways = np.eye(3)[1]
    # Sideways is easier to look at, if the tool gets at least half as far as in its freest direction.
    if 1 in chosen and np.ptp(offsets @ sideways) > 0.5 * np.ptp(offsets @ along):
        along = sideways
    along = along if along[np.argmax(np.abs(along))] > 0.0 else -along
    forward = offsets @ along
    astray = np.linalg.norm(offsets - forward[:, None] * along, axis=1)
    return along, [candidates[int(np.argmax(sign * forward - astray))] for sign in (-1.0, 1.0)]


def _across(along: Array, chosen: list[int]) -> list[Array]:
    """Directions normal to the way, within what the task moves in; any normal one if that is a line."""
    allowed = np.eye(3)[chosen]
    normals = allowed - np.outer(allowed @ along, along)
    _, weights, basis = np.linalg.svd(normals)
    kept = basis[: int((weights > 1e-6).sum())]
    if len(kept) == 0:
        kept = np.linalg.svd(along[None])[2][1:]
    if len(kept) == 1:
        return [kept[0], -kept[0]]
    angles = 2.0 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    return [np.cos(angle) * kept[0] + np.sin(angle) * kept[1] for angle in angles]


def _first(line: Line, way: list[Posture], clearance: float, size: float) -> float:
    """How far along a line (origin, direction) a point is first that far from the arm in all postures [m]."""
    origin, direction = line
    steps = np.arange(1, 301) * (size / 100.0)
    points = origin + steps[:, None] * direction
    clear = np.min([posture.gaps(points).min(axis=1) for posture in way], axis=0) >= clearance
    return float(steps[np.argmax(clear)] if clear.any() else steps[-1])
