from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at
from voxshell.simulation.body_shapes import mesh_of


def as_trimesh(shape):
    return trimesh.Trimesh(*mesh_of(shape), process=False)


def test_hull_mesh_is_the_hull():
    points = np.random.default_rng(1).normal(size=(500, 3))
    mesh = as_trimesh(vx.ConvexHull(points))
    assert mesh.is_watertight
    assert mesh.volume > 0
    # No point is outside, but for the rounding of Bullet's hull to a grid.
    heights = np.einsum("fk,pfk->pf", mesh.face_normals, points[:, None] - mesh.triangles[:, 0])
    assert heights.max() < 2e-4 * np.ptp(points, axis=0).max()


def test_a_mesh_is_taken_for_its_vertices():
    mesh = trimesh.creation.icosphere(1)
    for points in (mesh, vx.Mesh(mesh.vertices, mesh.faces)):
        np.testing.assert_array_equal(vx.ConvexHull(points).hulls[0], mesh.vertices)
    with pytest.raises(vx.MeshError, match=r"hulls\[0\] must be \(n, 3\) numbers"):
        vx.ConvexHull("part.stl")


def test_sampled_hull_has_at_most_42_vertices_and_lies_inside():
    points = trimesh.creation.icosphere(4).vertices * (1.0, 0.5, 2.0)
    hull = vx.ConvexHull.sampled(points)
    assert 20 <= len(hull.hulls[0]) <= 42
    assert as_trimesh(hull).volume < as_trimesh(vx.ConvexHull(points)).volume


def test_decomposition_mass_is_that_of_its_parts():
    left = trimesh.creation.box(bounds=[(0, 0, 0), (1, 1, 1)])
    right = trimesh.creation.box(bounds=[(1, 0, 0), (2, 1, 3)])
    shape = vx.ConvexDecomposition([left.vertices, right.vertices])
    assert as_trimesh(shape).volume == pytest.approx(4.0)


@pytest.mark.parametrize(
    "make",
    [lambda: vx.Plane((0, 1, 0), 0.25), lambda: vx.Box((1, 2, 3)), lambda: vx.Sphere(0.5)],
)
def test_meshes_of_analytic_shapes_lie_on_their_surface(make):
    shape = make()
    mesh = as_trimesh(shape)
    assert mesh.is_watertight
    assert mesh.volume > 0
    distances = shape.sample(mesh.vertices)
    assert distances.max() == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(
    ("make", "error", "part"),
    [
        (lambda: vx.ConvexHull(np.zeros((3, 3))), vx.MeshError, "at least 4"),
        (lambda: vx.ConvexHull(np.zeros((8, 3))), vx.MeshError, "plane"),
        (lambda: vx.ConvexHull(np.eye(4)[:, :3] * np.nan), vx.MeshError, "finite"),
        (lambda: vx.ConvexHull([[1, 2]] * 5), vx.MeshError, r"\(n, 3\)"),
        (lambda: vx.ConvexDecomposition([]), vx.SettingsError, "hull"),
        (lambda: vx.GImpact(([[0, 0, 0]], np.zeros((0, 3), int))), vx.MeshError, "triangles"),
        (lambda: vx.GImpact("missing.stl"), vx.MissingFileError, "missing.stl"),
        (lambda: vx.GImpact(trimesh.creation.box(), margin=-1), vx.SettingsError, "margin"),
    ],
)
def test_wrong_shapes_are_refused(make, error, part):
    with pytest.raises(error, match=part):
        make()


@pytest.mark.parametrize("radius", [0.001, 0.005, 0.02])
def test_small_capsules_are_capsules(radius):
    length = 2 * radius
    solid = as_trimesh(vx.Capsule(radius, length))
    assert solid.is_watertight
    expected = np.pi * radius**2 * length + 4 / 3 * np.pi * radius**3
    assert solid.volume == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("rate", [1000, 200, 60])
@pytest.mark.parametrize("speed", [0.3, 3.0])
@pytest.mark.parametrize("ground", ["plane", "box"])
def test_a_box_that_glides_does_not_sink(ground, speed, rate):
    half = np.array((0.1, 0.05, 0.015))
    world = vx.World(time_step=1 / rate)
    if ground == "plane":
        world.add(vx.Plane(), mass=0, friction=0)
    else:
        world.add(vx.Box((10, 1, 0.5)), mass=0, friction=0, pose=(0, 0, -0.5))
    box = world.add(vx.Box(half), mass=1, friction=0, pose=(-4, 0, half[2]))
    box.linear_velocity = (speed, 0, 0)
    world.step(rate)
    corners = half * np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    lowest = (corners @ box.pose[:3, :3].T + box.pose[:3, 3])[:, 2].min()
    assert abs(lowest) < 2e-5
    assert box.linear_velocity[0] == pytest.approx(speed, rel=1e-3)


@pytest.mark.parametrize(
    "shape",
    [
        lambda: vx.GImpact(trimesh.creation.icosphere(2, radius=0.1)),
        lambda: vx.ConvexHull(trimesh.creation.icosphere(2, radius=0.1).vertices),
        lambda: vx.ConvexDecomposition(
            [
                trimesh.creation.box(bounds=[(-0.1, -0.1, -0.1), (0, 0.1, 0.1)]).vertices,
                trimesh.creation.box(bounds=[(0, -0.1, -0.1), (0.1, 0.1, 0.1)]).vertices,
            ]
        ),
    ],
)
def test_comparison_shapes_fall_and_stay_on_a_plane(shape):
    world = vx.World(split_impulse_threshold=-0.04)
    world.add(vx.Plane(), mass=0)
    body = world.add(shape(), pose=at(z=0.15))
    world.step(300)
    # Bullet's margin holds them off by a millimeter.
    assert body.pose[2, 3] == pytest.approx(0.1, abs=2e-3)


def test_comparison_shapes_meet_models(brick):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    world.add(brick, mass=0, pose=at(z=0.03))
    hull = world.add(
        vx.ConvexHull(trimesh.creation.box(extents=[0.05] * 3).vertices), pose=at(z=0.1)
    )
    world.step(300)
    assert hull.pose[2, 3] == pytest.approx(0.06 + 0.025, abs=3e-3)
