"""Load a robot's YAML file: everything that is wrong with it is found and reported at once."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from proxgen.config.layers import read_layers
from proxgen.config.messages import contradictions_besides, dotted, mistaken_keys, problems_of
from proxgen.config.origin import Origin
from proxgen.config.quantities import against_its_motion
from proxgen.config.schema import Config
from proxgen.config.section import Section
from proxgen.config.urdf import (
    UrdfNames,
    read_names,
    resolve_urdf,
    unknown_frame,
    unknown_joint,
)
from proxgen.config.yaml_lines import read_yaml
from proxgen.errors import ConfigError, ModelError, Problem

AnySection = TypeVar("AnySection", bound=Section)


def load(path: str | Path) -> Config:
    """Read, check and resolve a robot's YAML file.

    Args:
        path: the file; messages name it as it is given here.

    Returns:
        The configuration, in SI units, with the place of every value.

    Raises:
        ConfigError: the file, or the URDF that it names, cannot be used; holds all problems with their lines.
    """
    path = Path(path)
    document = read_layers(path)
    problems = list(document.problems)
    if document.root is None:
        raise ConfigError(problems)
    if _has_a_scene(document.root.value):
        raise ConfigError([Problem(path, 0, "", "this is a scene; the YAML file of a robot is needed here")])
    data, origin = document.root.plain(), Origin(path, document.root.marks())
    config, found = validate(data, Config, origin)
    problems += found
    urdf_path, found = _find_urdf(data, origin)
    problems += found
    if config is None or urdf_path is None or problems:
        raise ConfigError(_without_echoes(problems))
    config._origin = Origin(path, origin.marks, urdf_path)
    return config


def is_scene(path: str | Path) -> bool:
    """Whether a file looks like a scene rather than a robot, so that it can be checked as what it is."""
    root = read_yaml(Path(path)).root
    return root is not None and _has_a_scene(root.value)


def _has_a_scene(values: Mapping[str, Any]) -> bool:
    """Whether these are the keys of a scene, and none of a robot."""
    return "robot" not in values and bool({"obstacles", "targets"} & set(values))


def validate(data: Any, model: type[AnySection], origin: Origin) -> tuple[AnySection | None, list[Problem]]:
    """Plain data to a section, or all problems.

    Pydantic does not look for contradictions in a section that has a mistake of another kind. So the mistaken
    values are taken out, and the rest is looked at once more.
    """
    try:
        return model.model_validate(data), []
    except ValidationError as error:
        problems = problems_of(error, data, model, origin)
        mistaken = mistaken_keys(error, data)
    rest = _copy(data)
    for *section, key in mistaken:
        target = rest
        for part in section:
            target = target.get(part, {}) if isinstance(target, dict) else target[part]
        target.pop(key, None)
    try:
        model.model_validate(rest)
    except ValidationError as error:
        more = contradictions_besides(error, rest, origin, [dotted(path) for path in mistaken])
        problems += [problem for problem in more if problem not in problems]
    return None, problems


def _copy(data: Any) -> Any:
    """A copy of mappings and lists, so that keys can be taken out."""
    if isinstance(data, dict):
        return {key: _copy(value) for key, value in data.items()}
    return [_copy(value) for value in data] if isinstance(data, list) else data


def _without_echoes(problems: list[Problem]) -> list[Problem]:
    """Problems without those that only follow from another at the same key (a value that was not read)."""
    first: dict[tuple[Path, str], Problem] = {}
    kept = []
    for problem in dict.fromkeys(problems):
        before = first.setdefault((problem.file, problem.key), problem)
        if not problem.key or before is problem or "found nothing" not in problem.message:
            kept.append(problem)
    return kept


def _find_urdf(data: Any, origin: Origin) -> tuple[Path | None, list[Problem]]:
    """The robot description and the names in the file that it does not have."""
    robot = data.get("robot")
    name = robot.get("urdf") if isinstance(robot, dict) else None
    if not isinstance(name, str):
        return None, []  # validation has said so
    written_in = origin.mark("robot.urdf").file
    try:
        path = resolve_urdf(name, written_in.parent)
        names = read_names(path)
    except ModelError as error:
        return None, [origin.problem("robot.urdf", str(error))]
    return path, list(_wrong_names(data, names, origin))


def _wrong_names(data: Any, names: UrdfNames, origin: Origin) -> Iterator[Problem]:
    """Frames and joints that the URDF lacks, and joint values whose unit the joint cannot have."""
    frames = [("robot.tool", _inside(data, "robot", "tool"))]
    for key, items in (
        ("capsules", _inside(data, "capsules")),
        ("skin.cuffs", _inside(data, "skin", "cuffs")),
    ):
        for index, item in enumerate(items if isinstance(items, list) else ()):
            frames.append((f"{key}.{index}.frame", _inside(item, "frame")))
    for key, frame in frames:
        if isinstance(frame, str) and (message := unknown_frame(frame, names)):
            yield origin.problem(key, message)
    for section in (
        ("robot", "locked_joints"),
        ("task", "posture", "joints"),
        ("limits", "position"),
        ("limits", "velocity"),
        ("limits", "acceleration"),
    ):
        by_joint = _inside(data, *section)
        for joint, value in by_joint.items() if isinstance(by_joint, dict) else ():
            message = unknown_joint(joint, names) or _wrong_unit(joint, value, names)
            if message:
                yield origin.problem(".".join((*section, joint)), message)
    if "prismatic" not in names.joints.values():
        for key in ("acceleration", "tolerance"):  # one value for all joints
            value = _inside(data, "limits", key)
            if motion := against_its_motion(value, prismatic=False):
                yield origin.problem(f"limits.{key}", f"'{value}': every joint {motion}")


def _wrong_unit(joint: str, value: Any, names: UrdfNames) -> str | None:
    """A length for a joint that turns, or an angle for one that slides."""
    kind = names.joints[joint]
    for item in value if isinstance(value, list) else [value]:
        if motion := against_its_motion(item, prismatic=kind == "prismatic"):
            return f"'{item}': joint '{joint}' is {kind}: it {motion}"
    return None


def _inside(data: Any, *path: str) -> Any:
    """A value some mappings deep, None where the path leads nowhere."""
    for part in path:
        data = data.get(part) if isinstance(data, dict) else None
    return data
