"""Collars on poles, pulled along them at a lever, so that they lean: friction holds them as statics says."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np
import pytest
import trimesh
import voxshell as vx

if TYPE_CHECKING:
    from numpy.typing import NDArray

HALF_LENGTH, BORE, POLE = 0.02, 0.0102, 0.01
LEVER, MASS, PULL = 0.03, 0.2, 2.0
START, WAY = 0.3, 0.4
HEADINGS = (0, 23)


@cache
def collar() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.annulus(BORE, 0.016, 2 * HALF_LENGTH, sections=64))


@cache
def pole() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.cylinder(POLE, 1.2, sections=64))


def rims() -> NDArray[np.float64]:
    """Places of both edges of the bore, the collar's frame."""
    # A few places of each side of the polygon that the bore is.
    corners = np.linspace(0.0, 2.0 * np.pi, 65)
    circle = BORE * np.column_stack([np.cos(corners), np.sin(corners)])
    sides = np.concatenate([(1 - s) * circle[:-1] + s * circle[1:] for s in np.linspace(0, 1, 9)])
    ends = [np.column_stack([sides, np.full(len(sides), z)]) for z in (-HALF_LENGTH, HALF_LENGTH)]
    return np.concatenate(ends)


@pytest.mark.parametrize("rate", [1000, 200])
@pytest.mark.parametrize("friction", [0.0, 0.6])
@pytest.mark.parametrize("is_model", [True, False])
def test_a_collar_that_leans_slides_as_statics_says(
    is_model: bool, friction: float, rate: int
) -> None:
    shape = pole() if is_model else vx.Cylinder(POLE, 1.2)
    places = rims()
    # Both edges of the bore are pressed with the pull's lever over the collar's length.
    pressed = PULL * LEVER / (2 * HALF_LENGTH)
    acceleration = (PULL - 2 * friction * friction * pressed) / MASS
    for heading in HEADINGS:
        world = vx.World(time_step=1 / rate, gravity=(0, 0, 0))
        world.add(shape, mass=0, friction=friction)
        pose = vx.pose((0, 0, START), euler=(0, 0, np.radians(heading)))
        body = world.add(collar(), mass=MASS, pose=pose, friction=friction)
        deepest = 0.0
        while body.position[2] > START - WAY and world.time < 1.0:
            body.apply_force((0, 0, -PULL), at=body.pose[:3, :3] @ (LEVER, 0, 0) + body.position)
            world.step()
            at = places @ body.pose[:3, :3].T + body.position
            deepest = max(deepest, POLE - np.hypot(at[:, 0], at[:, 1]).min())
        distance = START - body.position[2]
        assert world.time == pytest.approx(np.sqrt(2 * distance / acceleration), rel=0.05)
        assert deepest < 2e-4
