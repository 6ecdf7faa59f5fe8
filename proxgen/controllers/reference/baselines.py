"""The methods that the paper compares with: the nearest point moves away, or along (docs/method.md)."""

import numpy as np

from proxgen.controllers.protocol import OFF, Array
from proxgen.controllers.reference.avoidance import LAWS, Nearest, Rows
from proxgen.controllers.reference.geometry import Capsules, first_within
from proxgen.controllers.reference.kinematics import Arm
from proxgen.controllers.reference.parameters import Parameters
from proxgen.controllers.reference.tangents import (
    LEAST_VELOCITY,
    LinearTask,
    basis_of,
    first_of_best,
    tangents_of,
    unit_or_zero,
)

WIDTH = 1e-5
"""An equality holds up to this [m/s], so that its two rows are not exact opposites."""

INDEPENDENT = 0.01
"""A row of which less is left beside the rows before it could contradict them, and is off."""

KEEP = 0.5
"""Weight of the last tangent."""

LEAST_TANGENT = 1e-6
"""A tangent that is shorter once made normal to the obstacle's direction is forgotten."""


class Repulsive:
    """The nearest point moves straight away from the obstacle: J_p q̇ = -v d̂."""

    slots = 6

    def __init__(self, schedule: str, task_rows: tuple[str, ...]) -> None:
        """Take the law of `schedule`; the task does not matter."""
        self._schedule = schedule

    def reset(self) -> None:
        """There is nothing to forget."""

    def rows(self, arm: Arm, capsules: Capsules, nearest: Nearest, xdot: Array, p: Parameters) -> Rows:
        """The rows of the nearest point.

        Args:
            arm: at its present position.
            capsules: L capsules.
            nearest: their nearest obstacle points.
            xdot: (m,) task velocity.
            p: distances and speeds.
        """
        speeds, rows = _speeds(nearest, self._schedule, p), _Rows(self.slots, arm.n)
        slot = first_within(nearest.distance, p.d_0u if self._schedule == "paper" else p.damper_safety)
        if slot is not None:
            basis = basis_of(nearest.direction[slot])
            J_p = arm.point_jacobian(int(capsules.body[slot]), nearest.closest[slot])
            rows.away(0, basis.third @ J_p, speeds[slot], p)
            for first, direction in ((2, basis.first), (4, basis.second)):
                if rows.independent(direction @ J_p):
                    rows.equal(first, direction @ J_p, 0.0)
        return rows.finish(speeds)


class Tangential:
    """The nearest point moves along a tangent of the obstacle that is chosen among 24."""

    slots = 5

    def __init__(self, schedule: str, task_rows: tuple[str, ...]) -> None:
        """Take the law of `schedule`, and the rows x, y, z of the task."""
        self._schedule, self._task = schedule, LinearTask(task_rows)
        self.reset()

    def reset(self) -> None:
        """Forget the last tangent."""
        self._tangent = np.zeros(3)

    def rows(self, arm: Arm, capsules: Capsules, nearest: Nearest, xdot: Array, p: Parameters) -> Rows:
        """The rows of the nearest point; arguments as those of `Repulsive.rows`."""
        speeds, rows = _speeds(nearest, self._schedule, p), _Rows(self.slots, arm.n)
        slot = first_within(nearest.distance, p.d_a if self._schedule == "paper" else p.damper_influence)
        if slot is None:
            self._tangent = np.zeros(3)
            return rows.finish(speeds)
        normal = nearest.direction[slot]
        self._tangent = self._choose(slot, nearest, xdot, p)
        J_p = arm.point_jacobian(int(capsules.body[slot]), nearest.closest[slot])
        rows.away(0, normal @ J_p, speeds[slot], p)
        across, along = np.cross(normal, self._tangent) @ J_p, self._tangent @ J_p
        if rows.independent(across):
            rows.equal(2, across, 0.0)
        if rows.independent(along):
            rows.set(4, -along, -p.tangential_speed)
        return rows.finish(speeds)

    def _choose(self, slot: int, nearest: Nearest, xdot: Array, p: Parameters) -> Array:
        """The best tangent t (3,): towards the target, away from other obstacles, like the last one."""
        normal = nearest.direction[slot]
        candidates = tangents_of(normal)
        direction = unit_or_zero(self._task.velocity(xdot), LEAST_VELOCITY)
        last = unit_or_zero(self._tangent - (self._tangent @ normal) * normal, LEAST_TANGENT)
        scores = candidates @ direction + KEEP * candidates @ last
        for other in np.flatnonzero(np.isfinite(nearest.distance)).tolist():
            if other != slot:
                weight = max(0.0, (p.d_a - nearest.distance[other]) / (p.d_a - p.d_r))
                scores -= weight * np.maximum(candidates @ nearest.direction[other], 0.0)
        chosen: Array = candidates[first_of_best(scores)]
        return chosen


class _Rows:
    """Rows that are put together one by one; those that are not set are off."""

    def __init__(self, count: int, n: int) -> None:
        self._A, self._b = np.zeros((count, n)), np.full(count, OFF)
        self._units: list[Array] = []

    def set(self, slot: int, row: Array, b: float) -> None:
        """One row a q̇ ≤ b."""
        self._A[slot], self._b[slot] = row, b

    def equal(self, slot: int, row: Array, b: float) -> None:
        """Two rows: a q̇ = b, up to WIDTH."""
        self.set(slot, row, b + WIDTH)
        self.set(slot + 1, -row, -b + WIDTH)

    def away(self, slot: int, row: Array, speed: float, p: Parameters) -> None:
        """Two rows: a₁ᵀJ_p q̇ = b₁, the retreat that the law asks for and joints can give."""
        if self.independent(row):
            self.equal(slot, row, max(min(0.0, speed), -p.row_speed * float(np.linalg.norm(row))))

    def independent(self, row: Array) -> bool:
        """Whether a row adds something to those that were kept before; then it is kept as well."""
        left = row
        for unit in self._units:
            left = left - (left @ unit) * unit
        length = float(np.linalg.norm(left))
        if length < INDEPENDENT:
            return False
        self._units.append(left / length)
        return True

    def finish(self, speeds: Array) -> Rows:
        """All rows; `speeds` (L,) are those of the law."""
        return Rows(self._A, self._b, self._b < OFF, speeds)


def _speeds(nearest: Nearest, schedule: str, p: Parameters) -> Array:
    """The law at each capsule's distance (L,) [m/s]; inf where there is no obstacle point."""
    law = LAWS[schedule]
    return np.array([law(float(d), p) if np.isfinite(d) else np.inf for d in nearest.distance])


BASELINES: dict[str, type[Repulsive] | type[Tangential]] = {"repulsive": Repulsive, "tangential": Tangential}
"""Methods by the name that `avoidance.method` has for them."""

DROPPED_AT: dict[str, tuple[int, ...]] = {
    "repulsive": (99, 2, 1, 1, 1, 1),
    "tangential": (99, 2, 2, 2, 1),
}
"""The stage in which each slot is dropped; 99: in none."""
