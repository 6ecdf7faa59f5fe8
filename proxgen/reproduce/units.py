"""How the numbers of runs are written: words, scale, unit, digits; one entry per key."""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Unit:
    """How a number is written: what it is in words, scale to the unit, unit, digits behind the point.

    Attributes:
        words: what it is.
        scale: from SI.
        unit: behind it.
        digits: behind the point.
        whole: single values are whole numbers, and only their mean has digits.
    """

    words: str
    scale: float = 1.0
    unit: str = ""
    digits: int = 1
    whole: bool = False

    def write(self, value: float) -> str:
        """A value with its unit."""
        return f"{self.bare(value)} {self.unit}".rstrip()

    def bare(self, value: float) -> str:
        """A value without its unit."""
        text = f"{self.scale * value:.{self.digits}f}"
        return text.lstrip("-") if float(text) == 0.0 else text


UNITS = {
    "targets_reached": Unit("targets reached", whole=True),
    "min_distance_axis_m": Unit("least distance to a link's axis", 1.0, "m", 3),
    "min_distance_surface_m": Unit("least distance to a link's surface", 1.0, "m", 3),
    "time_below_dr_fraction": Unit("time with a link below d_r", 100.0, "%", 2),
    "time_below_d0l_fraction": Unit("time with a link below d_0l", 100.0, "%", 1),
    "link_below_dr_fraction": Unit("time below d_r of the link", 100.0, "%", 2),
    "penetration_samples": Unit("cycles with penetration", digits=0),
    "limit_violations": Unit("cycles outside the joint limits", digits=0),
    "solver_failures": Unit("solver failures", digits=0),
    "mean_abs_dqdot": Unit("mean change of the command", 1e3, "mrad/s", 1),
    "max_abs_dqdot": Unit("greatest change of the command", 1.0, "rad/s", 3),
    "mean_abs_dqdot_seen": Unit("mean change of the command with an obstacle in view", 1e3, "mrad/s", 1),
    "mean_abs_dqdot_clear": Unit("that with none in view", 1e3, "mrad/s", 1),
    "mean_abs_dqdot_switching": Unit(
        "mean change of the command where a link's constraint switches", 1e3, "mrad/s"
    ),
    "mean_abs_dqdot_steady": Unit("that in all other cycles", 1e3, "mrad/s"),
    "mean_abs_joint_jump": Unit("mean change of the joints' velocity", 1e3, "mrad/s", 2),
    "sudden_obstacles": Unit("obstacles first seen nearer than d_0u", whole=True),
    "start_manipulability": Unit("manipulability at the start", 1e3, "·10⁻³", 3),
    "escape_time_s": Unit("time to leave the singularity", 1.0, "s", 2),
    "path_per_straight": Unit("tool's path per straight way", digits=2),
    "deflection_m": Unit("greatest deflection of the tool", 1.0, "m", 2),
    "passes_between": Unit("passes between the boxes", whole=True),
    "last_motion_m": Unit("tool's path in the last 10 s", 1.0, "m", 2),
    "mean_us": Unit("mean cycle time", 1.0, "µs", 1),
}
"""By key; a key below it, such as `link_below_dr_fraction.hand`, has the same."""


def unit_of(key: str) -> Unit:
    """How the number at a key is written."""
    first, _, rest = key.partition(".")
    unit = UNITS[first]
    return replace(unit, words=f"{unit.words} {rest}") if rest else unit


def mean_and_spread(values: list[float], unit: Unit, *, with_range: bool = True) -> str:
    """`8.6 ± 0.7 (8 to 10)`: mean, standard deviation and range, without the unit."""
    text = unit.bare(float(np.mean(values)))
    if len(values) < 2:
        return text
    if min(values) == max(values):
        return f"{text} ± 0"
    spread = f"{text} ± {unit.bare(float(np.std(values, ddof=1)))}"
    ends = replace(unit, digits=0) if unit.whole else unit
    return f"{spread} ({ends.bare(min(values))} to {ends.bare(max(values))})" if with_range else spread
