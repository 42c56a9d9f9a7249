"""What can be done to bodies of a world: placing, forces, removal, wrong uses; how shapes stand."""

from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from poses import at


def test_a_placed_body_is_at_rest_and_wakes_what_it_lay_under():
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    lower = world.add(vx.Box((0.1, 0.1, 0.1)), pose=at(z=0.1))
    upper = world.add(vx.Box((0.1, 0.1, 0.1)), pose=at(z=0.3))
    world.step(800)
    assert lower.sleeping
    assert upper.sleeping
    lower.place(at(x=2.0, z=0.5))
    np.testing.assert_array_equal(lower.linear_velocity, 0.0)
    world.step(200)
    assert lower.position[2] == pytest.approx(0.1, abs=1e-3)
    assert upper.position[2] == pytest.approx(0.1, abs=1e-3)
    with pytest.raises(vx.PoseError):
        lower.place(np.zeros((4, 4)))


def test_a_lever_is_as_long_as_it_is(brick):
    world = vx.World(gravity=(0, 0, 0))
    inertia = brick.mass_properties(2.0).inertia
    body = world.add(brick, mass=2.0, pose=at(x=1.0))
    body.apply_impulse((0, 3.0, 0), at=(1.1, 0, 0))
    np.testing.assert_allclose(body.linear_velocity, (0, 1.5, 0))
    np.testing.assert_allclose(body.angular_velocity, (0, 0, 0.1 * 3.0 / inertia[2, 2]), atol=1e-9)
    pushed = world.add(brick, mass=2.0, pose=at(x=3.0))
    pushed.apply_force((0, 3.0, 0), at=(3.1, 0, 0))
    world.step(2)  # it acts in the first alone
    np.testing.assert_allclose(pushed.linear_velocity, (0, 1.5 / 200.0, 0))
    np.testing.assert_allclose(
        pushed.angular_velocity, (0, 0, 0.1 * 3.0 / 200.0 / inertia[2, 2]), atol=1e-9
    )
    spun = world.add(brick, mass=2.0, pose=at(x=5.0))
    spun.apply_torque((0, 0, 1.0))
    world.step()
    spun.apply_torque_impulse((0, 0, -1.0 / 200.0))
    np.testing.assert_allclose(spun.angular_velocity, 0.0, atol=1e-12)


def test_what_lay_on_a_removed_body_falls(brick):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    table = world.add(brick, mass=0, pose=at(z=0.5))
    body = world.add(brick, pose=at(z=0.5601))
    world.step(500)
    assert body.sleeping
    world.remove(table)
    world.step(200)
    assert body.pose[2, 3] < 0.1
    assert world.bodies == (world.bodies[0], body)


def test_recorders_keep_removed_bodies_where_they_were(brick):
    world = vx.World()
    kept, gone = world.add(brick), world.add(brick, pose=at(x=1.0), name="gone")
    recorder = world.record()
    world.step(5)
    last = gone.pose
    world.remove(gone)
    world.step(5)
    tracks = {track.name: track for track in recorder.recording().bodies}
    np.testing.assert_array_equal(tracks["gone"].poses[5:], [last] * 6)
    assert (tracks["body 0"].poses[-1] == kept.pose).all()


def test_callbacks_run_before_and_after_each_step(brick):
    world = vx.World()
    body = world.add(brick)
    seen = []
    world.step(
        2,
        lambda world: seen.append(("after", body.pose[2, 3])),
        before=lambda world: seen.append(("before", body.pose[2, 3])),
    )
    assert [when for when, _ in seen] == ["before", "after"] * 2
    assert seen[0][1] > seen[1][1] == seen[2][1] > seen[3][1]


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0), (1, 0, 2)])
def test_boxes_stand_as_they_are_put(order):
    """Their axes were those of inertia, sorted, and the box was not."""
    half = np.array([0.1, 0.2, 0.3])[list(order)]
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    body = world.add(vx.Box(half), pose=at(z=half[2] + 0.001))
    world.step(200)
    assert body.pose[2, 3] == pytest.approx(half[2], abs=1e-3)
    np.testing.assert_allclose(body.bounds, [[*-half[:2], 0], [*half[:2], 2 * half[2]]], atol=5e-3)


ROUND = {
    "capsule": (lambda: vx.Capsule(0.05, 0.2), 0.15),
    "cylinder": (lambda: vx.Cylinder(0.05, 0.2), 0.1),
    "cone": (lambda: vx.Cone(0.05, 0.2), 0.1),
}


@pytest.mark.parametrize("kind", ROUND)
@pytest.mark.parametrize("ground", ["box", "model"])
def test_round_shapes_stand_along_z(brick, kind, ground):
    make, height = ROUND[kind]
    world = vx.World()
    world.add(brick if ground == "model" else vx.Box((0.1, 0.05, 0.03)), mass=0, pose=at(z=-0.03))
    body = world.add(make(), pose=at(z=height + 0.001))
    world.step(20)
    assert body.pose[2, 3] == pytest.approx(height, abs=3e-3)
    assert len(world.contacts()) > 0


def test_wrong_uses_of_bodies_are_refused(brick):
    world = vx.World()
    still = world.add(brick, mass=0, name="still")
    driven = world.add(brick, motion="kinematic", name="driven")
    body = world.add(brick)
    for act, part in [
        (lambda: still.apply_force((1, 0, 0)), "'still' is static"),
        (lambda: driven.apply_impulse((1, 0, 0)), "'driven' is kinematic: set its pose"),
        (lambda: setattr(driven, "linear_velocity", (1, 0, 0)), "kinematic"),
        (lambda: body.apply_force((1, 0)), "force must be"),
        (lambda: body.apply_force((1, 0, 0), at=(1, 0, np.nan)), "at must be finite"),
        (lambda: setattr(body, "friction", -1), "friction must be at least 0"),
        (lambda: setattr(body, "linear_damping", 2), "linear_damping must be from 0 to 1"),
        (lambda: setattr(body, "group", -1), "group must be at least 0"),
        (lambda: world.set_collision(body, body, False), "both 'body 2'"),
        (lambda: world.add(brick, motion="flying"), "'dynamic', 'static' or 'kinematic'"),
        (lambda: world.add(brick, mass=0, motion="dynamic"), "a dynamic body needs a mass above 0"),
        (lambda: world.add(vx.Plane(), motion="kinematic"), "a plane is unbounded"),
        (lambda: world.add(vx.Plane(), motion="dynamic"), "a plane is unbounded"),
        (lambda: world.add(vx.Plane(), mass=1), "leave out mass and motion"),
        (lambda: vx.World().remove(body), "another world"),
    ]:
        with pytest.raises(vx.SettingsError, match=part):
            act()
    with pytest.raises(vx.InputTypeError, match="must be a Body"):
        world.remove("body")


def test_a_plane_is_static_without_being_told():
    ground = vx.World().add(vx.Plane())
    assert (ground.motion, ground.mass) == ("static", 0.0)


@pytest.mark.parametrize(
    "name", ["number", "shape", "mass", "motion", "center_of_mass", "inertia", "kinetic_energy"]
)
def test_what_a_body_is_cannot_be_set(brick, name):
    body = vx.World().add(brick)
    with pytest.raises(AttributeError):
        setattr(body, name, getattr(body, name))


@pytest.mark.parametrize("name", ["kind", "parent", "child"])
def test_what_a_joint_is_cannot_be_set(brick, name):
    world = vx.World()
    joint = world.add_joint(vx.HingeJoint(), None, world.add(brick))
    with pytest.raises(AttributeError):
        setattr(joint, name, getattr(joint, name))


@pytest.mark.parametrize("rate", [200, 60])
@pytest.mark.parametrize("side", [0.005, 0.02, 0.05])
def test_a_box_shape_that_falls_on_a_plane_shape_lies_on_it(side, rate):
    world = vx.World(time_step=1 / rate)
    world.add(vx.Plane(), mass=0)
    pose = np.eye(4)
    pose[2, 3] = 2 * side
    box = world.add(vx.Box((side / 2,) * 3), pose=pose, mass=0.01)
    world.step(2 * rate)
    assert box.pose[2, 3] == pytest.approx(side / 2, abs=1e-4)


def test_the_place_of_a_force_needs_no_name():
    balls = [vx.World(gravity=(0, 0, 0)).add(vx.Sphere(0.1)) for _ in range(2)]
    balls[0].apply_impulse((1, 0, 0), (0, 0, 0.1))
    balls[1].apply_impulse((1, 0, 0), at=(0, 0, 0.1))
    assert balls[0].angular_velocity.tolist() == balls[1].angular_velocity.tolist()
    assert balls[0].angular_velocity[1] > 1.0
