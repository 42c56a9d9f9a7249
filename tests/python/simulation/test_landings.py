"""Bodies that move too little in a step to pass anything still land on the surface, not in it."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from trimesh.transformations import random_rotation_matrix


@pytest.mark.parametrize("rate", [1000, 500, 200, 60])
@pytest.mark.parametrize("side", [0.1, 1.0])
@pytest.mark.parametrize("ground", ["slab", "plane"])
def test_cubes_land_no_deeper_than_a_500th_of_their_side(ground: str, side: float, rate: int):
    mesh = trimesh.creation.box((side, side, side))
    cube = vx.Model.from_mesh(mesh)
    slab = vx.Model.from_mesh(trimesh.creation.box((10 * side, 10 * side, side)))
    deepest = 0.0
    for placement in range(6):
        random = np.random.default_rng(placement)
        pose = np.eye(4) if placement % 2 else random_rotation_matrix(random.random(3))
        pose[2, 3] = random.uniform(1.2, 3.6) * side
        world = vx.World(time_step=1 / rate)
        if ground == "slab":
            world.add(slab, mass=0, pose=(0, 0, -0.5 * side))
        else:
            world.add(vx.Plane(), mass=0)
        body = world.add(cube, mass=1000 * side**3, pose=pose)
        for _ in range(round((np.sqrt(0.8 * side) + 0.1) * rate)):
            world.step()
            heights = mesh.vertices @ body.pose[2, :3] + body.pose[2, 3]
            deepest = max(deepest, -heights.min())
    assert deepest <= side / 500
