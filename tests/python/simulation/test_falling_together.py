"""Bodies that fall side by side or one above the other, at default settings.

While they fall they do not move as each other sees it. The lower one lands within a step, and the upper one must
not go on into it.
"""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import voxshell as vx
from poses import at
from trimesh.creation import box


@pytest.mark.parametrize(
    ("rate", "height", "gap"),
    [(1000, 2.0, 0.003), (200, 1.0, 0.010), (200, 2.0, 0.010), (60, 0.5, 0.05), (30, 0.1, 0.01)],
)
def test_the_upper_of_two_plates_lands_on_the_lower_one(rate, height, gap):
    plate = vx.Model.from_mesh(box((0.1, 0.1, 0.02)))
    world = vx.World(time_step=1 / rate)
    world.add(vx.Plane(), mass=0)
    lower = world.add(plate, pose=at(0, 0, height + 0.01))
    upper = world.add(plate, pose=at(0, 0, height + 0.03 + gap))
    world.step(2 * rate)
    assert lower.pose[2, 3] == pytest.approx(0.010, abs=1e-4)
    assert upper.pose[2, 3] == pytest.approx(0.030, abs=1e-4)


@pytest.mark.parametrize("rate", [200, 60])
def test_no_two_of_a_grid_of_cubes_end_in_one_place(rate):
    cube = vx.Model.from_mesh(box((0.05, 0.05, 0.05)))
    world = vx.World(time_step=1 / rate)
    world.add(vx.Plane(), mass=0)
    cubes = [
        world.add(cube, pose=at(0.06 * x, 0.06 * y, 0.225 + 0.06 * z))
        for x, y, z in itertools.product(range(2), range(2), range(3))
    ]
    world.step(rate)
    for a, b in itertools.combinations(cubes, 2):
        assert np.linalg.norm(a.pose[:3, 3] - b.pose[:3, 3]) > 0.049
