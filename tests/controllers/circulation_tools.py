"""A tool that is stuck, for the tests of circulation in the reference."""

from dataclasses import replace
from typing import Any

import numpy as np

from proxgen.controllers.protocol import Array
from proxgen.controllers.reference.avoidance import Nearest
from proxgen.controllers.reference.circulation import Circulation
from proxgen.controllers.reference.parameters import Parameters

CIRCULATION = "avoidance: {circulation: {enabled: true}}\n"
POSITION = ("x", "y", "z")
FORWARD = np.array([0.25, 0.0, 0.0])
ON = 0.30


def facing(*directions: list[float], distance: float = 0.25) -> Nearest:
    """One capsule per direction with an obstacle point in it; an empty one has none."""
    count = len(directions)
    there = np.array([bool(direction) for direction in directions])
    unit = np.array([np.array(d) / np.linalg.norm(d) if d else np.full(3, np.nan) for d in directions])
    distances = np.where(there, distance + 0.01 * np.arange(count), np.inf)
    return Nearest(distances, unit, unit, unit, False)


WALL = facing([1.0, 0.0, 0.0], [])
NOTHING = facing([], [])


class Tool:
    """A task of three rows whose tool moves as `velocity` says; remembers what it was told to do."""

    def __init__(self, p: Parameters, rows: tuple[str, ...] = POSITION) -> None:
        self.circulation, self._p, self._m = Circulation(rows), p, len(rows)

    def cycle(self, nearest: Nearest, velocity: Array | None = None, xdot: Array = FORWARD) -> Array:
        moving = np.zeros(self._m) if velocity is None else velocity
        return self.circulation.change(xdot, np.eye(self._m), moving, nearest, ON, self._p)

    def stick(self, nearest: Nearest = WALL, xdot: Array = FORWARD) -> Array:
        """Stand in front of an obstacle until the tool counts as stuck."""
        for _ in range(100):
            told = self.cycle(nearest, xdot=xdot)
            if self.circulation.circulating:
                return told
        raise AssertionError("never stuck")


def changed(p: Parameters, **values: Any) -> Parameters:
    """Other values."""
    return replace(p, **values)
