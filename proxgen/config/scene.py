"""A scene in a YAML file: obstacles, some of them moving, targets, and where the arm starts."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, PrivateAttr, Tag

from proxgen.config.examples import examples_directory
from proxgen.config.layers import read_layers
from proxgen.config.loader import validate
from proxgen.config.origin import Origin
from proxgen.config.paths import is_file
from proxgen.config.quantities import Angle, JointPosition, Length, Speed, Time, against_its_motion
from proxgen.config.section import Direction, Finding, Name, Section, Vector3, unique_names, zero_vector
from proxgen.config.trajectory import read_trajectory
from proxgen.errors import ConfigError, Problem, nearest_name, unknown_name

Size = Annotated[float, Length(gt=0.0, le=100.0)]
Rpy = tuple[Annotated[float, Angle()], Annotated[float, Angle()], Annotated[float, Angle()]]
Position = Annotated[float, JointPosition()]

_MEASURES = {
    "box": {"size"},
    "sphere": {"radius"},
    "capsule": {"radius", "length"},
}
"""The keys that give each shape its measures."""


def list_or_mapping(value: object) -> str:
    """Which form of joint positions was written."""
    return "mapping" if isinstance(value, dict) else "list"


class Motion(Section):
    """There and back along a line, again and again: out, hold, back, rest until the period is over."""

    direction: Direction = Field(description="of the way out, world frame; any length but zero")
    distance: Annotated[float, Length(gt=0.0, le=100.0)] = Field(description="how far out")
    speed: Annotated[float, Speed(gt=0.0, le=10.0)] = Field(description="on the way out and back")
    hold: Annotated[float, Time(ge=0.0, le=1e4)] = Field(0.0, description="stay outside for this long")
    period: Annotated[float, Time(gt=0.0, le=1e4)] = Field(description="from one start to the next")
    phase: Annotated[float, Time(ge=0.0, le=1e4)] = Field(
        0.0, description="how far into its period the motion is at time 0"
    )

    def contradictions(self) -> Iterator[Finding]:
        """No direction; a period too short for the way out and back."""
        yield from zero_vector("direction", self.direction)
        needed = 2.0 * self.distance / self.speed + self.hold
        if needed > self.period:
            message = f"out, hold and back take {needed:.6g} s, more than period = {self.period:.6g} s"
            yield Finding(("period", "distance", "speed", "hold"), message)


class Obstacle(Section):
    """A body that the arm must not touch."""

    name: Name = Field(description="for plots and messages; must differ from the other obstacles' names")
    shape: Literal["box", "sphere", "capsule"] = Field(description="its shape")
    size: tuple[Size, Size, Size] | None = Field(None, description="edge lengths along x, y, z (box)")
    radius: Size | None = Field(None, description="of a sphere or a capsule")
    length: Size | None = Field(None, description="of a capsule's axis, along z, without the caps")
    position: Vector3 = Field(description="of the centre, world frame; where it rests if it moves")
    orientation: Rpy = Field((0.0, 0.0, 0.0), description="roll, pitch, yaw about the world's x, y, z")
    motion: Motion | None = Field(None, description="how it moves; absent: not at all")

    def contradictions(self) -> Iterator[Finding]:
        """Measures that the shape needs or does not have."""
        for key in ("size", "radius", "length"):
            given, needed = getattr(self, key) is not None, key in _MEASURES[self.shape]
            if needed and not given:
                yield Finding(("shape", key), f"a {self.shape} needs '{key}'")
            elif given and not needed:
                has = " and ".join(f"'{name}'" for name in sorted(_MEASURES[self.shape]))
                yield Finding((key,), f"a {self.shape} has no '{key}', it has {has}")


class Target(Section):
    """Where the tool is to go."""

    position: Vector3 = Field(description="of the task point, world frame")
    orientation: Rpy | None = Field(
        None, description="roll, pitch, yaw of the tool about the world's x, y, z (pose and pointing tasks)"
    )
    time: Annotated[float, Time(ge=0.0, le=1e6)] | None = Field(
        None,
        description="when it is to be there; with times for all, targets are a trajectory. "
        "It may be in a file: `targets: FILE.csv`, with the columns time,x,y,z[,roll,pitch,yaw]",
    )


class Scene(Section):
    """Obstacles, targets that follow each other in a circle, and the start."""

    name: Name = Field(description="name of the scene")
    description: str = Field("", description="one sentence on what it shows")
    obstacles: Annotated[tuple[Obstacle, ...], AfterValidator(unique_names)] = Field(
        (), description="what the arm must not touch"
    )
    targets: tuple[Target, ...] = Field(
        min_length=1,
        description="the next one follows when one is reached, and after the last the first",
    )
    start: (
        Annotated[
            Annotated[tuple[Position, ...], Tag("list")] | Annotated[dict[str, Position], Tag("mapping")],
            Discriminator(list_or_mapping),
        ]
        | None
    ) = Field(
        None,
        description="joint positions at the start: a list from base to tool, or by name; else zero",
    )

    _origin: Origin = PrivateAttr(default_factory=lambda: Origin(Path()))
    _written_start: Any = PrivateAttr(default=None)  # with units, which only the arm can judge

    def contradictions(self) -> Iterator[Finding]:
        """Times that only some targets have, or that do not increase."""
        times = [target.time for target in self.targets]
        if any(time is not None for time in times):
            for index, time in enumerate(times):
                before = times[index - 1] if index else None
                if time is None:
                    yield Finding((f"targets.{index}", "targets"), "all targets have a 'time', or none has")
                elif before is not None and time <= before:
                    message = (
                        f"time = {time:.6g} s must be later than that of the target before, {before:.6g} s"
                    )
                    yield Finding((f"targets.{index}.time", "targets"), message)

    @property
    def source(self) -> Path:
        """The YAML file, as the user named it or as it was found."""
        return self._origin.source

    def problem(self, key: str, message: str) -> Problem:
        """A problem at a key's place in its file, for checks that need the robot as well."""
        return self._origin.problem(key, message)

    def start_positions(
        self,
        joints: Sequence[str],
        lower: Sequence[float] = (),
        upper: Sequence[float] = (),
        prismatic: Sequence[bool] = (),
    ) -> tuple[float, ...]:
        """Joint positions at the start, for an arm with these joints.

        Args:
            joints: names of the n controlled joints, from base to tool.
            lower: position limits (n,) [rad or m]; not checked if empty.
            upper: the same above.
            prismatic: whether each slides (n,); units are not checked if empty.

        Returns:
            (n,) [rad or m].

        Raises:
            ConfigError: another number of joints, a joint that the arm lacks, a start outside its limits,
                an angle for a joint that slides.
        """
        if isinstance(self.start, dict):
            places = {name: f"start.{name}" for name in self.start}
            problems = [
                self.problem(place, unknown_name("controlled joint", name, joints))
                for name, place in places.items()
                if name not in joints
            ]
            positions = tuple(self.start.get(name, 0.0) for name in joints)
        else:
            places = {name: f"start.{index}" for index, name in enumerate(joints)}
            positions, problems = self.start if self.start is not None else (0.0,) * len(joints), []
            if len(positions) != len(joints):
                message = f"{len(positions)} joint positions for an arm with {len(joints)} joints"
                raise ConfigError([self.problem("start", f"{message} ({', '.join(joints)})")])
        for name, position, low, high in zip(joints, positions, lower, upper, strict=False):
            if not low <= position <= high:
                message = f"joint '{name}' would start at {position:.6g}, outside its limits"
                problems.append(self.problem(places.get(name, "start"), f"{message} {low:.6g} to {high:.6g}"))
        written = self._written_start
        by_joint = written if isinstance(written, dict) else dict(zip(joints, written or (), strict=False))
        for name, slides in zip(joints, prismatic, strict=False):
            if motion := against_its_motion(by_joint.get(name), prismatic=slides):
                message = f"'{by_joint[name]}': joint '{name}' {motion}"
                problems.append(self.problem(places.get(name, "start"), message))
        if problems:
            raise ConfigError(problems)
        return positions


def load_scene(name: str | Path, beside: Path | None = None) -> Scene:
    """Load a scene by its name or from its file.

    Args:
        name: a path (with a `.yaml` ending), or the name of a scene: `gap` is `gap.yaml` in one of the
            folders of `scene_folders`.
        beside: a robot's YAML file; scenes may lie beside it.

    Raises:
        ConfigError: no such scene, or a file with mistakes; holds all problems with their lines.
    """
    path = Path(name)
    if path.suffix not in {".yaml", ".yml"}:
        path = _find_scene(str(name), beside)
    elif not is_file(path) and path.stem in scene_names(beside):
        message = f"the file does not exist; the scene '{path.stem}' is named without an ending"
        raise ConfigError([Problem(path, 0, "", message)])
    document = read_layers(path)
    problems = list(document.problems)
    if document.root is None:
        raise ConfigError(problems)
    if "robot" in document.root.value:
        raise ConfigError(
            [Problem(path, 0, "", "this is a robot's file; the YAML file of a scene is needed here")]
        )
    origin, data = Origin(path, document.root.marks()), document.root.plain()
    if isinstance(data.get("targets"), str):
        data["targets"], found = read_trajectory(origin.mark("targets").file.parent / data["targets"])
        problems += found
        if found:
            raise ConfigError(problems)
    scene, found = validate(data, Scene, origin)
    problems += found
    if scene is None or problems:
        raise ConfigError(problems)
    scene._origin, scene._written_start = origin, data.get("start")
    return scene


def scene_folders(beside: Path | None = None) -> list[Path]:
    """Where scenes are looked for: beside the robot's file, in `scenes` there or above, proxgen's own."""
    folders = [beside.parent, beside.parent / "scenes", beside.parent.parent / "scenes"] if beside else []
    return [*folders, Path("examples/scenes"), examples_directory() / "scenes"]


def scene_names(beside: Path | None = None) -> list[str]:
    """Names of all scenes that can be found by name; the folder of robots, with its other files, left out."""
    folders = scene_folders(beside)[1:] if beside else scene_folders()
    return sorted({path.stem for folder in folders for path in folder.glob("*.yaml")})


def _find_scene(name: str, beside: Path | None) -> Path:
    """The file of a scene given by its name."""
    for folder in scene_folders(beside):
        path = folder / f"{name}.yaml"
        if is_file(path) and path != beside:
            return path
    names = scene_names(beside)
    message = unknown_name("scene", name, names)
    if nearest_name(name, names) is None:
        message += "; a file is named with its ending, such as my_scene.yaml"
    raise ConfigError([Problem(Path(name), 0, "", message)])
