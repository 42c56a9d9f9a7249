"""Bodies come to rest where they lie: on planes, boxes, models and each other."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at

GROUNDS = {
    "plane": lambda: vx.Plane(),
    "box": lambda: vx.Box((0.5, 0.5, 0.1)),
    "model": lambda: vx.Model.from_mesh(
        trimesh.creation.box(extents=(1.0, 1.0, 0.2)), voxel_size=0.01
    ),
}


def top(kind):
    return at(z=0.0 if kind == "plane" else -0.1)


@pytest.mark.parametrize("kind", GROUNDS)
@pytest.mark.parametrize("contact", ["auto", "regular", "segmented"])
def test_brick_comes_to_rest_on_its_flat_side(brick, kind, contact):
    world = vx.World(contact=contact, sleeping=False)
    world.add(GROUNDS[kind](), mass=0, pose=top(kind))
    body = world.add(brick, pose=at(z=0.08))
    world.step(600)
    assert body.pose[2, 3] == pytest.approx(0.03, abs=2e-4)
    assert body.pose[2, 2] == pytest.approx(1.0, abs=1e-4)
    assert np.linalg.norm(body.linear_velocity) < 1e-3
    assert np.linalg.norm(body.angular_velocity) < 1e-2


def test_brick_on_brick(brick):
    world = vx.World(sleeping=False)
    world.add(vx.Plane(), mass=0)
    lower = world.add(brick, pose=at(z=0.031))
    upper = world.add(brick, pose=at(z=0.093))
    world.step(400)
    assert lower.pose[2, 3] == pytest.approx(0.03, abs=3e-4)
    assert upper.pose[2, 3] == pytest.approx(0.09, abs=6e-4)


def test_analytic_sphere_rests_on_a_model():
    ground = GROUNDS["model"]()
    world = vx.World(sleeping=False)
    world.add(ground, mass=0, pose=top("model"))
    body = world.add(vx.Sphere(0.1), pose=at(z=0.12))
    world.step(300)
    # The ground's points are 1 cm apart: the sphere sinks between them by less than a millimeter.
    assert body.pose[2, 3] == pytest.approx(0.1, abs=1e-3)


SOLVERS = ["sequential_impulse", "nncg", "dantzig", "projected_gauss_seidel"]


@pytest.mark.parametrize("kind", GROUNDS)
@pytest.mark.parametrize("solver", SOLVERS)
def test_bunny_comes_to_rest_with_every_solver(fine_bunny, solver, kind):
    upright = trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0))
    start = upright.copy()
    start[2, 3] = 0.05 - fine_bunny.bounds[0, 1]
    world = vx.World(solver=solver, sleeping=False)
    world.add(GROUNDS[kind](), mass=0, pose=top(kind), friction=1.0)
    body = world.add(fine_bunny, pose=start, friction=0.8)
    inertia = fine_bunny.mass_properties(1.0)
    energies = []

    def height_of_mass(pose):
        return (pose @ [*inertia.center_of_mass, 1.0])[2]

    def note(world):
        rotation = body.pose[:3, :3]
        height = height_of_mass(body.pose)
        spin = rotation.T @ body.angular_velocity
        energies.append(
            9.81 * height
            + 0.5 * body.linear_velocity @ body.linear_velocity
            + 0.5 * spin @ inertia.inertia @ spin
        )
        assert world.contacts()["depth"].max(initial=0.0) < 0.004  # two voxels
        assert height > 0.02

    world.step(1200, callback=note)
    assert max(energies) < 1.001 * 9.81 * height_of_mass(start)
    resting = body.pose
    world.step(400)
    assert np.linalg.norm(body.angular_velocity) < 0.05
    assert np.linalg.norm(body.pose[:3, 3] - resting[:3, 3]) < 2e-4


@pytest.mark.parametrize("contact", ["auto", "regular"])
def test_bricks_stacked_flush_lie_still(contact):
    """Places along the rims had no depth and normals aside: 9 mrad/s in "auto", 3 rad/s in "regular"."""
    brick = vx.Model.from_mesh(trimesh.creation.box(extents=(0.2, 0.1, 0.06)))
    ground = vx.Model.from_mesh(trimesh.creation.box(extents=(0.8, 0.8, 0.1)))
    world = vx.World(contact=contact, time_step=1 / 240, sleeping=False)
    world.add(ground, mass=0, pose=at(z=-0.05))
    bricks = [world.add(brick, pose=at(z=0.0301 + 0.0601 * i)) for i in range(5)]
    world.step(480)
    for i, body in enumerate(bricks):
        assert np.linalg.norm(body.angular_velocity) < 2e-4
        assert abs(body.pose[2, 3] - (0.03 + 0.06 * i)) < 2e-5


def test_more_iterations_carry_a_heavier_stack_and_as_many_as_needed_do_best(brick):
    def sag(**settings):
        world = vx.World(sleeping=False, **settings)
        world.add(vx.Plane(), mass=0)
        bricks = [world.add(brick, mass=3.0**i, pose=at(z=0.0301 + 0.0601 * i)) for i in range(5)]
        deepest = 0.0
        for _ in range(200):
            world.step()
            deepest = max(deepest, world.contacts()["depth"].max(initial=0.0))
        assert len(bricks) == 5
        return deepest

    assert sag(iterations=200) < 0.5 * sag(iterations=50)
    assert sag() < 0.1 * sag(iterations=200)
