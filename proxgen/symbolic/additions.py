"""Tables of the additions that work on what sensors see: constants, worked out once (docs/method.md)."""

from math import cos, pi, sin

from proxgen.config.schema import Config
from proxgen.model import RobotModel
from proxgen.model.frames import axis_basis
from proxgen.model.robot_model import Array
from proxgen.program import Memory, SelfMeasurement

Triple = tuple[float, float, float]


def self_measurement(config: Config, model: RobotModel) -> SelfMeasurement | None:
    """Rays of the range sensors and cones of the switches; None where the addition is off."""
    if not config.skin.self_measurement.enabled:
        return None
    cells = [module.capacitive for module in model.capacitive_modules if module.capacitive]
    return SelfMeasurement(
        rays=tuple(rays(module.normal, module.tof.cone) for module in model.tof_modules if module.tof),
        cones=tuple((cell.trigger, cos(0.5 * cell.cone)) for cell in cells),
    )


def memory(config: Config, model: RobotModel) -> Memory | None:
    """Slots, and how far off its axis a range sensor is believed to see through; None without a memory."""
    wanted = config.skin.memory
    if not wanted.enabled:
        return None
    cones = [module.tof.cone for module in model.tof_modules if module.tof]
    return Memory(wanted.capacity, tuple(cos(0.5 * wanted.cone * cone) for cone in cones))


def rays(normal: Array, cone: float) -> tuple[Triple, ...]:
    """Five unit vectors: the normal n, and sin(α/2)(cos φ e₁ + sin φ e₂) + cos(α/2) n at four angles φ.

    Args:
        normal: n (3,), unit vector in the body's frame.
        cone: the opening angle α [rad].
    """
    first, second, third = axis_basis(normal).T
    around = [
        sin(0.5 * cone) * (cos(turn) * first + sin(turn) * second) + cos(0.5 * cone) * third
        for turn in (0.0, 0.5 * pi, pi, 1.5 * pi)
    ]
    return tuple(_triple(ray) for ray in (normal, *around))


def _triple(vector: Array) -> Triple:
    """A vector as numbers; what rounding leaves of a zero becomes one."""
    x, y, z = (round(float(value), 15) + 0.0 for value in vector)
    return x, y, z
