"""The collision geometry of a URDF as point clouds: what a capsule has to contain.

Every shape is the convex hull of some balls, most of them of radius zero: a mesh its vertices, a box its
corners, a sphere one ball, a capsule two. A cylinder's rims are replaced by polygons around them, so that
what contains the polygons contains the cylinder.
"""

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np

from proxgen.errors import ModelError
from proxgen.model.robot_model import Array
from proxgen.scaffold.meshes import find_mesh, read_mesh

RIM = 256
"""Corners of the polygon around a cylinder's rim: 1e-4 of its radius too large, at most."""


@dataclass(frozen=True)
class Cloud:
    """Balls whose convex hull is a body.

    Attributes:
        points: centres (k, 3) [m].
        radii: (k,) [m].
    """

    points: Array
    radii: Array

    def placed(self, rotation: Array, translation: Array) -> "Cloud":
        """The same cloud in another frame."""
        return Cloud(self.points @ rotation.T + translation, self.radii)


def merged(clouds: Iterable[Cloud]) -> Cloud:
    """One cloud of several, at least one."""
    clouds = list(clouds)
    points = np.vstack([cloud.points for cloud in clouds])
    return Cloud(points, np.concatenate([cloud.radii for cloud in clouds]))


def points_only(points: Array) -> Cloud:
    """A cloud of balls without radius."""
    return Cloud(points, np.zeros(len(points)))


def collision_clouds(urdf: Path, links: Iterable[str]) -> dict[str, Cloud]:
    """Collision geometry of some links, each in its link's frame.

    Args:
        urdf: a readable URDF.
        links: names of the links to look at; the meshes of others are not opened.

    Returns:
        By link; a link without collision geometry is missing.

    Raises:
        ModelError: a mesh is missing or cannot be read, or a shape is not known; the message names it.
    """
    wanted, clouds = set(links), {}
    for link in ElementTree.parse(urdf).getroot().findall("link"):
        name = link.get("name", "")
        collisions = link.findall("collision")
        if name in wanted and collisions:
            try:
                clouds[name] = _with_extent(merged(_collision(element, urdf) for element in collisions))
            except (ModelError, ValueError) as error:
                raise ModelError(f"{urdf}: collision geometry of link '{name}': {error}") from error
    return clouds


def _with_extent(cloud: Cloud) -> Cloud:
    """The cloud, unless all of it is one point, around which there is nothing to put."""
    if not cloud.radii.any() and not np.ptp(cloud.points, axis=0).any():
        raise ModelError("it has no extent; is a size or a scale 0?")
    return cloud


def _collision(collision: ElementTree.Element, urdf: Path) -> Cloud:
    """One <collision> element in its link's frame."""
    shape = next(iter(collision.find("geometry") or ()), None)
    if shape is None:
        raise ModelError("a <collision> has no geometry")
    if shape.tag not in _SHAPES:
        raise ModelError(f"unknown shape <{shape.tag}> (allowed: {', '.join(sorted(_SHAPES))})")
    cloud, origin = _SHAPES[shape.tag](shape, urdf), collision.find("origin")
    if origin is None:
        return cloud
    return cloud.placed(rotation_of(_numbers(origin, "rpy", "0 0 0")), _numbers(origin, "xyz", "0 0 0"))


def _mesh(shape: ElementTree.Element, urdf: Path) -> Cloud:
    """Vertices of a mesh file."""
    path = find_mesh(shape.get("filename", ""), urdf)
    return points_only(read_mesh(path, _numbers(shape, "scale", "1 1 1")))


def _box(shape: ElementTree.Element, urdf: Path) -> Cloud:
    """Corners of a box."""
    corners = np.array(list(product((-0.5, 0.5), repeat=3)))
    return points_only(corners * _numbers(shape, "size"))


def _cylinder(shape: ElementTree.Element, urdf: Path) -> Cloud:
    """Polygons around both rims; the axis is z."""
    angles = 2.0 * math.pi * np.arange(RIM) / RIM
    radius = _number(shape, "radius") / math.cos(math.pi / RIM)
    rim = np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.zeros(RIM)])
    half = np.array([0.0, 0.0, 0.5 * _number(shape, "length")])
    return points_only(np.vstack([rim - half, rim + half]))


def _sphere(shape: ElementTree.Element, urdf: Path) -> Cloud:
    """One ball."""
    return Cloud(np.zeros((1, 3)), np.array([_number(shape, "radius")]))


def _capsule(shape: ElementTree.Element, urdf: Path) -> Cloud:
    """Two balls on the z axis; the length is that of the axis between them."""
    half = np.array([0.0, 0.0, 0.5 * _number(shape, "length")])
    return Cloud(np.array([-half, half]), np.full(2, _number(shape, "radius")))


_SHAPES: dict[str, Callable[[ElementTree.Element, Path], Cloud]] = {
    "mesh": _mesh,
    "box": _box,
    "cylinder": _cylinder,
    "sphere": _sphere,
    "capsule": _capsule,
}


def _numbers(element: ElementTree.Element, attribute: str, default: str = "") -> Array:
    """Three numbers of an attribute, (3,)."""
    try:
        values = np.array([float(word) for word in element.get(attribute, default).split()])
    except ValueError:
        values = np.zeros(0)
    if values.shape != (3,) or not np.isfinite(values).all():
        raise ModelError(f"<{element.tag} {attribute}=...> must be three numbers")
    return values


def _number(element: ElementTree.Element, attribute: str) -> float:
    """One number of an attribute, at least zero."""
    try:
        value = float(element.get(attribute, "nan"))
    except ValueError:
        value = math.nan
    if not 0.0 <= value < math.inf:
        raise ModelError(f"<{element.tag} {attribute}=...> must be a number, at least 0")
    return value


def rotation_of(rpy: Array) -> Array:
    """Rotation matrix (3, 3) of roll, pitch, yaw (3,) about fixed x, y, z, as in a URDF [rad]."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
