"""Find the mesh files that a URDF names, and read their vertices.

Read by Coal's loader (Assimp): it comes with Pinocchio, so that no further library is needed, it knows STL,
OBJ, DAE and more, applies the transforms inside a DAE, and refuses a broken file. What it leaves out, the
unit of a DAE, is read here. Like other readers of URDFs, it ignores a DAE's up axis: the URDF's frames rule.
"""

import os
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from proxgen.config.urdf import PACKAGE, resolve_package
from proxgen.errors import ModelError
from proxgen.model.robot_model import Array

_MODEL = "model://"
_FILE = "file://"
_COLLADA = "{http://www.collada.org/2005/11/COLLADASchema}"


def find_mesh(name: str, urdf: Path) -> Path:
    """Find a mesh file.

    Args:
        name: as in the URDF: `package://PACKAGE/path`, `file://path`, or a path relative to the URDF.
        urdf: the URDF that names it.

    Returns:
        An existing file. A package is looked for in the folders around the URDF (`PACKAGE/path` beside it or
        beside a folder above it, as ROS lays packages out), then among the installed Python packages, then in
        ROS_PACKAGE_PATH and AMENT_PREFIX_PATH.

    Raises:
        ModelError: there is no such file; the message says where it was looked for.
    """
    for scheme in (PACKAGE, _MODEL):
        if name.startswith(scheme):
            return _find_in_package(name, name.removeprefix(scheme).lstrip("/"), urdf)
    path = urdf.parent / name.removeprefix(_FILE)
    if not path.is_file():
        raise ModelError(f"the mesh '{name}' does not exist (looked for {path})")
    return path


def _find_in_package(name: str, inner: str, urdf: Path) -> Path:
    """The file of a package; `inner` is the package and the path in it."""
    package, _, rest = inner.partition("/")
    for folder in _package_folders(package, urdf):
        if rest and (folder / rest).is_file():
            return folder / rest
    try:
        return resolve_package(PACKAGE + inner)
    except ModelError as error:
        message = f"the mesh '{name}' does not exist: no folder '{package}' around {urdf} has it, and {error}"
        raise ModelError(message) from error


def _package_folders(package: str, urdf: Path) -> Iterator[Path]:
    """Where a ROS package of that name may lie."""
    for folder in urdf.resolve().parents:
        yield folder / package
        if _declares(folder / "package.xml", package):
            yield folder
    for root in filter(None, os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)):
        yield Path(root) / package
    for root in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
        yield Path(root) / "share" / package


def _declares(manifest: Path, package: str) -> bool:
    """Whether a ROS manifest names that package, whatever its folder is called."""
    if not manifest.is_file():
        return False
    try:
        return (ElementTree.parse(manifest).getroot().findtext("name") or "").strip() == package
    except (ElementTree.ParseError, OSError):
        return False


def read_mesh(path: Path, scale: Array) -> Array:
    """Vertices of a mesh.

    Args:
        path: STL, OBJ, DAE or another format that Assimp reads.
        scale: (3,) factors of the URDF.

    Returns:
        (k, 3), different from each other [m].

    Raises:
        ModelError: the file cannot be read or has no vertices; the message names it.
    """
    import coal

    try:
        vertices = np.array(coal.MeshLoader().load(str(path)).vertices(), dtype=float)
    except (ValueError, RuntimeError) as error:
        raise ModelError(f"the mesh {path} cannot be read: {_reason(str(error))}") from error
    if vertices.size == 0 or not np.isfinite(vertices).all():
        raise ModelError(f"the mesh {path} cannot be read: it has no vertices, or some are not finite")
    distinct: Array = np.unique(vertices * (_unit(path) * scale), axis=0)
    return distinct


def _reason(message: str) -> str:
    """What Coal says beyond the place in its own source, in one line."""
    lines = [line.strip() for line in message.splitlines()]
    start = next((index + 1 for index, line in enumerate(lines) if "Could not load" in line), len(lines))
    told = [line for line in lines[start:] if line and not line.startswith("Hint:")]
    return " ".join(told) or message.strip().replace("\n", " ")


def _unit(path: Path) -> float:
    """Metres per unit of the file: 1 unless a DAE says otherwise."""
    if path.suffix.lower() != ".dae":
        return 1.0
    try:
        for _, element in ElementTree.iterparse(path, events=("end",)):
            if element.tag == f"{_COLLADA}unit":
                return float(element.get("meter", "1"))
            if element.tag == f"{_COLLADA}asset":
                break
    except (ElementTree.ParseError, ValueError) as error:
        raise ModelError(f"the mesh {path} cannot be read: {error}") from error
    return 1.0
