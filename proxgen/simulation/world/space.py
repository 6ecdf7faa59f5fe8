"""Obstacles and arm as bodies in space: rays against them, pictures by pybullet's software renderer."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from proxgen.errors import SimulationError
from proxgen.model.frames import axis_basis
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.obstacles import Obstacle, ObstacleField
from proxgen.simulation.world.camera import FAR, NEAR, Camera, Shot
from proxgen.simulation.world.client import Client, Closing, silent
from proxgen.simulation.world.meshes import Mesh, disc_mesh, round_mesh
from proxgen.simulation.world.rotation import quaternion

Array = NDArray[np.float64]
Colour = tuple[float, float, float, float]

_OBSTACLE_COLOUR: Colour = (0.88, 0.72, 0.56, 1.0)
_ARM_COLOURS: tuple[Colour, ...] = ((0.42, 0.50, 0.58, 1.0), (0.86, 0.88, 0.90, 1.0))
_TARGET_COLOUR: Colour = (0.0, 0.62, 0.45, 1.0)
_FLOOR_COLOUR: Colour = (0.98, 0.98, 0.97, 1.0)
_OBSTACLE_BIT = 1
_ARM_BITS = 30
_MAX_RAYS = 4096
"""Rays per call: pybullet silently loses some of a batch of the size that it names as its limit."""


class World(Closing):
    """A pybullet world of obstacles, and of the arm's capsules where rays or pictures need them."""

    def __init__(
        self, field: ObstacleField, arm: ArmGeometry, *, arm_in_rays: bool = False, gui: bool = False
    ) -> None:
        """Connect and create the bodies.

        Args:
            field: the obstacles.
            arm: the arm; its capsules are drawn, and hit by rays if `arm_in_rays`.
            arm_in_rays: rays hit the arm too, except the body that carries the sensor.
            gui: open pybullet's window instead of working without one.

        Raises:
            SimulationError: no connection, such as --gui without a display.
        """
        self._field, self._arm, self._arm_in_rays = field, arm, arm_in_rays
        self._client = Client(gui=gui)
        self._bullet = self._client.bullet
        self._obstacles = [self._body(obstacle, _OBSTACLE_COLOUR, solid=True) for obstacle in field.obstacles]
        self._turns = [quaternion(obstacle.rotation) for obstacle in field.obstacles]
        self._capsules: list[int] = []
        self._decorations: list[int] = []
        if arm_in_rays or gui:
            self._create_arm()

    def close(self) -> None:
        """Disconnect; closing twice does nothing, any other call is then a SimulationError."""
        self._client.close()

    @property
    def _id(self) -> dict[str, int]:
        return self._client.keyword

    def place(self, time: float, poses: Array | None = None) -> None:
        """Move the obstacles to where they are at `time` [s], and the arm to body poses (B, 4, 4)."""
        positions = self._field.positions(time)
        for index, obstacle in enumerate(self._field.obstacles):
            if obstacle.motion is not None:
                self._move(self._obstacles[index], positions[index], self._turns[index])
        if poses is not None and self._capsules:
            starts, ends = self._arm.axes(poses)
            for body, start, end in zip(self._capsules, starts, ends, strict=True):
                rotation = axis_basis(end - start) if np.any(end != start) else np.eye(3)
                self._move(body, 0.5 * (start + end), quaternion(rotation))

    def rays(self, origins: Array, ends: Array, carriers: NDArray[np.intp] | None = None) -> Array:
        """How far rays get.

        Args:
            origins: (R, 3), world [m].
            ends: (R, 3), world [m].
            carriers: (R,) body that carries each sensor; its own capsules are transparent to the ray.

        Returns:
            (R,) fraction of the way to the first hit; 1 where nothing is hit. A ray that starts inside an
            obstacle does not see it.
        """
        if not self._arm_in_rays or carriers is None:
            return self._cast(origins, ends, _OBSTACLE_BIT)
        fractions = np.ones(len(origins))
        for body in np.unique(carriers):
            chosen = carriers == body
            fractions[chosen] = self._cast(origins[chosen], ends[chosen], -1 & ~self._arm_bit(int(body)))
        return fractions

    def shoot(
        self,
        time: float,
        poses: Array,
        *,
        camera: Camera | None = None,
        targets: Array | None = None,
    ) -> Shot:
        """Draw arm, obstacles and targets with the software renderer.

        Args:
            time: where moving obstacles are [s].
            poses: body poses (B, 4, 4).
            camera: default: from the front, a little above.
            targets: (K, 3) drawn as small spheres, world [m]; the first call decides.
        """
        view, bullet = camera or Camera(), self._bullet
        if not self._capsules:
            self._create_arm()
        if not self._decorations:
            self._create_decorations(np.empty((0, 3)) if targets is None else targets)
        self.place(time, poses)
        eye = bullet.computeViewMatrixFromYawPitchRoll(
            view.target, view.distance, view.yaw, view.pitch, 0.0, 2
        )
        lens = bullet.computeProjectionMatrixFOV(view.field_of_view, view.width / view.height, NEAR, FAR)
        with silent(1):
            _, _, pixels, depth, _ = bullet.getCameraImage(
                view.width,
                view.height,
                eye,
                lens,
                lightDirection=(1.0, -1.5, 3.0),
                shadow=1,
                renderer=bullet.ER_TINY_RENDERER,
                flags=bullet.ER_NO_SEGMENTATION_MASK,
                **self._id,
            )
        shape = (view.height, view.width)
        colours = np.asarray(pixels, dtype=np.uint8).reshape(*shape, 4)[:, :, :3].copy()
        metres = FAR * NEAR / (FAR - (FAR - NEAR) * np.asarray(depth, dtype=float).reshape(shape))
        return Shot(colours, metres, view)

    def _cast(self, origins: Array, ends: Array, mask: int) -> Array:
        """Rays in batches that pybullet accepts; only bodies whose group is in `mask` stop them."""
        fractions: list[float] = []
        for first in range(0, len(origins), _MAX_RAYS):
            hits = self._bullet.rayTestBatch(
                origins[first : first + _MAX_RAYS].tolist(),
                ends[first : first + _MAX_RAYS].tolist(),
                collisionFilterMask=mask,
                **self._id,
            )
            fractions.extend(hit[2] if hit[0] >= 0 else 1.0 for hit in hits)
        return np.array(fractions)

    def _arm_bit(self, body: int) -> int:
        """Collision group of the capsules that one body carries."""
        return 2 << (body % (_ARM_BITS - 1))

    def _move(self, body: int, position: Array, turn: list[float]) -> None:
        self._bullet.resetBasePositionAndOrientation(body, position.tolist(), turn, **self._id)

    def _body(self, obstacle: Obstacle, colour: Colour, *, solid: bool, group: int = _OBSTACLE_BIT) -> int:
        """A body without mass; one that is not `solid` is seen by the camera, but not by rays."""
        bullet, client = self._bullet, self._id
        kind, size = {
            "box": (bullet.GEOM_BOX, {"halfExtents": obstacle.half_size.tolist()}),
            "sphere": (bullet.GEOM_SPHERE, {"radius": obstacle.radius}),
            "capsule": (bullet.GEOM_CAPSULE, {"radius": obstacle.radius, "height": obstacle.length}),
        }[obstacle.shape]
        if obstacle.shape == "box":
            look = self._look(colour, shapeType=kind, **size)
        else:
            look = self._mesh(colour, round_mesh(obstacle.radius, obstacle.length))
        touch = bullet.createCollisionShape(kind, **size, **client) if solid else -1
        body: int = bullet.createMultiBody(
            0.0, touch, look, obstacle.position.tolist(), quaternion(obstacle.rotation), **client
        )
        if body < 0:
            raise SimulationError(f"pybullet refuses obstacle '{obstacle.name}' ({obstacle.shape})")
        if solid:
            bullet.setCollisionFilterGroupMask(body, -1, group, -1, **client)
        return body

    def _look(self, colour: Colour, **shape: Any) -> int:
        """What a body looks like."""
        number: int = self._bullet.createVisualShape(
            **shape, rgbaColor=colour, specularColor=(0.1, 0.1, 0.1), **self._id
        )
        return number

    def _mesh(self, colour: Colour, mesh: Mesh) -> int:
        """What a body of any shape looks like."""
        return self._look(
            colour,
            shapeType=self._bullet.GEOM_MESH,
            vertices=mesh.vertices.tolist(),
            indices=mesh.triangles.ravel().tolist(),
            normals=mesh.normals.tolist(),
        )

    def _create_arm(self) -> None:
        """One body per capsule; a capsule of no length is a sphere."""
        for index, capsule in enumerate(self._arm.model.capsules):
            length = float(np.linalg.norm(capsule.end - capsule.start))
            solid = Obstacle(
                name=capsule.name,
                shape="capsule" if length > 0.0 else "sphere",
                half_size=np.zeros(3),
                radius=capsule.radius,
                length=length,
                position=np.zeros(3),
                rotation=np.eye(3),
            )
            colour = _ARM_COLOURS[index % len(_ARM_COLOURS)]
            group = self._arm_bit(capsule.body)
            self._capsules.append(self._body(solid, colour, solid=self._arm_in_rays, group=group))

    def _create_decorations(self, targets: Array) -> None:
        """Floor and targets, which rays never see."""
        around = np.concatenate([self._field.positions(0.0), np.atleast_2d(targets).reshape(-1, 3)])
        radius = 0.45 + float(np.linalg.norm(around[:, :2], axis=1).max(initial=0.45))
        look = self._mesh(_FLOOR_COLOUR, disc_mesh(radius))
        self._decorations.append(self._bullet.createMultiBody(0.0, -1, look, [0.0, 0.0, -0.006], **self._id))
        for target in np.atleast_2d(targets):
            if target.size:
                ball = Obstacle("target", "sphere", np.zeros(3), 0.02, 0.0, target, np.eye(3))
                self._decorations.append(self._body(ball, _TARGET_COLOUR, solid=False))
