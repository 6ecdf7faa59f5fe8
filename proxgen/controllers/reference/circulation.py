"""Circulation: where an obstacle blocks the way for good, the tool is sent along it (docs/method.md)."""

from dataclasses import dataclass

import numpy as np

from proxgen.controllers.protocol import Array
from proxgen.controllers.reference.avoidance import Nearest
from proxgen.controllers.reference.geometry import first_within
from proxgen.controllers.reference.parameters import Parameters
from proxgen.controllers.reference.tangents import (
    LEAST_VELOCITY,
    LinearTask,
    first_of_best,
    tangents_of,
    unit_or_zero,
)

MOVING = 0.02
"""A task velocity that is not greater asks for no motion [m/s]."""

FRESH = 3.0
"""A tangent that was released no longer ago than this is preferred [s]."""

KEEP, TURN = 0.5, -2.0
"""Weights of the present tangent: of a new choice soon after the last, and of another way round."""

LEAST_SURFACE_PART = 0.1
"""A tangent that would be shorter on the surface is not moved onto it."""

LEAST_CANDIDATE = 0.5
"""A candidate that is shorter without the rows that the task lacks is left out."""

FREE_NORMAL, FREE_TANGENT = 0.2, 0.5
"""The way is clear if it hardly points at the obstacle, or along the surface it goes with the tangent."""

SAME = 1e-9
"""Speeds [m/s] and parts of unit vectors that differ by no more are equal to what they are held against."""

NEAREST_WEIGHTED = 1e-3
"""Least distance in the weights of other obstacles [m]."""


@dataclass(frozen=True)
class Situation:
    """What circulation looks at in a cycle.

    Attributes:
        speed: σ of the task velocity [m/s].
        direction: u of the task velocity (3,); 0 if it has none.
        velocity: v of the tool, by the previous command (3,) [m/s].
        normal: n̂ of the nearest capsule (3,), or None if nothing is near.
        others: d̂_l (K, 3) of the other capsules, divided by their distances in units of d_on.
    """

    speed: float
    direction: Array
    velocity: Array
    normal: Array | None
    others: Array


class Circulation:
    """Changes the task velocity while the tool is stuck.

    Attributes:
        circulating: the phase.
        tangent: τ (3,); 0 before the first choice.
    """

    def __init__(self, task_rows: tuple[str, ...]) -> None:
        """Start with the way free.

        Args:
            task_rows: names of the rows of the task; one of them is x, y or z.
        """
        self._task = LinearTask(task_rows)
        self.reset()

    def reset(self) -> None:
        """The way is free, and nothing is known."""
        self.circulating = False
        self.tangent = np.zeros(3)
        self._stalled = self._clear = self._failing = self._running = self._blend = 0.0
        self._since = 1e20

    def change(
        self, xdot: Array, J: Array, qdot_previous: Array, nearest: Nearest, on: float, p: Parameters
    ) -> Array:
        """The task velocity (m,) to be used in this cycle.

        Args:
            xdot: (m,) task velocity that is wanted.
            J: (m, n) task Jacobian.
            qdot_previous: (n,) previous command.
            nearest: obstacle points of the capsules.
            on: d_on [m].
            p: times, speeds and the bias.
        """
        now = self._situation(xdot, J @ qdot_previous, nearest, on)
        if self.circulating:
            self._circulate(now, p)
        else:
            self._watch(now, p)
        step, goal = p.period / p.circulation_blend_time, float(self.circulating)
        self._blend = min(self._blend + step, goal) if goal > self._blend else max(self._blend - step, goal)
        wanted = self._task.velocity(xdot)
        blended = (1.0 - self._blend) * wanted + self._blend * p.circulation_speed * self.tangent
        changed = xdot.copy()
        changed[self._task.rows] = blended[self._task.axes]
        return changed

    def _situation(self, xdot: Array, moving: Array, nearest: Nearest, on: float) -> Situation:
        """What there is to know; `moving` (m,) is how the tool moves."""
        wanted = self._task.velocity(xdot)
        slot = first_within(nearest.distance, on)
        there = np.isfinite(nearest.distance)
        if slot is not None:
            there[slot] = False
        weights = on / np.maximum(nearest.distance[there], NEAREST_WEIGHTED)
        return Situation(
            speed=float(np.linalg.norm(wanted)),
            direction=unit_or_zero(wanted, LEAST_VELOCITY),
            velocity=self._task.velocity(moving),
            normal=None if slot is None else nearest.direction[slot],
            others=nearest.direction[there] * weights[:, None],
        )

    def _watch(self, now: Situation, p: Parameters) -> None:
        """Phase 0: has the tool been blocked for long?"""
        progress = float(now.direction @ now.velocity)
        slow = now.speed > MOVING + SAME and progress < p.stall_fraction * now.speed - SAME
        self._since += p.period
        if now.normal is None or not slow:
            self._stalled = max(0.0, self._stalled - p.period)
            return
        self._stalled += p.period
        if self._stalled >= p.stall_time - 0.5 * p.period:
            fresh = self._since < FRESH - 0.5 * p.period and self.tangent.any()
            self._choose(now, now.normal, KEEP if fresh else 0.0, p)
            self.circulating = True
            self._stalled = self._clear = self._failing = self._running = 0.0

    def _circulate(self, now: Situation, p: Parameters) -> None:
        """Phase 1: follow the surface until the way is clear, or another way round has to be tried."""
        self._running += p.period
        if now.normal is not None:
            along = self._task.only(self.tangent - (self.tangent @ now.normal) * now.normal)
            if np.linalg.norm(along) > LEAST_SURFACE_PART + SAME:
                self.tangent = along / np.linalg.norm(along)
        self._clear = self._clear + p.period if self._is_clear(now) else 0.0
        if self.tangent @ now.velocity < p.stall_fraction * p.circulation_speed - SAME:
            self._failing += p.period
        else:
            self._failing = max(0.0, self._failing - p.period)
        released = self._clear >= p.circulation_release_time - 0.5 * p.period
        if released or self._running > p.circulation_time_limit:
            self.circulating = False
            self._stalled = self._since = 0.0
        elif self._failing >= p.circulation_patience - 0.5 * p.period:
            self._choose(now, now.direction if now.normal is None else now.normal, TURN, p)
            self._failing = 0.0

    def _is_clear(self, now: Situation) -> bool:
        """Whether the task velocity can be followed again."""
        if now.normal is None or now.speed <= MOVING + SAME:
            return True
        towards = float(now.direction @ now.normal)
        along = now.direction - max(0.0, towards) * now.normal
        return towards < FREE_NORMAL - SAME or float(along @ self.tangent) > FREE_TANGENT + SAME

    def _choose(self, now: Situation, normal: Array, keep: float, p: Parameters) -> None:
        """Take the tangent with the greatest score; none is left if the task has no row along the surface.

        A normal of 0, where nothing is near and nothing is asked for, has no tangents.
        """
        if not normal.any():
            return
        candidates = self._task.only(tangents_of(normal))
        length = np.sqrt((candidates * candidates).sum(axis=1))
        usable = length >= LEAST_CANDIDATE - SAME
        if not usable.any():
            return
        candidates = candidates[usable] / length[usable, None]
        bias = np.array([p.circulation_bias_x, p.circulation_bias_y, p.circulation_bias_z])
        towards_others = np.maximum(candidates @ now.others.T, 0.0).sum(axis=1)
        scores = candidates @ now.direction - towards_others + keep * candidates @ self.tangent
        self.tangent = candidates[first_of_best(scores + candidates @ bias)]
