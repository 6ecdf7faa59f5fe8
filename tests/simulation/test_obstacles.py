"""Obstacles that move in closed form, and nearest points of mixed fields."""

import numpy as np
import pytest
from numpy.typing import NDArray

from proxgen.simulation.geometry import norm
from proxgen.simulation.obstacles import Motion, Obstacle, ObstacleField
from proxgen.simulation.scenery import rotation_of

Array = NDArray[np.float64]

MOTION = Motion(np.array([0.0, 0.0, 1.0]), distance=0.4, speed=0.2, hold=3.0, period=20.0, phase=0.0)


@pytest.mark.parametrize(
    ("time", "travelled"),
    [
        (0.0, 0.0),
        (1.0, 0.2),
        (2.0, 0.4),
        (4.9, 0.4),
        (6.0, 0.2),
        (7.0, 0.0),
        (15.0, 0.0),
        (21.0, 0.2),
        (-19.0, 0.2),
    ],
)
def test_motion_goes_out_holds_comes_back_and_rests(time: float, travelled: float) -> None:
    np.testing.assert_allclose(MOTION.displacement(time), [0.0, 0.0, travelled], atol=1e-12)


def test_phase_is_how_far_into_its_period_the_motion_is_at_time_zero() -> None:
    shifted = Motion(MOTION.direction, 0.4, 0.2, 3.0, 20.0, phase=5.0)
    for time in np.linspace(0.0, 40.0, 81):
        np.testing.assert_allclose(shifted.displacement(time), MOTION.displacement(time + 5.0), atol=1e-12)


def test_motion_is_continuous_and_never_faster_than_its_speed() -> None:
    times = np.linspace(-20.0, 40.0, 6001)
    path = np.array([MOTION.displacement(time)[2] for time in times])
    assert np.abs(np.diff(path)).max() <= 0.2 * 0.01 + 1e-9
    assert path.min() == 0.0
    assert path.max() == pytest.approx(0.4)


def mixed_field() -> ObstacleField:
    """Every shape, turned, two of them moving."""
    turned = rotation_of((0.4, -0.7, 1.1))
    zero = np.zeros(3)
    return ObstacleField(
        [
            Obstacle("box", "box", np.array([0.1, 0.2, 0.05]), 0.0, 0.0, np.array([0.5, 0.1, 0.3]), turned),
            Obstacle("ball", "sphere", zero, 0.1, 0.0, np.array([-0.4, 0.2, 0.5]), np.eye(3), MOTION),
            Obstacle("pipe", "capsule", zero, 0.05, 0.4, np.array([0.1, -0.5, 0.2]), turned, MOTION),
            Obstacle(
                "crate", "box", np.array([0.1, 0.1, 0.1]), 0.0, 0.0, np.array([-0.2, -0.6, 0.1]), np.eye(3)
            ),
        ]
    )


def surface_sample(obstacle: Obstacle, time: float, rng: np.random.Generator) -> Array:
    """Many points of a solid obstacle in the world, by rejection-free sampling of its definition."""
    count = 200_000
    if obstacle.shape == "box":
        local = rng.uniform(-obstacle.half_size, obstacle.half_size, (count, 3))
        face = rng.integers(0, 3, count)
        local[np.arange(count), face] = np.sign(rng.uniform(-1, 1, count)) * obstacle.half_size[face]
    else:
        direction = rng.normal(size=(count, 3))
        local = obstacle.radius * direction / norm(direction)[:, None]
        local[:, 2] += rng.uniform(-0.5, 0.5, count) * obstacle.length
    return local @ obstacle.rotation.T + obstacle.position_at(time)


def test_nearest_points_of_a_mixed_field_against_sampled_surfaces() -> None:
    rng, field, time = np.random.default_rng(7), mixed_field(), 1.3
    starts, ends = rng.uniform(-1.0, 1.0, (2, 12, 3))
    points, segments = field.near_points(time, starts), field.near_segments(time, starts, ends)
    assert ((points.distance > 0.0).sum(axis=0) >= 6).all() and (
        (segments.distance > 0.0).sum(axis=0) >= 4
    ).all()
    for o, obstacle in enumerate(field.obstacles):
        sample = surface_sample(obstacle, time, rng)
        for k in range(12):
            if points.distance[k, o] > 0.0:
                brute = norm(sample - starts[k]).min()
                assert points.distance[k, o] == pytest.approx(brute, abs=2e-3)
                assert norm(points.point[k, o] - starts[k]) == pytest.approx(points.distance[k, o])
            if segments.distance[k, o] > 0.0:
                along = ends[k] - starts[k]
                t = np.clip((sample - starts[k]) @ along / (along @ along), 0.0, 1.0)
                brute = norm(sample - starts[k] - t[:, None] * along).min()
                assert segments.distance[k, o] == pytest.approx(brute, abs=2e-3)


def test_results_are_in_the_order_of_the_scene() -> None:
    field = mixed_field()
    for o, obstacle in enumerate(field.obstacles):
        near = field.near_points(2.5, obstacle.position_at(2.5)[None])
        assert int(np.argmin(near.distance[0])) == o
        assert near.distance[0, o] < 0.0


def test_a_field_without_obstacles_has_no_nearest_points() -> None:
    near = ObstacleField([]).near_segments(0.0, np.zeros((3, 3)), np.ones((3, 3)))
    assert near.point.shape == (3, 0, 3)
    assert near.distance.shape == (3, 0)


def test_obstacles_survive_being_written_down() -> None:
    for obstacle in mixed_field().obstacles:
        again = Obstacle.from_plain(obstacle.to_plain())
        np.testing.assert_array_equal(again.rotation, obstacle.rotation)
        np.testing.assert_array_equal(again.position_at(3.3), obstacle.position_at(3.3))
        assert (again.name, again.shape, again.radius, again.length) == (
            obstacle.name,
            obstacle.shape,
            obstacle.radius,
            obstacle.length,
        )
