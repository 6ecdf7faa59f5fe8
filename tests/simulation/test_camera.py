"""The camera's geometry, held against the renderer; meshes of round solids."""

import numpy as np
import pytest

from proxgen.model import RobotModel
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.obstacles import Obstacle, ObstacleField
from proxgen.simulation.world import Camera, World
from proxgen.simulation.world.meshes import Mesh, disc_mesh, round_mesh

BALL, RADIUS = np.array([0.7, 0.5, 0.9]), 0.05


@pytest.mark.parametrize(("yaw", "pitch"), [(0.0, 0.0), (62.0, -16.0), (-140.0, -50.0), (200.0, 30.0)])
def test_points_appear_where_the_renderer_draws_them(
    planar2_model: RobotModel, yaw: float, pitch: float
) -> None:
    camera = Camera(target=(0.6, 0.6, 0.85), distance=1.5, yaw=yaw, pitch=pitch, width=320, height=240)
    ball = Obstacle("ball", "sphere", np.zeros(3), RADIUS, 0.0, BALL, np.eye(3))
    arm = ArmGeometry(planar2_model)
    with World(ObstacleField([ball]), arm) as world:
        shot = world.shoot(0.0, arm.poses(np.zeros(2)), camera=camera)
    (place,), (depth,) = camera.project(BALL[None])
    rows, columns = np.nonzero(np.abs(shot.depth - depth) < 1.1 * RADIUS)
    assert len(rows) > 100
    assert (columns.mean() + 0.5, rows.mean() + 0.5) == pytest.approx(tuple(place), abs=1.0)
    assert shot.depth[rows, columns].min() == pytest.approx(depth - RADIUS, abs=3e-3)
    before, behind = BALL - 0.1 * camera.axes[2], BALL + 0.1 * camera.axes[2]
    beside = BALL + 0.2 * camera.axes[0]
    assert shot.hidden(np.array([before, behind, beside])).tolist() == [False, True, False]


def test_axes_are_orthonormal_and_right_handed() -> None:
    right, up, forward = Camera(yaw=33.0, pitch=-21.0).axes
    basis = np.stack([right, up, -forward])
    np.testing.assert_allclose(basis @ basis.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(basis) == pytest.approx(1.0)
    assert right[2] == 0.0
    assert up[2] > 0.0


def test_a_fitted_camera_sees_all_points_and_not_much_more() -> None:
    rng = np.random.default_rng(5)
    for _ in range(20):
        points = rng.uniform(-1.0, 1.0, (30, 3)) * rng.uniform(0.1, 2.0, 3)
        camera = Camera(yaw=float(rng.uniform(-180, 180)), pitch=-20.0, width=400, height=300)
        camera = camera.fitted(points, margin=0.05)
        places, depth = camera.project(points)
        assert (depth > 0.0).all()
        assert (places >= [19.0, 14.0]).all()
        assert (places <= [381.0, 286.0]).all()
        room = 1.0 - np.ptp(places, axis=0) / [400, 300]
        assert room.min() < 0.11  # the margin on both sides


def faces(mesh: Mesh) -> np.ndarray:
    """Normals of the triangles, as long as their area."""
    corners = mesh.vertices[mesh.triangles]
    return 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


@pytest.mark.parametrize("length", [0.0, 0.4])
def test_round_meshes_look_outwards_and_enclose_their_volume(length: float) -> None:
    mesh = round_mesh(0.1, length)
    axis = np.clip(mesh.vertices[:, 2], -0.5 * length, 0.5 * length)[:, None] * [0.0, 0.0, 1.0]
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices - axis, axis=1), 0.1, atol=1e-12)
    outward = mesh.normals[mesh.triangles].mean(axis=1)
    area = faces(mesh)
    solid = np.linalg.norm(area, axis=1) > 1e-12  # at the poles, triangles shrink to lines
    assert ((area * outward).sum(axis=1)[solid] > 0.0).all()
    exact = np.pi * 0.1**2 * length + 4.0 / 3.0 * np.pi * 0.1**3
    volume = (mesh.vertices[mesh.triangles[:, 0]] * area).sum() / 3.0
    assert volume == pytest.approx(exact, rel=0.02)


def test_a_disc_looks_up() -> None:
    mesh = disc_mesh(2.0)
    area = faces(mesh)
    assert (area[:, 2] > 0.0).all()
    assert area[:, 2].sum() == pytest.approx(np.pi * 4.0, rel=1e-3)
    assert np.abs(area[:, :2]).max() == 0.0
