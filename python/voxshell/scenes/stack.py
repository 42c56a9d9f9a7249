"""Spheres on top of each other: the second experiment of the thesis (section 5.3).

World frame: z up, the ground's surface at z = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from voxshell._arguments import as_integer, as_positive
from voxshell.body import Body
from voxshell.errors import SettingsError
from voxshell.scenes.ball import PUBLISHED_RULE, Rule, build_ball
from voxshell.shapes import Plane, Sphere
from voxshell.world import World


@dataclass(frozen=True)
class StackSettings:
    """Settings of the stack.

    Attributes:
        count: Spheres.
        radius: Metres.
        mass: Of each, kilograms.
        rate: Steps a second.
        seconds: How long it has to stand.
        resolutions: Points of the shells that are tried, ascending.
        seeds: How many stacks of each, their spheres turned at random.
        voxel_size: Of the spheres, metres.

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

    def __post_init__(self) -> None:
        for name in ("radius", "mass", "rate", "seconds", "voxel_size"):
            as_positive(getattr(self, name), name)
        for name in ("count", "seeds"):
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
        time_step=1.0 / settings.rate,
        sleeping=False,
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
