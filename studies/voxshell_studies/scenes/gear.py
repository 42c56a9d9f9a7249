"""Spur gears with involute teeth and an exact backlash, made with manifold3d. Meters; the axis is z."""

from __future__ import annotations

from typing import Any

import numpy as np
from voxshell_studies.scenes.solids import import_manifold

_PRESSURE_ANGLE = np.radians(20.0)
_BORE_SEGMENTS = 32


def make_gear(
    teeth: int, module: float, width: float, bore: float, backlash: float = 0.0, samples: int = 6
) -> Any:
    """A gear about z from z = 0 up, with a tooth along x, a ``manifold3d.Manifold``.

    Its pitch radius is teeth * module / 2. Two gears whose pitch circles touch roll without slip where
    each tooth is half a pitch wide; here it is thinner by ``backlash``.

    Args:
        teeth: How many.
        module: Meters.
        width: Meters.
        bore: Radius of the hole, meters.
        backlash: Meters along the pitch circle.
        samples: Vertices along a flank.

    Raises:
        MissingExtraError: manifold3d is not installed.
    """
    solids = import_manifold()
    pitch_radius = 0.5 * teeth * module
    base_radius = pitch_radius * np.cos(_PRESSURE_ANGLE)
    root_radius, outer_radius = pitch_radius - 1.25 * module, pitch_radius + module
    # Half a tooth's angle at the pitch circle, and what the involute adds on the way there.
    half = (0.5 * np.pi * module - backlash) / (2.0 * pitch_radius)
    offset = half + np.tan(_PRESSURE_ANGLE) - _PRESSURE_ANGLE
    radii = np.linspace(max(base_radius, root_radius), outer_radius, samples)
    flank_pressure = np.arccos(np.minimum(base_radius / radii, 1.0))
    flank = offset - (np.tan(flank_pressure) - flank_pressure)
    points = []
    for tooth in range(teeth):
        middle = 2.0 * np.pi * tooth / teeth
        profile = [
            (root_radius, -flank[0]),
            *zip(radii, -flank, strict=True),
            *zip(radii[::-1], flank[::-1], strict=True),
            (root_radius, flank[0]),
        ]
        points += [
            (radius * np.cos(middle + angle), radius * np.sin(middle + angle))
            for radius, angle in profile
        ]
    disc = solids.Manifold.extrude(solids.CrossSection([np.array(points)]), width)
    hole = solids.Manifold.cylinder(3.0 * width, bore, circular_segments=_BORE_SEGMENTS)
    return disc - hole.translate((0.0, 0.0, -width))
