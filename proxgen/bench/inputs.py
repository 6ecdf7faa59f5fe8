"""Recorded inputs of a closed loop: what `runtime/bench/replay.c` replays."""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from proxgen.config.scene import Scene
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array, Controller, Measurement
from proxgen.model import RobotModel
from proxgen.simulation.rollout import Cycle, run


@dataclass(frozen=True)
class Inputs:
    """What went into the controller, cycle by cycle.

    Attributes:
        name: of the scene.
        q: (T, n) joint positions [rad].
        xdot: (T, m) task velocities.
        measurements: (T,) of the skin and other sources.
    """

    name: str
    q: Array
    xdot: Array
    measurements: tuple[Measurement, ...]

    @property
    def cycles(self) -> int:
        """How many."""
        return len(self.measurements)

    def recorded(self) -> Iterator[tuple[Array, Array, Measurement]]:
        """What `step` takes, cycle by cycle, as it was kept: anywhere in memory, seldom in the cache."""
        yield from zip(self.q, self.xdot, self.measurements, strict=True)

    def just_made(self) -> Iterator[tuple[Array, Array, Measurement]]:
        """The same as a control loop has it: in arrays that were made a moment ago."""
        for q, xdot, seen in self.recorded():
            arrays: dict[str, Any] = {
                field.name: value.copy()
                for field in fields(seen)
                if isinstance(value := getattr(seen, field.name), np.ndarray)
            }
            yield q.copy(), xdot.copy(), replace(seen, **arrays)

    def save(self, path: Path) -> None:
        """Write the file that `replay` reads: doubles, in the order that it documents."""
        room = max(len(seen.points) for seen in self.measurements)
        parts: list[Array] = [np.array([self.cycles, room], dtype=float)]
        for q, xdot, seen in self.recorded():
            points = np.zeros((room, 3))
            points[: len(seen.points)] = seen.points
            parts += [np.array([seen.time]), q, xdot, seen.tof_range, _age(seen.tof_age, seen.tof_range)]
            parts += [seen.capacitive.astype(float), _age(seen.capacitive_age, seen.capacitive)]
            parts += [np.array([len(seen.points)], dtype=float), points.ravel()]
        path.write_bytes(np.concatenate(parts).astype(np.float64).tobytes())


def _age(age: Array | None, values: np.ndarray) -> Array:
    """Ages, or zeros where all readings are fresh."""
    return np.zeros(len(values)) if age is None else age


def record(
    config: Config, model: RobotModel, controller: Controller, scene: Scene, duration: float
) -> Inputs:
    """Let a controller move the arm through a scene and keep all that it was given.

    Args:
        config: of the robot.
        model: its model.
        controller: what moves the arm.
        scene: obstacles and targets.
        duration: [s].

    Returns:
        The inputs of all cycles, with the skin as the sensor.
    """
    cycles: list[Cycle] = []
    run(config, model, controller, scene, sensing="skin", duration=duration, observers=[cycles.append])
    return Inputs(
        name=scene.name,
        q=np.array([cycle.q for cycle in cycles]),
        xdot=np.array([cycle.xdot for cycle in cycles]),
        measurements=tuple(cycle.measurement for cycle in cycles),
    )


def crowded(inputs: Inputs, model: RobotModel, capacity: int, seed: int = 0) -> Inputs:
    """The same states, with obstacle points on opposite sides of the links in every fourth cycle.

    What a closed loop seldom shows is thus timed as well: rows that contradict each other, all stages of the
    reduction, stops.

    Args:
        inputs: of a closed loop.
        model: the arm.
        capacity: greatest number of further points per cycle.
        seed: of the places.
    """
    from proxgen.model.kinematics import body_poses

    rng, changed = np.random.default_rng(seed), []
    for index, (q, seen) in enumerate(zip(inputs.q, inputs.measurements, strict=True)):
        points: list[Array] = []
        if index % 4 == 0:
            poses = body_poses(model, q)
            for capsule in model.capsules:
                middle = (poses[capsule.body] @ np.append((capsule.start + capsule.end) / 2, 1.0))[:3]
                side = rng.normal(size=3)
                side *= rng.uniform(0.08, 0.3) / np.linalg.norm(side)
                points += [middle + side, middle - side]
        changed.append(
            Measurement(
                seen.time,
                seen.tof_range,
                seen.capacitive,
                seen.tof_age,
                seen.capacitive_age,
                np.array(points[:capacity]).reshape(-1, 3),
            )
        )
    return Inputs(f"{inputs.name} crowded", inputs.q, inputs.xdot, tuple(changed))
