"""Outlines against closed forms."""

import numpy as np
import pytest
from numpy.typing import NDArray

from proxgen.report.outlines import box_faces, capsule_outline, convex_hull, obstacle_outline, round_surface
from proxgen.simulation.obstacles import Obstacle

Array = NDArray[np.float64]


def area(outline: Array) -> float:
    """Shoelace formula; positive if counter-clockwise."""
    x, y = outline.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def obstacle(shape: str, rotation: Array | None = None) -> Obstacle:
    """An obstacle of each shape, 0.2 x 0.4 x 0.6 m or of radius 0.1 m."""
    half = np.array([0.1, 0.2, 0.3]) if shape == "box" else np.zeros(3)
    length = 0.5 if shape == "capsule" else 0.0
    radius = 0.0 if shape == "box" else 0.1
    turned = np.eye(3) if rotation is None else rotation
    return Obstacle(shape, shape, half, radius, length, np.array([1.0, 2.0, 3.0]), turned)  # type: ignore[arg-type]


def test_hull_drops_inner_points_and_goes_counter_clockwise() -> None:
    square = np.array([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [0.5, 0.0]])
    hull = convex_hull(square)
    assert len(hull) == 4
    assert area(hull) == pytest.approx(1.0)


def test_hull_of_fewer_than_three_points_is_these_points() -> None:
    assert convex_hull(np.array([[1.0, 2.0], [1.0, 2.0]])).tolist() == [[1.0, 2.0]]


def test_capsule_outline_has_the_area_of_a_stadium() -> None:
    outline = capsule_outline(np.array([0.0, 0.0]), np.array([0.3, 0.4]), 0.1)
    assert area(outline) == pytest.approx(2 * 0.1 * 0.5 + np.pi * 0.01, rel=3e-3)


def test_sphere_outline_is_a_circle_around_the_centre() -> None:
    outline = obstacle_outline(obstacle("sphere"), np.array([1.0, 2.0, 3.0]), (1, 2))
    assert np.linalg.norm(outline - [2.0, 3.0], axis=1) == pytest.approx(0.1)


@pytest.mark.parametrize(("axes", "expected"), [((0, 1), 0.08), ((0, 2), 0.12), ((1, 2), 0.24)])
def test_box_outline_has_the_area_of_its_face(axes: tuple[int, int], expected: float) -> None:
    assert area(obstacle_outline(obstacle("box"), np.zeros(3), axes)) == pytest.approx(expected)


def test_turned_box_shows_more_of_itself() -> None:
    turn = np.array([[np.sqrt(0.5), -np.sqrt(0.5), 0.0], [np.sqrt(0.5), np.sqrt(0.5), 0.0], [0.0, 0.0, 1.0]])
    outline = obstacle_outline(obstacle("box", turn), np.zeros(3), (1, 2))
    assert np.ptp(outline[:, 0]) == pytest.approx((0.2 + 0.4) * np.sqrt(0.5))
    assert np.ptp(outline[:, 1]) == pytest.approx(0.6)


def test_box_faces_lie_on_the_box_and_cover_it() -> None:
    centre = np.array([1.0, 2.0, 3.0])
    faces = box_faces(obstacle("box"), centre)
    sizes = sorted(float(np.prod(np.ptp(face, axis=0)[np.ptp(face, axis=0) > 0])) for face in faces)
    assert sizes == pytest.approx([0.08, 0.08, 0.12, 0.12, 0.24, 0.24])
    assert np.mean(np.concatenate(faces), axis=0) == pytest.approx(centre)


@pytest.mark.parametrize("shape", ["sphere", "capsule"])
def test_round_surface_has_the_radius_everywhere(shape: str) -> None:
    solid, centre = obstacle(shape), np.array([1.0, 2.0, 3.0])
    points = np.stack(round_surface(solid, centre), axis=-1).reshape(-1, 3) - centre
    along = np.clip(points[:, 2], -0.5 * solid.length, 0.5 * solid.length)
    points[:, 2] -= along
    assert np.linalg.norm(points, axis=1) == pytest.approx(solid.radius)
