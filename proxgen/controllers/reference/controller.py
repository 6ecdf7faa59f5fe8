"""ReferenceController: the steps of docs/method.md in their order."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from proxgen.config.schema import Config
from proxgen.controllers.protocol import OFF, Array, Command, Diagnostics, Measurement, Status
from proxgen.controllers.reference import avoidance, objective, relaxation
from proxgen.controllers.reference.baselines import BASELINES
from proxgen.controllers.reference.circulation import Circulation
from proxgen.controllers.reference.faults import find_fault, within_limits
from proxgen.controllers.reference.geometry import Capsules
from proxgen.controllers.reference.kinematics import Arm
from proxgen.controllers.reference.parameters import changed, default_parameters
from proxgen.controllers.reference.qp import QuadraticProgram
from proxgen.controllers.reference.row_order import RowOrder
from proxgen.controllers.reference.self_collision import NearestSelf, SelfPoints, self_rows
from proxgen.controllers.reference.sensing import Eyes, Seen
from proxgen.errors import ControllerError
from proxgen.model.robot_model import RobotModel


class ReferenceController:
    """The controller that a compiled one is compared with.

    Attributes:
        model: the arm.
    """

    def __init__(self, config: Config, model: RobotModel) -> None:
        """Start with the parameters of the configuration, at rest.

        Args:
            config: a loaded configuration.
            model: the arm that it describes.
        """
        self.model = model
        self._parameters = default_parameters(config, model)
        self._order = RowOrder.of(config)
        self._soft = config.relaxation.mode == "slack"
        self._tolerance = config.solver.tolerance
        self._max_points = config.skin.max_points
        self._arm = Arm(model)
        self._capsules = Capsules(model)
        self._eyes = Eyes(config, model, self._capsules)
        self._self_points = SelfPoints(model) if self._order.self_collision else None
        self._circulation = Circulation(model.task_rows) if config.avoidance.circulation.enabled else None
        baseline = BASELINES.get(self._order.method)
        self._baseline = baseline(self._order.schedule, model.task_rows) if baseline else None
        self.reset()

    def __repr__(self) -> str:
        """Robot and sizes, as the compiled controller says them."""
        model = self.model
        sizes = f"joints={model.n}, task_rows={model.m}, capsules={len(model.capsules)}"
        modules = f"tof={len(model.tof_modules)}, capacitive={len(model.capacitive_modules)}"
        return f"ReferenceController(robot={model.name!r}, {sizes}, {modules})"

    @property
    def parameters(self) -> Mapping[str, float | Array]:
        """All run-time parameters by name (see docs/method.md, table of parameters); copies."""
        return MappingProxyType(self._parameters.as_dict())

    def set_parameters(self, **values: Any) -> None:
        """Change parameters by name; all or, if one is not accepted, none.

        Raises:
            ControllerError: a name, a shape or a value that is not accepted.
        """
        self._parameters = changed(self._parameters, values)

    def reset(self) -> None:
        """Forget the previous velocity, the previous time, and what additions remember."""
        self._previous_time: float | None = None
        self._qdot_previous = np.zeros(self.model.n)
        self._eyes.reset()
        if self._circulation is not None:
            self._circulation.reset()
        if self._baseline is not None:
            self._baseline.reset()

    def follow(self, qdot: Array) -> None:
        """Take (n,) `qdot` for the previous command: what another controller gave to the arm [rad/s]."""
        self._qdot_previous = _vector("qdot", qdot, self.model.n)

    def step(self, q: Array, xdot: Array, measurement: Measurement) -> Command:
        """One control cycle.

        Args:
            q: (n,) joint positions [rad or m].
            xdot: (m,) task velocity [m/s, rad/s].
            measurement: what the sensors saw.

        Raises:
            ControllerError: an array of the wrong size.
        """
        q, xdot = _vector("q", q, self.model.n), _vector("xdot", xdot, self.model.m)
        self._check_sizes(measurement)
        p, time = self._parameters, measurement.time
        fault = find_fault(q, xdot, measurement, self._eyes.tof_limit, self._previous_time, p)
        later = self._previous_time is None or time > self._previous_time
        if later and fault is not Status.FAULT_NOT_FINITE:
            self._previous_time = time
        if fault is not None:
            return self._safe_stop(fault, q)
        self._arm.move_to(q)
        seen = self._eyes.see(self._arm, measurement, p)
        influence = avoidance.thresholds(self._order.schedule, p).influence
        nearest = avoidance.nearest_points(self._arm, self._capsules, seen.points, influence)
        near_self = None
        if self._self_points:
            near_self = self._self_points.nearest(self._arm, self._capsules, p.self_d_a)
        if nearest.inside or (near_self is not None and near_self.inside):
            return self._safe_stop(Status.FAULT_OBSTACLE_INSIDE, q)
        return self._solve(q, xdot, seen, nearest, near_self)

    def _solve(
        self, q: Array, xdot: Array, seen: Seen, nearest: avoidance.Nearest, near_self: NearestSelf | None
    ) -> Command:
        """Steps 4 to 7: rows, objective, bounds, decision; before them what circulation does."""
        p = self._parameters
        J = self._arm.task_jacobian()
        if self._circulation is not None:
            onset = p.d_a if self._order.schedule == "paper" else p.damper_influence
            xdot = self._circulation.change(xdot, J, self._qdot_previous, nearest, onset, p)
        rows = self._rows(xdot, nearest, near_self)
        self_distance = relaxation.NONE if near_self is None else near_self.distance
        w = objective.manipulability(J)
        damping = objective.damping(w, p)
        H, g = objective.objective(J, xdot, q, damping, p)
        lb, ub = objective.bounds(q, self._qdot_previous, p)
        program = QuadraticProgram(H, g, rows.A, rows.b, lb, ub)
        decision = self._decide(program, rows, nearest.distance, self_distance)
        solution = decision.solution
        qdot = np.zeros(q.size) if solution is None else solution.x[: q.size]
        diagnostics = Diagnostics(
            H=H,
            g=g,
            A=rows.A,
            ubA=rows.b,
            lb=lb,
            ub=ub,
            row_on=rows.on,
            distance=nearest.distance,
            nearest_point=nearest.obstacle,
            approach_speed=rows.approach_speed,
            manipulability=w,
            damping=damping,
            slack=decision.slack,
            kkt_residual=np.nan if solution is None else solution.residual,
            iterations=decision.iterations,
            solves=decision.solves,
            second_chances=decision.second_chances,
            self_readings=seen.self_readings,
            memory_points=seen.memory_points,
            self_distance=self_distance,
            circulating=bool(self._circulation and self._circulation.circulating),
            tangent=self._circulation.tangent if self._circulation else relaxation.NONE,
        )
        return self._command(qdot, decision.status, diagnostics)

    def _rows(self, xdot: Array, nearest: avoidance.Nearest, near_self: NearestSelf | None) -> avoidance.Rows:
        """Step 4, with the rows of self-collision; or those of the method that is in place of it."""
        p, arm, capsules = self._parameters, self._arm, self._capsules
        if self._baseline is not None:
            return self._baseline.rows(arm, capsules, nearest, xdot, p)
        rows = avoidance.rows(arm, capsules, nearest, self._order.schedule, self._order.active, p)
        if near_self is None:
            return rows
        self_A, self_b = self_rows(arm, capsules, near_self, p)
        A, b = np.concatenate((rows.A, self_A)), np.concatenate((rows.b, self_b))
        return avoidance.Rows(A, b, b < OFF, rows.approach_speed)

    def _decide(
        self, program: QuadraticProgram, rows: avoidance.Rows, distance: Array, self_distance: Array
    ) -> relaxation.Decision:
        """Step 6, in the mode of the configuration."""
        p, order = self._parameters, self._order
        if self._soft:
            rho = order.weights(rows.on, distance, self_distance, p)
            return relaxation.soft(program, rows.on, rho, self._tolerance)
        ladder = order.ladder(distance, self_distance, p)
        return relaxation.staged(program, rows.on, ladder, self._tolerance)

    def _safe_stop(self, fault: Status, q: Array) -> Command:
        """q̇ = clamp(0, lb, ub), with no QP behind it: no rows, and nothing known of H and g."""
        p, model = self._parameters, self.model
        usable = within_limits(q, p)
        lb, ub = (
            objective.bounds(q, self._qdot_previous, p)
            if usable
            else objective.blind_bounds(self._qdot_previous, p)
        )
        n, slots = model.n, len(model.capsules)
        count = self._order.count
        diagnostics = Diagnostics(
            H=np.zeros((n, n)),
            g=np.zeros(n),
            A=np.zeros((count, n)),
            ubA=np.full(count, OFF),
            lb=lb,
            ub=ub,
            row_on=np.zeros(count, dtype=bool),
            distance=np.full(slots, np.inf),
            nearest_point=np.full((slots, 3), np.nan),
            approach_speed=np.full(slots, np.inf),
            manipulability=np.nan,
            damping=np.nan,
            slack=np.zeros(count),
            kkt_residual=np.nan,
            iterations=0,
            solves=0,
            second_chances=0,
            self_distance=np.full(slots if self._self_points else 0, np.inf),
            tangent=np.full(3 if self._circulation else 0, np.nan),
        )
        return self._command(np.zeros(n), fault, diagnostics)

    def _command(self, qdot: Array, status: Status, diagnostics: Diagnostics) -> Command:
        """The command, within its bounds to the last bit; it is the next cycle's previous one."""
        command = Command(np.clip(qdot, diagnostics.lb, diagnostics.ub), status, diagnostics)
        self._qdot_previous = command.qdot
        return command

    def _check_sizes(self, measurement: Measurement) -> None:
        """Refuse arrays that do not fit this arm's skin."""
        tof, capacitive = len(self.model.tof_modules), len(self.model.capacitive_modules)
        _vector("measurement.tof_range", measurement.tof_range, tof)
        _vector("measurement.capacitive", measurement.capacitive, capacitive)
        if measurement.tof_age is not None:
            _vector("measurement.tof_age", measurement.tof_age, tof)
        if measurement.capacitive_age is not None:
            _vector("measurement.capacitive_age", measurement.capacitive_age, capacitive)
        points = np.asarray(measurement.points, dtype=float)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ControllerError(f"measurement.points must have the shape (P, 3), not {points.shape}")
        if len(points) > self._max_points:
            raise ControllerError(
                f"measurement.points holds {len(points)} points; skin.max_points allows {self._max_points}"
            )


def _vector(name: str, value: Any, size: int) -> Array:
    """A copy as floats of the right size."""
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise ControllerError(f"{name} must be {size} numbers, not {value!r}") from error
    if array.shape != (size,):
        raise ControllerError(f"{name} must be {size} numbers, not shape {array.shape}")
    return array
