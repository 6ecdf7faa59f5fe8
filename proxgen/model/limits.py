"""Limits of the controlled joints: the configuration's, else the URDF's; and those of their followers."""

import numpy as np

from proxgen.config.schema import Config
from proxgen.errors import Problem
from proxgen.model.robot_model import Array
from proxgen.model.urdf import Urdf, followed

UNLIMITED = 1e20
"""Stands for a limit that does not exist; the runtime's PG_OFF."""


def joint_limits(config: Config, urdf: Urdf, controlled: list[str]) -> tuple[Array, list[Problem]]:
    """Limits of every controlled joint, and what is missing or contradictory.

    A joint that follows another, on the way to the tool or elsewhere, at ratio * q + offset bounds q and its
    velocity as well, whatever the configuration says of q: it cannot be moved beyond its own limits.

    Args:
        config: limits here take the place of the URDF's.
        urdf: the whole robot.
        controlled: names of the n controlled joints.

    Returns:
        (n, 4): lower, upper [rad or m], velocity (per s), acceleration (per s^2); and problems.
    """
    table, problems = np.empty((len(controlled), 4)), []
    for index, name in enumerate(controlled):
        (lower, upper), velocity = _position(config, urdf, name), config.limits.velocity.get(name)
        if lower is None or upper is None:
            message = f"the URDF gives joint '{name}' {_missing(urdf, name)}; set limits.position.{name}"
            problems.append(config.problem("limits.position", message))
            lower, upper = -UNLIMITED, UNLIMITED
        if velocity is None:
            velocity = urdf.limits[name].velocity or 0.0
        if velocity <= 0.0:
            message = f"the URDF gives joint '{name}' no velocity limit above 0; set limits.velocity.{name}"
            problems.append(config.problem("limits.velocity", message))
        table[index] = lower, upper, velocity, _acceleration(config, name)
    return table, problems + _heed_followers(config, urdf, controlled, table)


def _position(config: Config, urdf: Urdf, name: str) -> tuple[float | None, float | None]:
    """Position limits of a joint; None where nobody says them."""
    if name in config.limits.position:
        return config.limits.position[name]
    if urdf.full.joints[urdf.full.getJointId(name)].nq == 2:  # continuous
        return -UNLIMITED, UNLIMITED
    written = urdf.limits[name]
    if written.lower is None or written.upper is None or written.lower >= written.upper:
        return None, None
    return written.lower, written.upper


def _missing(urdf: Urdf, name: str) -> str:
    """What is wrong with the URDF's position limits of a joint that has none that can be used."""
    lower, upper = urdf.limits[name].lower, urdf.limits[name].upper
    if lower is None or upper is None:
        return "no position limits"
    return f"position limits without room, {lower:.6g} to {upper:.6g}"


def _heed_followers(config: Config, urdf: Urdf, controlled: list[str], table: Array) -> list[Problem]:
    """Narrow the limits by those of the joints that follow; problems where nothing is left."""
    problems = []
    for name in urdf.mimics:
        leader, ratio, offset = followed(urdf, name, config.robot.locked_joints)
        if leader not in controlled or leader == name or ratio == 0.0:
            continue
        row, written = table[controlled.index(leader)], urdf.limits[name]
        low, high = written.lower, written.upper
        # As in a leader, limits that leave no room are none: some URDFs write zeros for followers.
        if low is not None and high is not None and low < high:
            first, last = sorted(((low - offset) / ratio, (high - offset) / ratio))
            row[:2] = max(row[0], first), min(row[1], last)
            if row[0] >= row[1]:
                message = f"'{name}', which follows it, allows {first:.6g} to {last:.6g} only"
                problems.append(
                    config.problem(
                        f"limits.position.{leader}", f"joint '{leader}' has no room to move: {message}"
                    )
                )
        if written.velocity:
            row[2] = min(row[2], written.velocity / abs(ratio))
    return problems


def _acceleration(config: Config, name: str) -> float:
    """Acceleration limit of a joint, UNLIMITED where none is configured."""
    acceleration = config.limits.acceleration
    if isinstance(acceleration, dict):
        return acceleration.get(name, UNLIMITED)
    return UNLIMITED if acceleration is None else acceleration
