"""Center of mass, inertia and kinetic energy of bodies."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at

TURNED = vx.pose((0.3, -0.2, 0.5), axis_angle=((1, 2, 3), 0.8))


def test_matter_of_a_body_is_in_the_world_frame():
    """A rod along x with its mass in one half, turned a quarter about z and moved."""
    center, moments = np.array([0.2, 0.0, 0.0]), np.diag([0.1, 0.2, 0.25])
    rod = vx.MassProperties(2.0, center, moments)
    world = vx.World(gravity=(0, 0, 0))
    quarter = vx.pose((1, 2, 3), axis_angle=((0, 0, 1), np.pi / 2))
    body = world.add(vx.Box((0.5, 0.1, 0.1)), inertia=rod, pose=quarter)
    np.testing.assert_allclose(body.center_of_mass, (1, 2.2, 3), atol=1e-12)
    np.testing.assert_allclose(body.inertia, np.diag([0.2, 0.1, 0.25]), atol=1e-12)
    body.pose = TURNED
    turn = TURNED[:3, :3]
    np.testing.assert_allclose(body.center_of_mass, (TURNED @ [0.2, 0, 0, 1])[:3], atol=1e-12)
    np.testing.assert_allclose(body.inertia, turn @ moments @ turn.T, atol=1e-12)


@pytest.mark.parametrize("kind", ["box", "cylinder", "sphere", "brick"])
def test_inertia_is_that_of_the_closed_form(brick, kind):
    mass = 1.7
    made, moments = {
        "box": (vx.Box((0.1, 0.2, 0.3)), np.array([0.52, 0.4, 0.2]) / 12),
        "cylinder": (
            vx.Cylinder(0.1, 0.6),
            np.array([0.03 + 0.36, 0.03 + 0.36, 0.06]) / 12,
        ),
        "sphere": (vx.Sphere(0.1), np.full(3, 0.4 * 0.01)),
        "brick": (brick, np.array([0.0136, 0.0436, 0.05]) / 12),
    }[kind]
    body = vx.World().add(made, mass=mass, pose=TURNED)
    turn = TURNED[:3, :3]
    found, exact = turn.T @ body.inertia @ turn, mass * np.diag(moments)
    np.testing.assert_allclose(found, exact, atol=2e-3 * exact.max())
    np.testing.assert_allclose(body.center_of_mass, TURNED[:3, 3], atol=1e-6)


def test_inertia_and_energy_are_those_that_bullet_moves_bodies_with():
    """An angular impulse changes the spin by the inverse of the inertia, and work becomes energy."""
    axes = vx.pose(axis_angle=((2, -1, 1), 0.7))[:3, :3]
    tensor = axes @ np.diag([0.1, 0.2, 0.25]) @ axes.T
    matter = vx.MassProperties(2.0, np.array([0.1, -0.2, 0.3]), tensor)
    world = vx.World(gravity=(0, 0, 0))
    body = world.add(vx.Box((0.1, 0.1, 0.1)), inertia=matter, pose=TURNED)
    assert body.kinetic_energy == 0.0
    angular = np.array((0.03, -0.02, 0.05))
    body.apply_torque_impulse(angular)
    np.testing.assert_allclose(body.inertia @ body.angular_velocity, angular, atol=1e-12)
    assert body.kinetic_energy == pytest.approx(0.5 * angular @ body.angular_velocity)
    impulse = np.array((0.3, 0.1, -0.2))
    body.apply_impulse(impulse)
    linear = impulse @ impulse / (2 * 2.0)
    energy = 0.5 * angular @ body.angular_velocity + linear
    assert body.kinetic_energy == pytest.approx(energy)
    world.step(200)
    assert body.kinetic_energy == pytest.approx(energy, rel=1e-6)
    np.testing.assert_allclose(body.inertia @ body.angular_velocity, angular, rtol=1e-4)
    # Its origin goes around the center of mass, whose way is straight.
    start = (TURNED @ [0.1, -0.2, 0.3, 1])[:3]
    np.testing.assert_allclose(body.center_of_mass, start + impulse / 2.0, atol=1e-6)


def test_a_fall_turns_height_into_kinetic_energy():
    world = vx.World()
    body = world.add(vx.Sphere(0.1), mass=2.0)
    world.step(200)
    assert body.kinetic_energy == pytest.approx(2.0 * 9.81 * -body.center_of_mass[2], rel=0.01)


@pytest.mark.parametrize("motion", ["static", "kinematic"])
def test_bodies_that_forces_do_not_move_have_no_matter(motion):
    world = vx.World()
    body = world.add(vx.Box((0.1, 0.1, 0.1)), motion=motion, pose=(1, 2, 3))
    if motion == "kinematic":
        body.position = (1, 2, 4)
        world.step()
        assert body.linear_velocity[2] > 0.0
    np.testing.assert_array_equal(body.center_of_mass, body.position)
    np.testing.assert_array_equal(body.inertia, np.zeros((3, 3)))
    assert body.kinetic_energy == 0.0


@pytest.mark.parametrize("name", ["center_of_mass", "inertia", "kinetic_energy"])
def test_the_matter_of_a_removed_body_is_refused(brick, name):
    world = vx.World()
    body = world.add(brick, name="gone")
    value = getattr(body, name)
    if isinstance(value, np.ndarray):
        assert not value.flags.writeable
    world.remove(body)
    with pytest.raises(vx.SettingsError, match="'gone' has been removed"):
        getattr(body, name)


def test_given_mass_properties_have_their_mass_unless_another_is_given():
    world = vx.World(gravity=(0, 0, 0))
    own = vx.MassProperties(5.0, np.zeros(3), np.diag([0.02, 0.02, 0.03]))
    box = vx.Box((0.1, 0.1, 0.1))
    for place, mass, spin in ((0, None, 1.0), (5, 5.0, 1.0), (10, 10.0, 0.5)):
        body = world.add(box, mass=mass, inertia=own, pose=at(x=place))
        assert body.mass == (mass or 5.0)
        body.apply_torque_impulse((0, 0, 0.03))
        assert body.angular_velocity[2] == pytest.approx(spin)
    assert world.add(box, pose=at(x=15)).mass == 1.0
    assert world.add(box, inertia=own, motion="static", pose=at(x=20)).mass == 0.0


@pytest.mark.parametrize(
    ("mass", "center", "tensor", "message"),
    [
        (
            1.0,
            np.zeros(3),
            np.diag([1.0, 1.0, 2.001]),
            "triangle inequality: its largest principal moment, 2.001 kg m2, exceeds",
        ),
        (1.0, np.zeros(3), np.array([[2.0, 1, 0], [0, 2, 0], [0, 0, 2]]), "finite, symmetric and"),
        (1.0, np.zeros(3), np.diag([1.0, 1.0, np.nan]), "finite, symmetric and"),
        (1.0, np.zeros(3), np.zeros((3, 3)), "positive definite"),
        (1.0, (0.0, np.nan, 0.0), np.eye(3), r"inertia\.center_of_mass must be finite"),
        (0.0, np.zeros(3), np.eye(3), r"inertia\.mass must be above 0"),
    ],
)
def test_mass_properties_of_no_body_are_refused(mass, center, tensor, message):
    world = vx.World()
    with pytest.raises(vx.SettingsError, match=message):
        world.add(vx.Sphere(0.1), inertia=vx.MassProperties(mass, center, tensor))
    assert len(world.bodies) == 0


def test_a_flat_body_has_the_largest_moment_that_there_is():
    disk = vx.MassProperties(1.0, np.zeros(3), np.diag([0.1, 0.2, 0.1 + 0.2]))
    assert vx.World().add(vx.Sphere(0.1), inertia=disk).mass == 1.0


def test_given_mass_properties_put_the_mass_elsewhere():
    world = vx.World(gravity=(0, 0, 0))
    matter = vx.MassProperties(1.0, np.array([0.0, 0.0, 0.2]), np.diag([0.1, 0.2, 0.3]))
    body = world.add(vx.Box((0.1, 0.1, 0.3)), inertia=matter)
    body.angular_velocity = (1, 0, 0)
    world.step(100)
    np.testing.assert_allclose((body.pose @ [0, 0, 0.2, 1])[:3], (0, 0, 0.2), atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(body.pose[:3, 3] - (0, 0, 0.2)), 0.2, atol=1e-6)


def test_origin_is_the_mesh_origin_wherever_the_mass_lies():
    offset = np.array([0.3, -0.2, 0.5])
    mesh = trimesh.creation.box(extents=(0.2, 0.1, 0.06))
    mesh.apply_translation(offset)
    model = vx.Model.from_mesh(mesh, voxel_size=0.005)
    world = vx.World(gravity=(0, 0, 0))
    turned = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3))
    body = world.add(model, pose=turned)
    np.testing.assert_allclose(body.pose, turned, atol=1e-12)
    body.angular_velocity = (0, 0, 3.0)
    center = (turned @ [*offset, 1])[:3]
    world.step(100)
    # Free rotation moves the origin, but not the center of mass.
    np.testing.assert_allclose((body.pose @ [*offset, 1])[:3], center, atol=1e-6)
    assert np.linalg.norm(body.pose[:3, 3] - turned[:3, 3]) > 0.1


def test_inertia_kinds_and_given_mass_properties(brick):
    def spin(**inertia):
        """Angular speed about x, after a while, of a free body spun about a skew axis."""
        world = vx.World(gravity=(0, 0, 0), sleeping=False)
        body = world.add(brick, mass=3.0, **inertia)
        body.angular_velocity = (5.0, 4.0, 3.0)
        world.step(40)
        return body.angular_velocity

    solid, surface = spin(inertia="solid"), spin(inertia="surface")
    assert not np.allclose(solid, surface, atol=1e-3)
    given = spin(inertia=brick.mass_properties(7.0, "solid"))
    np.testing.assert_allclose(given, solid, atol=1e-9)
