"""Step 0 of docs/method.md: is this input fit to be used?"""

import math

import numpy as np

from proxgen.controllers.protocol import Array, Measurement, Status
from proxgen.controllers.reference.parameters import Parameters


def find_fault(
    q: Array,
    xdot: Array,
    measurement: Measurement,
    tof_limit: Array,
    previous_time: float | None,
    p: Parameters,
) -> Status | None:
    """The first check that fails, in the order of the table.

    Args:
        q: (n,) joint positions [rad or m].
        xdot: (m,) task velocity.
        measurement: what the sensors saw; sizes were checked before.
        tof_limit: (S,) greatest reading of each range sensor [m].
        previous_time: of the last cycle whose time was accepted [s], or None after a reset.
        p: limits and times.

    Returns:
        The status of the fault, or None.
    """
    time, ages = measurement.time, _ages(measurement)
    readings = np.asarray(measurement.tof_range, dtype=float)
    numbers = (q, xdot, readings, ages, np.ravel(measurement.points))
    if not (math.isfinite(time) and all(np.isfinite(array).all() for array in numbers)):
        return Status.FAULT_NOT_FINITE
    if not within_limits(q, p):
        return Status.FAULT_JOINT_LIMIT
    if (readings < 0.0).any() or (readings > tof_limit).any() or (ages < 0.0).any():
        return Status.FAULT_READING
    if previous_time is not None:
        if time <= previous_time:
            return Status.FAULT_TIME
        if p.max_period > 0.0 and time - previous_time > p.max_period:
            return Status.FAULT_DEADLINE
    if (ages > p.sensor_timeout).any():
        return Status.FAULT_STALE
    return None


def within_limits(q: Array, p: Parameters) -> bool:
    """True if q is finite and at most `limit_tolerance` outside its limits, so that (11) makes sense."""
    above = q >= p.q_lower - p.limit_tolerance
    below = q <= p.q_upper + p.limit_tolerance
    return bool(np.all(above & below))


def _ages(measurement: Measurement) -> Array:
    """All ages that were given, (A,) [s]."""
    given = [age for age in (measurement.tof_age, measurement.capacitive_age) if age is not None]
    return np.concatenate([np.ravel(np.asarray(age, dtype=float)) for age in given]) if given else np.empty(0)
