"""Small scenes and a trivial controller, so that the simulation is tested without a real one."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from proxgen.config.scene import Obstacle, Scene, Target
from proxgen.controllers.protocol import OFF, Command, Diagnostics, Measurement, Status
from proxgen.model import RobotModel
from proxgen.model.kinematics import to_pin

Array = NDArray[np.float64]

IDENTITY = np.eye(4)


class StraightController:
    """Goes straight to the target by the damped pseudo-inverse, blind to obstacles."""

    name = "straight"

    def __init__(self, model: RobotModel, status: Status = Status.SOLVED) -> None:
        self.model, self.status = model, status
        self.measurements: list[Measurement] = []
        self.resets = 0

    @property
    def parameters(self) -> Mapping[str, float | Array]:
        return {"d_r": 0.17, "d_a": 0.3}

    def set_parameters(self, **values: Any) -> None:
        raise NotImplementedError(values)

    def reset(self) -> None:
        self.resets += 1
        self.measurements.clear()

    def step(self, q: Array, xdot: Array, measurement: Measurement) -> Command:
        self.measurements.append(measurement)
        J = task_jacobian(self.model, q)
        qdot = np.linalg.solve(J.T @ J + 1e-4 * np.eye(self.model.n), J.T @ xdot)
        qdot = np.clip(qdot, -self.model.qdot_limit, self.model.qdot_limit)
        return Command(qdot, self.status, self._diagnostics())

    def _diagnostics(self) -> Diagnostics:
        n, rows = self.model.n, len(self.model.capsules) + 1
        return Diagnostics(
            H=np.eye(n),
            g=np.zeros(n),
            A=np.zeros((rows, n)),
            ubA=np.full(rows, OFF),
            lb=-self.model.qdot_limit,
            ub=self.model.qdot_limit,
            row_on=np.zeros(rows, dtype=bool),
            distance=np.full(rows - 1, np.inf),
            nearest_point=np.full((rows - 1, 3), np.nan),
            approach_speed=np.full(rows - 1, np.inf),
            manipulability=0.25,
            damping=1e-4,
            slack=np.zeros(rows),
            kkt_residual=1e-12,
            iterations=1,
            solves=1,
            second_chances=0,
        )


def task_jacobian(model: RobotModel, q: Array) -> Array:
    """J (m, n) by Pinocchio, for tests."""
    data = model.pin_model.createData()
    pin.computeJointJacobians(model.pin_model, data, to_pin(model, q))
    pin.updateFramePlacements(model.pin_model, data)
    at_joint = pin.getJointJacobian(model.pin_model, data, model.tool_body, pin.LOCAL_WORLD_ALIGNED)
    lever = data.oMi[model.tool_body].rotation @ model.tool_in_body[:3, 3]
    angular = at_joint[3:]
    linear = at_joint[:3] + np.cross(angular.T, lever).T
    if model.task_frame is not None:
        rotation = data.oMi[model.tool_body].rotation @ model.tool_in_body[:3, :3]
        angular = (rotation @ model.task_frame).T @ angular
    full = np.vstack([linear, angular]) @ model.transmission
    names = ("x", "y", "z", "rx", "ry", "rz")
    return np.array([full[names.index(row)] for row in model.task_rows])


def scene(
    *obstacles: Obstacle,
    targets: tuple[tuple[float, float, float], ...],
    start: Any = None,
    name: str = "test",
) -> Scene:
    """A scene without a file."""
    aims = tuple(Target(position=position) for position in targets)
    return Scene(name=name, obstacles=obstacles, targets=aims, start=start)
