"""What can be done to bodies of a world: kinematic motion, forces, groups, removal; compounds."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at
from voxshell import _bullet


@pytest.mark.parametrize("plate", ["box", "model"])
def test_kinematic_body_takes_along_what_lies_on_it(brick, plate):
    slab = vx.Box((0.5, 0.5, 0.03))
    if plate == "model":
        slab = vx.Model.from_mesh(trimesh.creation.box(extents=(1, 1, 0.06)), voxel_size=0.01)
    world = vx.World()
    carrier = world.add(slab, motion="kinematic", pose=at(z=-0.03))
    parcel = world.add(brick, pose=at(z=0.031), friction=1.0)
    world.step(50)

    def push(world):
        carrier.pose = carrier.pose @ at(x=0.4 * world.time_step)

    world.step(300, before=push)
    np.testing.assert_allclose(carrier.linear_velocity, (0.4, 0, 0), atol=1e-9)
    np.testing.assert_allclose(parcel.linear_velocity, (0.4, 0, 0), atol=5e-3)
    assert parcel.pose[2, 3] == pytest.approx(0.03, abs=1e-3)
    world.step(2)
    np.testing.assert_allclose(carrier.linear_velocity, 0.0)


@pytest.mark.parametrize("rate", [120, 100, 60])
@pytest.mark.parametrize(("size", "tray"), [(0.1, 0.01), (0.1, 0.002), (0.005, 0.002)])
def test_cargo_stays_on_a_tray_that_starts_to_rise(rate, size, tray):
    """It closes on the cargo by more than the rest margin a step, and by less than CCD begins at."""
    cargoes = (
        vx.Box((size / 2, size / 2, size / 2)),
        vx.Model.from_mesh(trimesh.creation.box((size, size, size))),
    )
    for cargo in cargoes:
        world = vx.World(time_step=1 / rate)
        slab = vx.Model.from_mesh(trimesh.creation.box((4 * size, 4 * size, tray)))
        lift = world.add(slab, motion="kinematic", pose=at(z=-tray / 2))
        body = world.add(cargo, pose=at(z=size / 2))
        world.step(rate // 5)
        for step in range(1, 2 * rate):
            height = 0.05 * (1 - np.cos(2 * np.pi * step / rate))
            lift.pose = at(z=height - tray / 2)
            world.step()
            assert body.position[2] == pytest.approx(height + size / 2, abs=5e-5)


@pytest.mark.parametrize("rate", [1000, 200, 60, 30])
def test_cargo_stays_on_a_lift_that_goes_up_and_down(rate):
    world = vx.World(time_step=1 / rate)
    cube = vx.Model.from_mesh(trimesh.creation.box((0.1, 0.1, 0.1)))
    slab = vx.Model.from_mesh(trimesh.creation.box((1, 1, 0.1)))
    lift = world.add(slab, motion="kinematic", pose=at(z=-0.05))
    cargo = world.add(cube, pose=at(z=0.05))
    for step in range(1, 2 * rate):
        height = 0.2 * np.sin(5.0 * step / rate)  # falls with half of gravity at most
        lift.pose = at(z=height - 0.05)
        world.step()
        assert cargo.position[2] == pytest.approx(height + 0.05, abs=1e-4)


def ride_a_turntable(rate, fraction, drive):
    """The distance of cargo from the axis after 6 s; it begins at 0.3 m.

    The turntable comes to that fraction of the spin at which the cargo slides.
    """
    friction = 0.1
    spin = fraction * np.sqrt(friction * 9.81 / 0.3)
    world = vx.World(time_step=1 / rate)
    disk = vx.Model.from_mesh(trimesh.creation.cylinder(radius=0.5, height=0.1, sections=64))
    motion = "kinematic" if drive == "pose" else "dynamic"
    table = world.add(disk, motion=motion, mass=5.0, pose=at(z=-0.05), friction=1.0)
    block = vx.Model.from_mesh(trimesh.creation.box((0.06, 0.06, 0.02)))
    cargo = world.add(block, mass=0.5, pose=at(x=0.3, z=0.01), friction=friction)
    axle = world.add_joint(vx.HingeJoint(axis=(0, 0, 1)), None, table) if drive == "motor" else None
    angle = 0.0
    for step in range(1, 6 * rate + 1):
        now = spin * min(step / rate / 3, 1)
        angle += now / rate
        if axle is None:
            table.pose = vx.pose((0, 0, -0.05), axis_angle=((0, 0, 1), angle))
        else:
            axle.set_target_velocity(now, max_force=1e3)
        world.step()
    return np.hypot(*cargo.position[:2])


@pytest.mark.parametrize("drive", ["pose", "motor"])
@pytest.mark.parametrize("rate", [1000, 200, 60, 30])
def test_cargo_stays_on_a_turntable_up_to_the_spin_at_which_it_slides(rate, drive):
    within = 1e-5 if rate >= 200 else 1e-3
    for fraction in (0.4, 0.95):
        assert ride_a_turntable(rate, fraction, drive) == pytest.approx(0.3, abs=within)
    assert ride_a_turntable(rate, 1.05, drive) > 0.4


@pytest.mark.parametrize("rate", [1000, 200, 60, 30])
def test_a_ball_goes_round_on_a_turntable_at_two_sevenths_of_its_spin(rate):
    """A solid ball that rolls; its circle may have any center (Burns 1981)."""
    spin, distance, radius = 4.0, 0.3, 0.03
    speed = 2 / 7 * spin * distance
    world = vx.World(time_step=1 / rate)
    table = world.add(vx.Box((1, 1, 0.05)), motion="kinematic", pose=at(z=-0.05), friction=1.0)
    ball = world.add(vx.Sphere(radius), mass=0.1, pose=at(x=distance, z=radius), friction=1.0)
    ball.linear_velocity = (0, speed, 0)
    ball.angular_velocity = ((spin * distance - speed) / radius, 0, 0)
    path = [ball.position[:2]]
    for step in range(1, 5 * rate + 1):
        table.pose = vx.pose((0, 0, -0.05), axis_angle=((0, 0, 1), spin * step / rate))
        world.step()
        path.append(ball.position[:2])
    x, y = np.array(path).T
    assert np.unwrap(np.arctan2(y, x))[-1] == pytest.approx(5 * 2 / 7 * spin, rel=1e-3)
    np.testing.assert_allclose(np.hypot(x, y), distance, atol=2e-4)


@pytest.mark.parametrize("rate", [1000, 200, 60, 30])
@pytest.mark.parametrize("speed", [1.0, 20.0])
def test_a_kinematic_paddle_hits_what_it_moves_across(rate, speed):
    world = vx.World(gravity=(0, 0, 0), time_step=1 / rate)
    board = vx.Model.from_mesh(trimesh.creation.box((0.02, 0.3, 0.3)))
    paddle = world.add(board, motion="kinematic", pose=at(x=-0.1))
    ball = world.add(vx.Model.from_mesh(trimesh.creation.icosphere(4, radius=0.03)))
    for step in range(1, rate // 4):
        paddle.pose = at(x=-0.1 + speed * step / rate)
        world.step()
    np.testing.assert_allclose(ball.linear_velocity, (speed, 0, 0), atol=1e-3 * speed)


@pytest.mark.parametrize("is_new", [True, False])
def test_a_placed_kinematic_body_hits_nothing_in_between(is_new):
    world = vx.World(gravity=(0, 0, 0))
    ball = world.add(vx.Sphere(0.05))
    board = world.add(vx.Box((0.01, 0.2, 0.2)), motion="kinematic", pose=at(x=-0.3))
    if not is_new:
        board.pose = at(x=-0.2)
        world.step()
    board.place(at(x=0.3))
    np.testing.assert_array_equal(board.position, (0.3, 0, 0))
    world.step(2)
    np.testing.assert_array_equal(board.position, (0.3, 0, 0))
    np.testing.assert_array_equal(board.linear_velocity, 0.0)
    np.testing.assert_array_equal(ball.linear_velocity, 0.0)
    for step in range(30):  # moves again, at 2 m/s
        board.pose = at(x=0.29 - 0.01 * step)
        world.step()
    assert ball.linear_velocity[0] == pytest.approx(-2.0, abs=0.01)


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


def test_kinematic_velocity_is_of_the_last_pose_set(brick):
    world = vx.World()
    body = world.add(brick, motion="kinematic")
    body.pose = at(x=5.0)
    body.pose = at(x=0.01)
    world.step()
    np.testing.assert_allclose(body.linear_velocity, (0.01 * 200.0, 0, 0), atol=1e-9)
    turned = trimesh.transformations.rotation_matrix(0.01, (0, 0, 1)) @ at(x=0.01)
    body.pose = turned
    world.step()
    np.testing.assert_allclose(body.angular_velocity, (0, 0, 2.0), atol=1e-6)
    assert body.mass == 0.0


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


def test_damping_is_the_fraction_lost_in_a_second():
    world = vx.World(gravity=(0, 0, 0), sleeping=False)
    body = world.add(vx.Sphere(0.1), linear_damping=0.3)
    body.angular_damping = 0.6
    body.linear_velocity, body.angular_velocity = (1, 0, 0), (0, 1, 0)
    world.step(200)
    assert body.linear_velocity[0] == pytest.approx(0.7, rel=1e-6)
    assert body.angular_velocity[1] == pytest.approx(0.4, rel=1e-6)


def test_friction_and_restitution_can_be_set_at_any_time(brick):
    world = vx.World()
    ground = world.add(vx.Plane(), mass=0, friction=1.0, restitution=1.0)
    body = world.add(brick, pose=at(z=0.0301), friction=0.0)
    body.linear_velocity = (1, 0, 0)
    world.step(50)
    assert body.linear_velocity[0] == pytest.approx(1.0, rel=1e-3)
    body.friction = 0.5
    world.step(50)
    assert body.linear_velocity[0] < 0.1
    assert (ground.friction, body.friction, body.restitution) == (1.0, 0.5, 0.0)


@pytest.mark.parametrize("on", ["ball", "ground"])
def test_rolling_friction_stops_a_ball_at_the_rate_that_its_lever_says(on):
    radius, lever, friction = 0.1, 0.002, 0.5
    world = vx.World()
    ground = world.add(vx.Plane(), mass=0, friction=friction)
    ball = world.add(vx.Sphere(radius), pose=at(z=radius), friction=friction)
    {"ball": ball, "ground": ground}[on].rolling_friction = lever
    ball.linear_velocity, ball.angular_velocity = (0.2, 0, 0), (0, 0.2 / radius, 0)
    world.step(200)
    # The torque lever * friction * m g slows a solid ball, whose inertia about its lowest point is 7/5 m r^2.
    slowed = lever * friction * 9.81 / (1.4 * radius)
    assert ball.linear_velocity[0] == pytest.approx(0.2 - slowed, rel=0.02)
    world.step(600)
    assert ball.linear_velocity[0] == pytest.approx(0.0, abs=1e-6)


def test_spinning_friction_stops_a_ball_at_the_rate_that_its_lever_says():
    radius, lever, friction = 0.1, 0.002, 0.5
    world = vx.World()
    world.add(vx.Plane(), mass=0, friction=friction)
    ball = world.add(
        vx.Sphere(radius),
        pose=at(z=radius),
        friction=friction,
        rolling_friction=lever,
        spinning_friction=lever,
    )
    ball.angular_velocity = (0, 0, 2.0)
    world.step(50)
    # The torque lever * friction * m g slows a solid ball, whose inertia is 2/5 m r^2.
    slowed = 0.25 * lever * friction * 9.81 / (0.4 * radius**2)
    assert ball.angular_velocity[2] == pytest.approx(2.0 - slowed, rel=0.02)
    world.step(200)
    np.testing.assert_allclose(ball.angular_velocity, 0.0, atol=1e-6)
    ball.spinning_friction = 0.0
    ball.angular_velocity = (0, 0, 2.0)
    world.step(50)
    assert (ball.rolling_friction, ball.spinning_friction) == (lever, 0.0)
    assert ball.angular_velocity[2] == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize("apart", ["pair", "groups", "later", "pair from the start"])
def test_bodies_set_apart_pass_through(brick, apart):
    world = vx.World()
    ground = world.add(vx.Plane(), mass=0)
    table = world.add(brick, mass=0, pose=at(z=0.5))
    body = world.add(brick, pose=at(z=0.561), group=2 if apart == "groups" else 1)
    if apart == "groups":
        table.mask = 1
    if apart == "pair from the start":
        world.set_collision(body, table, False)
    world.step(100)
    if apart == "pair":
        assert body.pose[2, 3] > 0.55
        world.set_collision(table, body, False)
    if apart == "later":
        body.group, table.mask = 4, 3
    world.step(300)
    assert body.pose[2, 3] == pytest.approx(0.03, abs=1e-3)
    world.set_collision(ground, body, False)
    world.set_collision(ground, body, True)
    world.step(200)
    assert body.pose[2, 3] == pytest.approx(0.03, abs=1e-3)


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


def test_compound_has_the_matter_of_its_parts():
    left, right = vx.Box((0.5, 0.1, 0.1)), vx.Box((0.5, 0.1, 0.1))
    halves = vx.Compound([(left, at(x=0.2)), (right, at(x=1.2))])
    world = vx.World(gravity=(0, 0, 0))
    whole = world.add(vx.Box((1.0, 0.1, 0.1)), mass=3.0, pose=at(x=0.7, y=3.0))
    joined = world.add(halves, mass=3.0)
    for body, center in ((whole, (0.7, 3, 0)), (joined, (0.7, 0, 0))):
        body.apply_impulse((0, 0, 1.0), at=np.add(center, (0.4, 0.05, 0)))
    np.testing.assert_allclose(joined.angular_velocity, whole.angular_velocity, rtol=1e-9)
    np.testing.assert_allclose(joined.linear_velocity, whole.linear_velocity, rtol=1e-9)


@pytest.mark.parametrize("ground", ["plane", "model"])
def test_compound_of_models_and_shapes_stands_on_its_legs(brick, ground):
    """A stool: a model as its seat, and a leg of each kind."""
    legs = [vx.Cylinder(0.02, 0.2), vx.Box((0.02, 0.02, 0.1)), vx.Capsule(0.02, 0.16), brick]
    sides = [(-0.07, -0.07), (0.07, -0.07), (-0.07, 0.07), (0.07, 0.07)]
    turned = trimesh.transformations.rotation_matrix(np.pi / 2, (0, 1, 0))
    stool = vx.Compound(
        [(brick, at(z=0.03))]
        + [
            (leg, at(x, y, -0.1) @ (turned if leg is brick else np.eye(4)))
            for leg, (x, y) in zip(legs, sides, strict=True)
        ]
    )
    world = vx.World()
    floor = vx.Plane()
    if ground == "model":
        floor = vx.Model.from_mesh(trimesh.creation.box(extents=(1, 1, 0.1)), voxel_size=0.01)
    world.add(floor, mass=0, pose=at(z=-0.05 if ground == "model" else 0.0))
    body = world.add(stool, pose=at(z=0.205))
    world.step(300)
    assert body.pose[2, 3] == pytest.approx(0.2, abs=2e-3)
    assert body.pose[2, 2] > 0.999
    assert np.linalg.norm(body.angular_velocity) < 0.05


@pytest.mark.parametrize(
    ("parts", "error", "part"),
    [
        (lambda: [], vx.SettingsError, "at least one part"),
        (lambda: [vx.Sphere(1.0)], vx.InputTypeError, r"parts\[0\] must be a pair"),
        (
            lambda: [(vx.Plane(), np.eye(4))],
            vx.InputTypeError,
            r"parts\[0\] must be one of .* not Plane",
        ),
        (lambda: [(vx.Sphere(1.0), np.eye(3))], vx.PoseError, r"the pose of parts\[0\]"),
    ],
)
def test_wrong_compounds_are_refused(parts, error, part):
    with pytest.raises(error, match=part):
        vx.Compound(parts())


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
        (lambda: vx.World().remove(body), "another world"),
    ]:
        with pytest.raises(vx.SettingsError, match=part):
            act()
    with pytest.raises(vx.InputTypeError, match="must be a Body"):
        world.remove("body")


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


def test_any_number_in_any_argument_of_a_simulation_is_harmless(brick):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    for _ in range(3):
        world.add_joint(vx.HingeJoint(), None, world.add(brick))
    simulation = world._simulation
    vector, pose, motor = (0.0, 0.0, 1.0), np.eye(4), _bullet.MotorMode
    calls = {
        "pose": (), "set_pose": (pose,), "linear_velocity": (), "angular_velocity": (),
        "set_linear_velocity": (vector,), "set_angular_velocity": (vector,), "bounds": (),
        "apply_force": (vector, vector), "apply_torque": (vector,), "apply_torque_impulse": (vector,),
        "apply_impulse": (vector, None), "material": (), "set_material": (_bullet.BodyMaterial(),),
        "is_asleep": (), "wake": (), "read_joint": (), "joint_reaction": (), "motor": (),
    }  # fmt: skip
    generator = np.random.default_rng(5)
    numbers = [
        -(2**63),
        -(2**31),
        -2,
        -1,
        *range(7),
        2**31 - 1,
        2**31,
        2**63 - 1,
        2**63,
        2**64 - 1,
        2**64,
    ]
    refused = 0

    def call(function, *arguments):
        nonlocal refused
        try:
            function(*arguments)
        except (vx.SettingsError, TypeError):
            refused += 1

    def any_number() -> int:
        return numbers[generator.integers(len(numbers))]

    for _ in range(1000):
        name = str(generator.choice([*calls]))
        call(getattr(simulation, name), any_number(), *calls[name])
        call(simulation.set_collision, any_number(), any_number(), False)
        call(simulation.find_contacts, any_number(), any_number(), 0.1)
        mode = motor.FOLLOW if generator.random() < 0.5 else motor.VELOCITY
        call(
            lambda mode=mode: simulation.set_motor(
                any_number(), _bullet.Motor(mode, 0.0, 1.0, 1.0, any_number())
            )
        )
        if generator.random() < 0.1:
            call(
                lambda: simulation.add_joint(
                    _bullet.JointSettings(
                        kind=_bullet.JointKind.HINGE,
                        parent=any_number(),
                        child=any_number(),
                        parent_from_joint=pose,
                        child_from_joint=pose,
                        lower=1.0,
                        upper=-1.0,
                        friction=0.0,
                        damping=0.0,
                        collides=False,
                    )
                )
            )
        call(simulation.step, 1)
    call(simulation.remove_joint, 99)
    call(simulation.remove_body, 99)
    assert refused > 2000


def test_any_number_in_any_argument_of_a_query_is_harmless(brick):
    tree = brick.shell.tree
    near = vx.contacts(brick, brick, a_pose=at(z=0.05))
    for number in (-(2**63), -(2**31), -1, 0, 13, 31, 64, 2**31, 2**63, 2**64):
        for ask in (
            tree.spheres,
            tree.segments,
            lambda level: vx.contacts(brick, brick, level=level),
            lambda level: vx.deepest_per_segment(brick, brick, level=level),
            lambda count: vx.contacts(brick, brick, max_points=count),
            lambda count: near.manifold(count),
        ):
            try:
                ask(number)
            except vx.SettingsError:
                continue
            assert number >= 0


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
