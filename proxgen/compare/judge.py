"""One cycle of two controllers: how far apart their QPs and their decisions are.

The *candidate* is the controller under test, the *reference* the one it is measured by. Nothing that the
candidate says about its own quality is believed: the KKT residual of its velocity is computed here, with the
matrices of the reference and multipliers that are solved for anew.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array, Command, Controller, Diagnostics, Status
from proxgen.controllers.reference.exact import meets_exactly
from proxgen.controllers.reference.feasibility import feasibility_margin
from proxgen.controllers.reference.parameters import Parameters
from proxgen.controllers.reference.qp import QuadraticProgram, kkt_residual, solve
from proxgen.controllers.reference.relaxation import STAGES, soft_program, stage_rows
from proxgen.controllers.reference.row_order import RowOrder
from proxgen.errors import CompareError


@dataclass(frozen=True)
class Tolerances:
    """Greatest differences that still pass.

    Attributes:
        qdot: of the velocity, and of the slack [rad/s].
        matrices: of H, g, A, ubA, lb, ub, the distances, and all other diagnostics.
        kkt: residual of the candidate's velocity, and how far it may be outside its bounds.
    """

    qdot: float = 1e-8
    matrices: float = 1e-10
    kkt: float = 1e-8

    def of(self, quantity: str) -> float:
        """The tolerance of a quantity of `QUANTITIES`."""
        if quantity in ("kkt_residual", "bound_penetration"):
            return self.kkt
        return self.qdot if quantity in ("qdot", "slack") else self.matrices


QUANTITIES = (
    "qdot", "slack", "H", "g", "A", "ubA", "lb", "ub", "distance", "self_distance", "tangent",
    "nearest_point", "approach_speed", "manipulability", "damping", "kkt_residual", "bound_penetration",
)  # fmt: skip
"""What is measured in every cycle; nan where a cycle does not have it."""

OF_A_QP = (
    "H", "g", "distance", "self_distance", "tangent", "nearest_point", "approach_speed", "manipulability",
    "damping",
)  # fmt: skip
"""Those of the diagnostics that a cycle has unless it ends in a fault, whatever rows are on."""

COUNTS = ("self_readings", "memory_points", "circulating")
"""What additions count, which has to be the same; 0 for both where an addition is off."""


@dataclass(frozen=True)
class Judgement:
    """A cycle's differences.

    Attributes:
        errors: greatest difference per quantity; nan: nothing to compare; inf: one side is not finite.
        status: of the candidate.
        reference_status: of the reference; where another is as right, this is no finding.
        row_mismatches: rows that are on for one and off for the other.
        findings: everything beyond its tolerance, each a sentence without place and time.
    """

    errors: dict[str, float]
    status: Status
    reference_status: Status
    row_mismatches: int
    findings: tuple[str, ...] = field(default=())


class Judge:
    """Compares commands that two controllers gave for the same input."""

    def __init__(self, config: Config, reference: Controller, tolerances: Tolerances | None = None) -> None:
        """Judge by the parameters that `reference` has now.

        Args:
            config: of both controllers.
            reference: its parameters decide what the stages and the soft rows are.
            tolerances: the acceptance's by default.
        """
        self.tolerances = tolerances or Tolerances()
        self._soft = config.relaxation.mode == "slack"
        self._parameters = Parameters(**dict(reference.parameters))  # type: ignore[arg-type]
        self._order = RowOrder.of(config)
        self._tolerance = config.solver.tolerance

    def judge(self, candidate: Command, reference: Command) -> Judgement:
        """All differences of a cycle.

        Raises:
            CompareError: arrays of different shapes, so that they are not controllers of the same arm.
        """
        mine, theirs = candidate.diagnostics, reference.diagnostics
        _check_shapes(mine, theirs)
        errors = dict.fromkeys(QUANTITIES, np.nan)
        findings: list[str] = []
        pairs = {name: _pair(mine, theirs, name) for name in ("lb", "ub")}
        rows_differ = mine.row_on != theirs.row_on
        if candidate.status == reference.status:
            pairs["qdot"] = candidate.qdot, reference.qdot
            if candidate.status.success:
                pairs["slack"] = mine.slack, theirs.slack
        tied = candidate.status != reference.status and self._is_tie(candidate, reference)
        if candidate.status != reference.status and not tied:
            findings.append(self._status_sentence(candidate.status, reference.status, theirs))
        if not candidate.status.fault and not reference.status.fault:
            pairs |= {name: _pair(mine, theirs, name) for name in OF_A_QP}
            findings += _count_sentences(mine, theirs)
            both = mine.row_on & theirs.row_on
            pairs["A"] = _where(both, mine.A), _where(both, theirs.A)
            pairs["ubA"] = _where(both, mine.ubA), _where(both, theirs.ubA)
        findings += [_row_sentence(int(row), mine) for row in np.flatnonzero(rows_differ)]
        for name, (a, b) in pairs.items():
            errors[name], worst = _greatest_difference(a, b)
            if errors[name] > self.tolerances.of(name):
                findings.append(_value_sentence(name, a, b, worst, errors[name], self.tolerances.of(name)))
        errors["bound_penetration"] = _outside(candidate.qdot, theirs.lb, theirs.ub)
        if candidate.status.success and reference.status.success and not tied:
            errors["kkt_residual"] = self.residual(candidate, theirs)
        for name in ("kkt_residual", "bound_penetration"):
            if errors[name] > self.tolerances.of(name):
                findings.append(_residual_sentence(name, errors[name], self.tolerances.of(name), mine))
        return Judgement(errors, candidate.status, reference.status, int(rows_differ.sum()), tuple(findings))

    def residual(self, candidate: Command, theirs: Diagnostics) -> float:
        """KKT residual of the candidate's velocity in the reference's QP, at the stage that it claims.

        The multipliers are those of the reference's solver. inf if that QP has no solution.

        Args:
            candidate: a command with a success status.
            theirs: the reference's QP of the same cycle.
        """
        program = self._program(candidate.status, theirs)
        x = candidate.qdot
        if self._soft:
            exceeded = np.maximum(program.A @ x - program.b, 0.0)
            rho = self._order.weights(theirs.row_on, theirs.distance, theirs.self_distance, self._parameters)
            program, x = soft_program(program, rho[theirs.row_on]), np.concatenate((x, exceeded))
        solution = solve(program, self._tolerance).solution
        if solution is None:
            return np.inf
        residual = kkt_residual(program, x, solution.row_multipliers, solution.bound_multipliers)
        return residual if np.isfinite(residual) else np.inf

    def _program(self, status: Status, theirs: Diagnostics) -> QuadraticProgram:
        """The reference's QP with the rows that a stage keeps."""
        ladder = self._order.ladder(theirs.distance, theirs.self_distance, self._parameters)
        kept, b = stage_rows(status, theirs.row_on, theirs.ubA, ladder)
        return QuadraticProgram(theirs.H, theirs.g, theirs.A[kept], b[kept], theirs.lb, theirs.ub)

    def _is_tie(self, candidate: Command, reference: Command) -> bool:
        """Whether docs/method.md, step 6, allows both statuses.

        It does where a stage is a tie: its rows exclude each other by more than 0, but by no more than the
        tolerance. A stage may be skipped unless it is feasible, and taken unless it is infeasible; each side
        is judged by its own QP, in rational arithmetic.
        """
        stages = (*STAGES, Status.STOPPED_INFEASIBLE)
        if self._soft or candidate.status not in stages or reference.status not in stages:
            return False
        earlier = min(candidate.status, reference.status)
        for command in (candidate, reference):
            program = self._program(earlier, command.diagnostics)
            rows = program.A, program.b, program.lb, program.ub
            if meets_exactly(*rows) or not meets_exactly(*rows, self._tolerance):
                return False
            between = [stage for stage in STAGES if earlier < stage < command.status]
            for stage in between:
                program = self._program(stage, command.diagnostics)
                if meets_exactly(program.A, program.b, program.lb, program.ub):
                    return False
        return True

    def _status_sentence(self, mine: Status, reference: Status, theirs: Diagnostics) -> str:
        """Both statuses, and how clear the case is at the first stage that only one of them took."""
        sentence = f"status {mine.name}, in the reference {reference.name}"
        stage = min(mine, reference)
        if self._soft or stage not in STAGES or mine.fault or reference.fault:
            return sentence
        program = self._program(Status(stage), theirs)
        bounds = feasibility_margin(program.A, program.b, program.lb, program.ub, self._tolerance)[1:]
        return (
            f"{sentence} (at {Status(stage).name}, the worst row is exceeded by "
            f"at least {bounds[0]:.3g} and at most {bounds[1]:.3g} m/s at the best velocity)"
        )


def _check_shapes(mine: Diagnostics, theirs: Diagnostics) -> None:
    """Refuse to compare different arms."""
    for name in (*OF_A_QP, "A", "ubA", "lb", "ub", "row_on", "slack"):
        a, b = np.shape(getattr(mine, name)), np.shape(getattr(theirs, name))
        if a != b:
            raise CompareError(
                f"diagnostics.{name} is {a}, in the reference {b}: not controllers of the same arm"
            )


def _pair(mine: Diagnostics, theirs: Diagnostics, name: str) -> tuple[Array, Array]:
    """The same of both sides, a number as an array of one."""
    return np.atleast_1d(getattr(mine, name)), np.atleast_1d(getattr(theirs, name))


def _where(rows: NDArray[np.bool_], array: Array) -> Array:
    """The array with all other rows set to 0, so that places keep their index."""
    return np.where(rows[:, None] if array.ndim == 2 else rows, array, 0.0)


def _greatest_difference(a: Array, b: Array) -> tuple[float, tuple[int, ...]]:
    """Greatest |a - b| and where; inf if only one side is finite, 0 where both are the same or both nan."""
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    with np.errstate(invalid="ignore"):
        difference = np.where(same, 0.0, np.abs(a - b))
    difference = np.where(np.isnan(difference), np.inf, difference)
    if difference.size == 0:
        return 0.0, ()
    worst = np.unravel_index(int(np.argmax(difference)), difference.shape)
    return float(difference[worst]), tuple(int(index) for index in worst)


def _outside(qdot: Array, lb: Array, ub: Array) -> float:
    """How far a velocity is outside its bounds; inf if it is not finite."""
    if not np.isfinite(qdot).all():
        return np.inf
    return float(np.maximum(np.maximum(lb - qdot, qdot - ub).max(), 0.0))


def _value_sentence(
    name: str, a: Array, b: Array, worst: tuple[int, ...], error: float, tolerance: float
) -> str:
    """Both values of a quantity at the place where they differ most."""
    place = ", ".join(str(index) for index in worst)
    values = f"{float(a[worst]):.17g}, in the reference {float(b[worst]):.17g}"
    return f"{name}[{place}] is {values}: error {error:.3g}, tolerance {tolerance:g}"


def _count_sentences(mine: Diagnostics, theirs: Diagnostics) -> list[str]:
    """What additions count, where the two differ."""
    pairs = {name: (int(getattr(mine, name)), int(getattr(theirs, name))) for name in COUNTS}
    return [
        f"{name} is {here}, in the reference {there}"
        for name, (here, there) in pairs.items()
        if here != there
    ]


def _row_sentence(row: int, mine: Diagnostics) -> str:
    """Which row is on here and off there."""
    here, there = ("on", "off") if mine.row_on[row] else ("off", "on")
    return f"row {row} is {here}, in the reference {there}"


def _residual_sentence(name: str, error: float, tolerance: float, mine: Diagnostics) -> str:
    """A residual against its tolerance, and what the candidate claims."""
    what = "KKT residual of qdot" if name == "kkt_residual" else "qdot outside its bounds:"
    claim = f"; the controller itself says {mine.kkt_residual:.3g}" if name == "kkt_residual" else ""
    return f"{what} {error:.3g}, tolerance {tolerance:g}{claim}"
