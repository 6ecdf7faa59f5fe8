"""Cuffs, as declared, to sensor modules in the frames of their bodies."""

import math
from typing import Any

import numpy as np

from proxgen.config.schema import Cuff, Ring, Skin
from proxgen.model.frames import axis_basis
from proxgen.model.robot_model import Array, SensorModule
from proxgen.model.urdf import frame_named


def _tilt(ring: Ring, index: int) -> float:
    """Tilt of one module [rad]; a list alternates."""
    return ring.tilt[index % len(ring.tilt)] if isinstance(ring.tilt, tuple) else ring.tilt


def ring_places(cuff: Cuff, ring: Ring) -> list[tuple[Array, Array]]:
    """Position and normal of every module of a ring, in the frame that carries the cuff [m].

    Module k sits at the angle 2 pi (k + stagger)/modules about the cuff's axis, counted from `axis_basis`'s
    first column; its normal leans from the radial direction by the tilt towards the axis.
    """
    basis, places = axis_basis(np.array(cuff.axis)), []
    for index in range(ring.modules):
        angle = 2.0 * math.pi * (index + ring.stagger) / ring.modules
        radial = basis @ np.array([math.cos(angle), math.sin(angle), 0.0])
        tilt = _tilt(ring, index)
        position = np.array(cuff.origin) + ring.offset * basis[:, 2] + ring.radius * radial
        normal = math.cos(tilt) * radial + math.sin(tilt) * basis[:, 2]
        places.append((position, normal / np.linalg.norm(normal)))
    return places


def sensor_modules(skin: Skin, pin_model: Any) -> tuple[SensorModule, ...]:
    """All modules of all cuffs, in the frames of the bodies that carry them.

    Args:
        skin: the configuration; every cuff's frame must exist in `pin_model`.
        pin_model: the reduced Pinocchio model.

    Returns:
        Cuff by cuff, ring by ring, module by module.
    """
    modules = []
    for cuff in skin.cuffs:
        frame = frame_named(pin_model, cuff.frame)
        rotation, translation = frame.placement.rotation, frame.placement.translation
        for ring_index, ring in enumerate(cuff.rings):
            for index, (position, normal) in enumerate(ring_places(cuff, ring)):
                modules.append(
                    SensorModule(
                        name=f"{cuff.name}.{ring_index}.{index}",
                        body=int(frame.parentJoint),
                        position=rotation @ position + translation,
                        normal=rotation @ normal,
                        tof=cuff.tof or skin.tof,
                        capacitive=cuff.capacitive or skin.capacitive,
                    )
                )
    return tuple(modules)
