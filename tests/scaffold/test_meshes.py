"""Meshes: formats, units, transforms, where they are found, and broken files."""

import struct
from pathlib import Path

import numpy as np
import pytest

from proxgen.errors import ModelError
from proxgen.scaffold.meshes import find_mesh, read_mesh

CORNERS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]])
FACES = [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)]
ONE = np.ones(3)


def write_stl(path: Path) -> Path:
    """A tetrahedron as a binary STL, which repeats every corner."""
    records = b"".join(
        struct.pack("<12fH", 0, 0, 0, *(x for k in face for x in CORNERS[k]), 0) for face in FACES
    )
    path.write_bytes(b"\0" * 80 + struct.pack("<I", len(FACES)) + records)
    return path


def write_ascii_stl(path: Path) -> Path:
    """The same as text."""
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {} {} {}\n".format(*CORNERS[k]) for k in face)
        + "endloop\nendfacet\n"
        for face in FACES
    )
    path.write_text(f"solid t\n{facets}endsolid t\n")
    return path


def write_obj(path: Path) -> Path:
    """The same as OBJ."""
    lines = ["v {} {} {}".format(*corner) for corner in CORNERS]
    lines += ["f " + " ".join(str(k + 1) for k in face) for face in FACES]
    path.write_text("\n".join(lines) + "\n")
    return path


def write_dae(path: Path, asset: str = "", transform: str = "") -> Path:
    """The same as COLLADA, with the transform at its node."""
    numbers = " ".join(f"{x}" for x in CORNERS.ravel())
    indices = " ".join(str(k) for face in FACES for k in face)
    path.write_text(
        f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><created>2020-01-01T00:00:00</created><modified>2020-01-01T00:00:00</modified>{asset}</asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">{numbers}</float_array>
<technique_common><accessor source="#a" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>{indices}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="outer"><node id="inner">{transform}
<instance_geometry url="#g"/></node></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""
    )
    return path


def sorted_rows(points: np.ndarray) -> np.ndarray:
    """Points in an order of their own."""
    rows: np.ndarray = points[np.lexsort(points.T)]
    return rows


@pytest.mark.parametrize("write", [write_stl, write_ascii_stl, write_obj, write_dae])
def test_formats(tmp_path: Path, write: object) -> None:
    assert callable(write)
    ending = {write_obj: "obj", write_dae: "dae"}.get(write, "stl")
    path = write(tmp_path / f"tetrahedron.{ending}")
    np.testing.assert_allclose(sorted_rows(read_mesh(path, ONE)), sorted_rows(CORNERS), atol=1e-7)
    mirrored = read_mesh(path, np.array([0.001, -0.001, 0.001]))
    np.testing.assert_allclose(
        sorted_rows(mirrored), sorted_rows(CORNERS * [0.001, -0.001, 0.001]), atol=1e-9
    )


@pytest.mark.parametrize(
    ("asset", "factor"),
    [
        ("", 1.0),
        ('<unit name="millimeter" meter="0.001"/>', 0.001),
        ('<unit meter="0.0254" name="inch"/><up_axis>Z_UP</up_axis>', 0.0254),
        ('<unit name="centimeter" meter="0.01"/><up_axis>Y_UP</up_axis>', 0.01),
        ("<up_axis>Y_UP</up_axis>", 1.0),
    ],
)
def test_units_of_a_dae_count_and_its_up_axis_does_not(tmp_path: Path, asset: str, factor: float) -> None:
    points = read_mesh(write_dae(tmp_path / "t.dae", asset), ONE)
    np.testing.assert_allclose(sorted_rows(points), sorted_rows(CORNERS * factor), atol=1e-7)


def test_transforms_inside_a_dae_are_applied(tmp_path: Path) -> None:
    matrix = "<matrix>0 -2 0 5 2 0 0 6 0 0 2 7 0 0 0 1</matrix>"
    points = read_mesh(write_dae(tmp_path / "t.dae", transform=matrix), ONE)
    turned = CORNERS @ np.array([[0.0, -2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]]).T + [5.0, 6.0, 7.0]
    np.testing.assert_allclose(sorted_rows(points), sorted_rows(turned), atol=1e-6)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("empty.stl", b""),
        ("words.stl", b"this is not a mesh"),
        ("cut.stl", None),
        ("empty.obj", b"# nothing\n"),
        ("points.obj", b"v 0 0 0\n" * 20),
        ("broken.dae", b"<COLLADA><asset>"),
        ("empty.dae", b"<COLLADA/>"),
        ("unknown.xyz", b"0 0 0\n"),
    ],
)
def test_a_broken_mesh_is_an_error_with_its_path(tmp_path: Path, name: str, content: bytes | None) -> None:
    path = tmp_path / name
    path.write_bytes(write_stl(tmp_path / "whole.stl").read_bytes()[:150] if content is None else content)
    with pytest.raises(ModelError) as caught:
        read_mesh(path, ONE)
    assert str(path) in str(caught.value)
    assert "cannot be read" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert "mesh_loader" not in str(caught.value)  # a place in the source of a library says nothing to a user


def test_relative_and_absolute_paths(tmp_path: Path) -> None:
    urdf = tmp_path / "urdf" / "arm.urdf"
    (tmp_path / "meshes").mkdir()
    mesh = write_stl(tmp_path / "meshes" / "t.stl")
    urdf.parent.mkdir()
    for name in ("../meshes/t.stl", f"file://{mesh}", str(mesh)):
        assert find_mesh(name, urdf).resolve() == mesh
    with pytest.raises(ModelError, match=r"the mesh 'no\.stl' does not exist \(looked for .*urdf/no\.stl\)"):
        find_mesh("no.stl", urdf)


def test_packages_are_found_around_the_urdf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As ROS lays them out: the folder above has the package's name, or a manifest that says it."""
    package = tmp_path / "ws" / "my_robot"
    (package / "urdf").mkdir(parents=True)
    (package / "meshes").mkdir()
    mesh, urdf = write_stl(package / "meshes" / "t.stl"), package / "urdf" / "arm.urdf"
    assert find_mesh("package://my_robot/meshes/t.stl", urdf) == mesh
    assert find_mesh("model://my_robot/meshes/t.stl", urdf) == mesh
    (package / "package.xml").write_text("<package><name>another_name</name></package>")
    assert find_mesh("package://another_name/meshes/t.stl", urdf).resolve() == mesh
    elsewhere = tmp_path / "arm.urdf"
    with pytest.raises(ModelError, match=r"'package://my_robot/meshes/t\.stl' does not exist"):
        find_mesh("package://my_robot/meshes/t.stl", elsewhere)
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{tmp_path / 'none'}:{tmp_path / 'ws'}")
    assert find_mesh("package://my_robot/meshes/t.stl", elsewhere) == mesh


def test_packages_are_found_in_an_ament_prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "install" / "share" / "my_robot" / "meshes"
    folder.mkdir(parents=True)
    mesh = write_stl(folder / "t.stl")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "install"))
    assert find_mesh("package://my_robot/meshes/t.stl", tmp_path / "arm.urdf") == mesh


def test_packages_are_found_among_python_packages(tmp_path: Path) -> None:
    urdf = tmp_path / "arm.urdf"
    name = "package://pybullet_data/kuka_iiwa/meshes/link_1.stl"
    assert find_mesh(name, urdf).name == "link_1.stl"
    name = "package://example-robot-data/robots/ur_description/meshes/ur10/collision/forearm.stl"
    assert find_mesh(name, urdf).name == "forearm.stl"
