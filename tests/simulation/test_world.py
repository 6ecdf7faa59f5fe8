"""Rays in pybullet, worlds side by side, a clean standard output, pictures."""

import subprocess
import sys

import numpy as np
import pytest
from numpy.typing import NDArray

from proxgen.errors import SimulationError
from proxgen.model import RobotModel
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.geometry import point_to_capsule, ray_to_capsule
from proxgen.simulation.obstacles import Motion, Obstacle, ObstacleField
from proxgen.simulation.scenery import rotation_of
from proxgen.simulation.world import Camera, World, quaternion

Array = NDArray[np.float64]


def sphere(position: tuple[float, float, float], radius: float, motion: Motion | None = None) -> Obstacle:
    return Obstacle("ball", "sphere", np.zeros(3), radius, 0.0, np.array(position), np.eye(3), motion)


def pipe(position: tuple[float, float, float], rotation: Array) -> Obstacle:
    return Obstacle("pipe", "capsule", np.zeros(3), 0.1, 0.6, np.array(position), rotation)


def random_rays(count: int, seed: int) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    origins = rng.uniform(-1.0, 1.0, (count, 3))
    directions = 0.3 * rng.normal(size=(count, 3)) - origins
    return origins, directions / np.linalg.norm(directions, axis=1)[:, None]


def test_rays_agree_with_closed_forms(planar2_model: RobotModel) -> None:
    rotation = rotation_of((0.3, 0.8, -0.2))
    obstacle = pipe((0.1, -0.1, 0.2), rotation)
    half = 0.5 * obstacle.length * rotation[:, 2]
    origins, directions = random_rays(500, 13)
    expected = ray_to_capsule(
        origins, directions, obstacle.position - half, obstacle.position + half, np.array(obstacle.radius)
    )
    outside = expected > 0.0
    with World(ObstacleField([obstacle]), ArmGeometry(planar2_model)) as world:
        found = 2.0 * world.rays(origins, origins + 2.0 * directions)
    hit = outside & (expected < 1.99)
    assert hit.sum() > 50
    # Bullet stops within 1 mm of the surface, which is further along a ray that grazes it.
    ends = (origins + found[:, None] * directions)[hit]
    near = point_to_capsule(
        ends, obstacle.position - half, obstacle.position + half, np.array(obstacle.radius)
    )
    np.testing.assert_allclose(near.distance, 0.0, atol=1e-3)
    assert (found[hit] <= expected[hit] + 1e-6).all()
    assert np.median(expected[hit] - found[hit]) < 5e-4
    assert (found[np.isinf(expected)] == 2.0).mean() > 0.99


def test_rays_hit_boxes_exactly_and_miss_beside(planar2_model: RobotModel) -> None:
    box = Obstacle("box", "box", np.array([0.1, 0.2, 0.3]), 0.0, 0.0, np.array([0.6, 0.0, 0.0]), np.eye(3))
    origins = np.array([[0.0, 0.0, 0.0], [0.0, 0.19, 0.29], [0.0, 0.21, 0.0], [0.6, 0.0, 0.0]])
    with World(ObstacleField([box]), ArmGeometry(planar2_model)) as world:
        found = world.rays(origins, origins + np.array([1.0, 0.0, 0.0]))
    np.testing.assert_allclose(found, [0.5, 0.5, 1.0, 1.0], atol=1e-9)  # the last one starts inside


def test_more_rays_than_pybullet_takes_at_once(planar2_model: RobotModel) -> None:
    count = 40_000
    origins = np.zeros((count, 3))
    ends = np.tile([1.0, 0.0, 0.0], (count, 1))
    ends[1::2] = [-1.0, 0.0, 0.0]
    with World(ObstacleField([sphere((0.5, 0.0, 0.0), 0.1)]), ArmGeometry(planar2_model)) as world:
        found = world.rays(origins, ends)
    np.testing.assert_allclose(found[0::2], 0.4, atol=1e-4)
    np.testing.assert_array_equal(found[1::2], 1.0)


def test_moving_obstacles_are_where_their_closed_form_says(planar2_model: RobotModel) -> None:
    motion = Motion(np.array([1.0, 0.0, 0.0]), 0.4, 0.2, 1.0, 10.0, 0.0)
    obstacle = sphere((0.3, 0.0, 0.0), 0.1, motion)
    with World(ObstacleField([obstacle]), ArmGeometry(planar2_model)) as world:
        for time in (0.0, 1.0, 2.5, 4.0, 7.0):
            world.place(time)
            found = world.rays(np.zeros((1, 3)), np.array([[1.0, 0.0, 0.0]]))
            assert found[0] == pytest.approx(obstacle.position_at(time)[0] - 0.1, abs=1e-4)


def test_two_worlds_do_not_disturb_each_other(planar2_model: RobotModel) -> None:
    arm, origin, end = ArmGeometry(planar2_model), np.zeros((1, 3)), np.array([[1.0, 0.0, 0.0]])
    with World(ObstacleField([sphere((0.5, 0, 0), 0.1)]), arm) as near:
        with World(ObstacleField([sphere((0.9, 0, 0), 0.1)]), arm) as far:
            assert near.rays(origin, end)[0] == pytest.approx(0.4, abs=1e-4)
            assert far.rays(origin, end)[0] == pytest.approx(0.8, abs=1e-4)
        assert near.rays(origin, end)[0] == pytest.approx(0.4, abs=1e-4)
        near.close()
        near.close()
        with pytest.raises(SimulationError, match="closed"):
            near.rays(origin, end)


def test_the_arm_is_hit_by_rays_only_if_asked(iiwa7_model: RobotModel) -> None:
    arm = ArmGeometry(iiwa7_model)
    poses = arm.poses(np.zeros(7))
    origin, end = np.array([[1.0, 0.0, 0.9]]), np.array([[0.0, 0.0, 0.9]])
    forearm = iiwa7_model.capsules[1].body
    for in_rays, carrier, expected in ((False, 0, 1.0), (True, 0, 0.93), (True, forearm, 1.0)):
        with World(ObstacleField([]), arm, arm_in_rays=in_rays) as world:
            world.place(0.0, poses)
            found = world.rays(origin, end, np.array([carrier]))
        assert found[0] == pytest.approx(expected, abs=1e-4)


def test_nothing_is_printed() -> None:
    """Pybullet prints a banner from C on import; in a pipe, C holds it back till the end."""
    code = (
        "from proxgen.simulation.obstacles import ObstacleField\n"
        "from proxgen.simulation.world import World\n"
        "print('before')\n"
        "class Arm:\n"
        "    class model: capsules = ()\n"
        "World(ObstacleField([]), Arm()).close()\n"
        "print('after')\n"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (result.stdout, result.stderr) == ("before\nafter\n", "")


def test_a_window_without_a_display_is_refused(
    monkeypatch: pytest.MonkeyPatch, planar2_model: RobotModel
) -> None:
    """Left to itself, pybullet would end the process."""
    for display in ("", ":4242"):
        monkeypatch.setenv("DISPLAY", display)
        with pytest.raises(SimulationError, match="needs an X display"):
            World(ObstacleField([]), ArmGeometry(planar2_model), gui=True)


def test_a_picture_shows_arm_obstacles_and_targets(iiwa7_model: RobotModel) -> None:
    arm = ArmGeometry(iiwa7_model)
    motion = Motion(np.array([0.0, 0.0, 1.0]), 0.4, 0.2, 1.0, 10.0, 0.0)
    field = ObstacleField([sphere((0.4, 0.4, 0.3), 0.15, motion)])
    camera = Camera(width=160, height=120)
    with World(field, arm) as world:
        bent, straight = arm.poses(np.array([0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0])), arm.poses(np.zeros(7))
        pictures = [
            world.shoot(time, poses, camera=camera, targets=np.array([[0.5, -0.4, 0.4]])).pixels
            for time, poses in ((0.0, straight), (0.0, bent), (2.0, straight), (0.0, straight))
        ]
        rays = world.rays(np.array([[0.0, 0.0, 2.0]]), np.array([[0.0, 0.0, 0.5]]))
    for picture in pictures:
        assert picture.shape == (120, 160, 3)
        assert picture.dtype == np.uint8
        assert picture.std() > 10.0
    assert (pictures[0] != pictures[1]).any(axis=2).mean() > 0.01
    assert (pictures[0] != pictures[2]).any(axis=2).mean() > 0.005
    np.testing.assert_array_equal(pictures[0], pictures[3])
    assert rays[0] == 1.0  # what is only drawn does not stop rays


def test_quaternion_of_every_kind_of_rotation() -> None:
    rng = np.random.default_rng(14)
    for rpy in [*rng.uniform(-np.pi, np.pi, (50, 3)), (np.pi, 0, 0), (0, np.pi, 0), (0, 0, np.pi), (0, 0, 0)]:
        rotation = rotation_of(tuple(rpy))
        x, y, z, w = quaternion(rotation)
        again = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )
        np.testing.assert_allclose(again, rotation, atol=1e-12)


def test_pybullet_is_loaded_only_where_it_is_needed() -> None:
    code = "import sys, proxgen.simulation.rollout; print(sorted({'pybullet', 'ruckig'} & set(sys.modules)))"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout == "[]\n"
