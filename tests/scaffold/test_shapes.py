"""Collision geometry as point clouds: every shape, where it is placed, and what is refused."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from proxgen.errors import ModelError
from proxgen.scaffold.fit import fit_capsule
from proxgen.scaffold.shapes import collision_clouds, rotation_of


def clouds_of(tmp_path: Path, *collisions: str) -> np.ndarray:
    """Points of the collision elements of one link."""
    urdf = tmp_path / "robot.urdf"
    urdf.write_text(f'<robot name="r"><link name="a">{"".join(collisions)}</link></robot>')
    return collision_clouds(urdf, ["a"])["a"].points


def collision(geometry: str, origin: str = "") -> str:
    """A collision element."""
    return f"<collision>{origin}<geometry>{geometry}</geometry></collision>"


def test_rotation_is_that_of_pinocchio() -> None:
    rng = np.random.default_rng(1)
    for rpy in rng.uniform(-4.0, 4.0, (50, 3)):
        np.testing.assert_allclose(rotation_of(rpy), pin.rpy.rpyToMatrix(*rpy), atol=1e-15)


def test_box_has_its_corners(tmp_path: Path) -> None:
    points = clouds_of(tmp_path, collision('<box size="0.2 0.4 0.6"/>', '<origin xyz="1 2 3"/>'))
    assert points.shape == (8, 3)
    np.testing.assert_allclose(points.min(axis=0), [0.9, 1.8, 2.7])
    np.testing.assert_allclose(points.max(axis=0), [1.1, 2.2, 3.3])


def test_a_cylinder_is_inside_its_polygons_and_they_are_tight(tmp_path: Path) -> None:
    origin = '<origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/>'
    points = clouds_of(tmp_path, collision('<cylinder radius="0.05" length="0.3"/>', origin))
    local = (points - [0.1, 0.2, 0.3]) @ rotation_of(np.array([0.4, 0.5, 0.6]))
    np.testing.assert_allclose(np.abs(local[:, 2]), 0.15)
    angles = np.random.default_rng(2).uniform(0.0, 2.0 * np.pi, 2000)
    for direction in np.column_stack([np.cos(angles), np.sin(angles)]):
        assert 0.05 - 1e-12 <= (local[:, :2] @ direction).max() <= 0.05 * (1.0 + 1e-4)


def test_sphere_and_capsule_are_balls(tmp_path: Path) -> None:
    urdf = tmp_path / "robot.urdf"
    shapes = collision('<sphere radius="0.1"/>') + collision('<capsule radius="0.1" length="0.5"/>')
    urdf.write_text(f'<robot name="r"><link name="a">{shapes}</link></robot>')
    cloud = collision_clouds(urdf, ["a"])["a"]
    assert cloud.radii.tolist() == [0.1, 0.1, 0.1]
    assert fit_capsule(cloud).length == pytest.approx(0.5, rel=1e-6)


def test_only_links_that_are_asked_for_are_opened(tmp_path: Path) -> None:
    urdf = tmp_path / "robot.urdf"
    missing = collision('<mesh filename="nowhere.stl"/>')
    box = collision('<box size="1 1 1"/>')
    urdf.write_text(
        f'<robot name="r"><link name="a">{box}</link><link name="b">{missing}</link><link name="c"/></robot>'
    )
    assert set(collision_clouds(urdf, ["a", "c"])) == {"a"}
    with pytest.raises(ModelError, match=r"link 'b'.*nowhere\.stl"):
        collision_clouds(urdf, ["a", "b"])


@pytest.mark.parametrize(
    ("element", "message"),
    [
        ("<collision/>", "a <collision> has no geometry"),
        (collision(""), "a <collision> has no geometry"),
        (collision("<cone/>"), r"unknown shape <cone> \(allowed: box, capsule, cylinder, mesh, sphere\)"),
        (collision('<box size="1 1"/>'), "<box size=...> must be three numbers"),
        (collision('<box size="1 1 x"/>'), "<box size=...> must be three numbers"),
        (collision('<sphere radius="1 cm"/>'), "<sphere radius=...> must be a number, at least 0"),
        (collision('<box size="0 0 0"/>'), "it has no extent; is a size or a scale 0?"),
        (collision('<sphere radius="-1"/>'), "<sphere radius=...> must be a number, at least 0"),
        (collision('<cylinder radius="1"/>'), "<cylinder length=...> must be a number"),
        (collision('<sphere radius="1"/>', '<origin xyz="0 0"/>'), "<origin xyz=...> must be three numbers"),
    ],
)
def test_what_is_not_a_shape_is_refused(tmp_path: Path, element: str, message: str) -> None:
    with pytest.raises(ModelError, match=message) as caught:
        clouds_of(tmp_path, element)
    assert "robot.urdf" in str(caught.value)
    assert "'a'" in str(caught.value)
