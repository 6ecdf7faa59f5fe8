"""The only place that knows pybullet: rays against obstacles and arm, pictures, a dynamic arm."""

from proxgen.simulation.world.camera import Camera, Shot
from proxgen.simulation.world.client import Closing
from proxgen.simulation.world.dynamic_arm import DynamicArm
from proxgen.simulation.world.rotation import quaternion
from proxgen.simulation.world.space import World

__all__ = ["Camera", "Closing", "DynamicArm", "Shot", "World", "quaternion"]
