"""Controllers that are wrong on purpose, to show that a comparison notices."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array, Command, Diagnostics, Measurement, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.model import RobotModel

Change = Callable[[Command], Command]


class Distorted:
    """A reference whose commands are changed on their way out, in every cycle or `only` in one."""

    def __init__(self, inner: ReferenceController, change: Change, *, only: int | None = None) -> None:
        self._inner, self._change, self._only, self._cycle = inner, change, only, -1

    @property
    def parameters(self) -> Mapping[str, float | Array]:
        return self._inner.parameters

    def set_parameters(self, **values: Any) -> None:
        self._inner.set_parameters(**values)

    def reset(self) -> None:
        self._inner.reset()

    def step(self, q: Array, xdot: Array, measurement: Measurement) -> Command:
        self._cycle += 1
        command = self._inner.step(q, xdot, measurement)
        if self._only is not None and self._cycle != self._only:
            return command
        command = self._change(command)
        if np.isfinite(command.qdot).all():
            self._inner.follow(command.qdot)  # what was commanded is what it remembers
        return command


class FollowingDistorted(Distorted):
    """The same, for the side of the reference, which is told what was commanded."""

    def follow(self, qdot: Array) -> None:
        self._inner.follow(qdot)


def negated(name: str, row: int | None = None) -> Change:
    """Changes the sign of an array of the diagnostics, or of one row of it."""

    def change(command: Command) -> Command:
        array = np.array(getattr(command.diagnostics, name))
        rows = slice(None) if row is None else row
        array[rows] = -array[rows]
        return with_diagnostics(command, **{name: array})

    return change


def moved(name: str, amount: float) -> Change:
    """Adds to the first entry of an array of the diagnostics."""

    def change(command: Command) -> Command:
        array = np.array(getattr(command.diagnostics, name))
        array.flat[0] += amount
        return with_diagnostics(command, **{name: array})

    return change


def with_diagnostics(command: Command, **values: Any) -> Command:
    """The command with other diagnostics."""
    return replace(command, diagnostics=replace(command.diagnostics, **values))


def with_qdot(factor: float = 1.0, offset: float | Array = 0.0) -> Change:
    """Another velocity, and nothing else."""
    return lambda command: replace(command, qdot=factor * command.qdot + offset)


def with_status(status: Status) -> Change:
    """Another status, and nothing else."""
    return lambda command: replace(command, status=status)


class WrongSign(ReferenceController):
    """A reference that is wrong inside: one capsule's row has the wrong sign before the QP is solved."""

    def __init__(self, config: Config, model: RobotModel, capsule: int) -> None:
        super().__init__(config, model)
        self._wrong = capsule

    def _solve(self, q: Array, xdot: Array, seen: Any, nearest: Any, own: Any) -> Command:
        direction = nearest.direction.copy()
        direction[self._wrong] *= -1.0
        return super()._solve(q, xdot, seen, replace(nearest, direction=direction), own)


def diagnostics_of_another_arm(found: Diagnostics) -> Diagnostics:
    """One joint less."""
    return replace(found, H=found.H[1:, 1:])
