"""A capsule per moving link: fitted to its geometry, turned towards the tool, rounded outwards."""

import math
from dataclasses import dataclass

import numpy as np

from proxgen.model.robot_model import Array
from proxgen.scaffold.chain import ArmBody
from proxgen.scaffold.fit import FittedCapsule, enclosing, fit_capsule
from proxgen.scaffold.names import distinct
from proxgen.scaffold.shapes import Cloud


@dataclass(frozen=True)
class CapsuleProposal:
    """One item of `capsules`.

    Attributes:
        name: an identifier, after the link.
        body: which moving body it stands for, from 0.
        frame: the body's own link.
        start: (3,) in the frame [m].
        end: (3,) in the frame, nearer to the tool [m].
        radius: [m]; None if the URDF has no geometry to take it from.
        note: links of the body that have no geometry; empty if all have.
        onwards: (3,) unit vector from the joint to the next one or to the tool, in the frame.
    """

    name: str
    body: int
    frame: str
    start: Array
    end: Array
    radius: float | None
    note: str
    onwards: Array

    @property
    def length(self) -> float:
        """Length of the axis [m]."""
        return float(np.linalg.norm(self.end - self.start))


def propose_capsules(bodies: tuple[ArmBody, ...]) -> list[CapsuleProposal]:
    """A capsule for each moving body with collision geometry.

    If no body has any, the long ones get the line from their joint to the next one, without a radius: the
    user has to say how thick they are.
    """
    named = list(zip(range(len(bodies)), distinct(body.link for body in bodies), bodies, strict=True))
    proposals = []
    for index, name, body in named:
        if body.cloud is not None:
            fitted = rounded(body.cloud, body.outlet)
            note = f"without geometry: {', '.join(body.bare)}" if body.bare else ""
            ends = fitted.start, fitted.end
            proposals.append(
                CapsuleProposal(name, index, body.link, *ends, fitted.radius, note, _onwards(body, fitted))
            )
    if proposals:
        return proposals
    lengths = [float(np.linalg.norm(body.outlet)) for body in bodies]
    return [
        CapsuleProposal(
            name, index, body.link, np.zeros(3), np.round(body.outlet, 4) + 0.0, None, "", body.outlet
        )
        for index, name, body in named
        if lengths[index] >= 0.1 * max(lengths)
    ]


def _onwards(body: ArmBody, fitted: FittedCapsule) -> Array:
    """Direction from a body's joint to where the next one is attached, or else to its middle."""
    for way in (body.outlet, 0.5 * (fitted.start + fitted.end)):
        length = float(np.linalg.norm(way))
        if length > 0.1 * fitted.radius:
            return way / length
    return np.array([0.0, 0.0, 1.0])


def rounded(cloud: Cloud, outlet: Array) -> FittedCapsule:
    """The least capsule around a body, with few digits; the radius is rounded up to contain all."""
    fitted = fit_capsule(cloud)
    digits = 4 if fitted.radius > 0.02 else 5
    ends = [np.round(end, digits) + 0.0 for end in (fitted.start, fitted.end)]
    if fitted.length < 0.01 * fitted.radius:
        ends = [ends[0], ends[0]]
    else:
        middle = 0.5 * (ends[0] + ends[1])
        onwards = outlet - middle if float(np.linalg.norm(outlet)) > 0.2 * fitted.length else middle
        if (ends[1] - ends[0]) @ onwards < 0.0:
            ends.reverse()
    radius = enclosing(cloud, *ends).radius
    return FittedCapsule(ends[0], ends[1], math.ceil(radius * 10**digits - 1e-6) / 10**digits)
