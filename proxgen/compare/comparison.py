"""What came out of a comparison: arrays per cycle, findings in words, a verdict."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from proxgen.compare.judge import QUANTITIES, Judgement, Tolerances
from proxgen.controllers.protocol import Array

if TYPE_CHECKING:
    from proxgen.simulation.log import RolloutLog

MAX_SENTENCES = 40
"""Findings of a scene that are put into words; the others are counted."""

_GREATEST = 1e300
"""Stands for infinity in JSON, which has no such number."""


@dataclass(frozen=True)
class SceneComparison:
    """One scene, or one list of states, of T cycles.

    Attributes:
        scene: its name.
        time: (T,) [s].
        errors: per quantity of `judge.QUANTITIES` an array (T,); nan where a cycle has nothing to compare.
        status: (T,) of the candidate.
        reference_status: (T,) of the reference.
        row_mismatches: (T,) rows that are on for one and off for the other.
        sentences: findings that name scene, cycle, quantity and both values, `MAX_SENTENCES` at most.
        findings: how many there are in all.
        log: what the closed loop recorded, or None.
    """

    scene: str
    time: Array
    errors: dict[str, Array]
    status: NDArray[np.int64]
    reference_status: NDArray[np.int64]
    row_mismatches: NDArray[np.int64]
    sentences: tuple[str, ...]
    findings: int
    log: "RolloutLog | None" = None

    @property
    def cycles(self) -> int:
        """Number of cycles T."""
        return len(self.time)

    @property
    def status_mismatches(self) -> int:
        """Cycles with different statuses."""
        return int(np.count_nonzero(self.status != self.reference_status))

    def greatest(self, quantity: str) -> float:
        """Greatest value of a quantity over all cycles; 0 if no cycle has it."""
        values = self.errors[quantity]
        present = values[~np.isnan(values)]
        return float(present.max()) if present.size else 0.0

    @property
    def failures(self) -> tuple[str, ...]:
        """The findings in words."""
        hidden = self.findings - len(self.sentences)
        return (*self.sentences, f"{self.scene}: {hidden} more findings") if hidden else self.sentences

    def to_json(self) -> dict[str, Any]:
        """The scene's entry of `proxgen compare --json`."""
        return {
            "scene": self.scene,
            "cycles": self.cycles,
            "max_abs_qdot_error": _number(self.greatest("qdot")),
            "max_abs_H_error": _number(self.greatest("H")),
            "max_abs_A_error": _number(self.greatest("A")),
            "max_kkt_residual": _number(self.greatest("kkt_residual")),
            "status_mismatches": self.status_mismatches,
        }


@dataclass(frozen=True)
class Comparison:
    """All scenes of a comparison.

    Attributes:
        scenes: in the order in which they were asked for.
        tolerances: what the verdict is about.
    """

    scenes: tuple[SceneComparison, ...]
    tolerances: Tolerances

    @property
    def verdict(self) -> str:
        """`pass` if there were cycles, and everything in every cycle is within its tolerance; else `fail`."""
        compared = sum(scene.cycles for scene in self.scenes)
        return "pass" if compared and not any(scene.findings for scene in self.scenes) else "fail"

    @property
    def failures(self) -> tuple[str, ...]:
        """Why the verdict is `fail`, in sentences; empty if it is `pass`."""
        if not any(scene.cycles for scene in self.scenes):
            return ("no cycle was compared",)
        return tuple(sentence for scene in self.scenes for sentence in scene.failures)

    def to_json(self) -> dict[str, Any]:
        """The object of `proxgen compare --json`: numbers and the verdict."""
        return {"scenes": [scene.to_json() for scene in self.scenes], "verdict": self.verdict}


def _number(value: float) -> float:
    """A number that JSON can hold."""
    return value if math.isfinite(value) else _GREATEST


@dataclass
class Record:
    """Collects the judgements of a scene, cycle by cycle.

    Attributes:
        scene: its name.
    """

    scene: str
    _times: list[float] = field(default_factory=list)
    _judgements: list[Judgement] = field(default_factory=list)
    _sentences: list[str] = field(default_factory=list)

    def add(self, time: float, judgement: Judgement) -> None:
        """Append a cycle."""
        cycle = len(self._times)
        room = MAX_SENTENCES - len(self._sentences)
        self._sentences += [f"{self.scene}, cycle {cycle}: {words}" for words in judgement.findings[:room]]
        self._times.append(time)
        self._judgements.append(judgement)

    def comparison(self, log: "RolloutLog | None" = None) -> SceneComparison:
        """Everything that was added, as arrays."""
        judgements: Sequence[Judgement] = self._judgements
        return SceneComparison(
            scene=self.scene,
            time=np.array(self._times),
            errors={name: np.array([j.errors[name] for j in judgements]) for name in QUANTITIES},
            status=np.array([j.status for j in judgements], dtype=np.int64),
            reference_status=np.array([j.reference_status for j in judgements], dtype=np.int64),
            row_mismatches=np.array([j.row_mismatches for j in judgements], dtype=np.int64),
            sentences=tuple(self._sentences),
            findings=sum(len(j.findings) for j in judgements),
            log=log,
        )
