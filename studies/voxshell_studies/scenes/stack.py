"""Spheres on top of each other: the second experiment of the thesis (section 5.3); and bunnies.

World frame: z up, the ground's surface at z = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.errors import SettingsError
from voxshell.model.shapes import Plane, Sphere
from voxshell.simulation.body import Body
from voxshell.simulation.world import World
from voxshell_studies.scenes.ball import PUBLISHED_RULE, Rule, build_ball
from voxshell_studies.scenes.bunny import BunnySettings

# Found by letting bunnies down on each other in random turns, and keeping those that held for seconds.
BUNNY_PLACES: tuple[tuple[float, ...], ...] = (
    (0.0, 0.0, 0.06958, 0.81002, 0.09203, -0.06229, -0.57577),
    (-0.03766, 0.0013, 0.16877, 0.35214, -0.04354, -0.11594, -0.92772),
    (-0.02748, -0.00082, 0.27297, 0.11594, -0.83474, 0.53791, 0.02031),
    (0.00592, 0.014, 0.37735, 0.15659, 0.00076, -0.04031, 0.98684),
    (0.01811, -0.02308, 0.47058, 0.33404, -0.9167, -0.21052, -0.06126),
)
"""Of five bunnies that touch: place, meters, and quaternion (w, x, y, z), world_from_body."""

BUNNY_SHAKE = 0.0005
"""Bunnies start so far over each other, and up to so far aside, meters."""


@dataclass(frozen=True)
class StackSettings:
    """Settings of the stack.

    Attributes:
        count: Spheres.
        radius: Meters.
        mass: Of each, kilograms.
        rate: Steps a second.
        seconds: How long it has to stand.
        resolutions: Points of the shells that are tried, ascending.
        seeds: How many stacks of each, their spheres turned at random.
        voxel_size: Of the spheres, meters.
        bunny_seeds: How many stacks of five bunnies, each shaken at random at the start.

    Raises:
        SettingsError: A number is out of range.
    """

    count: int = 5
    radius: float = 0.5
    mass: float = 1.0
    rate: float = 200.0
    seconds: float = 60.0
    resolutions: tuple[int, ...] = (275, 2_700, 25_880)
    seeds: int = 20
    voxel_size: float = 0.005
    bunny_seeds: int = 10

    def __post_init__(self) -> None:
        for name in ("radius", "mass", "rate", "seconds", "voxel_size"):
            as_positive(getattr(self, name), name)
        for name in ("count", "seeds", "bunny_seeds"):
            as_integer(getattr(self, name), name, 1, 1000)
        if not self.resolutions or sorted(set(self.resolutions)) != list(self.resolutions):
            raise SettingsError(f"resolutions must ascend, not {self.resolutions}")


def build_world(
    settings: StackSettings, *, points: int | None, rule: Rule, seed: int
) -> tuple[World, list[Body]]:
    """The stack at its start, each sphere just touching the next.

    Args:
        settings: Of the experiment.
        points: Of the shells; None for Bullet's own spheres.
        rule: Which points are contacts.
        seed: Of the spheres' orientations.
    """
    from trimesh.transformations import random_rotation_matrix

    world = World(
        shell="fewest",
        time_step=1.0 / settings.rate,
        sleeping=False,
        friction_directions=1 if points is None else 2,
        **(PUBLISHED_RULE if rule == "published" else {}),
    )
    world.add(Plane(), mass=0.0, name="ground")
    shape = (
        Sphere(settings.radius)
        if points is None
        else build_ball(settings.radius, settings.voxel_size, points)
    )
    rng = np.random.default_rng(seed)
    bodies = []
    for number in range(settings.count):
        pose = np.array(random_rotation_matrix(rng.random(3)))
        pose[2, 3] = settings.radius * (2 * number + 1)
        bodies.append(world.add(shape, mass=settings.mass, pose=pose, name=f"sphere {number + 1}"))
    return world, bodies


def build_bunny_world(settings: StackSettings, *, seed: int) -> tuple[World, list[Body]]:
    """Five fine bunnies on an analytic plane at their start, from the lowest to the highest.

    Args:
        settings: Of the experiment.
        seed: Of what is random at the start.
    """
    from trimesh.transformations import quaternion_matrix

    bunny = BunnySettings()
    world = World(shell="fewest", time_step=1.0 / settings.rate, sleeping=False)
    world.add(Plane(), mass=0.0, name="ground")
    rng = np.random.default_rng(seed)
    bodies = []
    for number, (x, y, z, *quaternion) in enumerate(BUNNY_PLACES):
        pose = np.array(quaternion_matrix(quaternion))
        lift = BUNNY_SHAKE * (1 + 2 * number)
        pose[:3, 3] = np.array((x, y, z + lift)) + rng.uniform(-BUNNY_SHAKE, BUNNY_SHAKE, 3)
        bodies.append(
            world.add(
                bunny.build_model(),
                mass=bunny.mass,
                pose=pose,
                inertia=bunny.mass_properties,
                name=f"bunny {number + 1}",
            )
        )
    return world, bodies
