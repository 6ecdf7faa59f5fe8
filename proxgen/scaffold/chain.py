"""The arm between base and tool, as `init` sees it: what moves, what is locked, what each body carries."""

import math
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from proxgen.config.urdf import read_names
from proxgen.errors import ModelError
from proxgen.model.robot_model import Array
from proxgen.model.urdf import (
    LINK,
    Urdf,
    chain_joints,
    frame_named,
    locked_position,
    read_urdf,
    reduced_model,
    unknown_frame,
)
from proxgen.scaffold.shapes import Cloud, collision_clouds, merged


@dataclass(frozen=True)
class ArmJoint:
    """A controlled joint and its limits in the URDF; None where the URDF gives none that can be used.

    Attributes:
        name: as in the URDF.
        kind: `revolute`, `continuous` or `prismatic`.
        lower: [rad or m].
        upper: [rad or m].
        velocity: [rad/s or m/s].
    """

    name: str
    kind: str
    lower: float | None
    upper: float | None
    velocity: float | None

    @property
    def unit(self) -> str:
        """Unit of its position."""
        return "m" if self.kind == "prismatic" else "rad"

    @property
    def needs_position(self) -> bool:
        """Whether the user has to say how far it goes."""
        return self.lower is None and self.kind != "continuous"

    @property
    def needs_velocity(self) -> bool:
        """Whether the user has to say how fast it may be."""
        return self.velocity is None


@dataclass(frozen=True)
class LockedJoint:
    """A joint that is held.

    Attributes:
        name: as in the URDF.
        position: where [rad or m].
        kind: as in the URDF.
    """

    name: str
    position: float
    kind: str


@dataclass(frozen=True)
class ArmBody:
    """What moves with one joint: its link, and everything rigidly attached to it.

    Attributes:
        joint: the joint that moves it.
        link: the joint's child link; the body's frame is this link's frame.
        links: all links of the body, its own first.
        cloud: their collision geometry in the body's frame; None if they have none.
        bare: the links without collision geometry.
        outlet: where the next joint, or the tool, is attached, (3,) in the body's frame [m].
    """

    joint: str
    link: str
    links: tuple[str, ...]
    cloud: Cloud | None
    bare: tuple[str, ...]
    outlet: Array


@dataclass(frozen=True)
class Arm:
    """Everything that `init` reads from a URDF.

    Attributes:
        robot: the robot's name in the URDF.
        base: the URDF's root link.
        tool: the tool's frame.
        joints: controlled joints, base to tool.
        mimics: (joint, joint that it follows) on the way to the tool.
        locked: joints on the way that cannot be controlled: planar, floating, or mimics of one elsewhere.
        branches: joints on other branches, locked.
        bodies: moving bodies, base to tool.
        size: length of the stretched arm from its first joint to the tool, at most [m].
    """

    robot: str
    base: str
    tool: str
    joints: tuple[ArmJoint, ...]
    mimics: tuple[tuple[str, str], ...]
    locked: tuple[LockedJoint, ...]
    branches: tuple[LockedJoint, ...]
    bodies: tuple[ArmBody, ...]
    size: float


def read_arm(path: Path, tool: str) -> Arm:
    """Read the chain from the base to a tool frame.

    Args:
        path: a URDF.
        tool: name of a link (or joint) in it.

    Raises:
        ModelError: the URDF or one of its meshes cannot be read, there is no such frame, or nothing moves it.
    """
    kinds = read_names(path).joints
    urdf = read_urdf(path)
    frame = frame_named(urdf.full, tool)
    if frame is None:
        raise ModelError(f"{path}: {unknown_frame(urdf.full, tool)}")
    way = chain_joints(urdf, tool)
    held = [name for name in way if not _can_be_controlled(urdf, name, way)]
    moving = [name for name in way if name not in held]
    controlled = [name for name in moving if name not in urdf.mimics]
    if not controlled:
        raise ModelError(f"{path}: no joint between the base and the tool frame '{tool}' can be controlled")
    reduced = reduced_model(urdf, moving, {})
    branches = [name for name in list(urdf.full.names)[1:] if name not in way]
    root = ElementTree.parse(path).getroot()
    return Arm(
        robot=root.get("name", "") or path.stem,
        base=_root_link(root),
        tool=tool,
        joints=tuple(_joint(urdf, name, kinds[name]) for name in controlled),
        mimics=tuple((name, urdf.mimics[name].joint) for name in moving if name in urdf.mimics),
        locked=tuple(_locked(urdf, name, kinds[name]) for name in held),
        branches=tuple(_locked(urdf, name, kinds[name]) for name in branches),
        bodies=_bodies(path, root, reduced, tool),
        size=_size(urdf, reduced, frame_named(reduced, tool)),
    )


def _can_be_controlled(urdf: Urdf, name: str, way: list[str]) -> bool:
    """Whether a joint on the way to the tool has one degree of freedom, and follows no joint elsewhere."""
    joint = urdf.full.joints[urdf.full.getJointId(name)]
    return joint.nv == 1 and (name not in urdf.mimics or urdf.mimics[name].joint in way)


def _joint(urdf: Urdf, name: str, kind: str) -> ArmJoint:
    """A controlled joint with the limits that make sense."""
    limits = urdf.limits[name]
    lower, upper = limits.lower, limits.upper
    if kind == "continuous" or lower is None or upper is None or not lower < upper:
        lower = upper = None
    velocity = limits.velocity if limits.velocity and 0.0 < limits.velocity < math.inf else None
    return ArmJoint(name, kind, lower, upper, velocity)


def _locked(urdf: Urdf, name: str, kind: str) -> LockedJoint:
    """A joint that is held where the model room holds it."""
    movable = urdf.full.joints[urdf.full.getJointId(name)].nv == 1
    return LockedJoint(name, locked_position(urdf, name) if movable else 0.0, kind)


def _root_link(root: ElementTree.Element) -> str:
    """The link that is no joint's child."""
    children = {child.get("link") for child in root.findall("joint/child")}
    return next((name for link in root.findall("link") if (name := link.get("name", "")) not in children), "")


def _bodies(path: Path, root: ElementTree.Element, reduced: Any, tool: str) -> tuple[ArmBody, ...]:
    """The moving bodies with their collision geometry."""
    ends = [*list(reduced.jointPlacements)[2:], frame_named(reduced, tool).placement]
    child_of = {joint.get("name"): joint.find("child") for joint in root.findall("joint")}
    links = {link.get("name", "") for link in root.findall("link")}
    carried: dict[int, list[str]] = {index: [] for index in range(1, reduced.njoints)}
    for frame in reduced.frames:
        name = frame.name.removesuffix(LINK)
        body = carried.get(frame.parentJoint, [])
        if name in links and name not in body and frame_named(reduced, name).parentJoint == frame.parentJoint:
            body.append(name)
    clouds = collision_clouds(path, [name for body in carried.values() for name in body])
    bodies = []
    for index, names in carried.items():
        joint = reduced.names[index]
        child = child_of[joint]
        own = child.get("link", "") if child is not None else ""
        parts = [
            clouds[name].placed(np.array(place.rotation), np.array(place.translation))
            for name in names
            if name in clouds
            for place in [frame_named(reduced, name).placement]
        ]
        bare = tuple(name for name in names if name not in clouds)
        ordered = (own, *(name for name in names if name != own))
        outlet = np.array(ends[index - 1].translation)
        bodies.append(ArmBody(joint, own, ordered, merged(parts) if parts else None, bare, outlet))
    return tuple(bodies)


def _size(urdf: Urdf, reduced: Any, tool: Any) -> float:
    """Sum of the distances from joint to joint, after the first, of prismatic travel and of the tool [m]."""
    length = float(np.linalg.norm(tool.placement.translation))
    index = tool.parentJoint
    while index > 0:
        parent, limits = reduced.parents[index], urdf.limits[reduced.names[index]]
        if "P" in reduced.joints[index].shortname().removeprefix("JointModel")[:1]:
            length += max(abs(limits.lower or 0.0), abs(limits.upper or 0.0))
        if parent > 0:
            length += float(np.linalg.norm(reduced.jointPlacements[index].translation))
        index = parent
    return length
