"""The least capsule: closed forms, containment, and a long search that works quite differently."""

import math

import numpy as np
import pytest
from capsule_search import excess, long_search

from proxgen.scaffold.fit import FittedCapsule, fit_capsule
from proxgen.scaffold.shapes import Cloud, points_only, rotation_of

BOX = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


def on_a_capsule(length: float, radius: float, count: int = 4000) -> np.ndarray:
    """Points all over the surface of a capsule along z."""
    rng = np.random.default_rng(1)
    normal = rng.normal(size=(count, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    height = np.where(normal[:, 2] > 0.0, 0.5 * length, -0.5 * length)
    height = np.where(rng.random(count) < 0.5, height, rng.uniform(-0.5, 0.5, count) * length)
    flat = np.abs(height) < 0.5 * length
    normal[flat, 2] = 0.0
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    points: np.ndarray = radius * normal
    points[:, 2] += height
    return points


def test_a_capsule_is_found_again_wherever_it_lies() -> None:
    points = on_a_capsule(0.4, 0.07)
    for rpy in ((0.0, 0.0, 0.0), (0.3, -1.2, 2.0), (1.5, 0.1, 0.0)):
        rotation, place = rotation_of(np.array(rpy)), np.array([1.0, -2.0, 0.5])
        capsule = fit_capsule(points_only(points).placed(rotation, place))
        assert capsule.radius == pytest.approx(0.07, rel=1e-3)
        assert capsule.length == pytest.approx(0.4, rel=1e-2)
        direction = (capsule.end - capsule.start) / capsule.length
        assert abs(direction @ rotation[:, 2]) > 0.9999
        np.testing.assert_allclose(0.5 * (capsule.start + capsule.end), place, atol=1e-3)


def test_balls_are_contained_with_their_radii() -> None:
    cloud = Cloud(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), np.array([0.1, 0.1]))
    capsule = fit_capsule(cloud)
    assert capsule.radius == pytest.approx(0.1, rel=1e-6)
    assert capsule.length == pytest.approx(1.0, rel=1e-6)
    ball = fit_capsule(Cloud(np.zeros((1, 3)), np.array([0.3])))
    assert (ball.length, ball.radius) == (0.0, 0.3)


def test_a_long_box_is_nearly_that_of_its_edges() -> None:
    """Around the middle axis of a bar a x a x L, R = a / sqrt(2) would do, with an axis of length L."""
    capsule = fit_capsule(points_only(BOX * [0.1, 0.1, 1.0]))
    middle = FittedCapsule(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.1 / math.sqrt(2.0))
    assert capsule.volume < middle.volume
    assert capsule.radius == pytest.approx(0.1 / math.sqrt(2.0), rel=0.02)


@pytest.mark.parametrize("flat", ["plane", "line", "point"])
def test_clouds_without_volume(flat: str) -> None:
    rng = np.random.default_rng(2)
    points = rng.normal(size=(50, 3)) * {"plane": [1, 1, 0], "line": [1, 0, 0], "point": [0, 0, 0]}[flat]
    capsule = fit_capsule(points_only(points))
    assert excess(points, capsule) < 1e-12
    assert np.isfinite([*capsule.start, *capsule.end, capsule.radius]).all()


@pytest.mark.parametrize("seed", range(12))
def test_random_clouds_are_contained_and_no_long_search_finds_less(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(rng.integers(5, 3000), 3)) * rng.uniform(0.02, 0.3, 3)
    points = points @ rotation_of(rng.uniform(-3.0, 3.0, 3)).T + rng.normal(size=3)
    capsule = fit_capsule(points_only(points))
    assert excess(points, capsule) < 1e-12
    assert capsule.volume <= 1.001 * long_search(points, seed)


def test_the_same_cloud_gives_the_same_capsule() -> None:
    points = np.random.default_rng(3).normal(size=(500, 3))
    first, second = fit_capsule(points_only(points)), fit_capsule(points_only(points))
    np.testing.assert_array_equal(first.start, second.start)
    assert first.radius == second.radius
