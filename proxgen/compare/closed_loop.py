"""The comparison in the closed loop: the candidate moves the arm, the reference sees what it sees."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from proxgen.compare.comparison import Comparison, Record, SceneComparison
from proxgen.compare.judge import Judge, Tolerances
from proxgen.config.scene import Scene, load_scene
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array, Command, Controller
from proxgen.controllers.reference import ReferenceController
from proxgen.errors import CompareError
from proxgen.model import build_model

if TYPE_CHECKING:
    from proxgen.simulation.rollout import Cycle

Progress = Callable[[int, int], None]
"""Called after each cycle with the number of cycles done and the number of all, over all scenes."""


@runtime_checkable
class Follower(Protocol):
    """A controller that can be told what another one commanded."""

    def follow(self, qdot: Array) -> None:
        """Take `qdot` (n,) for the previous command."""


def tell(reference: Controller, command: Command) -> None:
    """Let the reference follow what the candidate has commanded, if it can and if that is a velocity."""
    if isinstance(reference, Follower) and np.isfinite(command.qdot).all():
        reference.follow(command.qdot)


class Companion:
    """Observer of a closed loop: gives the reference the same input, and judges what both decided.

    A reference that is a `Follower` is told in every cycle what the candidate has commanded, so that both
    begin the next one with the same previous velocity: each cycle is judged by itself, and a difference is
    not found again in all later ones. What the candidate remembers is judged too, by its bounds.
    """

    def __init__(self, scene: str, reference: Controller, judge: Judge) -> None:
        """Begin a scene with a reset reference."""
        self._reference, self._judge, self._record = reference, judge, Record(scene)
        reference.reset()

    def __call__(self, cycle: "Cycle") -> None:
        """Judge a cycle."""
        expected = self._reference.step(cycle.q, cycle.xdot, cycle.measurement)
        judgement = self._judge.judge(cycle.command, expected)
        tell(self._reference, cycle.command)
        self._record.add(cycle.time, judgement)

    @property
    def record(self) -> Record:
        """What was seen so far."""
        return self._record


def compare(
    config: Config,
    scenes: Sequence[str | Path | Scene],
    *,
    sensing: str = "skin",
    duration: float = 60.0,
    seed: int = 0,
    progress: Progress | None = None,
    candidate: Controller | None = None,
    reference: Controller | None = None,
    tolerances: Tolerances | None = None,
) -> Comparison:
    """Compare two controllers, cycle by cycle, in the closed loop of each scene.

    Args:
        config: of both controllers.
        scenes: names, files or scenes.
        sensing: `skin` or `ideal`.
        duration: of each scene [s].
        seed: of the simulation's noise.
        progress: called in every cycle.
        candidate: the controller under test, which moves the arm; by default the compiled one, built if it is
            not up to date.
        reference: what it is measured by; by default the reference.
        tolerances: the acceptance's by default.

    Raises:
        CompareError: no scene, or controllers of different arms.
        ConfigError: a scene that cannot be used.
        BuildError: the compiled controller cannot be built.
    """
    from proxgen.simulation.rollout import run  # imports pybullet, which open-loop comparisons do without

    if not scenes:
        raise CompareError("no scene to compare in")
    loaded = [scene if isinstance(scene, Scene) else load_scene(scene, config.source) for scene in scenes]
    model = build_model(config)
    if candidate is None:
        from proxgen.builder.api import build  # needs a compiler; not where both controllers are given

        candidate = build(config)
    reference = ReferenceController(config, model) if reference is None else reference
    judge = Judge(config, reference, tolerances)
    results: list[SceneComparison] = []
    for index, scene in enumerate(loaded):
        companion = Companion(scene.name, reference, judge)
        log = run(
            config,
            model,
            candidate,
            scene,
            sensing=sensing,
            duration=duration,
            seed=seed,
            observers=(companion,),
            progress=_over_all_scenes(progress, index, len(loaded)),
        )
        results.append(companion.record.comparison(log))
    return Comparison(tuple(results), judge.tolerances)


def _over_all_scenes(progress: Progress | None, scene: int, scenes: int) -> Progress | None:
    """The progress of one scene as a part of all, which have the same number of cycles."""
    if progress is None:
        return None
    return lambda done, cycles: progress(scene * cycles + done, scenes * cycles)
