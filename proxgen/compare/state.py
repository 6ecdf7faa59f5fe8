"""The input of one cycle of a comparison."""

from dataclasses import dataclass

from proxgen.controllers.protocol import Array, Measurement


@dataclass(frozen=True)
class State:
    """The input of one cycle.

    Attributes:
        q: (n,) joint positions [rad or m].
        xdot: (m,) task velocity [m/s, rad/s].
        measurement: what the sensors saw.
        reset: the controllers are reset before.
    """

    q: Array
    xdot: Array
    measurement: Measurement
    reset: bool = False
