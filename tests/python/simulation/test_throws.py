"""Boxes, hulls and crosses of bars that are thrown onto a slab, in any orientation and with any spin."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from scipy.spatial.transform import Rotation

THROWS = 80
BOUNCE = 1.2  # s, in which all come to rest or nearly


def build_mesh(kind, rng):
    if kind == "box":
        return trimesh.creation.box(rng.uniform(0.02, 0.15, 3))
    if kind == "hull":
        corners = rng.normal(size=(14, 3)) * rng.uniform(0.02, 0.06, 3)
        hull = trimesh.convex.convex_hull(corners)
        return hull.apply_translation(-hull.center_mass)
    bars = [trimesh.creation.box((0.12, 0.03, 0.03)), trimesh.creation.box((0.03, 0.1, 0.03))]
    return trimesh.boolean.union(bars, engine="manifold")


def throw(model, corners, slab, rate, rng):
    """Depth of the lowest corner below the slab's top, meters."""
    world = vx.World(1.0 / rate)
    world.add(slab, motion="static", pose=(0, 0, -0.1))
    start = ((0, 0, 0.25), Rotation.random(random_state=rng).as_quat())
    body = world.add(model, mass=0.3, pose=start)
    body.linear_velocity = (rng.uniform(-0.5, 0.5), 0, -1)
    body.angular_velocity = rng.uniform(-3, 3, 3)
    deepest = 0.0
    for _ in range(round(BOUNCE * rate)):
        world.step()
        heights = corners @ body.pose[2, :3] + body.pose[2, 3]
        deepest = max(deepest, -float(heights.min()))
    return deepest


# Contacts of corners were lost, and boxes were up to 18 mm deep at 60 Hz. The first touch of a fall at 2 m/s changes the
# spin so far that other corners are some millimeters deep for a step. Edges of the hulls are sharp.
@pytest.mark.parametrize(
    ("kind", "rate", "most"),
    [
        *[(kind, rate, 1e-4) for kind in ("box", "cross") for rate in (200, 60, 30)],
        *[("hull", 200, 3e-4), ("hull", 60, 5e-4), ("hull", 30, 6e-4)],
    ],
)
def test_thrown_bodies_stay_on_the_slab(kind, most, rate):
    rng = np.random.default_rng(5)
    slab = vx.Model.from_mesh(trimesh.creation.box((3, 3, 0.2)))
    meshes = [build_mesh(kind, rng) for _ in range(4)]
    depths = [
        throw(model, mesh.vertices, slab, rate, rng)
        for mesh in meshes
        for model in [vx.Model.from_mesh(mesh)]
        for _ in range(THROWS // 4)
    ]
    assert np.percentile(depths, 90) < most
    assert max(depths) < 5e-3
