"""A first scene of the robot's own size: two targets, a post beside the way, a visitor."""

from dataclasses import dataclass

import numpy as np

from proxgen.model.robot_model import Array
from proxgen.scaffold.postures import Posture, neighbours

_DIRECTIONS = 16


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
class SceneProposal:
    """What the scene file says.

    Attributes:
        start: (n,) joint positions [rad or m].
        targets: (3,) each [m].
        post: stands beside the way.
        visitor: comes towards the arm and goes back.
    """

    start: Array
    targets: tuple[Array, ...]
    post: Ball
    visitor: Ball


def propose_scene(start: Posture, rows: tuple[str, ...], size: float, limits: Thresholds) -> SceneProposal:
    """Place targets and obstacles around a start posture.

    Args:
        start: where the arm starts.
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
    places = []
    for direction in _across(along, chosen):
        distance = _first(start, way, direction, radius + 0.6 * limits.d_a + 0.4 * limits.d_0u, size)
        places.append((distance, direction))
    post_distance, post_direction = min(places, key=lambda place: place[0])
    apart = [place for place in places if place[1] @ post_direction < 0.5]
    _, visitor_direction = min(apart or places, key=lambda place: place[0])
    far = _first(start, way, visitor_direction, radius + 1.2 * limits.d_a, size)
    near = _first(start, [start], visitor_direction, radius + 0.5 * (limits.d_0l + limits.d_r), size)
    return SceneProposal(
        start.q,
        tuple(np.round(end.tool, 3) + 0.0 for end in ends),
        Ball(np.round(start.tool + post_distance * post_direction, 3), radius, np.zeros(3), 0.0),
        Ball(
            np.round(start.tool + far * visitor_direction, 3),
            radius,
            np.round(-visitor_direction, 3) + 0.0,
            round(max(far - near, 0.1 * limits.d_a), 3),
        ),
    )


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


def _first(start: Posture, way: list[Posture], direction: Array, clearance: float, size: float) -> float:
    """How far from the tool, in a direction, a point is first that far from the arm in all postures [m]."""
    steps = np.arange(1, 301) * (size / 100.0)
    for distance in steps:
        point = start.tool + distance * direction
        if min(posture.gaps(point[None]).min() for posture in way) >= clearance:
            return float(distance)
    return float(steps[-1])
