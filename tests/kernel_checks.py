"""Kernels of any arm against Pinocchio."""

import casadi as ca
import numpy as np
import pinocchio as pin

from proxgen.config.schema import Config
from proxgen.model import RobotModel
from proxgen.model.kinematics import body_poses, to_pin, tool_pose
from proxgen.program import Program
from proxgen.symbolic import build_program
from proxgen.symbolic.program_builder import carrying_bodies


def call(program: Program, name: str, **inputs: object) -> dict[str, np.ndarray]:
    """Evaluate a kernel; parameters take their defaults unless given."""
    kernel = program.kernel(name)
    defaults = {parameter.name: parameter.default for parameter in program.parameters}
    values = [np.array(inputs.get(a.name, defaults.get(a.name)), dtype=float) for a in kernel.inputs]
    results = kernel.function.call([ca.DM(value) for value in values])
    return {
        argument.name: np.array(ca.DM(result)).reshape(argument.shape)
        for argument, result in zip(kernel.outputs, results, strict=True)
    }


def pin_task_jacobian(model: RobotModel, data: pin.Data, q: np.ndarray) -> np.ndarray:
    """Task Jacobian by Pinocchio's own Jacobians."""
    pin.computeJointJacobians(model.pin_model, data, to_pin(model, q))
    jacobian = pin.getJointJacobian(model.pin_model, data, model.tool_body, pin.LOCAL_WORLD_ALIGNED)
    tool = data.oMi[model.tool_body].homogeneous @ model.tool_in_body
    arm = tool[:3, 3] - data.oMi[model.tool_body].translation
    linear = jacobian[:3] - pin.skew(arm) @ jacobian[3:]
    angular = jacobian[3:]
    if model.task_frame is not None:
        angular = (tool[:3, :3] @ model.task_frame).T @ angular
    rows = dict(zip(("x", "y", "z", "rx", "ry", "rz"), np.vstack([linear, angular]), strict=True))
    return np.array([rows[name] for name in model.task_rows]) @ model.transmission


def check_against_pinocchio(config: Config, model: RobotModel, states: int) -> None:
    """Poses and task Jacobian at random states, to 1e-12."""
    program, data = build_program(config, model), model.pin_model.createData()
    bodies, rng = carrying_bodies(model), np.random.default_rng(21)
    for _ in range(states):
        q = rng.uniform(-3.0, 3.0, model.n)
        result = call(program, "kinematics", q=q)
        poses = body_poses(model, q, data)
        np.testing.assert_allclose(result["tool_to_world"], tool_pose(model, q, data)[:3], rtol=0, atol=1e-12)
        expected = np.array([poses[body][:3].ravel() for body in bodies])
        np.testing.assert_allclose(result["body_to_world"], expected, rtol=0, atol=1e-12)
        np.testing.assert_allclose(result["J"], pin_task_jacobian(model, data, q), rtol=0, atol=1e-12)
