"""Cuffs of proximity sensors on the longest links and on the last one."""

import math
from dataclasses import dataclass, replace

import numpy as np

from proxgen.model.frames import axis_basis
from proxgen.model.posture import Posture
from proxgen.model.robot_model import Array
from proxgen.scaffold.capsules import CapsuleProposal
from proxgen.scaffold.names import distinct

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
        origin: (3,) a point on its axis [m].
        axis: (3,) unit vector.
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
    """Cuffs on the last link, and on the two longest between first and last that have a place for one.

    Args:
        capsules: with radii, in the order of the postures' model.
        postures: the start, and others to see whether a place lies inside another link.

    Returns:
        Base to tool; a link on which no ring lies outside all other links has none.
    """
    if not capsules:
        return []
    last = len(capsules) - 1
    between = list(range(len(capsules)))[1:-1] if len(capsules) > 3 else list(range(last))
    found: dict[int, CuffProposal] = {}
    for index in sorted(between, key=lambda index: -capsules[index].length):
        if len(found) < _LONG and (cuff := _cuff(index, capsules, postures, hand=False)):
            found[index] = cuff
    if cuff := _cuff(last, capsules, postures, hand=True):
        found[last] = cuff
    cuffs = [found[index] for index in sorted(found)]
    names = distinct(cuff.name for cuff in cuffs)
    return [replace(cuff, name=name) for cuff, name in zip(cuffs, names, strict=True)]


def _cuff(
    index: int, capsules: list[CapsuleProposal], postures: list[Posture], *, hand: bool
) -> CuffProposal | None:
    """The cuff of one link, or None if every place for a ring lies inside another link."""
    capsule = capsules[index]
    tube = _crosswise(capsule) if hand and capsule.length < (capsule.radius or 0.0) else _lengthwise(capsule)
    free = [float(place) for place in tube.places if _is_free(index, tube, place, postures)]
    if not free:
        return None
    count = int(np.clip(round(2.0 * math.pi * tube.radius / _SPACING), 4, 12))
    low, high = free[0], free[-1]
    rings: tuple[RingProposal, ...]
    if hand or high - low < 0.06:
        place = _nearest(free, 0.5 * (low + high))
        rings = (RingProposal(round(place, 3), tube.radius, max(count, 8) if hand else 2 * count, 0.0),)
    else:
        first, second = (_nearest(free, low + part * (high - low)) for part in (0.2, 0.8))
        rings = (
            RingProposal(round(first, 3), tube.radius, count, 0.0),
            RingProposal(round(second, 3), tube.radius, count, 0.5),
        )
    return CuffProposal(f"{capsule.name}_cuff", capsule.frame, tube.origin, tube.axis, rings, hand)


@dataclass(frozen=True)
class _Tube:
    """Where rings of one cuff may lie: around an axis, outside the capsule."""

    origin: Array
    axis: Array
    radius: float
    places: Array


def _lengthwise(capsule: CapsuleProposal) -> _Tube:
    """Rings around the capsule's axis."""
    axis = (capsule.end - capsule.start) / capsule.length if capsule.length > 0.0 else capsule.onwards
    radius = _outside(capsule.radius or 0.0)
    return _Tube(capsule.start, axis, radius, np.linspace(0.0, capsule.length, 21))


def _crosswise(capsule: CapsuleProposal) -> _Tube:
    """Rings around the way to the tool, for a hand whose capsule is short or lies across."""
    radius = _outside(0.5 * capsule.length + (capsule.radius or 0.0))
    middle = np.round(0.5 * (capsule.start + capsule.end), 4) + 0.0
    return _Tube(middle, capsule.onwards, radius, np.linspace(-0.3 * radius, 0.6 * radius, 21))


def _outside(radius: float) -> float:
    """Radius of a ring around a radius, in whole millimetres."""
    return math.ceil((radius + GAP) * 1000.0) / 1000.0


def _nearest(places: list[float], wanted: float) -> float:
    """The place that is nearest to the wanted one."""
    return float(min(places, key=lambda place: abs(place - wanted)))


def _is_free(index: int, tube: _Tube, place: float, postures: list[Posture]) -> bool:
    """Whether a circle of modules lies outside all other links: in the first posture and nearly all others.

    An arm that folds can always touch its own cuffs in some postures.
    """
    basis = axis_basis(tube.axis)
    angles = 2.0 * math.pi * np.arange(24) / 24
    around = np.outer(np.cos(angles), basis[:, 0]) + np.outer(np.sin(angles), basis[:, 1])
    circle = tube.origin + place * tube.axis + tube.radius * around
    free = []
    for posture in postures:
        capsules = posture.model.capsules
        own = capsules[index].body
        others = [other.body != own for other in capsules]
        pose = posture.poses[own]  # of the capsule's frame, too: it is the joint's child link
        gaps = posture.gaps(circle @ pose[:3, :3].T + pose[:3, 3])[:, others]
        free.append(bool(gaps.min(initial=np.inf) > 0.0))
    return free[0] and sum(free) >= 0.85 * len(free)
