"""Heavy loads, firm grips, calm towers and moving surfaces, in worlds at default settings."""

from __future__ import annotations

import itertools
from functools import cache

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at
from voxshell_studies.everyday.runs import run_stage
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.machines import _chain, _chain_length, _gripper, _true_chain

G = 9.81  # m/s2
RATES = (200.0, 60.0, 30.0)
BRICK = (0.12, 0.08, 0.04)


@cache
def build_box(*size: float) -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.box(extents=size))


@pytest.fixture(scope="module")
def brick():
    return build_box(*BRICK)


def stack(brick, masses, rate):
    """Bricks of these masses on a plane, from below."""
    world = vx.World(time_step=1.0 / rate)
    world.add(vx.Plane(), mass=0)
    bodies = [
        world.add(brick, mass=mass, pose=at(z=(i + 0.5) * BRICK[2]), friction=0.7)
        for i, mass in enumerate(masses)
    ]
    return world, bodies


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("masses", [(1.0, 100.0), (1.0, 1000.0), (1.0, 1.0, 1000.0), (1000.0, 1.0)])
def test_bricks_hold_a_thousand_times_their_mass(brick, masses, rate):
    """Ten iterations squeeze a brick of 1 kg out below 100 kg."""
    world, bodies = stack(brick, masses, rate)
    starts = [body.pose for body in bodies]
    world.step(round(2.0 * rate))
    for body, start in zip(bodies, starts, strict=True):
        assert np.linalg.norm(body.pose[:3, 3] - start[:3, 3]) < 2e-4


@pytest.mark.parametrize(("count", "rate"), [(5, 60.0), (5, 30.0), (8, 200.0)])
def test_towers_are_calm(brick, count, rate):
    """With fifty iterations five bricks rock at 60 mm/s at 60 Hz."""
    world, bodies = stack(brick, [0.5] * count, rate)
    fastest = 0.0
    world.step(round(rate))
    for _ in range(round(rate)):
        world.step()
        fastest = max(fastest, *(float(np.linalg.norm(b.linear_velocity)) for b in bodies))
    assert fastest < 1e-3


@pytest.mark.parametrize(
    ("rate", "speed"), [(200.0, 2.75), (100.0, 1.75), (60.0, 1.5), (60.0, 3.0), (30.0, 2.75)]
)
def test_a_stack_that_falls_off_an_edge_gains_no_energy(rate, speed):
    """Solves that ended early drove each other apart: bodies left at 60 m/s to 30,000 km/s."""
    size, mass = (0.19, 0.19, 0.15), 3.0
    box, slab = build_box(*size), build_box(0.8, 0.6, 0.07)
    world = vx.World(time_step=1.0 / rate)
    world.add(slab, mass=0, friction=0.4, pose=at(z=0.035))
    world.add(vx.Plane(offset=-1.5), mass=0)
    bodies = []
    for x, y, z in itertools.product((-0.2, 0.0), (-0.1, 0.1), (0.145, 0.295)):
        pose = at(x, 0.0, z)
        pose[1, 3] = y
        bodies.append(world.add(box, mass=mass, pose=pose, friction=1.0))
        bodies[-1].linear_velocity = (-speed, 0.0, 0.0)
    inertia = mass / 12.0 * (np.square(size).sum() - np.square(size))

    def energy():
        total = 0.0
        for body in bodies:
            velocity = body.linear_velocity
            spin = body.pose[:3, :3].T @ body.angular_velocity
            total += mass * (velocity @ velocity / 2.0 + G * body.pose[2, 3])
            total += inertia @ spin**2 / 2.0
        return total

    before = energy()
    allowed = 1e-3 * len(bodies) * mass * speed**2 / 2.0
    for _ in range(round(1.2 * rate)):
        world.step()
        after = energy()
        assert after < before + allowed
        before = after


@pytest.mark.parametrize("rate", [1000.0, *RATES])
def test_a_gripper_holds_a_mug_at_every_rate(rate):
    """With fifty iterations the mug slips by 26 mm at 200 Hz and falls at 60 Hz."""
    track = run_stage(_gripper(0, 20.0, forms.mug()), "voxshell", rate, 2.0)
    assert abs(track.path("body")[-1, 2]) < 5e-5


@pytest.mark.parametrize(
    ("load", "rate"), [(10.0, 30.0), (20.0, 60.0), (50.0, 200.0), (50.0, 60.0), (50.0, 30.0)]
)
def test_chains_of_light_links_stay_closed(load, rate):
    """Sweeps between rounds of Newton's method open them within a second."""
    track = run_stage(_chain(0, load), "voxshell", rate, 2.0)
    assert _chain_length(track) == pytest.approx(_true_chain(track), rel=0.002)


@pytest.mark.parametrize("rate", [1000.0, 200.0, 60.0])
@pytest.mark.parametrize("kind", ["model", "box"])
@pytest.mark.parametrize("gravity", [0.0, G])
def test_a_motor_pushes_against_a_brake(kind, rate, gravity):
    """Rounding errors counted as rebounds where nothing falls: islands kept to ten sweeps."""
    world = vx.World(time_step=1.0 / rate, gravity=(0, 0, -gravity))
    shape = build_box(0.05, 0.05, 0.05) if kind == "model" else vx.Box((0.025, 0.025, 0.025))
    pushing = world.add(shape, mass=0.1, friction=0.3)
    pushed = world.add(shape, mass=1.0, friction=0.3, pose=at(0.0505))
    motor = world.add_joint(vx.SliderJoint(axis=(1, 0, 0)), None, pushing)
    world.add_joint(vx.SliderJoint(axis=(1, 0, 0), friction=100.0), None, pushed)
    motor.set_target_velocity(0.1, max_force=500.0)
    world.step(round(0.5 * rate))
    assert motor.velocity == pytest.approx(0.1, rel=1e-3)
    assert pushing.pose[0, 3] == pytest.approx(0.05, abs=0.1 / rate)
    force = sum(contact["impulse"] for contact in world.contacts()) * rate
    assert force == pytest.approx(100.0, rel=1e-3)


def test_given_iterations_are_all_that_is_done(brick):
    """Two iterations do not carry 100 kg on 1 kg."""
    world = vx.World(time_step=1.0 / 60.0, iterations=2)
    world.add(vx.Plane(), mass=0)
    for i, mass in enumerate((1.0, 100.0)):
        world.add(brick, mass=mass, pose=at(z=(i + 0.5) * BRICK[2]))
    world.step(60)
    assert (
        np.abs([body.pose[2, 3] for body in world.bodies[1:]] - np.array([0.02, 0.06])).max() > 1e-3
    )


def carry(rate, velocity, friction, seconds, yaw=0.0):
    """A cube on a belt that is turned by `yaw`: speeds along the belt after each step, m/s."""
    world = vx.World(time_step=1.0 / rate)
    way = trimesh.transformations.rotation_matrix(yaw, (0, 0, 1))
    belt, cube = build_box(3.0, 0.4, 0.05), build_box(0.1, 0.1, 0.1)
    world.add(
        belt,
        motion="kinematic",
        pose=way @ at(z=-0.025),
        friction=1.0,
        surface_velocity=(velocity, 0.0, 0.0),
    )
    body = world.add(cube, pose=way @ at(-1.0, 0.0, 0.05), friction=friction)
    speeds = []
    for _ in range(round(seconds * rate)):
        world.step()
        speeds.append(float(way[:3, 0] @ body.linear_velocity))
    return world, body, np.array(speeds)


@pytest.mark.parametrize("yaw", [0.0, 0.7])
@pytest.mark.parametrize("rate", [1000.0, *RATES])
def test_a_box_on_a_belt_reaches_its_speed_after_v_over_mu_g(rate, yaw):
    """Friction accelerates it with mu g until it has the belt's speed."""
    velocity, friction = 0.5, 0.2
    _, _, speeds = carry(rate, velocity, friction, 0.6, yaw)
    times = np.arange(1, len(speeds) + 1) / rate
    expected = np.minimum(friction * G * times, velocity)
    assert np.abs(speeds - expected).max() < 0.02 * velocity
    assert np.abs(speeds[-1] - velocity) < 1e-3 * velocity


def test_a_slow_belt_takes_along_what_rests_on_it():
    """Where a resting body would be held in its place."""
    _, _, speeds = carry(1000.0, 0.001, 0.5, 0.3)
    assert np.abs(speeds[-100:] - 0.001).max() < 2e-5


def test_surface_velocities_are_saved_with_states():
    world, body, _ = carry(200.0, 0.5, 0.2, 0.05)
    belt = world.bodies[0]
    state = world.save_state()
    world.step(40)
    first = body.pose
    belt.surface_velocity = (0.0, 0.0, 0.0)
    world.restore_state(state)
    assert belt.surface_velocity.tolist() == [0.5, 0.0, 0.0]
    world.step(40)
    assert (body.pose == first).all()


def test_a_belt_that_stops_stops_what_it_carries():
    world, body, _ = carry(200.0, 0.5, 0.5, 0.5)
    world.bodies[0].surface_velocity = (0.0, 0.0, 0.0)
    world.step(100)
    assert np.linalg.norm(body.linear_velocity) < 1e-3


@pytest.mark.parametrize(
    ("world", "body", "message"),
    [
        ({}, {"mass": 1.0}, "kinematic"),
        ({}, {"mass": 0.0}, "kinematic"),
        ({"solver": "sequential_impulse"}, {"motion": "kinematic"}, "solver='coulomb'"),
        ({"friction_directions": 1}, {"motion": "kinematic"}, "friction_directions=2"),
        ({}, {"motion": "kinematic", "surface_velocity": (np.nan, 0, 0)}, "surface_velocity"),
    ],
)
def test_surface_velocities_that_cannot_be_are_refused(world, body, message):
    with pytest.raises(vx.SettingsError, match=message):
        vx.World(**world).add(vx.Sphere(0.1), **{"surface_velocity": (1, 0, 0), **body})


@pytest.mark.parametrize("limits", [None, (-0.1, 0.1)])
def test_a_light_link_between_heavy_bodies_gains_no_energy_without_gravity(limits):
    """Far limits counted as aims of 160 rad/s, so that the solver took 3 m/s for solved."""
    world = vx.World(gravity=(0, 0, 0), time_step=0.001, sleeping=False)
    first = world.add(vx.Box((0.05, 0.05, 0.05)), mass=7.0, pose=(0.25, 0, 0.5))
    link = world.add(vx.Sphere(0.04), mass=0.01, pose=(-0.25, 0.25, 0.25))
    last = world.add(vx.Box((0.05, 0.05, 0.05)), mass=5.0, pose=(-0.25, 0.25, 0.5))
    hinge = vx.HingeJoint(axis=(0.0, -0.76, -0.92), limits=limits, friction=0.1)
    world.add_joint(hinge, first, link)
    world.add_joint(vx.PointJoint(), link, last)
    first.linear_velocity = (0.5, 1.2, 2.7)
    last.linear_velocity = (-2.4, 1.0, -2.3)
    first.angular_velocity = (-1.9, 5.0, 0.0)

    def energy():
        spins = [b.angular_velocity for b in (first, last)]
        inertia = [2.0 / 3.0 * b.mass * 0.05**2 for b in (first, last)]
        straight = sum(b.mass * (b.linear_velocity**2).sum() for b in (first, link, last))
        return 0.5 * (straight + sum(i * (w**2).sum() for i, w in zip(inertia, spins, strict=True)))

    world.step(1)
    energies = []
    world.step(1000, lambda world: energies.append(energy()))
    assert max(energies) < 1.001 * energies[0]


@pytest.mark.parametrize("rate", [60.0, 120.0])
def test_a_light_chain_under_a_heavy_body_gains_no_energy(rate):
    """Its links swing faster than steps follow, and joints that closed at any speed drove them."""
    gravity = np.array([1.0, 2.0, -20.0])
    world = vx.World(time_step=1.0 / rate, gravity=tuple(gravity))
    first = world.add(vx.Box((0.08, 0.08, 0.02)), mass=0.012, pose=(-0.25, 0, 0))
    second = world.add(vx.Box((0.06, 0.06, 0.005)), mass=0.019, pose=(0, 0.25, 0.25))
    heavy = world.add(vx.Box((0.03, 0.03, 0.04)), mass=35.0, pose=(0, 0, 0.5))
    first.linear_velocity = (-2.6, -5.7, 0.2)
    second.linear_velocity = (-2.9, -2.0, -2.5)
    heavy.angular_velocity = (-6.1, 0.5, 10.6)
    world.add_joint(vx.PointJoint(), None, first)
    world.add_joint(vx.HingeJoint(axis=(1.75, 0.35, 0.77), friction=0.1), first, second)
    world.add_joint(vx.FixedJoint(), second, heavy)

    def energy(_world=None):
        """Without that of turning, which only adds to it."""
        return sum(
            b.mass * (0.5 * b.linear_velocity @ b.linear_velocity - gravity @ b.position)
            for b in world.bodies
        )

    start = energy() + 0.5 * 35.0 * (0.05 * 12.3) ** 2  # and at most this much
    energies = []
    world.step(round(2 * rate), lambda world: energies.append(energy()))
    assert max(energies) < start + 1.0


@pytest.mark.parametrize("count", [13, 20])
def test_towers_of_rings_are_calm(count):
    """Above twelve bodies, sweeps alone left them shaking by centimeters a second, at 50 ms a step."""
    ring = vx.Model.from_mesh(
        trimesh.creation.torus(0.04, 0.015, major_sections=64, minor_sections=32)
    )
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    rings = [world.add(ring, mass=0.2, pose=(0, 0, 0.0151 + 0.03 * k)) for k in range(count)]
    world.step(300)
    assert max(np.linalg.norm(body.linear_velocity) for body in rings) < 2e-3
    for k, body in enumerate(rings):
        assert body.position[2] == pytest.approx(0.015 + 0.03 * k, abs=5e-5)


def test_a_wall_of_bricks_is_calm():
    """Sweeps alone left 68 bricks moving by up to 19 mm/s, and the wall crept."""
    whole, half = build_box(0.1, 0.05, 0.04), build_box(0.05, 0.05, 0.04)
    world = vx.World()
    world.add(vx.Plane())
    bricks = []
    for layer in range(8):
        is_odd = layer % 2
        z = 0.02 + 0.04 * layer
        for x in 0.1001 * (np.arange(8 - is_odd) + 0.5 * is_odd):
            bricks.append(world.add(whole, mass=1, pose=(x, 0, z)))
        for x in (-0.025, 0.7257) if is_odd else ():
            bricks.append(world.add(half, mass=0.5, pose=(x, 0, z)))
    before = np.array([brick.position for brick in bricks])
    world.step(1)
    fastest = 0.0
    for _ in range(100):
        world.step()
        fastest = max(fastest, *(np.linalg.norm(brick.linear_velocity) for brick in bricks))
    assert fastest < 2e-3
    after = np.array([brick.position for brick in bricks])
    assert np.linalg.norm(after - before, axis=1).max() < 1e-5


def build_ground(kind):
    world_shape = {
        "plane": vx.Plane,
        "box": lambda: vx.Box((1, 1, 0.05)),
        "model": lambda: build_box(2, 2, 0.1),
    }[kind]()
    return world_shape, (0, 0, 0 if kind == "plane" else -0.05)


DOOR_SHAPES = {"model": lambda: build_box(0.8, 0.04, 2.0), "box": lambda: vx.Box((0.4, 0.02, 1.0))}


def open_door(door, ground, rate, gap):
    """A door on a hinge that moves in no other direction, after a second in which its motor turns it by 0.96."""
    world = vx.World(1.0 / rate)
    shape, pose = build_ground(ground)
    floor = world.add(shape, motion="static", pose=pose)
    body = world.add(DOOR_SHAPES[door](), mass=20.0, pose=(0.4, 0, 1.0 + gap))
    hinge = world.add_joint(vx.HingeJoint(axis=(0, 0, 1)), None, body, world_from_joint=np.eye(4))
    hinge.set_target_velocity(1.0, max_force=60.0)
    world.step(round(rate))
    return hinge.position, world.contacts(body, floor)["impulse"].sum() * rate


@pytest.mark.parametrize("rate", [200.0, 60.0])
@pytest.mark.parametrize("ground", ["plane", "box", "model"])
def test_a_door_turns_just_above_the_ground(ground, rate):
    """The ground pressed it with 1.5 times its weight, and it stood still."""
    angle, force = open_door("model", ground, rate, 2e-5)
    assert angle == pytest.approx(0.96, abs=0.03)
    assert force < 20.0


@pytest.mark.parametrize("rate", [1000.0, 200.0, 60.0, 30.0])
@pytest.mark.parametrize("ground", ["plane", "box", "model"])
@pytest.mark.parametrize("door", ["model", "box"])
def test_a_door_turns_flush_with_the_ground(door, ground, rate):
    """Hinge and ground pressed it against each other by more in each step, until it stood still."""
    angle, _ = open_door(door, ground, rate, 0.0)
    assert angle == pytest.approx(0.96, abs=0.03)


@pytest.mark.parametrize("rate", [1000.0, 200.0, 60.0, 30.0])
def test_a_door_in_the_ground_is_pressed_by_a_spring(rate):
    """By a tenth of a millimeter, at which the ground pressed it with up to 300 MN."""
    _, force = open_door("model", "plane", rate, -1e-4)
    assert force < 1e4


@pytest.mark.parametrize("rate", [1000.0, 200.0, 60.0])
@pytest.mark.parametrize(("plate", "table"), [("model", "model"), ("model", "box"), ("box", "box")])
def test_a_slider_moves_a_plate_that_lies_flush(plate, table, rate):
    """The table pressed a plate and its load with 100 times their weight, and they stood still."""
    turned = vx.pose(axis_angle=((0, 0, 1), 0.63))
    shapes = {"model": build_box(0.2, 0.15, 0.02), "box": vx.Box((0.1, 0.075, 0.01))}
    world = vx.World(1.0 / rate)
    shape, pose = build_ground(table)
    world.add(shape, motion="static", pose=turned @ vx.pose(pose))
    body = world.add(shapes[plate], mass=0.1, pose=turned @ vx.pose((0, 0, 0.01)))
    world.add(build_box(0.15, 0.1, 0.03), mass=0.5, pose=turned @ vx.pose((0, 0, 0.035)))
    joint = world.add_joint(vx.SliderJoint(axis=(1, 0, 0)), None, body)
    joint.set_target_velocity(0.1, max_force=100.0)
    world.step(round(rate))
    assert joint.position == pytest.approx(0.1, rel=0.02)


@pytest.mark.parametrize(
    ("table", "rate"),
    [(table, rate) for table in ("plane", "box", "model") for rate in (1000.0, 200.0, 60.0)]
    + [("model", 30.0)],
)
def test_fingers_that_touch_the_table_close(table, rate):
    """They stuck to the table that their tips were flush with."""
    world = vx.World(1.0 / rate)
    shape, pose = build_ground(table)
    world.add(shape, motion="static", pose=pose)
    part = world.add(build_box(0.04, 0.03, 0.01), mass=0.05, pose=(0, 0, 0.005), friction=0.9)
    palm = world.add(vx.Box((0.06, 0.02, 0.01)), motion="kinematic", pose=(0, 0, 0.1))
    fingers = []
    for side in (-1, 1):
        finger = world.add(
            build_box(0.01, 0.02, 0.06), mass=0.1, pose=(0.04 * side, 0, 0.03), friction=0.9
        )
        slider = vx.SliderJoint(axis=(-side, 0, 0), limits=(0, 0.04), damping=10.0)
        fingers.append(world.add_joint(slider, palm, finger))
        fingers[-1].set_target_position(0.04, max_force=5.0, max_speed=0.1)
    world.step(round(0.8 * rate))
    for finger in fingers:
        assert finger.position == pytest.approx(0.015, abs=5e-5)
    for step in range(round(rate)):
        palm.position = (0, 0, 0.1 + 0.1 * (step + 1) / rate)
        world.step()
    assert part.position[2] == pytest.approx(0.105, abs=2e-4)
