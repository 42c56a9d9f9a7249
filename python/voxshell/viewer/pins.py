"""Contact pins: a ball at the contact point and a stem along the normal, colored by depth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voxshell.recording import ContactTrack, Recording
from voxshell.viewer.quaternions import normals_as_wxyz

# Warm colors, in contrast to the cool ones of bodies; from a touch to the largest depth.
DEPTH_COLORS = ((255, 196, 0), (255, 112, 16), (224, 30, 60), (92, 0, 34))
_STEM_IN_BALL_RADII = 7.0
_SEGMENTS = 8
# Rounding to 1/4096 turns a stem by less than a pixel, and such numbers compress well.
_TURNS = 4096.0
# A percentile, so that one deep contact in a bad step does not make all others pale.
_FULL_DEPTH_QUANTILE = 0.995


@dataclass(frozen=True, eq=False)
class Pins:
    """The contacts of one instant, to draw as instances of one mesh.

    Args:
        positions: (k, 3) float32, display units, lane frame.
        rotations: (k, 4) float32, quaternions (w, x, y, z) that rotate the mesh's z axis to the
            normal.
        colors: (k, 3) uint8, linear intensities of red, green and blue.
    """

    positions: NDArray[np.float32]
    rotations: NDArray[np.float32]
    colors: NDArray[np.uint8]

    def __len__(self) -> int:
        return len(self.positions)


def build_pin_mesh(
    ball_radius: float, *, stem: bool = True
) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return a surface of revolution about z: a ball around the origin with a stem upward.

    Args:
        ball_radius: Radius of the ball.
        stem: Add the stem.

    Returns:
        vertices (n, 3) in the unit of ``ball_radius``, and faces (m, 3), counterclockwise.
    """
    ball = [(math.sin(a), -math.cos(a)) for a in np.linspace(0.0, 0.9 * math.pi, 6)[1:]]
    top = [(0.22, _STEM_IN_BALL_RADII - 1.0), (0.0, _STEM_IN_BALL_RADII)] if stem else [(0.0, 1.0)]
    profile = np.array([(0.0, -1.0), *ball, *top]) * ball_radius
    angle = np.arange(_SEGMENTS) * (2.0 * math.pi / _SEGMENTS)
    rings = [
        np.stack([r * np.cos(angle), r * np.sin(angle), np.full(_SEGMENTS, z)], axis=1)
        for r, z in profile
    ]
    faces = []
    for ring in range(len(profile) - 1):
        for i in range(_SEGMENTS):
            a, b = ring * _SEGMENTS + i, ring * _SEGMENTS + (i + 1) % _SEGMENTS
            faces += [(a, b, b + _SEGMENTS), (a, b + _SEGMENTS, a + _SEGMENTS)]
    return np.concatenate(rings).astype(np.float32), np.array(faces, dtype=np.uint32)


LEAST_DEPTH = 1e-4
"""Smallest depth of the darkest color, in diameters of a typical body: less is rounding."""


def full_depth(recordings: Sequence[Recording], body_size: float) -> float:
    """Return the depth of the darkest color, meters: about that of the deepest contact.

    It is rounded up to one or two digits, because the scale shows it. It is 0 if nothing overlaps.

    Args:
        recordings: The recordings that share the scale.
        body_size: Diameter of a typical body, meters.
    """
    depths = np.concatenate([recording.contacts.depths for recording in recordings])
    depths = depths[depths > 0.0]
    if len(depths) == 0:
        return 0.0
    deep = max(float(np.quantile(depths, _FULL_DEPTH_QUANTILE)), LEAST_DEPTH * body_size)
    digit = 10.0 ** math.floor(math.log10(deep))
    steps = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
    return digit * next(step for step in steps if step * digit >= deep * (1.0 - 1e-9))


def build_pins(
    contacts: ContactTrack, *, scale: float, deepest: float, limit: int, grain: float
) -> Pins:
    """Return pins for the contacts of one frame.

    Args:
        contacts: One frame, meters.
        scale: Display units per meter.
        deepest: Depth of the darkest color, meters.
        limit: Largest number of pins; from more contacts, an even sample is taken.
        grain: Multiple to which positions are rounded, display units; a power of two, so that the
            numbers compress well.
    """
    chosen = slice(None)
    if len(contacts.points) > limit:
        chosen = np.linspace(0, len(contacts.points) - 1, limit).round().astype(np.int64)
    positions = np.round(contacts.points[chosen] * (scale / grain)) * grain
    fraction = contacts.depths[chosen] / deepest if deepest > 0.0 else np.zeros(len(positions))
    return Pins(
        positions.astype(np.float32),
        (np.round(normals_as_wxyz(contacts.normals[chosen]) * _TURNS) / _TURNS).astype(np.float32),
        as_light(color_depths(fraction)),
    )


def color_depths(fractions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return colors (sRGB, 0 to 255), (k, 3), of depths as fractions of the deepest, (k,)."""
    stops = np.linspace(0.0, 1.0, len(DEPTH_COLORS))
    channels = np.array(DEPTH_COLORS, dtype=np.float64).T
    return np.stack([np.interp(fractions, stops, channel) for channel in channels], axis=1)


def as_light(colors: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Convert colors (sRGB, 0 to 255) to linear intensities, 0 to 255, for the player's instances.

    Unconverted colors would look pale.

    Example:
        >>> as_light(np.array([[0.0, 128.0, 255.0]]))
        array([[  0,  55, 255]], dtype=uint8)
    """
    fraction = colors / 255.0
    light = np.where(fraction <= 0.04045, fraction / 12.92, ((fraction + 0.055) / 1.055) ** 2.4)
    return (255.0 * light).round().astype(np.uint8)
