"""Nearest points against brute force, against each other, and against Bullet."""

from collections.abc import Iterator

import coal
import numpy as np
import pybullet
import pytest
from numpy.typing import NDArray

from proxgen.model.frames import axis_basis
from proxgen.simulation.geometry import (
    between_segments,
    norm,
    point_to_box,
    point_to_capsule,
    point_to_sphere,
    ray_to_capsule,
    segment_to_box,
    segment_to_capsule,
    segment_to_sphere,
)
from proxgen.simulation.world import quaternion

Array = NDArray[np.float64]


def signed_box_distance(point: Array, half: Array) -> float:
    """Textbook signed distance of a box, written for one point."""
    excess = np.abs(point) - half
    return float(np.linalg.norm(np.maximum(excess, 0.0)) + min(excess.max(), 0.0))


def least_along(start: Array, end: Array, half: Array) -> float:
    """Brute force: the signed distance is convex along a segment, so thirds can be cut off."""
    low, high = 0.0, 1.0
    for _ in range(120):
        third = (high - low) / 3.0
        left, right = (
            signed_box_distance(start + t * (end - start), half) for t in (low + third, high - third)
        )
        low, high = (low, high - third) if left < right else (low + third, high)
    return signed_box_distance(start + 0.5 * (low + high) * (end - start), half)


def test_segment_to_box_is_the_least_signed_distance_along_the_segment() -> None:
    rng = np.random.default_rng(1)
    starts, ends = rng.uniform(-0.6, 0.6, (2, 300, 3))
    half = rng.uniform(0.02, 0.4, (300, 3))
    near = segment_to_box(starts, ends, half)
    brute = np.array([least_along(*pair) for pair in zip(starts, ends, half, strict=True)])
    assert (brute < 0.0).sum() > 50
    assert (brute > 0.0).sum() > 50
    np.testing.assert_allclose(near.distance, brute, atol=1e-9)
    outside = brute > 1e-6
    gap = [
        np.linalg.norm(s + np.clip((p - s) @ (e - s) / ((e - s) @ (e - s)), 0, 1) * (e - s) - p)
        for s, e, p in zip(starts, ends, near.point, strict=True)
    ]
    np.testing.assert_allclose(np.array(gap)[outside], brute[outside], atol=1e-7)
    assert (np.abs(near.point) <= half + 1e-15).all()


def test_segment_to_box_of_special_segments() -> None:
    half = np.array([0.1, 0.2, 0.3])
    cases = {
        "a point": ([0.3, 0.0, 0.0], [0.3, 0.0, 0.0], 0.2),
        "parallel to a face": ([-1.0, 0.0, 0.5], [1.0, 0.0, 0.5], 0.2),
        "parallel to an edge": ([0.4, -1.0, 0.7], [0.4, 1.0, 0.7], 0.5),
        "on a face": ([0.1, -0.1, 0.0], [0.1, 0.1, 0.0], 0.0),
        "through the middle": ([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], -0.1),
        "inside": ([0.05, 0.0, 0.0], [0.05, 0.1, 0.0], -0.05),
        "a point inside": ([0.0, 0.0, 0.29], [0.0, 0.0, 0.29], -0.01),
        "ends before the corner": ([0.5, 0.6, 0.7], [0.4, 0.6, 0.7], np.sqrt(0.09 + 0.16 + 0.16)),
    }
    for name, (start, end, expected) in cases.items():
        near = segment_to_box(np.array([start]), np.array([end]), half[None])
        assert near.distance[0] == pytest.approx(expected, abs=1e-12), name


def test_nearest_point_of_a_parallel_segment_is_in_the_middle_of_the_overlap() -> None:
    half = np.full((1, 3), 0.1)
    near = segment_to_box(np.array([[-1.0, 0.0, 0.3]]), np.array([[1.0, 0.0, 0.3]]), half)
    np.testing.assert_allclose(near.point[0], [0.0, 0.0, 0.1], atol=1e-12)


def test_between_segments_against_a_grid() -> None:
    rng = np.random.default_rng(2)
    a, b, c, d = rng.uniform(-1.0, 1.0, (4, 200, 3))
    d[:40] = c[:40] + 0.7 * (b[:40] - a[:40])  # parallel
    b[40:50], d[50:60] = a[40:50], c[50:60]  # points
    s, t = between_segments(a, b, c, d)
    gap = norm(a + s[:, None] * (b - a) - c - t[:, None] * (d - c))
    grid = np.linspace(0.0, 1.0, 101)
    on_first = a[:, None] + grid[None, :, None] * (b - a)[:, None]
    on_second = c[:, None] + grid[None, :, None] * (d - c)[:, None]
    brute = norm(on_first[:, :, None] - on_second[:, None]).min(axis=(1, 2))
    assert (gap <= brute + 1e-12).all()
    assert (gap >= brute - 0.03).all()
    assert ((s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)).all()


def test_round_solids_follow_from_their_axes() -> None:
    rng = np.random.default_rng(3)
    points, starts, ends, centres = rng.uniform(-1.0, 1.0, (4, 100, 3))
    radii = rng.uniform(0.05, 0.5, 100)
    sphere = point_to_sphere(points, centres, radii)
    np.testing.assert_allclose(sphere.distance, norm(points - centres) - radii)
    degenerate = point_to_capsule(points, centres, centres, radii)
    np.testing.assert_allclose(degenerate.distance, sphere.distance)
    for near, start, end in (
        (point_to_capsule(points, starts, ends, radii), points, points),
        (segment_to_capsule(points, centres, starts, ends, radii), points, centres),
    ):
        s, t = between_segments(start, end, starts, ends)
        own = start + s[:, None] * (end - start)
        other = starts + t[:, None] * (ends - starts)
        np.testing.assert_allclose(near.distance, norm(own - other) - radii, atol=1e-12)
        outside = near.distance > 0.0
        np.testing.assert_allclose(norm(near.point - own)[outside], near.distance[outside], atol=1e-12)
        np.testing.assert_allclose(near.point[~outside], own[~outside], atol=1e-12)
    segment = segment_to_sphere(starts, ends, centres, radii)
    capsule = point_to_capsule(centres, starts, ends, np.zeros(100))
    np.testing.assert_allclose(segment.distance, capsule.distance - radii, atol=1e-12)


def test_point_to_box_is_the_segment_of_no_length() -> None:
    rng = np.random.default_rng(4)
    points, half = rng.uniform(-0.6, 0.6, (200, 3)), rng.uniform(0.05, 0.5, (200, 3))
    by_point, by_segment = point_to_box(points, half), segment_to_box(points, points, half)
    np.testing.assert_allclose(by_point.distance, by_segment.distance, atol=1e-12)
    np.testing.assert_allclose(by_point.point, by_segment.point, atol=1e-12)


def random_pairs() -> Iterator[tuple[Array, Array, Array, float]]:
    """Start and end of a segment, half size of a box and radius of a sphere, both in the origin."""
    rng = np.random.default_rng(5)
    for _ in range(60):
        start, end = rng.uniform(-0.8, 0.8, (2, 3))
        yield start, end, rng.uniform(0.05, 0.3, 3), float(rng.uniform(0.05, 0.3))


def test_distances_agree_with_coal_to_a_micrometre() -> None:
    thin, compared = 1e-3, 0
    for start, end, half, radius in random_pairs():
        length = float(np.linalg.norm(end - start))
        pose = coal.Transform3s(axis_basis(end - start), 0.5 * (start + end))
        capsule = coal.Capsule(thin, length)
        box = coal.distance(
            capsule,
            pose,
            coal.Box(*(2.0 * half)),
            coal.Transform3s(),
            coal.DistanceRequest(),
            coal.DistanceResult(),
        )
        sphere = coal.distance(
            capsule,
            pose,
            coal.Sphere(radius),
            coal.Transform3s(),
            coal.DistanceRequest(),
            coal.DistanceResult(),
        )
        ours = segment_to_box(start[None], end[None], half[None]).distance[0]
        if ours > 2.0 * thin:
            assert box == pytest.approx(ours - thin, abs=1e-6)
            compared += 1
        ours = segment_to_sphere(start, end, np.zeros(3), np.array(radius)).distance
        assert sphere == pytest.approx(ours - thin, abs=1e-6)
    assert compared > 30


def bullet_distance(client: int, start: Array, end: Array, thin: float, collision: int) -> float:
    """Least distance between a thin capsule and a body in the origin."""
    length = float(np.linalg.norm(end - start))
    shape = pybullet.createCollisionShape(
        pybullet.GEOM_CAPSULE, radius=thin, height=length, physicsClientId=client
    )
    middle, turn = (0.5 * (start + end)).tolist(), quaternion(axis_basis(end - start))
    arm = pybullet.createMultiBody(0, shape, -1, middle, turn, physicsClientId=client)
    body = pybullet.createMultiBody(0, collision, -1, physicsClientId=client)
    contacts = pybullet.getClosestPoints(arm, body, 3.0, physicsClientId=client)
    pybullet.removeBody(arm, physicsClientId=client)
    pybullet.removeBody(body, physicsClientId=client)
    return float(min(contact[8] for contact in contacts))


def test_distances_agree_with_bullet() -> None:
    client, thin, compared = pybullet.connect(pybullet.DIRECT), 1e-3, 0
    try:
        for start, end, half, radius in random_pairs():
            ball = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=radius, physicsClientId=client)
            ours = segment_to_sphere(start, end, np.zeros(3), np.array(radius)).distance
            if ours > 2.0 * thin:  # Bullet is not exact for penetrations
                assert bullet_distance(client, start, end, thin, ball) == pytest.approx(ours - thin, abs=1e-6)
            box = pybullet.createCollisionShape(
                pybullet.GEOM_BOX, halfExtents=half.tolist(), physicsClientId=client
            )
            near = segment_to_box(start[None], end[None], half[None])
            if near.distance[0] > 2.0 * thin:
                on_face = (np.abs(near.point[0]) > half - 1e-9).sum() == 1
                tolerance = 1e-6 if on_face else 1e-3  # Bullet rounds edges and corners off by 1 mm
                theirs = bullet_distance(client, start, end, thin, box)
                assert theirs == pytest.approx(near.distance[0] - thin, abs=tolerance)
                compared += on_face
    finally:
        pybullet.disconnect(client)
    assert compared >= 3


def test_ray_to_capsule_against_marching() -> None:
    rng = np.random.default_rng(6)
    origins, starts, ends = rng.uniform(-1.0, 1.0, (3, 400, 3))
    towards = 0.5 * (starts + ends) + rng.normal(0.0, 0.25, (400, 3)) - origins
    directions = towards / norm(towards)[:, None]
    directions[60:120] *= -1.0  # the capsule is behind
    radii = rng.uniform(0.05, 0.3, 400)
    ends[:50] = starts[:50]
    directions[50:60] = (ends - starts)[50:60] / norm((ends - starts)[50:60])[:, None]
    found = ray_to_capsule(origins, directions, starts, ends, radii)
    travelled = np.zeros(400)
    for _ in range(4000):  # sphere tracing: never steps through a surface
        here = origins + travelled[:, None] * directions
        travelled += np.clip(point_to_capsule(here, starts, ends, radii).distance, 0.0, 5.0)
    hit = point_to_capsule(origins + travelled[:, None] * directions, starts, ends, radii).distance < 1e-9
    assert 100 < hit.sum() < 400
    inside = point_to_capsule(origins, starts, ends, radii).distance <= 0.0
    assert inside.any()
    assert (found[inside] == 0.0).all()
    np.testing.assert_allclose(found[hit], travelled[hit], atol=2e-4)
    assert np.isinf(found[~hit]).all()
