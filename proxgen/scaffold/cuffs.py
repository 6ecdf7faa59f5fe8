"""Cuffs of proximity sensors on the longest links and on the last one."""

import math
from dataclasses import dataclass

import numpy as np

from proxgen.model.frames import axis_basis
from proxgen.model.robot_model import Array
from proxgen.scaffold.capsules import CapsuleProposal
from proxgen.scaffold.postures import Posture

GAP = 0.01
"""Distance of the modules from the capsule's surface [m]."""
_SPACING = 0.09
_LONG = 2


@dataclass(frozen=True)
class RingProposal:
    """One ring: where along the cuff's axis [m], its radius [m], how many modules, and how it is turned."""

    offset: float
    radius: float
    modules: int
    stagger: float


@dataclass(frozen=True)
class CuffProposal:
    """One item of `skin.cuffs`.

    Attributes:
        name: an identifier, after the link.
        frame: the link.
        origin: (3,) the start of the capsule's axis [m].
        axis: (3,) along the capsule.
        rings: one or two.
        hand: on the last link, where modules also look ahead.
    """

    name: str
    frame: str
    origin: Array
    axis: Array
    rings: tuple[RingProposal, ...]
    hand: bool


def propose_cuffs(capsules: list[CapsuleProposal], postures: list[Posture]) -> list[CuffProposal]:
    """Cuffs on the two longest links between the first and the last, and on the last.

    Args:
        capsules: with radii, in the order of the postures' model.
        postures: in none of these may a module lie inside another link's capsule.

    Returns:
        Base to tool; a link on which no ring fits is left out.
    """
    between = list(range(len(capsules)))[1:-1] if len(capsules) > 3 else list(range(len(capsules)))[:-1]
    longest = sorted(between, key=lambda index: -capsules[index].length)[:_LONG]
    chosen = [*sorted(longest), len(capsules) - 1] if capsules else []
    cuffs = [_cuff(index, capsules, postures, hand=index == len(capsules) - 1) for index in chosen]
    return [cuff for cuff in cuffs if cuff is not None]


def _cuff(
    index: int, capsules: list[CapsuleProposal], postures: list[Posture], *, hand: bool
) -> CuffProposal | None:
    """The cuff of one link, or None if every place for a ring lies inside another link."""
    capsule = capsules[index]
    radius = math.ceil(((capsule.radius or 0.0) + GAP) * 1000.0) / 1000.0
    along = capsule.end - capsule.start
    axis = along / capsule.length if capsule.length > 0.0 else np.array([0.0, 0.0, 1.0])
    places = np.linspace(0.0, capsule.length, 21) if capsule.length > 0.0 else np.zeros(1)
    free = [place for place in places if _is_free(index, capsule, axis, place, radius, postures)]
    if not free:
        return None
    count = int(np.clip(round(2.0 * math.pi * radius / _SPACING), 4, 12))
    low, high = free[0], free[-1]
    rings: tuple[RingProposal, ...]
    if hand:
        rings = (RingProposal(round(_nearest(free, 0.5 * (low + high)), 3), radius, max(count, 8), 0.0),)
    elif high - low < 0.06:
        rings = (RingProposal(round(_nearest(free, 0.5 * (low + high)), 3), radius, 2 * count, 0.0),)
    else:
        first, second = (_nearest(free, low + part * (high - low)) for part in (0.2, 0.8))
        rings = (
            RingProposal(round(first, 3), radius, count, 0.0),
            RingProposal(round(second, 3), radius, count, 0.5),
        )
    return CuffProposal(f"{capsule.name[:35]}_cuff", capsule.frame, capsule.start, axis, rings, hand)


def _nearest(places: list[float], wanted: float) -> float:
    """The place that is nearest to the wanted one."""
    return float(min(places, key=lambda place: abs(place - wanted)))


def _is_free(
    index: int, capsule: CapsuleProposal, axis: Array, place: float, radius: float, postures: list[Posture]
) -> bool:
    """Whether a circle of modules lies outside all other links in all postures."""
    basis = axis_basis(axis)
    angles = 2.0 * math.pi * np.arange(24) / 24
    circle = (
        capsule.start
        + place * axis
        + radius * (np.outer(np.cos(angles), basis[:, 0]) + np.outer(np.sin(angles), basis[:, 1]))
    )
    for posture in postures:
        capsules = posture.model.capsules
        own = capsules[index].body
        others = [other.body != own for other in capsules]
        pose = posture.poses[own]  # of the capsule's frame, too: it is the joint's child link
        if any(others) and posture.gaps(circle @ pose[:3, :3].T + pose[:3, 3])[:, others].min() < 0.0:
            return False
    return True
