"""Which rows a configuration has, in which order, and what relaxation does with each."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array, Status
from proxgen.controllers.reference.avoidance import thresholds
from proxgen.controllers.reference.baselines import DROPPED_AT, WIDTH
from proxgen.controllers.reference.parameters import Parameters
from proxgen.controllers.reference.relaxation import Ladder, dropping, slack_weights
from proxgen.controllers.reference.self_collision import self_limits


@dataclass(frozen=True)
class RowOrder:
    """One slot per capsule, the active row, one slot per capsule for self-collision; or those of a baseline.

    Attributes:
        method: `proposed`, `repulsive` or `tangential`.
        schedule: `paper` or `damper`.
        capsules: number of capsules L.
        active: whether there is an active row.
        self_collision: whether there is self-collision.
    """

    method: str
    schedule: str
    capsules: int
    active: bool
    self_collision: bool

    @classmethod
    def of(cls, config: Config) -> "RowOrder":
        """The rows of a configuration."""
        avoidance = config.avoidance
        return cls(
            method=avoidance.method,
            schedule=avoidance.schedule,
            capsules=len(config.capsules),
            active=avoidance.active.enabled,
            self_collision=bool(avoidance.self_collision.points),
        )

    @property
    def count(self) -> int:
        """Number of rows R."""
        if self.method != "proposed":
            return len(DROPPED_AT[self.method])
        return self.capsules + self.active + (self.capsules if self.self_collision else 0)

    def ladder(self, distance: Array, self_distance: Array, p: Parameters) -> Ladder:
        """What the stages do with each row.

        Args:
            distance: (L,) of the capsules [m].
            self_distance: (L,) of self-collision [m], or (0,) without it.
            p: distances.
        """
        if self.method != "proposed":
            return Ladder(np.array(DROPPED_AT[self.method]), WIDTH)
        limits = thresholds(self.schedule, p)
        active = np.full(int(self.active), int(Status.REDUCED_ACTIVE))
        groups = [dropping(distance, limits.distant, limits.critical), active]
        return Ladder(np.concatenate((*groups, dropping(self_distance, *self_limits(p)))))

    def weights(self, on: NDArray[np.bool_], distance: Array, self_distance: Array, p: Parameters) -> Array:
        """Weights ρ (R,) of the soft rows; arguments as those of `ladder`."""
        return slack_weights(on, distance, p, self_distance)
