"""A ball dropped on a ground: the first experiment of the thesis (section 5.3).

World frame: z up, the ground's surface at z = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.errors import SettingsError
from voxshell.model.model import Model
from voxshell.model.shapes import Box, Plane, Sphere
from voxshell.simulation.body import Body
from voxshell.simulation.body_shapes import mesh_of
from voxshell.simulation.world import World

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.simulation.body_shapes import Shape

GROUND_HALF_EXTENTS = (0.4, 0.4, 0.1)
"""Of the block under the ball, meters: it meets the ball's lowest part only."""

_SUBDIVISIONS = 6
"""Of the icosahedron: 81,920 triangles, within 0.1 mm of a sphere of 0.5 m."""

Ground = Literal["voxels", "plane", "box"]
Rule = Literal["published", "voxshell"]
"""Which points are contacts: the one that penetrates deepest, or those of this package's rule."""

Landing = Literal["pole", "beside"]
"""Where the shell's lowest point is at the start: straight below the center; or, with the ball turned as
its mesh is, beside that, by 42 mm with 275 points."""

PUBLISHED_RULE = {
    "contact": "segmented",
    "level": 1,
    "margin": 0.0,
    "ccd_motion_threshold": math.inf,
}
"""As arguments of World."""


@dataclass(frozen=True)
class BallSettings:
    """Settings of the bouncing ball.

    Attributes:
        radius: Meters.
        mass: Kilograms.
        height: Of the ball's center at the start, meters.
        gravity: m/s2, downward.
        rate: Steps a second.
        steps: How many.
        restitutions: Of the ball; the ground's is 1.
        phase_restitutions: The same, where many start heights are tried.
        low_points, high_points: Of the two shells.
        voxel_size: Of ball and ground, meters.
        phases: How many start heights are tried,
        phase_reach: within this of ``height``, meters.

    Raises:
        SettingsError: A number is out of range.
    """

    radius: float = 0.5
    mass: float = 1.0
    height: float = 1.0
    gravity: float = 10.0
    rate: float = 200.0
    steps: int = 300
    restitutions: tuple[float, ...] = (0.1, 0.5, 0.9)
    phase_restitutions: tuple[float, ...] = (0.0, 0.1, 0.5, 0.9, 1.0)
    low_points: int = 275
    high_points: int = 25_880
    voxel_size: float = 0.005
    phases: int = 50
    phase_reach: float = 0.005

    def __post_init__(self) -> None:
        for name in (
            *("radius", "mass", "height", "gravity", "rate"),
            *("voxel_size", "phase_reach"),
        ):
            as_positive(getattr(self, name), name)
        for name in ("steps", "low_points", "high_points", "phases"):
            as_integer(getattr(self, name), name, 1, 2**31 - 1)
        if self.height <= self.radius:
            raise SettingsError(
                f"height must be above radius, {self.radius:g}, for the ball to fall"
            )
        for name in ("restitutions", "phase_restitutions"):
            values = getattr(self, name)
            if not values or not all(0.0 <= c <= 1.0 for c in values):
                raise SettingsError(f"{name} must be from 0 to 1, not {values}")
        if not set(self.restitutions) <= set(self.phase_restitutions):
            raise SettingsError("phase_restitutions must have all restitutions among them")

    @property
    def way_a_step(self) -> float:
        """How far the ball moves in the step in which it arrives, meters."""
        return math.sqrt(2.0 * self.gravity * (self.height - self.radius)) / self.rate


@cache
def build_ball(radius: float, voxel_size: float, points: int) -> Model:
    """A sphere's model about its origin."""
    from trimesh.creation import icosphere

    mesh = icosphere(subdivisions=_SUBDIVISIONS, radius=radius)
    return Model.from_mesh(mesh, voxel_size=voxel_size, target_points=points)


@cache
def build_ground(voxel_size: float) -> Model:
    """The block's model about its middle."""
    return Model.from_mesh(mesh_of(Box(GROUND_HALF_EXTENTS)), voxel_size=voxel_size)


def build_world(
    settings: BallSettings,
    *,
    points: int | None,
    ground: Ground,
    rule: Rule,
    restitution: float,
    height: float,
    landing: Landing = "pole",
) -> tuple[World, Body]:
    """The ball at its start.

    Args:
        settings: Of the experiment.
        points: Of the ball's shell; None for Bullet's own sphere.
        ground: The block as a model, an endless plane, or Bullet's box.
        rule: Which points are contacts.
        restitution: Of the ball.
        height: Of its center, meters.
        landing: Where the shell's lowest point is.
    """
    # The reported rebounds are of bodies that are followed from a voxel a step on.
    contact_rule: dict[str, Any] = {"ccd_motion_threshold": settings.voxel_size}
    if rule == "published":
        contact_rule = PUBLISHED_RULE
    world = World(
        shell="fewest",
        gravity=(0.0, 0.0, -settings.gravity),
        time_step=1.0 / settings.rate,
        sleeping=False,
        **contact_rule,
    )
    blocks: dict[Ground, Shape] = {"box": Box(GROUND_HALF_EXTENTS), "plane": Plane()}
    shape = build_ground(settings.voxel_size) if ground == "voxels" else blocks[ground]
    world.add(
        shape,
        mass=0.0,
        pose=_lifted(0.0 if ground == "plane" else -GROUND_HALF_EXTENTS[2]),
        restitution=1.0,
        name="ground",
    )
    model = None if points is None else build_ball(settings.radius, settings.voxel_size, points)
    pose = _lifted(height)
    if model is not None and landing == "pole":
        pose[:3, :3] = turn_pole_down(model)
    ball = world.add(
        Sphere(settings.radius) if model is None else model,
        mass=settings.mass,
        pose=pose,
        restitution=restitution,
        name="ball",
    )
    return world, ball


def turn_pole_down(ball: Model) -> NDArray[np.float64]:
    """A turn that brings the lowest of a ball's points straight below its center.

    Returns:
        (3, 3) ``world_from_body``.
    """
    from trimesh.geometry import align_vectors

    points = ball.shell.points.astype(np.float64)
    lowest = points[points[:, 2].argmin()]
    return np.asarray(align_vectors(lowest, (0.0, 0.0, -1.0)))[:3, :3]


def _lifted(height: float) -> NDArray[np.float64]:
    pose = np.eye(4)
    pose[2, 3] = height
    return pose
