"""What additions need of random states: readings of the arm itself, and situations that last.

A memory fills, and a tool is stuck, only where one state follows from the last.
"""

from dataclasses import replace

import numpy as np

from proxgen.compare.state import State
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array, Measurement
from proxgen.controllers.reference.geometry import Capsules
from proxgen.controllers.reference.kinematics import Arm
from proxgen.controllers.reference.places import Places
from proxgen.model.robot_model import RobotModel

MEAN_TIME = 1.2
"""Of a situation that lasts [s]."""

SAMPLES = 40
"""Places along a sensor's normal that are tried for a reading of the arm itself."""


def duration(config: Config, rng: np.random.Generator) -> int:
    """Cycles that a new situation lasts: one, and many now and then if some addition has a memory."""
    if not (config.skin.memory.enabled or config.avoidance.circulation.enabled):
        return 1
    return int(rng.geometric(1.0 / (MEAN_TIME * config.control.rate))) if rng.random() < 0.1 else 1


def next_of(state: State, config: Config, model: RobotModel, time: float, rng: np.random.Generator) -> State:
    """The state after one that lasts: the arm has moved a little, and sensors read about the same."""
    allowed = 0.9 * config.limits.tolerance
    moved = state.q + rng.normal(scale=1e-3, size=model.n)
    seen, ranges = state.measurement, ranges_of(model)
    readings = np.clip(seen.tof_range + rng.normal(scale=2e-3, size=ranges.size), 0.0, ranges)
    gone = (seen.tof_range >= ranges) | (rng.random(ranges.size) < 0.02)
    measurement = replace(
        seen,
        time=time,
        tof_range=np.where(gone, ranges, readings),
        points=seen.points + rng.normal(scale=1e-3, size=seen.points.shape),
    )
    q = np.clip(moved, model.q_lower - allowed, model.q_upper + allowed)
    return replace(state, q=q, measurement=measurement, reset=False)


def with_own_readings(
    config: Config, model: RobotModel, q: Array, measurement: Measurement, rng: np.random.Generator
) -> Measurement:
    """The measurement, in which some sensors read, or may read, the arm itself.

    Args:
        config: whose margin decides what a reading of the arm is.
        model: the arm.
        q: (n,) its position [rad or m].
        measurement: of which other readings stay.
        rng: random numbers.
    """
    if not config.skin.self_measurement.enabled:
        return measurement
    arm, capsules = Arm(model), Capsules(model)
    arm.move_to(q)
    margin = config.skin.self_measurement.margin
    ranges, closed = ranges_of(model), measurement.capacitive.copy()
    reach = rng.uniform(0.0, 1.0, (ranges.size, SAMPLES)) * ranges[:, None]
    gap = _gaps(arm, capsules, Places(model.tof_modules), reach)
    near = np.argmin(np.abs(gap - margin), axis=1)
    sensors = np.arange(ranges.size)
    own = (np.abs(gap[sensors, near] - margin) < 0.03) & (rng.random(ranges.size) < 0.5)
    cells = [module.capacitive for module in model.capacitive_modules if module.capacitive]
    trigger = np.array([cell.trigger for cell in cells])
    front = _gaps(arm, capsules, Places(model.capacitive_modules), np.zeros((trigger.size, 1)))[:, 0]
    closed |= (front < trigger + 2.0 * margin) & (rng.random(trigger.size) < 0.3)
    readings = np.where(own, reach[sensors, near], measurement.tof_range)
    return replace(measurement, tof_range=readings, capacitive=closed)


def ranges_of(model: RobotModel) -> Array:
    """(S,) greatest readings of the range sensors [m]."""
    return np.array([module.tof.range for module in model.tof_modules if module.tof])


def _gaps(arm: Arm, capsules: Capsules, places: Places, reach: Array) -> Array:
    """(S, K) distances of places along each sensor's normal from the capsules of other bodies [m]."""
    sensors, samples = reach.shape
    which = np.repeat(np.arange(sensors), samples)
    points = places.points(arm, which, reach.ravel())
    distance = capsules.surface_distance(arm, points).reshape(capsules.body.size, sensors, samples)
    own_body = capsules.body[:, None] == places.body
    gaps: Array = np.where(own_body[:, :, None], np.inf, distance).min(axis=0)
    return gaps
