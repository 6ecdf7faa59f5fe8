"""Collects the cycles of a closed loop into a RolloutLog."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from proxgen.config.schema import Config
from proxgen.controllers.protocol import Command, Controller, Measurement
from proxgen.model.robot_model import RobotModel
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.geometry import Nearest
from proxgen.simulation.log import RolloutLog
from proxgen.simulation.scenery import Surroundings
from proxgen.simulation.task import TargetTracker, TaskVelocity

Array = NDArray[np.float64]

THRESHOLDS = ("d_a", "d_0u", "d_0l", "d_r", "d_active", "damper_influence", "damper_safety")
"""Distances that the log keeps, as the controller had them at the start [m]."""


class Recorder:
    """Arrays for a known number of cycles, filled one by one."""

    def __init__(self, cycles: int, arm: ArmGeometry) -> None:
        """Make room for `cycles` cycles of `arm`."""
        model = arm.model
        n, count = model.n, len(model.capsules)
        self._radius = arm.radius
        self._arrays: dict[str, NDArray[Any]] = {
            "time": np.zeros(cycles),
            "q": np.zeros((cycles, n)),
            "qdot": np.zeros((cycles, n)),
            "xdot": np.zeros((cycles, model.m)),
            "tool_position": np.zeros((cycles, 3)),
            "tool_rotation": np.zeros((cycles, 3, 3)),
            "target_index": np.zeros(cycles, dtype=np.int64),
            "target_position": np.zeros((cycles, 3)),
            "target_distance": np.zeros(cycles),
            "targets_reached": np.zeros(cycles, dtype=np.int64),
            "tof_range": np.zeros((cycles, len(model.tof_modules))),
            "capacitive": np.zeros((cycles, len(model.capacitive_modules)), dtype=bool),
            "status": np.zeros(cycles, dtype=np.int64),
            "controller_distance": np.full((cycles, count), np.inf),
            "true_axis_distance": np.full((cycles, count), np.inf),
            "true_surface_distance": np.full((cycles, count), np.inf),
            "manipulability": np.zeros(cycles),
            "damping": np.zeros(cycles),
            "kkt_residual": np.zeros(cycles),
            "cycle_us": np.zeros(cycles),
        }

    def record_state(self, index: int, time: float, q: Array, tool: Array, near: Nearest) -> None:
        """Note where arm and obstacles are: tool pose 4x4, distances (L, O) from the capsules' axes."""
        self._set(index, time=time, q=q, tool_position=tool[:3, 3], tool_rotation=tool[:3, :3])
        axis = near.distance.min(axis=1, initial=np.inf)
        self._set(index, true_axis_distance=axis, true_surface_distance=axis - self._radius)

    def record_target(self, index: int, tracker: TargetTracker, velocity: TaskVelocity) -> None:
        """Note what the tool was asked to do."""
        self._set(
            index,
            xdot=velocity.xdot,
            target_index=tracker.index,
            target_position=tracker.target.position,
            target_distance=velocity.distance,
            targets_reached=tracker.reached,
        )

    def record_command(self, index: int, measurement: Measurement, command: Command, cycle_us: float) -> None:
        """Note what the controller was told and what it decided."""
        diagnostics = command.diagnostics
        self._set(
            index,
            tof_range=measurement.tof_range,
            capacitive=measurement.capacitive,
            qdot=command.qdot,
            status=int(command.status),
            controller_distance=diagnostics.distance,
            manipulability=diagnostics.manipulability,
            damping=diagnostics.damping,
            kkt_residual=diagnostics.kkt_residual,
            cycle_us=cycle_us,
        )

    def log(self, meta: dict[str, Any]) -> RolloutLog:
        """The finished log."""
        return RolloutLog(**self._arrays, meta=meta)

    def _set(self, index: int, **values: Any) -> None:
        for name, value in values.items():
            self._arrays[name][index] = value


def describe(
    config: Config, model: RobotModel, controller: Controller, around: Surroundings
) -> dict[str, Any]:
    """What a log says of robot, controller and surroundings, as numbers, texts and lists."""
    parameters = controller.parameters
    known = {name: float(parameters[name]) for name in THRESHOLDS if name in parameters}
    return {
        "scene": around.name,
        "robot": model.name,
        "controller": _name_of(controller, config.avoidance.method),
        "method": config.avoidance.method,
        "backend": str(getattr(controller, "backend", "none")),
        "period": 1.0 / config.control.rate,
        "thresholds": {"d_r": config.avoidance.d_r} | known,
        "schedule": config.avoidance.schedule,
        "distance_reference": config.avoidance.distance_reference,
        "q_lower": model.q_lower.tolist(),
        "q_upper": model.q_upper.tolist(),
        "qdot_limit": model.qdot_limit.tolist(),
        "joint_names": list(model.joint_names),
        "capsule_names": [capsule.name for capsule in model.capsules],
        "capsule_radii": [capsule.radius for capsule in model.capsules],
        "targets": [target.position.tolist() for target in around.targets],
        "obstacles": [obstacle.to_plain() for obstacle in around.field.obstacles],
    }


def _name_of(controller: Controller, method: str) -> str:
    """`compiled` or `reference`; of the compiled controller, its method if that is not the proposed one."""
    kind = str(getattr(controller, "name", type(controller).__name__.removesuffix("Controller").lower()))
    if method == "proposed":
        return kind
    return method if kind == "compiled" else f"{kind}, {method}"
