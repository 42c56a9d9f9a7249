from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at


@pytest.mark.parametrize("shell", ["a", "b", "both"])
def test_a_budget_says_what_it_may_have_missed(ball: vx.Model, cube: vx.Model, shell: str):
    inexact = 0
    for height in (0.45, 0.55, 0.599, 0.7):
        pose = at(0.05, 0.02, height)
        everything = vx.contacts(ball, cube, pose, shell=shell)
        keys = list(zip(everything.shells.tolist(), everything.ids.tolist(), strict=True))
        rows_of = {key: row for row, key in enumerate(keys)}
        for budget in (1, 3, 10, 30, 100, 1_000, 2**62):
            found = vx.contacts(ball, cube, pose, shell=shell, budget=budget)
            seen = zip(found.shells.tolist(), found.ids.tolist(), strict=True)
            rows = [rows_of[key] for key in seen]
            missed = np.setdiff1d(np.arange(len(everything)), rows)
            np.testing.assert_array_equal(found.depths, everything.depths[rows])
            assert everything.depths[missed].max(initial=-np.inf) <= found.depth_bound
            if found.exact:
                assert len(missed) == 0
                assert found.depth_bound == -np.inf
            else:
                inexact += 1
                assert "perhaps not all" in repr(found)
        assert found.exact
    assert inexact >= 8


def test_no_budget_hides_what_is_deeper_than_its_bound(ball: vx.Model, box: vx.Model):
    for x in np.linspace(0.0, 0.7, 30):
        pose = at(x, 0.03, 0.01)
        for shell in ("fewest", "auto"):
            everything = vx.contacts(ball, box, pose, shell=shell)
            for budget in (1, 2, 5, 20, 100):
                found = vx.contacts(ball, box, pose, shell=shell, budget=budget)
                missed = everything.depths
                if found.shell == everything.shell:
                    keys = everything.ids * 2 + (everything.shells == "b")
                    of_found = found.ids * 2 + (found.shells == "b")
                    missed = missed[np.isin(keys, of_found, invert=True)]
                assert missed.max(initial=-np.inf) <= found.depth_bound


def count_nodes(a: vx.Model, b: vx.Model, pose: np.ndarray) -> int:
    """The least budget with which contacts are complete."""
    too_few, enough = 0, 2**20
    while enough - too_few > 1:
        middle = (too_few + enough) // 2
        if vx.contacts(a, b, pose, shell="a", budget=middle).exact:
            enough = middle
        else:
            too_few = middle
    return enough


def test_work_grows_less_than_the_points(cube: vx.Model):
    """A flat loop looks at all points: the exponent of its work is 1."""
    mesh = trimesh.creation.icosphere(4, radius=0.1)
    pose = at(0.05, 0.02, 0.5982)
    points, nodes = [], []
    for target_points in (1_000, 4_000, 16_000, 64_000):
        model = vx.Model.from_mesh(mesh, voxel_size=0.005, target_points=target_points)
        assert len(vx.contacts(model, cube, pose, shell="a")) > 0
        points.append(len(model.shell))
        nodes.append(count_nodes(model, cube, pose))
    assert nodes[-1] < points[-1] / 8 / 20, "a node is eight points"
    assert np.polyfit(np.log(points), np.log(nodes), 1)[0] < 0.7
