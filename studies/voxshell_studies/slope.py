"""A box of points on a slope: whether it slides from Coulomb's angle on."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from voxshell.base.arguments import as_positive
from voxshell.model.model import Model
from voxshell.model.shapes import Box, Plane
from voxshell.simulation.body_shapes import mesh_of
from voxshell.simulation.world import World

from voxshell_studies.part import Part

if TYPE_CHECKING:
    from voxshell.simulation.body_shapes import Shape

    from voxshell_studies.part import Tables

Kind = Literal["regular", "segmented", "bullet"]
KINDS: tuple[Kind, ...] = ("regular", "segmented", "bullet")
"""Two contact modes of the model, and Bullet's own box."""


@dataclass(frozen=True)
class SlopeSettings:
    """Settings of the slope.

    Attributes:
        half_extents: Half extents of the box, meters.
        voxel_size: Voxel size of the box, meters.
        rate: Steps per second.
        frictions: Coefficients to try.
        settle_seconds: Time on the slope before sliding is measured.
        seconds: Duration of the measurement.
        least_slide: Smallest displacement that counts as sliding, meters.
        halvings: Halvings of the range of angles: the result is accurate to 20 degrees /
            2^halvings.
    """

    half_extents: tuple[float, ...] = (0.1, 0.1, 0.05)
    voxel_size: float = 0.005
    rate: float = 200.0
    frictions: tuple[float, ...] = (0.2, 0.5, 0.8)
    settle_seconds: float = 0.5
    seconds: float = 2.0
    least_slide: float = 0.005
    halvings: int = 9

    def __post_init__(self) -> None:
        for name in ("voxel_size", "rate", "settle_seconds", "seconds", "least_slide"):
            as_positive(getattr(self, name), name)
        for friction in self.frictions:
            as_positive(friction, "frictions")


def plan(settings: SlopeSettings) -> list[Part]:
    """Return a part for each kind."""
    return [
        Part(kind, find_angles, {"settings": settings, "kind": kind}, cost=3.0) for kind in KINDS
    ]


def find_angles(settings: SlopeSettings, kind: Kind) -> Tables:
    """Find the smallest angle at which the box slides, and its acceleration beyond it."""
    rows = []
    for friction in settings.frictions:
        ideal = math.degrees(math.atan(friction))
        low, high = max(ideal - 10.0, 0.0), ideal + 10.0
        for _ in range(settings.halvings):
            middle = 0.5 * (low + high)
            slid, _ = _slide(settings, kind, friction, middle)
            low, high = (low, middle) if slid > settings.least_slide else (middle, high)
        steep = ideal + 10.0
        _, acceleration = _slide(settings, kind, friction, steep)
        angle = math.radians(steep)
        expected = 9.81 * (math.sin(angle) - friction * math.cos(angle))
        rows.append((friction, ideal, 0.5 * (low + high), acceleration, expected))
    names = ("friction", "ideal", "angle", "acceleration", "expected_acceleration")
    return {"angles": dict(zip(names, np.array(rows).T, strict=True))}


def _slide(
    settings: SlopeSettings, kind: Kind, friction: float, angle: float
) -> tuple[float, float]:
    """Return the displacement of the box, meters, and its mean acceleration, m/s2.

    The slope is level, and gravity is tilted instead.
    """
    turn = math.radians(angle)
    world = World(
        shell="fewest",
        gravity=(9.81 * math.sin(turn), 0.0, -9.81 * math.cos(turn)),
        time_step=1.0 / settings.rate,
        contact="auto" if kind == "bullet" else kind,
        sleeping=False,
        friction_directions=1 if kind == "bullet" else 2,
    )
    world.add(Plane(), mass=0.0, friction=1.0)
    box = Box(settings.half_extents)
    shape: Shape = (
        box if kind == "bullet" else Model.from_mesh(mesh_of(box), voxel_size=settings.voxel_size)
    )
    pose = np.eye(4)
    pose[2, 3] = settings.half_extents[2]
    body = world.add(shape, mass=1.0, pose=pose, friction=friction)
    world.step(round(settings.settle_seconds * settings.rate))
    place, speed = body.pose[0, 3], body.linear_velocity[0]
    world.step(round(settings.seconds * settings.rate))
    return (
        float(body.pose[0, 3] - place),
        float(body.linear_velocity[0] - speed) / settings.seconds,
    )
