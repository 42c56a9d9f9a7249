from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at


@pytest.fixture(scope="module")
def ring_mesh():
    return trimesh.creation.torus(0.1, 0.03)


@pytest.fixture(scope="module")
def ring(ring_mesh):
    return vx.Model.from_mesh(ring_mesh, voxel_size=0.005)


def meet_triangles(mesh, starts, ends):
    """Fraction and normal of the first triangle that each ray meets (Moeller and Trumbore 1997)."""
    corner, along, aside = mesh.triangles[:, 0], *np.diff(mesh.triangles, axis=1).swapaxes(0, 1)
    aside = along + aside
    nearest, normals = np.full(len(starts), np.inf), np.zeros((len(starts), 3))
    for i, (start, way) in enumerate(zip(starts, ends - starts, strict=True)):
        across = np.cross(way, aside)
        scale = np.sum(across * along, axis=1)
        to_start = start - corner
        u = np.sum(to_start * across, axis=1) / scale
        turned = np.cross(to_start, along)
        v = turned @ way / scale
        fraction = np.sum(turned * aside, axis=1) / scale
        inside = (u >= 0) & (v >= 0) & (u + v <= 1) & (fraction >= 0) & (fraction <= 1)
        if inside.any():
            first = np.flatnonzero(inside)[fraction[inside].argmin()]
            nearest[i], normals[i] = fraction[first], mesh.face_normals[first]
    return nearest, normals


def test_rays_agree_with_the_mesh(ring, ring_mesh):
    random = np.random.default_rng(1)
    pose = trimesh.transformations.rotation_matrix(0.8, (1, 2, 3)) @ at(0.02, 0.01, 0.03)
    world = vx.World()
    body = world.add(ring, pose=pose)
    starts = random.normal(size=(500, 3))
    starts *= 0.4 / np.linalg.norm(starts, axis=1, keepdims=True)
    ends = -starts + random.normal(size=(500, 3)) * 0.05
    hits = world.ray_cast(starts, ends)
    nearest, normals = meet_triangles(ring_mesh.copy().apply_transform(pose), starts, ends)
    found = hits["body"] == body.number
    assert 100 < found.sum() < 450
    # A ray through an edge may be told either way.
    assert (found != (nearest <= 1.0)).sum() <= 1
    both = found & (nearest <= 1.0)
    np.testing.assert_allclose(hits["fraction"][both], nearest[both], atol=1e-6)
    np.testing.assert_allclose(
        hits["point"][both], (starts + nearest[:, None] * (ends - starts))[both], atol=1e-6
    )
    assert (np.sum(hits["normal"] * normals, axis=1)[both] > 0.999).mean() > 0.99
    assert (hits["body"][~found] == -1).all()
    np.testing.assert_array_equal(hits["point"][~found], ends[~found])


RAYED = {
    "plane": (lambda: vx.Plane(), 0.0),
    "box": (lambda: vx.Box((1, 1, 0.5)), 0.5),
    "sphere": (lambda: vx.Sphere(0.3), 0.3),
    "capsule": (lambda: vx.Capsule(0.1, 0.2), 0.2),
    "cylinder": (lambda: vx.Cylinder(0.1, 0.2), 0.1),
    "cone": (lambda: vx.Cone(0.1, 0.2), 0.1),
    "hull": (lambda: vx.ConvexHull(trimesh.creation.box().vertices), 0.5),
    "gimpact": (lambda: vx.GImpact(trimesh.creation.box()), 0.5),
    "compound": (
        lambda: vx.Compound([(vx.Sphere(0.1), at(z=0.4)), (vx.Box((1, 1, 0.1)), at())]),
        0.5,
    ),
}
"""How each is made, and where a ray from above meets it."""


@pytest.mark.parametrize("kind", RAYED)
def test_rays_meet_every_shape(kind):
    make, top = RAYED[kind]
    world = vx.World()
    body = world.add(make(), mass=0)
    hit = world.ray_cast((1e-3, 1e-3, 2.0), (1e-3, 1e-3, -2.0))[0]
    assert hit["body"] == body.number
    assert hit["point"][2] == pytest.approx(top, abs=3e-3)
    assert hit["normal"][2] > 0.4


def test_rays_see_bodies_where_they_are_now(ring):
    world = vx.World(gravity=(0, 0, 0))
    body = world.add(vx.Sphere(0.1))
    body.linear_velocity = (100.0, 0, 0)
    world.step(1)
    assert body.pose[0, 3] == pytest.approx(0.5)
    hits = world.ray_cast([(0.5, 0, 1), (0, 0, 1)], [(0.5, 0, -1), (0, 0, -1)])
    assert hits["body"].tolist() == [0, -1]
    world.remove(body)
    assert world.ray_cast((0.5, 0, 1), (0.5, 0, -1))["body"].tolist() == [-1]


def test_a_rings_hole_is_a_hole(ring):
    world = vx.World()
    through = world.add(ring)
    needle = world.add(vx.Capsule(0.02, 0.5))
    assert not world.overlaps(through, needle)
    needle.pose = at(x=0.06)
    assert world.overlaps(through, needle)
    contacts = world.query_contacts(through, needle)
    assert contacts["depth"].max() == pytest.approx(0.01, abs=1e-3)
    assert set(contacts["body_a"]) | set(contacts["body_b"]) == {0, 1}


def test_queries_with_a_margin_tell_the_distance(ring):
    world = vx.World()
    ground = world.add(vx.Plane(), mass=0)
    body = world.add(ring, pose=at(z=0.05))
    far = world.add(vx.Sphere(0.1), pose=at(x=3.0, z=2.0))
    assert len(world.query_contacts(body)) == 0
    assert not world.overlaps(body, ground)
    near = world.query_contacts(body, margin=0.03)
    assert near["depth"].max() == pytest.approx(-0.02, abs=1e-3)
    assert far.number not in near["body_a"]
    assert far.number not in near["body_b"]
    assert (np.abs(near["normal"][:, 2]) > 0.9).all()
    np.testing.assert_allclose(
        near["point_a"] - near["point_b"], -near["depth"][:, None] * near["normal"], atol=1e-5
    )


def test_query_finds_what_is_kept_apart(ring):
    world = vx.World()
    first, second = world.add(ring), world.add(ring, group=0)
    world.set_collision(first, second, False)
    assert world.overlaps(first, second)
    world.step()
    assert len(world.contacts()) == 0


def test_contacts_of_a_body_are_those_of_the_world_with_it_as_body_a():
    world = vx.World()
    ground = world.add(vx.Plane(), mass=0)
    boxes = [world.add(vx.Box((0.1, 0.1, 0.1)), pose=at(z=0.1 + 0.2 * i)) for i in range(3)]
    apart = world.add(vx.Sphere(0.1), pose=at(x=2.0, z=0.1))
    in_the_air = world.add(vx.Sphere(0.1), pose=at(z=30.0))
    world.step(100)
    everything = world.contacts()
    weight = 9.81
    loads = {ground: -4 * weight, boxes[0]: weight, boxes[1]: weight, apart: weight}
    for body, load in loads.items():
        own = world.contacts(body)
        of_it = (everything["body_a"] == body.number) | (everything["body_b"] == body.number)
        assert len(own) == of_it.sum() > 0
        assert (own["body_a"] == body.number).all()
        np.testing.assert_array_equal(own["impulse"], everything["impulse"][of_it])
        force = own["impulse"] / world.time_step @ own["normal"]
        np.testing.assert_allclose(force, (0, 0, load), atol=0.05)
        np.testing.assert_allclose(
            own["point_a"] - own["point_b"], -own["depth"][:, None] * own["normal"], atol=1e-5
        )
    between = world.contacts(boxes[0], boxes[1])
    assert set(between["body_b"]) == {boxes[1].number}
    assert (between["normal"][:, 2] < -0.99).all()
    back = world.contacts(boxes[1], boxes[0])
    np.testing.assert_array_equal(back["normal"], -between["normal"])
    np.testing.assert_array_equal(back["point_a"], between["point_b"])
    assert len(world.contacts(in_the_air)) == len(world.contacts(ground, boxes[1])) == 0
    assert world.contacts(in_the_air).dtype == everything.dtype


def test_a_body_that_is_asked_is_body_a(ring):
    world = vx.World()
    bodies = [world.add(ring), world.add(vx.Box((0.1, 0.1, 0.1))), world.add(vx.Plane(), mass=0)]
    for body in bodies:
        found = world.query_contacts(body)
        assert (found["body_a"] == body.number).all()
        assert set(found["body_b"]) == {it.number for it in bodies if it is not body}
        np.testing.assert_allclose(
            found["point_a"] - found["point_b"],
            -found["depth"][:, None] * found["normal"],
            atol=1e-5,
        )


def test_queries_leave_the_simulation_as_it_is(ring):
    def fall(asks):
        world = vx.World()
        world.add(vx.Plane(), mass=0)
        for i in range(3):
            world.add(ring, pose=at(x=0.03 * i, z=0.1 + 0.1 * i))

        def ask(world):
            for body in world.bodies:
                world.query_contacts(body, margin=0.02)
                _ = body.bounds
            world.ray_cast([(0, 0, 1), (0.1, 0, 1)], [(0, 0, -1), (0.1, 0, -1)])

        world.step(200, ask if asks else None)
        return b"".join(body.pose.tobytes() for body in world.bodies)

    assert fall(asks=True) == fall(asks=False)


def test_bounds_hold_the_mesh_tightly(ring, ring_mesh):
    pose = trimesh.transformations.rotation_matrix(1.0, (3, 2, 1)) @ at(0.3, 0.2, 0.1)
    body = vx.World().add(ring, pose=pose)
    exact = ring_mesh.copy().apply_transform(pose).bounds
    assert (body.bounds[0] <= exact[0]).all()
    assert (body.bounds[1] >= exact[1]).all()
    assert (body.bounds[1] - body.bounds[0] < 1.7 * (exact[1] - exact[0])).all()


def test_wrong_queries_are_refused(ring):
    world = vx.World()
    body = world.add(ring)
    with pytest.raises(vx.SettingsError, match=r"same shape, not \(3,\) and \(2, 3\)"):
        world.ray_cast((0, 0, 0), [(0, 0, 1), (0, 0, 2)])
    with pytest.raises(vx.SettingsError, match="ends must be finite"):
        world.ray_cast((0, 0, 0), (0, 0, np.inf))
    with pytest.raises(vx.SettingsError, match=r"ends must be within 1e\+15 m .*, not 1e\+100"):
        world.ray_cast((0, 0, 0), (0, 0, -1e100))
    with pytest.raises(vx.SettingsError, match="starts must be"):  # raised numpy's ValueError
        world.ray_cast([0, [0, 0]], (0, 0, 1))
    with pytest.raises(
        vx.SettingsError, match=r"starts must be \(n, 3\) .* one ray, not \[0, 1\]$"
    ):
        world.ray_cast((0, 1), (0, 0, 1))
    with pytest.raises(
        vx.SettingsError, match=r"ends must be .* not an array of shape \(1, 1, 3\)"
    ):
        world.ray_cast((0, 0, 1), [[(0, 0, 1)]])
    with pytest.raises(vx.SettingsError, match="margin must be at least 0"):
        world.query_contacts(body, margin=-1.0)
    with pytest.raises(vx.InputTypeError, match="b must be a Body, not Model"):
        world.overlaps(body, ring)
    with pytest.raises(vx.InputTypeError, match="a must be a Body, not int"):
        world.contacts(body.number)
    with pytest.raises(vx.SettingsError, match="b is given without a"):
        world.contacts(b=body)
    for ask in (world.contacts, world.query_contacts, world.overlaps):
        # Bullet found contacts of a body with itself.
        with pytest.raises(vx.SettingsError, match="a and b are both 'body 0'"):
            ask(body, body)
    world.remove(body)
    with pytest.raises(vx.SettingsError, match="'body 0' has been removed"):
        world.contacts(body)


CUBE = trimesh.creation.box(extents=(0.2, 0.2, 0.2))


@cache
def build_cube() -> vx.Model:
    return vx.Model.from_mesh(CUBE, voxel_size=0.01)


CUBES = {
    "model": build_cube,
    "box": lambda: vx.Box((0.1, 0.1, 0.1)),
    "cylinder": lambda: vx.Cylinder(0.1, 0.2),
    "capsule": lambda: vx.Capsule(0.1, 0.1),
    "cone": lambda: vx.Cone(0.15, 0.2),
    "sphere": lambda: vx.Sphere(0.1),
    "hull": lambda: vx.ConvexHull(CUBE.vertices),
    "gimpact": lambda: vx.GImpact(CUBE),
    "compound": lambda: vx.Compound(
        [(vx.Box((0.05, 0.1, 0.1)), at(x=0.05)), (vx.Box((0.05, 0.1, 0.1)), at(x=-0.05))]
    ),
    "compound of models": lambda: vx.Compound([(build_cube(), at()), (vx.Sphere(0.05), at())]),
}


@pytest.mark.parametrize("kind", CUBES)
@pytest.mark.parametrize("other", CUBES)
def test_every_pair_of_shapes_can_be_asked(kind, other):
    world = vx.World()
    ground = world.add(vx.Plane(), mass=0, pose=at(z=-1.0))
    first = world.add(CUBES[kind]())
    second = world.add(CUBES[other](), pose=at(x=0.11, z=0.01))
    if other == "gimpact":
        with pytest.raises(vx.SettingsError, match="'body 2', a GImpact, with 'body 0', a Plane"):
            world.overlaps(second, ground)
        if kind == "gimpact":
            with pytest.raises(vx.SettingsError, match="a GImpact, outside of a step"):
                world.overlaps(first, second)
            return
    assert world.overlaps(first, second)
    assert world.overlaps(second, first)
    second.pose = at(x=0.4)
    assert not world.overlaps(first, second)
    assert not world.overlaps(second, first)
    second.pose = at(z=-0.95)
    if "gimpact" not in (kind, other):
        assert world.overlaps(second, ground)
        assert not world.overlaps(first, ground)


def test_a_robot_is_no_body_and_the_error_says_where_its_bodies_are(tmp_path: Path):
    (tmp_path / "ball.urdf").write_text(
        '<robot name="ball"><link name="a"><collision><geometry><sphere radius="0.1"/></geometry>'
        "</collision></link></robot>"
    )
    world = vx.World()
    robot = vx.load_urdf(world, tmp_path / "ball.urdf")
    with pytest.raises(
        vx.InputTypeError, match=r"not Robot; pass one of its bodies, which robot\.bod"
    ):
        world.contacts(robot)  # pyright: ignore[reportArgumentType]
    assert len(world.contacts(robot.bodies[0])) == 0


@pytest.mark.parametrize("solver", ["coulomb", "sequential_impulse"])
@pytest.mark.parametrize("directions", [1, 2])
def test_contacts_tell_the_whole_force_on_a_body_at_rest(solver, directions):
    slope = np.radians(20.0)
    world = vx.World(solver=solver, friction_directions=directions, sleeping=False)
    world.add(vx.Plane(), pose=vx.pose((0, 0, 0), euler=(0, slope, 0)), friction=1.0)
    box = world.add(
        vx.Box((0.1, 0.1, 0.1)),
        mass=2.0,
        pose=vx.pose(0.1 * np.array((np.sin(slope), 0, np.cos(slope))), euler=(0, slope, 0)),
    )
    world.step(200)
    contacts = world.contacts(box)
    impulses = contacts["impulse"][:, None] * contacts["normal"] + contacts["friction"]
    np.testing.assert_allclose(
        impulses.sum(axis=0) / world.time_step, (0, 0, 2.0 * 9.81), atol=0.02 * 9.81
    )
    np.testing.assert_allclose(
        np.einsum("ij,ij->i", contacts["friction"], contacts["normal"]), 0.0, atol=1e-9
    )


@pytest.mark.parametrize("rate", [1000.0, 200.0, 60.0])
@pytest.mark.parametrize("restitution", [0.0, 0.8])
def test_impulses_of_contacts_are_what_bodies_gain(rate, restitution):
    """Of bodies that land, rebound, slide and turn, in every step."""
    world = vx.World(1.0 / rate, sleeping=False)
    world.add(vx.Plane(), friction=0.7, restitution=1.0)
    ring = trimesh.creation.annulus(0.02, 0.04, 0.02)
    shapes = (vx.Model.from_mesh(ring), vx.Sphere(0.03), vx.Box((0.03, 0.02, 0.02)), ring)
    bodies = [
        world.add(
            shape,
            mass=0.3,
            pose=vx.pose((0.05 * i - 0.1, 0.01 * i, 0.06 + 0.05 * i), euler=(0.4 * i, 0.3, 0)),
            friction=0.7,
            restitution=restitution,
        )
        for i, shape in enumerate(shapes)
    ]
    for body in bodies:
        body.linear_velocity = (0.5, 0.2, -1.0)
    for _ in range(round(0.5 * rate)):
        before = [body.linear_velocity for body in bodies]
        world.step()
        for body, velocity in zip(bodies, before, strict=True):
            contacts = world.contacts(body)
            impulses = contacts["impulse"][:, None] * contacts["normal"] + contacts["friction"]
            gained = body.mass * (body.linear_velocity - velocity - world.gravity / rate)
            np.testing.assert_allclose(impulses.sum(axis=0), gained, atol=2e-3 * body.mass)


THIN = 0.001  # m, the radius of rods, or half of their sides
RODS = {
    "capsule": vx.Capsule(THIN, 0.4),
    "cylinder": vx.Cylinder(THIN, 0.4),
    "cone": vx.Cone(2 * THIN, 0.4),
    "bar": vx.Box((2 * THIN, 2 * THIN, 0.4)),
    "hull": vx.ConvexHull(trimesh.creation.cylinder(THIN, 0.4, sections=6).vertices),
}


@pytest.mark.parametrize("name", RODS)
def test_rods_that_pierce_a_cube_through_its_faces_overlap_it(name):
    random = np.random.default_rng(0)
    world = vx.World(gravity=(0, 0, 0))
    cube = world.add(vx.Model.from_mesh(trimesh.creation.box((0.1, 0.1, 0.1))), mass=0)
    rod = world.add(RODS[name], mass=1.0)
    for _ in range(50):
        place = (*random.uniform(-0.045, 0.045, 2), 0.0)
        rod.pose = vx.pose(place, euler=(*random.uniform(-0.05, 0.05, 2), 0.0))
        assert world.overlaps(rod, cube)
        deepest = world.query_contacts(rod, cube)["depth"].max()
        assert deepest <= 0.05 + 2 * THIN
        rod.pose = vx.pose((0.0531, *place[:2]), euler=(0, 0, random.uniform(0, 1)))
        assert not world.overlaps(rod, cube)
