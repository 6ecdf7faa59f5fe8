"""URDF file to a reduced Pinocchio model of the chain from base to tool."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from proxgen.config.schema import Config
from proxgen.errors import ModelError, Problem, nearest_name, unknown_name
from proxgen.model.frames import snapped
from proxgen.model.robot_model import Array, Drive
from proxgen.model.urdf_text import finite_number, pinocchio_model

LINK = "/link"
"""Ending of a link's frame in the Pinocchio model, where a joint has the same name."""


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: position = multiplier * position of `joint` + offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class UrdfLimits:
    """Limits of one joint as the URDF writes them; None where it writes none."""

    lower: float | None
    upper: float | None
    velocity: float | None


@dataclass(frozen=True)
class Urdf:
    """A parsed URDF.

    Attributes:
        full: Pinocchio model of everything in the file, mimic joints independent.
        mimics: by the name of the joint that follows.
        limits: by joint name.
    """

    full: Any
    mimics: dict[str, Mimic]
    limits: dict[str, UrdfLimits]


def parse_urdf(config: Config) -> Urdf | Problem:
    """Read the configured URDF.

    Returns:
        The parsed file, or the problem that keeps it from being read, in its own line of the YAML file.
    """
    try:
        return read_urdf(config.urdf_path)
    except ModelError as error:
        return config.problem("robot.urdf", str(error))


def read_urdf(path: Path) -> Urdf:
    """Read a URDF.

    Raises:
        ModelError: the file cannot be read as a URDF; the message names it.
    """
    try:
        root = ElementTree.parse(path).getroot()
        full = pinocchio_model(root)
        _tell_links_from_joints(full)
        mimics, limits = {}, {}
        for joint in root.findall("joint"):
            name = joint.get("name", "")
            limit = joint.find("limit")
            limits[name] = UrdfLimits(
                finite_number(limit, "lower"), finite_number(limit, "upper"), finite_number(limit, "velocity")
            )
            mimic = joint.find("mimic")
            if mimic is not None:
                multiplier, offset = finite_number(mimic, "multiplier"), finite_number(mimic, "offset")
                mimics[name] = Mimic(
                    mimic.get("joint", ""), 1.0 if multiplier is None else multiplier, offset or 0.0
                )
    except ElementTree.ParseError as error:
        raise ModelError(f"{path} is not well-formed XML: {error}") from error
    except (OSError, ValueError, ModelError) as error:
        raise ModelError(f"{path} cannot be read as a URDF: {error}") from error
    return Urdf(full, mimics, limits)


def chain_joints(urdf: Urdf, tool: str) -> list[str]:
    """Names of the moving joints from base to the tool frame, base first, mimic joints included."""
    return supporting_joints(urdf, frame_named(urdf.full, tool))


def supporting_joints(urdf: Urdf, frame: Any) -> list[str]:
    """Names of the moving joints from base to a frame, base first."""
    return [urdf.full.names[index] for index in urdf.full.supports[frame.parentJoint] if index > 0]


def independent_joints(urdf: Urdf, chain: list[str]) -> list[str]:
    """The joints of the chain that are controlled: those that follow no other."""
    return [name for name in chain if name not in urdf.mimics]


def reduce_to_chain(config: Config, urdf: Urdf) -> tuple[Any, list[str]] | list[Problem]:
    """Lock everything that is not between base and tool.

    Returns:
        The reduced, snapped Pinocchio model and the controlled joints' names; or all problems.
    """
    problems = _name_problems(config, urdf)
    if problems:
        return problems
    chain = [name for name in chain_joints(urdf, config.robot.tool) if name not in config.robot.locked_joints]
    controlled = independent_joints(urdf, chain)
    if not controlled:
        message = f"no moving joint between the base and the tool frame '{config.robot.tool}'"
        return [config.problem("robot.tool", message)]
    problems = [problem for name in chain if (problem := _joint_problem(config, urdf, chain, name))]
    if problems:
        return problems
    return reduced_model(urdf, chain, config.robot.locked_joints), controlled


def reduced_model(urdf: Urdf, chain: Sequence[str], locked: Mapping[str, float]) -> Any:
    """Snapped Pinocchio model in which only the joints of the chain move.

    Args:
        urdf: the whole robot.
        chain: names of the joints that move, mimic joints included.
        locked: positions of some of the others; the rest is held as `locked_position` says.
    """
    fixed = [urdf.full.getJointId(name) for name in list(urdf.full.names)[1:] if name not in chain]
    reduced = pin.buildReducedModel(urdf.full, fixed, _locked_configuration(urdf, locked))
    _snap(reduced)
    return reduced


def _name_problems(config: Config, urdf: Urdf) -> list[Problem]:
    """Tool frame and locked joints that the URDF does not have."""
    joints = list(urdf.full.names)[1:]
    problems = []
    if frame_named(urdf.full, config.robot.tool) is None:
        problems.append(config.problem("robot.tool", unknown_frame(urdf.full, config.robot.tool)))
    for name in config.robot.locked_joints:
        if name not in joints:
            problems.append(
                config.problem(f"robot.locked_joints.{name}", unknown_name("joint", name, joints))
            )
    return problems


def _tell_links_from_joints(model: Any) -> None:
    """Rename links that share their name with a joint: Pinocchio cannot look up a name that occurs twice."""
    joints = {frame.name for frame in model.frames if frame.type != pin.BODY}
    for index in range(model.nframes):
        frame = model.frames[index]
        if frame.type == pin.BODY and frame.name in joints:
            frame.name += LINK


def frame_named(model: Any, name: str) -> Any:
    """The frame of a link or, where no link has that name, of a joint; None if there is none."""
    for candidate in (name + LINK, name):
        if model.existFrame(candidate):
            return model.frames[model.getFrameId(candidate)]
    return None


def unknown_frame(model: Any, name: str) -> str:
    """The sentence for a frame that the URDF lacks. Long lists are cut to the nearest name and a count."""
    frames = [frame.name.removesuffix(LINK) for frame in model.frames[1:]]  # the first is Pinocchio's own
    nearest = nearest_name(name, frames)
    if len(frames) <= 24:
        return unknown_name("frame", name, frames)
    hint = f"; did you mean '{nearest}'?" if nearest else ""
    return f"unknown frame '{name}'{hint} (the URDF has {len(frames)} frames)"


def _joint_problem(config: Config, urdf: Urdf, chain: list[str], name: str) -> Problem | None:
    """What keeps a joint of the chain from being controlled, if anything."""
    joint = urdf.full.joints[urdf.full.getJointId(name)]
    if joint.nv != 1:
        kind = joint.shortname().removeprefix("JointModel")
        message = f"joint '{name}' is a {kind}; the chain may have revolute, continuous, prismatic joints"
        return config.problem("robot.urdf", message)
    mimic = urdf.mimics.get(name)
    if mimic is not None and mimic.joint not in chain:
        message = (
            f"joint '{name}' mimics '{mimic.joint}', which is not between the base and the tool; lock it"
        )
        return config.problem("robot.urdf", f"{message} with robot.locked_joints")
    if followed(urdf, name)[0] in urdf.mimics:
        message = (
            f"joint '{name}' mimics '{urdf.mimics[name].joint}', which follows it in turn; none of them leads"
        )
        return config.problem("robot.urdf", message)
    return None


def followed(urdf: Urdf, name: str, locked: Collection[str] = ()) -> tuple[str, float, float]:
    """What a joint follows, chained mimics resolved: position = ratio * position of the leader + offset.

    Args:
        urdf: the whole robot.
        name: a joint; one that follows no other leads itself.
        locked: joints that are held, so that they follow no other.

    Returns:
        The leader's name, ratio and offset. Joints that follow each other in a circle lead nowhere.
    """
    ratio, offset, passed = 1.0, 0.0, {name}
    while name not in locked and name in urdf.mimics and urdf.mimics[name].joint not in passed:
        mimic = urdf.mimics[name]
        ratio, offset, name = ratio * mimic.multiplier, offset + ratio * mimic.offset, mimic.joint
        passed.add(name)
    return name, ratio, offset


def locked_position(urdf: Urdf, name: str, locked: Mapping[str, float] | None = None) -> float:
    """Where a joint is locked.

    Args:
        urdf: the whole robot.
        name: a joint with one degree of freedom.
        locked: positions that were asked for, by joint.

    Returns:
        As asked for; else where its mimic rule puts it; else nearest to zero within its limits [rad or m].
    """
    locked = locked or {}
    name, ratio, offset = followed(urdf, name, locked)
    limits = urdf.limits.get(name, UrdfLimits(None, None, None))
    lower = limits.lower or 0.0
    nearest = float(np.clip(0.0, lower, max(limits.upper or 0.0, lower)))
    return ratio * locked.get(name, nearest) + offset


def _locked_configuration(urdf: Urdf, locked: Mapping[str, float]) -> Array:
    """Configuration of the whole robot with its locked joints in place; planar and floating ones at zero."""
    configuration: Array = pin.neutral(urdf.full)
    for index in range(1, urdf.full.njoints):
        joint, name = urdf.full.joints[index], urdf.full.names[index]
        if joint.nv != 1:
            continue
        position = locked_position(urdf, name, locked)
        if joint.nq == 2:
            configuration[joint.idx_q : joint.idx_q + 2] = np.cos(position), np.sin(position)
        else:
            configuration[joint.idx_q] = position
    return configuration


def _snap(model: Any) -> None:
    """Set rotation entries that are only rounding of the URDF's decimals to zero."""
    for placement in list(model.jointPlacements):
        placement.rotation = snapped(placement.rotation)
    for index in range(model.nframes):
        placement = model.frames[index].placement
        placement.rotation = snapped(placement.rotation)
        model.frames[index].placement = placement


def drives(urdf: Urdf, reduced: Any, controlled: list[str]) -> tuple[Drive, ...]:
    """How each joint of the reduced model follows the controlled ones, chained mimics resolved."""
    result, data = [], reduced.createData()
    pin.computeJointJacobians(reduced, data, pin.neutral(reduced))
    for index in range(1, reduced.njoints):
        leader, ratio, offset = followed(urdf, reduced.names[index])
        prismatic, axis = _axis(np.array(data.joints[index].S).ravel())
        result.append(Drive(controlled.index(leader), ratio, offset, prismatic, axis))
    return tuple(result)


def _axis(subspace: Array) -> tuple[bool, Array]:
    """Whether a one-dimensional joint is prismatic, and its axis: from its motion subspace, (6,)."""
    linear, angular = subspace[:3], subspace[3:]
    prismatic = bool(np.linalg.norm(linear) > np.linalg.norm(angular))
    axis: Array = np.array(linear if prismatic else angular)
    return prismatic, axis / np.linalg.norm(axis)
