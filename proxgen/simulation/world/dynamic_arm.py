"""The arm as a pybullet multibody with masses, gravity and one velocity motor per joint."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from proxgen.errors import SimulationError
from proxgen.model.robot_model import RobotModel
from proxgen.simulation.world.client import Client, Closing
from proxgen.simulation.world.rotation import quaternion

Array = NDArray[np.float64]

_GRAVITY = -9.81
_DEFAULT_MASS = 1.0
"""Of a link whose URDF has none [kg]; its inertia is then that of a ball of 0.1 m."""
_DEFAULT_INERTIA = (0.004, 0.004, 0.004)
_DEFAULT_EFFORT = 1000.0
"""Of a motor whose URDF joint has no effort limit [Nm or N]."""


class DynamicArm(Closing):
    """The model's chain with its masses; velocity motors as strong as the URDF's effort limits.

    Links do not collide: what the arm touches is judged by exact distances, not by contacts. The chain comes
    from the RobotModel rather than from the URDF, so that locked joints and branches are merged as the
    controller has them.
    """

    def __init__(self, model: RobotModel, time_step: float) -> None:
        """Build the chain at q = 0.

        Args:
            model: the arm.
            time_step: of the physics [s].
        """
        self._model, self._client = model, Client()
        self._bullet = self._client.bullet
        self._bullet.setGravity(0.0, 0.0, _GRAVITY, **self._id)
        self._bullet.setTimeStep(time_step, **self._id)
        self._joints = list(range(len(model.drives)))
        self._ratio = np.array([drive.ratio for drive in model.drives])
        self._offset = np.array([drive.offset for drive in model.drives])
        self._index = np.array([drive.index for drive in model.drives], dtype=np.intp)
        pin_names = list(model.pin_model.names)[1:]
        self._measured = np.array([pin_names.index(name) for name in model.joint_names], dtype=np.intp)
        self._body = self._create()
        efforts = np.array(model.pin_model.effortLimit, dtype=float)
        usable = np.isfinite(efforts) & (efforts > 0.0)
        self._efforts = np.where(usable, efforts, _DEFAULT_EFFORT).tolist()

    def close(self) -> None:
        """Release the physics client; any other call is then a SimulationError."""
        self._client.close()

    @property
    def _id(self) -> dict[str, int]:
        return self._client.keyword

    def reset(self, q: Array) -> None:
        """Stand still at q (n,)."""
        for joint, position in zip(self._joints, self._all_joints(q) + self._offset, strict=True):
            self._bullet.resetJointState(self._body, joint, float(position), 0.0, **self._id)

    def step(self, qdot: Array) -> Array:
        """Let one time step pass with motor speeds q̇ (n,).

        Returns:
            (n,) joint positions after it [rad or m].

        Raises:
            SimulationError: the physics broke down (not finite).
        """
        self._bullet.setJointMotorControlArray(
            self._body,
            self._joints,
            self._bullet.VELOCITY_CONTROL,
            targetVelocities=self._all_joints(qdot).tolist(),
            forces=self._efforts,
            **self._id,
        )
        self._bullet.stepSimulation(**self._id)
        states = self._bullet.getJointStates(self._body, self._joints, **self._id)
        q = np.array([state[0] for state in states])[self._measured]
        if not np.isfinite(q).all():
            raise SimulationError("the dynamic arm broke down: joint positions are not finite")
        return q

    def _all_joints(self, values: Array) -> Array:
        """Values of Pinocchio's joints from those of the controlled ones, mimic joints included."""
        scaled: Array = self._ratio * values[self._index]
        return scaled

    def _create(self) -> int:
        """The multibody: link k is Pinocchio's joint k + 1."""
        bullet, pin_model, count = self._bullet, self._model.pin_model, len(self._joints)
        inertias = [_inertia(pin_model.inertias[joint + 1]) for joint in self._joints]
        placements = [pin_model.jointPlacements[joint + 1] for joint in self._joints]
        kinds = [bullet.JOINT_PRISMATIC if d.prismatic else bullet.JOINT_REVOLUTE for d in self._model.drives]
        body: int = bullet.createMultiBody(
            0.0,
            -1,
            -1,
            linkMasses=[mass for mass, *_ in inertias],
            linkCollisionShapeIndices=[-1] * count,
            linkVisualShapeIndices=[-1] * count,
            linkPositions=[np.array(placement.translation).tolist() for placement in placements],
            linkOrientations=[quaternion(np.array(placement.rotation)) for placement in placements],
            linkInertialFramePositions=[centre for _, centre, *_ in inertias],
            linkInertialFrameOrientations=[turn for _, _, turn, _ in inertias],
            linkParentIndices=[int(pin_model.parents[joint + 1]) for joint in self._joints],
            linkJointTypes=kinds,
            linkJointAxis=[drive.axis.tolist() for drive in self._model.drives],
            **self._id,
        )
        if body < 0:
            raise SimulationError(f"pybullet refuses the arm '{self._model.name}'")
        for joint, (_, _, _, diagonal) in enumerate(inertias):
            bullet.changeDynamics(
                body,
                joint,
                localInertiaDiagonal=diagonal,
                linearDamping=0.0,
                angularDamping=0.0,
                jointDamping=0.0,
                **self._id,
            )
        return body


def _inertia(inertia: Any) -> tuple[float, list[float], list[float], list[float]]:
    """Mass, centre, orientation of the principal axes, and principal moments of a Pinocchio inertia."""
    if inertia.mass < 1e-9:
        return _DEFAULT_MASS, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0], list(_DEFAULT_INERTIA)
    moments, axes = np.linalg.eigh(np.array(inertia.inertia))
    if np.linalg.det(axes) < 0.0:
        axes[:, 2] = -axes[:, 2]
    return float(inertia.mass), np.array(inertia.lever).tolist(), quaternion(axes), moments.tolist()
