"""Random states and readings for a comparison without a simulation, those that hurt included.

Obstacle points crowd around the arm at the distances where the laws have their corners, so that most QPs have
several rows that conflict; some joints are at or beyond their limits; some inputs are faults. An arm with
self-collision is often folded, so that its own points are about as far apart as those laws have corners.
With a memory or circulation some situations last, and sensors read the arm itself where that is removed.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from proxgen.compare import lasting
from proxgen.compare.state import State
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array, Measurement
from proxgen.model.kinematics import body_poses
from proxgen.model.posture import Posture
from proxgen.model.robot_model import RobotModel

UNLIMITED = 1e10
"""A position limit beyond this is none."""

FOLDED = 0.7
"""Probability that an arm with self-collision is folded."""

SEARCH = 60
"""Postures that are tried until an arm is folded as wanted."""


def random_states(
    config: Config, model: RobotModel, count: int, *, seed: int, faults: float = 0.05
) -> Iterator[State]:
    """States for any arm; the same seed gives the same states.

    Args:
        config: thresholds, rate, capacity for points.
        model: the arm.
        count: how many.
        seed: of the random numbers.
        faults: probability that a state has a fault.
    """
    rng = np.random.default_rng(seed)
    time, left = 0.0, 0
    state: State | None = None
    for _ in range(count):
        time += 1.0 / config.control.rate
        if state is not None and left > 0:
            state = lasting.next_of(state, config, model, time, rng)
        else:
            state, left = _new_state(config, model, time, rng), lasting.duration(config, rng)
        left -= 1
        yield _with_fault(config, model, state, rng) if rng.random() < faults else state


def _new_state(config: Config, model: RobotModel, time: float, rng: np.random.Generator) -> State:
    """A state that has nothing to do with the last one."""
    q = _joint_positions(config, model, rng)
    xdot = rng.normal(size=model.m) * 10.0 ** rng.uniform(-2.0, 0.3)
    seen = _measurement(config, model, q, time, rng)
    reset = bool(rng.random() < 0.05)
    return State(q, xdot, lasting.with_own_readings(config, model, q, seen, rng), reset)


def _joint_positions(config: Config, model: RobotModel, rng: np.random.Generator) -> Array:
    """Within the limits; now and then exactly at one, or beyond it by less than the tolerance."""
    lower = np.where(model.q_lower < -UNLIMITED, -np.pi, model.q_lower)
    upper = np.where(model.q_upper > UNLIMITED, np.pi, model.q_upper)
    q = rng.uniform(lower, upper)
    if model.self_points and rng.random() < FOLDED:
        q = _folded(config, model, (lower, upper), rng)
    limited, kind = np.flatnonzero(model.q_upper <= UNLIMITED), rng.random()
    if kind < 0.1 and limited.size:
        joint, beyond = int(rng.choice(limited)), 0.0 if kind < 0.05 else 0.9 * config.limits.tolerance
        at_upper = rng.random() < 0.5
        q[joint] = upper[joint] + beyond if at_upper else lower[joint] - beyond
    return q


def _folded(
    config: Config, model: RobotModel, limits: tuple[Array, Array], rng: np.random.Generator
) -> Array:
    """A posture (n,) in which a random pair of self-collision is about as far apart as another draw says.

    Found by a random search within the limits that takes smaller and smaller steps.
    """
    own, (lower, upper) = config.avoidance.self_collision, limits
    wanted = rng.uniform(-0.5 * own.d_r, 1.1 * own.d_a)
    pairs = np.argwhere([point.capsules for point in model.self_points])
    point, capsule = pairs[int(rng.integers(len(pairs)))]
    best, error = rng.uniform(lower, upper), np.inf
    for step in np.geomspace(0.5, 0.005, SEARCH):
        q = np.clip(best + step * (upper - lower) * rng.normal(size=model.n), lower, upper)
        missing = abs(own_gaps(Posture(model, q))[point, capsule] - wanted)
        if missing < error:
            best, error = q, missing
    return best


def own_gaps(posture: Posture) -> Array:
    """Distances (P, L) of self points from capsules, between surfaces [m]; inf where they are no pair."""
    paired = np.array([point.capsules for point in posture.model.self_points])
    return np.where(paired, posture.own_gaps(), np.inf)


def _measurement(
    config: Config, model: RobotModel, q: Array, time: float, rng: np.random.Generator
) -> Measurement:
    """Some readings, a few closed switches, some points around the arm, ages now and then.

    Nothing is nearer than a distance that is different in every state, so that calm ones are among them.
    """
    ranges = lasting.ranges_of(model)
    seeing = rng.random(ranges.size) < rng.choice([0.0, 0.1, 0.5])
    avoidance = config.avoidance
    reach = 1.2 * max(avoidance.d_a, avoidance.damper.influence_distance, avoidance.active.distance)
    least = reach * rng.uniform(0.005, 0.95)
    points = int(rng.integers(min(6, config.skin.max_points) + 1))
    switches = len(model.capacitive_modules)
    aged = rng.random() < 0.3
    return Measurement(
        time=time,
        tof_range=np.where(seeing, rng.uniform(np.minimum(least, ranges), ranges), ranges),
        capacitive=rng.random(switches) < rng.choice([0.0, 0.0, 0.05]),
        tof_age=rng.uniform(0.0, config.skin.timeout, ranges.size) if aged else None,
        capacitive_age=rng.uniform(0.0, config.skin.timeout, switches) if aged else None,
        points=_points_around(model, q, points, (least, reach), rng),
    )


def _points_around(
    model: RobotModel, q: Array, count: int, distances: tuple[float, float], rng: np.random.Generator
) -> Array:
    """Points (count, 3) beside random capsules, at distances between two in the capsules' reference."""
    poses, points = body_poses(model, q), []
    for _ in range(count):
        capsule = model.capsules[int(rng.integers(len(model.capsules)))]
        on_axis = capsule.start + rng.uniform(-0.1, 1.1) * (capsule.end - capsule.start)
        direction = rng.normal(size=3)
        away = (capsule.reference_radius + rng.uniform(*distances)) * direction / np.linalg.norm(direction)
        points.append(poses[capsule.body][:3] @ np.append(on_axis + away, 1.0))
    return np.array(points).reshape(-1, 3)


def _with_fault(config: Config, model: RobotModel, state: State, rng: np.random.Generator) -> State:
    """The state with one thing wrong."""
    measurement, bad = state.measurement, float(rng.choice([np.nan, np.inf, -np.inf]))
    readings, timeout = measurement.tof_range, config.skin.timeout
    limited = np.flatnonzero(model.q_upper <= UNLIMITED)
    kinds: list[Callable[[], State]] = [
        lambda: replace(state, q=_spoilt(state.q, rng, bad)),
        lambda: replace(state, xdot=_spoilt(state.xdot, rng, bad)),
        lambda: replace(state, measurement=replace(measurement, time=bad)),
        lambda: replace(state, measurement=replace(measurement, time=measurement.time - 1.0)),
        lambda: replace(state, measurement=replace(measurement, points=_on_axis(model, state.q))),
    ]
    if limited.size:
        far = model.q_upper[limited[0]] + 2.0 * config.limits.tolerance + 0.1
        kinds.append(lambda: replace(state, q=_put(state.q, int(limited[0]), far)))
    if readings.size:
        for value in (bad, -0.01, 20.0):
            spoilt = _spoilt(readings, rng, value)
            kinds.append(lambda new=spoilt: replace(state, measurement=replace(measurement, tof_range=new)))  # type: ignore[misc]
        for age in (bad, -1e-3, 1.01 * timeout):
            ages = _spoilt(np.zeros(readings.size), rng, age)
            kinds.append(lambda new=ages: replace(state, measurement=replace(measurement, tof_age=new)))  # type: ignore[misc]
    return kinds[int(rng.integers(len(kinds)))]()


def _spoilt(array: Array, rng: np.random.Generator, value: float) -> Array:
    """A copy with one entry replaced."""
    return _put(array, int(rng.integers(array.size)), value)


def _put(array: Array, index: int, value: float) -> Array:
    """A copy with the entry at `index` replaced."""
    copy: NDArray[np.float64] = array.copy()
    copy[index] = value
    return copy


def _on_axis(model: RobotModel, q: Array) -> Array:
    """A point (1, 3) on the last capsule's axis."""
    capsule = model.capsules[-1]
    middle = 0.5 * (capsule.start + capsule.end)
    point: Array = body_poses(model, q)[capsule.body][:3] @ np.append(middle, 1.0)
    return point[None, :]
