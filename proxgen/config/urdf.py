"""The robot description that a configuration names: where it lies, and which names it has.

Only names are read here, so that a misspelt frame is reported together with everything else that is wrong
with the file; the kinematics are the model room's.
"""

import importlib.metadata
import importlib.util
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from proxgen.config.paths import did_you_mean, is_file, is_folder
from proxgen.errors import ModelError, nearest_name, unknown_name

PACKAGE = "package://"


@dataclass(frozen=True)
class UrdfNames:
    """What a URDF calls its parts.

    Attributes:
        links: names of all links.
        joints: type (`revolute`, `fixed`, ...) by joint name.
    """

    links: tuple[str, ...]
    joints: dict[str, str]

    @property
    def moving(self) -> list[str]:
        """Names of the joints that are not fixed."""
        return [name for name, kind in self.joints.items() if kind != "fixed"]


def resolve_urdf(name: str, folder: Path) -> Path:
    """Find a robot description.

    Args:
        name: a path, relative to `folder`, or `package://PACKAGE/path` in an installed Python package.
        folder: the folder of the YAML file that names it.

    Returns:
        The absolute path of an existing file.

    Raises:
        ModelError: there is no such file or package.
    """
    if name.startswith(PACKAGE):
        return resolve_package(name)
    path = folder / name
    if is_file(path):
        return path.resolve()
    if is_folder(path):
        raise ModelError(f"'{name}' is a folder; a URDF file is needed")
    raise ModelError(f"the file '{name}' does not exist{did_you_mean(path, Path(name))} (looked for {path})")


def resolve_package(uri: str) -> Path:
    """Find a file of an installed Python package, such as `package://pybullet_data/kuka_iiwa/model.urdf`.

    PACKAGE is the name of an importable package, or of a distribution as `pip` knows it; in the latter case
    the file is looked for below the distribution's folders, as packages that only hold data put them below
    `share/PACKAGE/`.

    Raises:
        ModelError: the package is not installed, or has no such file.
    """
    package, _, inner = uri.removeprefix(PACKAGE).partition("/")
    if not package or not inner or ".." in PurePosixPath(inner).parts:
        raise ModelError(f"'{uri}' is not of the form package://PACKAGE/path/to/file")
    roots = list(_import_folders(package))
    for root in roots:
        if is_file(root / inner):
            return (root / inner).resolve()
    try:
        distribution = importlib.metadata.distribution(package)
    except (importlib.metadata.PackageNotFoundError, ValueError):
        if not roots:
            message = f"the Python package '{package}' of '{uri}' is not installed (pip install {package})"
            raise ModelError(message) from None
        files: list[importlib.metadata.PackagePath] = []
    else:
        files = list(distribution.files or ())
    files.sort(key=lambda file: (not _below(file, package), len(file.parts)))
    for file in files:
        if f"/{file.as_posix()}".endswith(f"/{inner}") and is_file(path := Path(str(file.locate()))):
            return path.resolve()
    suffix = PurePosixPath(inner).suffix
    names = {file.name: file for file in reversed(files) if file.suffix == suffix}
    nearest = nearest_name(PurePosixPath(inner).name, names)
    hint = f"; did you mean '{_below(names[nearest], package) or names[nearest]}'?" if nearest else ""
    raise ModelError(f"the Python package '{package}' has no file '{inner}'{hint}")


def _import_folders(package: str) -> Iterator[Path]:
    """Folders of an importable package, without importing it."""
    if package.isidentifier():
        spec = importlib.util.find_spec(package)
        if spec is not None:
            yield from map(Path, spec.submodule_search_locations or ())


def _below(file: PurePosixPath, package: str) -> str:
    """The rest of a path below the folder of the package's name (`-` and `_` are the same); empty if none."""
    canonical = re.sub(r"[-_.]+", "-", package).lower()
    for index, part in enumerate(file.parts[:-1]):
        if re.sub(r"[-_.]+", "-", part).lower() == canonical:
            return PurePosixPath(*file.parts[index + 1 :]).as_posix()
    return ""


def read_names(path: Path) -> UrdfNames:
    """Links and joints of a URDF.

    Raises:
        ModelError: not a readable URDF.
    """
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        raise ModelError(f"{path.name} is not well-formed XML: {error}") from error
    except (OSError, ValueError, LookupError) as error:
        raise ModelError(f"{path.name} cannot be read: {error}") from error
    if root.tag != "robot":
        raise ModelError(f"{path.name} is not a URDF: its root element is <{root.tag}>, not <robot>")
    if any(element.tag.startswith("{") and "xacro" in element.tag for element in root.iter()):
        raise ModelError(
            f"{path.name} is a xacro file; turn it into a URDF first (xacro {path.name} > robot.urdf)"
        )
    _refuse_xacro_residue(path, root)
    links = tuple(link.get("name", "") for link in root.findall("link"))
    joints = {joint.get("name", ""): joint.get("type", "") for joint in root.findall("joint")}
    if not links:
        raise ModelError(f"{path.name} has no links")
    return UrdfNames(links, joints)


def _refuse_xacro_residue(path: Path, root: ElementTree.Element) -> None:
    """Raise where one of xacro's expressions, ${radius} or $(find PACKAGE), stands in what is read."""
    for part in (*root.findall("joint"), *root.findall("link/collision")):
        for element in part.iter():
            for attribute, value in element.items():
                if "${" in value or "$(" in value:
                    raise ModelError(
                        f'{path.name} is a xacro file, as <{element.tag} {attribute}="{value}"> shows; '
                        f"turn it into a URDF first (xacro {path.name} > robot.urdf)"
                    )


def unknown_frame(name: str, names: UrdfNames) -> str | None:
    """What is wrong with a frame's name, or None. A link or a joint names a frame."""
    if name in names.links or name in names.joints:
        return None
    return _cut(unknown_name("frame", name, names.links), name, names.links, "links")


def unknown_joint(name: str, names: UrdfNames) -> str | None:
    """What is wrong with the name of a joint that can move, or None."""
    if name in names.moving:
        return None
    if name in names.joints:
        return f"joint '{name}' is fixed; it has no position, limit or velocity"
    return _cut(unknown_name("joint", name, names.moving), name, names.moving, "moving joints")


def _cut(message: str, name: str, allowed: Iterable[str], kind: str) -> str:
    """The message, with a count in place of a long list of names."""
    allowed = list(allowed)
    if len(allowed) <= 24:
        return message
    return f"{message.partition(' (allowed:')[0]} (the URDF has {len(allowed)} {kind})"
