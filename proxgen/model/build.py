"""Config to RobotModel: chain, limits, capsules and sensors, with every mistake reported at once."""

from typing import Any

import numpy as np

from proxgen.config.schema import ROWS_OF_KIND, Config
from proxgen.errors import ConfigError, Problem, unknown_name
from proxgen.model.buried import buried_cuffs
from proxgen.model.frames import axis_basis
from proxgen.model.limits import joint_limits
from proxgen.model.robot_model import CapsuleModel, RobotModel, SelfPointModel
from proxgen.model.skin import sensor_modules
from proxgen.model.touching import touching_pairs
from proxgen.model.urdf import (
    Urdf,
    chain_joints,
    drives,
    followed,
    frame_named,
    parse_urdf,
    reduce_to_chain,
    supporting_joints,
    unknown_frame,
)


def build_model(config: Config) -> RobotModel:
    """The arm that a configuration describes.

    Args:
        config: a loaded configuration.

    Returns:
        The controlled chain with its limits, capsules and sensor modules.

    Raises:
        ConfigError: the URDF cannot be read, or lacks a frame, joint or limit that the configuration needs;
            all problems at once, each with its line.
    """
    urdf = parse_urdf(config)
    if isinstance(urdf, Problem):
        raise ConfigError([urdf])
    chain = reduce_to_chain(config, urdf)
    if isinstance(chain, list):
        raise ConfigError(chain + _frame_problems(config, urdf.full))
    reduced, controlled = chain
    limits, problems = joint_limits(config, urdf, controlled)
    problems += _frame_problems(config, reduced) + _joint_name_problems(config, controlled)
    problems += _branch_problems(config, urdf, controlled)
    if problems:
        raise ConfigError(problems)
    kind_rows = ROWS_OF_KIND[config.task.kind]
    tool = frame_named(reduced, config.robot.tool)
    tool_in_body = np.array(tool.placement.homogeneous)
    tool_in_body[:3, 3] += tool_in_body[:3, :3] @ np.array(config.robot.tool_offset)
    model = RobotModel(
        name=config.robot.name,
        pin_model=reduced,
        drives=drives(urdf, reduced, controlled),
        joint_names=tuple(controlled),
        tool_body=int(tool.parentJoint),
        tool_in_body=tool_in_body,
        task_rows=tuple(row for row in kind_rows if row in (config.task.rows or kind_rows)),
        task_frame=axis_basis(np.array(config.task.axis)) if config.task.kind == "pointing" else None,
        q_lower=limits[:, 0],
        q_upper=limits[:, 1],
        qdot_limit=limits[:, 2],
        qddot_limit=limits[:, 3],
        capsules=_capsules(config, reduced),
        modules=sensor_modules(config.skin, reduced),
        self_points=_self_points(config, reduced),
    )
    problems = buried_cuffs(config, model) + touching_pairs(config, model)
    if problems:
        raise ConfigError(problems)
    return model


def _frame_problems(config: Config, pin_model: Any) -> list[Problem]:
    """Frames of capsules and cuffs that the model lacks."""
    return [
        config.problem(key, unknown_frame(pin_model, frame))
        for key, frame in _named_frames(config)
        if frame_named(pin_model, frame) is None
    ]


def _branch_problems(config: Config, urdf: Urdf, controlled: list[str]) -> list[Problem]:
    """Frames on a branch that moves with a controlled joint: the chain would hold it still."""
    locked, chain = config.robot.locked_joints, chain_joints(urdf, config.robot.tool)
    problems = []
    for key, name in _named_frames(config):
        frame = frame_named(urdf.full, name)
        for joint in () if frame is None else supporting_joints(urdf, frame):
            leader, _, _ = followed(urdf, joint, locked)
            if joint not in chain and joint != leader and leader in controlled:
                message = (
                    f"'{name}' moves with joint '{joint}', which follows '{leader}' but is not on the way to "
                    "the tool; name a frame on that way, or hold the joint with robot.locked_joints"
                )
                problems.append(config.problem(key, message))
    return problems


def _named_frames(config: Config) -> list[tuple[str, str]]:
    """Frames that carry something, each with its key."""
    named = [(f"capsules.{index}.frame", capsule.frame) for index, capsule in enumerate(config.capsules)]
    named += [(f"skin.cuffs.{index}.frame", cuff.frame) for index, cuff in enumerate(config.skin.cuffs)]
    points = config.avoidance.self_collision.points
    return named + [
        (f"avoidance.self_collision.points.{index}.frame", point.frame) for index, point in enumerate(points)
    ]


def _joint_name_problems(config: Config, controlled: list[str]) -> list[Problem]:
    """Joints named in the limits or the posture that are not controlled."""
    named = [(f"limits.position.{name}", name) for name in config.limits.position]
    named += [(f"limits.velocity.{name}", name) for name in config.limits.velocity]
    if isinstance(config.limits.acceleration, dict):
        named += [(f"limits.acceleration.{name}", name) for name in config.limits.acceleration]
    if config.task.posture is not None:
        named += [(f"task.posture.joints.{name}", name) for name in config.task.posture.joints]
    return [
        config.problem(key, unknown_name("controlled joint", name, controlled))
        for key, name in named
        if name not in controlled
    ]


def _capsules(config: Config, pin_model: Any) -> tuple[CapsuleModel, ...]:
    """The capsules in the frames of the bodies that carry them."""
    capsules = []
    for capsule in config.capsules:
        frame = frame_named(pin_model, capsule.frame)
        rotation, translation = frame.placement.rotation, frame.placement.translation
        capsules.append(
            CapsuleModel(
                name=capsule.name,
                body=int(frame.parentJoint),
                start=rotation @ np.array(capsule.start) + translation,
                end=rotation @ np.array(capsule.end) + translation,
                radius=capsule.radius,
                reference_radius=capsule.radius if config.avoidance.distance_reference == "surface" else 0.0,
            )
        )
    return tuple(capsules)


def _self_points(config: Config, pin_model: Any) -> tuple[SelfPointModel, ...]:
    """The points of self-collision in the frames of the bodies that carry them, and their pairs."""
    own, points = config.avoidance.self_collision, []
    excluded = {(pair.capsule, pair.point) for pair in own.exclude}
    carriers = [int(frame_named(pin_model, capsule.frame).parentJoint) for capsule in config.capsules]
    for point in own.points:
        frame = frame_named(pin_model, point.frame)
        body, placement = int(frame.parentJoint), frame.placement
        points.append(
            SelfPointModel(
                name=point.name,
                body=body,
                position=placement.rotation @ np.array(point.position) + placement.translation,
                radius=point.radius,
                capsules=tuple(
                    carrier != body and (capsule.name, point.name) not in excluded
                    for capsule, carrier in zip(config.capsules, carriers, strict=True)
                ),
            )
        )
    return tuple(points)
