"""What every peer gets: the arm as plain data, and per cycle the state and the nearest obstacle points."""

import json
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from proxgen.bench.inputs import Inputs
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array
from proxgen.errors import GenerateError
from proxgen.model import RobotModel


@dataclass(frozen=True)
class Problem:
    """Recorded cycles as a peer without sensors can use them, and what the reference made of them.

    Attributes:
        name: of the scene.
        q: (T, n) [rad].
        xdot: (T, m) [m/s].
        points: (T, L, 3) nearest obstacle point per capsule, world [m]; nan where there is none.
        target: (T, 3) where the task point is to be one period later, world [m].
        reference_times: (T,) of each step of the reference [s].
        reference_qdot: (T, n) its answers [rad/s].
    """

    name: str
    q: Array
    xdot: Array
    points: Array
    target: Array
    reference_times: Array
    reference_qdot: Array

    def save(self, path: Path, arm: dict[str, Any]) -> None:
        """Write the file that `run_peer.py` reads."""
        np.savez(path, arm=json.dumps(arm), q=self.q, xdot=self.xdot, points=self.points, target=self.target)


def pose_problem(config: Config, model: RobotModel, inputs: Inputs) -> Problem:
    """Let the reference go through recorded inputs, timed, and keep the obstacle points that it found.

    Args:
        config: of the robot.
        model: its model.
        inputs: of a closed loop.
    """
    from proxgen.controllers.reference import ReferenceController
    from proxgen.model.kinematics import tool_pose

    controller = ReferenceController(config, model)
    times, points, target, qdot = np.empty(inputs.cycles), [], [], []
    for index, (q, xdot, seen) in enumerate(zip(inputs.q, inputs.xdot, inputs.measurements, strict=True)):
        begin = time.perf_counter_ns()
        command = controller.step(q, xdot, seen)
        times[index] = (time.perf_counter_ns() - begin) * 1e-9
        points.append(command.diagnostics.nearest_point)
        qdot.append(command.qdot)
        target.append(tool_pose(model, q)[:3, 3] + xdot / config.control.rate)
    return Problem(
        inputs.name, inputs.q, inputs.xdot, np.array(points), np.array(target), times, np.array(qdot)
    )


def describe_arm(config: Config, model: RobotModel) -> dict[str, Any]:
    """The arm, the law's distances and the period as plain data, from which each peer makes its own model.

    Args:
        config: of the robot.
        model: its model.

    Raises:
        GenerateError: the arm or the task is one that not every peer can express.
    """
    if model.task_rows != ("x", "y", "z"):
        raise GenerateError("peers are compared on a position task (rows x, y, z)")
    follows = [drive.index != index or drive.ratio != 1.0 for index, drive in enumerate(model.drives)]
    pin_model = model.pin_model
    chained = [int(parent) for parent in pin_model.parents][1:] == list(range(len(model.drives)))
    if any(follows) or not chained or pin_model.nq != pin_model.nv:
        raise GenerateError("peers are compared on a chain without mimic and continuous joints")
    joints = [
        {
            "name": model.joint_names[index],
            "placement": pin_model.jointPlacements[index + 1].homogeneous.tolist(),
            "axis": [float(value) for value in drive.axis],
            "prismatic": drive.prismatic,
            "lower": float(model.q_lower[index]),
            "upper": float(model.q_upper[index]),
            "velocity": float(model.qdot_limit[index]),
        }
        for index, drive in enumerate(model.drives)
    ]
    capsules = [
        {"body": capsule.body, "start": capsule.start.tolist(), "end": capsule.end.tolist()}
        for capsule in model.capsules
    ]
    law = {key: getattr(config.avoidance, key) for key in ("d_a", "d_0u", "approach_speed")}
    return {
        "name": model.name,
        "joints": joints,
        "tool": {"body": model.tool_body, "placement": model.tool_in_body.tolist()},
        "capsules": capsules,
        "damping": config.damping.floor,
        "period": 1.0 / config.control.rate,
        **law,
    }
