from __future__ import annotations

import math
import time
import warnings

import numpy as np
import pytest
import trimesh
import voxshell as vx
from parts import random_rotation
from poses import at


@pytest.fixture(scope="module")
def bar():
    """0.4 m along x from its origin at one end: its mass lies elsewhere, its principal axes turned."""
    mesh = trimesh.creation.box(extents=(0.4, 0.05, 0.03))
    mesh.apply_translation((0.2, 0.0, 0.0))
    return vx.Model.from_mesh(mesh, voxel_size=0.01)


AXES = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, -2, 0.5)]


@pytest.mark.parametrize("kind", [vx.HingeJoint, vx.SliderJoint])
@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("velocity", [2.5, -2.5])
def test_motor_reaches_its_velocity_along_its_axis(bar, kind, axis, velocity):
    world = vx.World(gravity=(0, 0, 0))
    start = trimesh.transformations.rotation_matrix(0.5, (1, 1, 0))
    body = world.add(bar, pose=start)
    joint = world.add_joint(kind(axis=axis), None, body)
    joint.set_target_velocity(velocity, max_force=200.0)
    world.step(200)
    # Between steps a body has turned freely, about no principal axis by speed^2 * step aside.
    assert joint.velocity == pytest.approx(velocity, rel=2e-3)
    assert joint.position == pytest.approx(velocity, rel=0.03)
    along = start[:3, :3] @ np.array(axis) / np.linalg.norm(axis)
    if kind is vx.HingeJoint:
        np.testing.assert_allclose(body.angular_velocity, velocity * along, atol=1e-2)
        turned = trimesh.transformations.rotation_matrix(joint.position, axis)
        np.testing.assert_allclose(body.pose, start @ turned, atol=5e-3)
    else:
        np.testing.assert_allclose(body.pose[:3, 3], joint.position * along, atol=1e-3)


# A wheel whose hinge had other axes in its frame than in the chassis' was accepted, and jumped.
@pytest.mark.parametrize(
    ("kind", "turn", "off", "message"),
    [
        (vx.HingeJoint((0, 1, 0)), (math.pi / 2, 0, 0), (0, 0, 0), "90 degrees and 0 m"),
        (vx.HingeJoint((0, 1, 0)), (0, 0.7, 0), (0, 0, 0), None),
        (vx.HingeJoint((0, 1, 0)), (0, 0, 0), (0, 0.01, 0), "0 degrees and 0.01 m"),
        (vx.SliderJoint((0, 1, 0)), (0, 0, 0), (0, 0.3, 0), None),
        (vx.SliderJoint((0, 1, 0)), (0, 0, 0), (0.01, 0.3, 0), "0 degrees and 0.01 m"),
        (vx.SliderJoint((0, 1, 0)), (0, 0.5, 0), (0, 0, 0), "28.6 degrees"),
        (vx.PointJoint(), (1.0, 0.5, 0), (0, 0, 0), None),
        (vx.FixedJoint(), (0.5, 0, 0), (0, 0, 0), "28.6 degrees"),
        (vx.FixedJoint(), (0.001, 0, 0), (1e-5, 0, 0), None),
    ],
)
@pytest.mark.parametrize("is_on_world", [False, True])
def test_joints_whose_frames_do_not_coincide_warn(kind, turn, off, message, is_on_world):
    world = vx.World()
    chassis = None if is_on_world else world.add(vx.Box((0.17, 0.08, 0.025)), mass=4)
    place = np.array((0.12, 0.1, 0.0))
    wheel = world.add(vx.Cylinder(0.05, 0.03), mass=0.3, pose=vx.pose(place + off, euler=turn))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        world.add_joint(kind, chassis, wheel, parent_from_joint=vx.pose(place))
    assert [message in str(each.message) for each in caught] == ([True] if message else [])


@pytest.mark.parametrize("turns", [0.4, 2.25, -3.6])
def test_hinge_counts_turns_and_reaches_its_target(bar, turns):
    world = vx.World()
    body = world.add(bar, mass=0.5)
    hinge = world.add_joint(vx.HingeJoint(axis=(0, 1, 0)), None, body)
    target = turns * 2.0 * math.pi
    hinge.set_target_position(target, max_force=30.0, max_speed=20.0)
    positions = []
    world.step(400, lambda world: positions.append(hinge.position))
    assert np.abs(np.diff(positions)).max() < 0.2  # no jump at half turns
    assert hinge.position == pytest.approx(target, abs=1e-3)
    assert abs(hinge.velocity) < 1e-3


@pytest.mark.parametrize("kind", [vx.HingeJoint, vx.SliderJoint])
@pytest.mark.parametrize("limits", [(-0.3, 0.2), (0.0, 9.0), (-14.0, 0.1)])
@pytest.mark.parametrize("sign", [1, -1])
def test_limits_hold_against_a_motor(bar, kind, limits, sign):
    world = vx.World(gravity=(0, 0, 0))
    joint = world.add_joint(kind(axis=(0, 0, 1), limits=limits), None, world.add(bar, mass=0.2))
    joint.set_target_velocity(sign * 12.0, max_force=20.0)
    world.step(400)
    assert joint.position == pytest.approx(limits[1] if sign > 0 else limits[0], abs=2e-3)
    joint.set_target_position(sum(limits) / 2.0, max_force=50.0, max_speed=10.0)
    world.step(400)
    assert joint.position == pytest.approx(sum(limits) / 2.0, abs=2e-3)


@pytest.mark.parametrize("halves", [(-1, 1), (-2, 2), (0, 2), (-1, 3), (-3, 3)])
@pytest.mark.parametrize("sign", [1, -1])
def test_limits_of_whole_and_half_turns_hold(bar, halves, sign):
    """Where Bullet's angle wraps, the last bit decides its sign: bodies were thrown at 1000 rad/s."""
    limits = tuple(math.pi * half for half in halves)
    rng = np.random.default_rng(3)
    for _ in range(5):
        world = vx.World()
        pose = np.eye(4)
        pose[:3, :3] = random_rotation(rng)
        joint = world.add_joint(
            vx.HingeJoint(axis=(0, 0, 1), limits=limits), None, world.add(bar, pose=pose)
        )
        joint.set_target_velocity(sign * 5.0, max_force=200.0)
        fastest, farthest = [], []

        def measure(world, joint=joint, fastest=fastest, farthest=farthest):
            fastest.append(abs(joint.velocity))
            farthest.append(sign * joint.position)

        world.step(600, measure)
        assert max(fastest) < 5.1
        assert max(farthest) < sign * limits[sign > 0] + 1e-3
        assert joint.position == pytest.approx(limits[sign > 0], abs=1e-3)


@pytest.mark.parametrize("limits", [(-2.7, -0.9), (0.3, 0.3), (3.0, 3.3), (4.0, 5.0), (10.0, 11.0)])
@pytest.mark.parametrize("rate", [1000, 200, 60])
def test_a_joint_that_begins_outside_its_limits_turns_back_slowly(bar, limits, rate):
    world = vx.World(gravity=(0, 0, 0), time_step=1.0 / rate)
    joint = world.add_joint(vx.HingeJoint(axis=(0, 0, 1), limits=limits), None, world.add(bar))
    fastest = []
    world.step(12 * rate, lambda world: fastest.append(abs(joint.velocity)))
    assert max(fastest) < 1.05  # rad/s
    assert limits[0] - 1e-3 < joint.position < limits[1] + 1e-3


def test_a_slider_that_begins_outside_its_limits_slides_back_slowly(bar):
    world = vx.World(gravity=(0, 0, 0))
    joint = world.add_joint(vx.SliderJoint(axis=(0, 0, 1), limits=(0.1, 0.2)), None, world.add(bar))
    fastest = []
    world.step(600, lambda world: fastest.append(abs(joint.velocity)))
    assert max(fastest) < 0.105
    assert 0.099 < joint.position < 0.201


def test_motor_is_no_stronger_than_it_is_told(bar):
    """The bar's weight turns it by 1 kg * 9.81 * 0.2 m = 1.96 N m."""
    angles = []
    for max_force in (1.8, 2.2):
        world = vx.World()
        body = world.add(bar)
        hinge = world.add_joint(vx.HingeJoint(axis=(0, -1, 0)), None, body)
        hinge.set_target_position(0.0, max_force=max_force)
        world.step(200)
        angles.append(hinge.position)
    assert angles[0] < -0.2
    assert angles[1] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("kind", [vx.HingeJoint, vx.SliderJoint])
def test_friction_and_damping_slow_down_as_physics_says(kind):
    def speed_after_a_fifth_of_a_second(**loss):
        world = vx.World(gravity=(0, 0, 0), sleeping=False)
        body = world.add(vx.Sphere(0.5), mass=10.0)  # a moment of inertia of 1 kg m2
        joint = world.add_joint(kind(axis=(0, 0, 1), **loss), None, body)
        if kind is vx.HingeJoint:
            body.angular_velocity = (0, 0, 1)
        else:
            body.linear_velocity = (0, 0, 1)
        world.step(40)
        return joint.velocity

    resistance = 1.0 if kind is vx.HingeJoint else 10.0
    assert speed_after_a_fifth_of_a_second() == pytest.approx(1.0)
    assert speed_after_a_fifth_of_a_second(friction=2.0 * resistance) == pytest.approx(
        0.6, rel=1e-3
    )
    assert speed_after_a_fifth_of_a_second(friction=9.0 * resistance) == pytest.approx(
        0.0, abs=1e-6
    )
    assert speed_after_a_fifth_of_a_second(damping=3.0 * resistance) == pytest.approx(
        math.exp(-0.6), rel=0.01
    )


@pytest.mark.parametrize("solver", ["coulomb", "sequential_impulse"])
@pytest.mark.parametrize("rate", [1000, 200, 60])
def test_damping_acts_while_another_force_slows_the_joint(solver, rate):
    """Thrown up along a damped slider, a body stops below the apex of free flight.

    Bullet's own damper did nothing while gravity slowed the body by more than the damper would.
    """
    mass, damping, speed = 0.6, 0.5, 5.0
    world = vx.World(time_step=1.0 / rate, sleeping=False, solver=solver)
    body = world.add(vx.Sphere(0.05), mass=mass)
    world.add_joint(vx.SliderJoint(axis=(0, 0, 1), damping=damping), None, body)
    body.linear_velocity = (0, 0, speed)
    apex = 0.0
    for _ in range(rate):
        world.step()
        apex = max(apex, body.position[2])
    fall = 9.81 * mass / damping  # terminal speed
    truth = mass / damping * (speed - fall * math.log1p(speed / fall))
    free = speed**2 / (2.0 * 9.81)
    assert apex == pytest.approx(truth, abs=speed / rate)
    assert abs(apex - truth) < 0.5 * (free - truth)


@pytest.mark.parametrize("rate", [1000, 200, 30])
def test_strong_damping_lets_a_joint_creep_at_its_terminal_speed(rate):
    world = vx.World(time_step=1.0 / rate, sleeping=False)
    body = world.add(vx.Sphere(0.05), mass=0.5)
    joint = world.add_joint(vx.SliderJoint(axis=(0, 0, -1), damping=300.0), None, body)
    world.step(rate)
    assert joint.velocity == pytest.approx(0.5 * 9.81 / 300.0, rel=1e-3)


def test_friction_adds_to_damping():
    """A wheel of 1 kg m2 that 2 N m drive against friction of 0.5 N m and damping of 3 N m s."""
    world = vx.World(gravity=(0, 0, 0), time_step=0.001, sleeping=False)
    body = world.add(vx.Sphere(0.5), mass=10.0)
    joint = world.add_joint(vx.HingeJoint(axis=(0, 0, 1), friction=0.5, damping=3.0), None, body)
    world.step(3000, before=lambda world: body.apply_torque((0, 0, 2.0)))
    assert joint.velocity == pytest.approx((2.0 - 0.5) / 3.0, rel=1e-3)


def test_reaction_carries_the_weight_about_the_joint(bar):
    world = vx.World()
    body = world.add(bar, mass=2.0)
    nail = world.add_joint(vx.FixedJoint(), None, body)
    world.step(300)
    np.testing.assert_allclose(nail.reaction.force, (0, 0, 2.0 * 9.81), atol=0.02)
    # The weight at x = 0.2 m turns the bar about y by -0.2 * -19.62; the nail holds against it.
    np.testing.assert_allclose(nail.reaction.torque, (0, -0.2 * 2.0 * 9.81, 0), atol=0.02)


def test_frames_are_of_meshes_wherever_the_mass_lies(bar):
    world = vx.World()
    post = world.add(bar, mass=0, pose=trimesh.transformations.rotation_matrix(0.3, (0, 0, 1)))
    arm = world.add(bar, pose=at(z=3.0))
    hinge = world.add_joint(
        vx.HingeJoint(axis=(0, 0, 1)),
        post,
        arm,
        parent_from_joint=at(x=0.4, z=0.1),
        child_from_joint=at(x=0.05),
    )
    arm.pose = post.pose @ at(x=0.4, z=0.1) @ at(x=-0.05)
    assert hinge.position == pytest.approx(0.0, abs=1e-9)
    hinge.set_target_position(1.0, max_force=50.0)
    world.step(200)
    expected = (
        post.pose
        @ at(x=0.4, z=0.1)
        @ trimesh.transformations.rotation_matrix(1.0, (0, 0, 1))
        @ at(x=-0.05)
    )
    np.testing.assert_allclose(arm.pose, expected, atol=2e-3)


@pytest.mark.parametrize("kind", [vx.FixedJoint(), vx.PointJoint(), vx.HingeJoint(axis=(0, 1, 0))])
def test_chains_stay_together(bar, kind):
    world = vx.World(sleeping=False)
    links = [world.add(bar, pose=at(x=0.4 * i)) for i in range(5)]
    for i, link in enumerate(links):
        world.add_joint(kind, links[i - 1] if i else None, link)
    gaps, heights = [], []

    def measure(world):
        ends = [np.zeros(3), *((link.pose @ [0.4, 0, 0, 1])[:3] for link in links[:-1])]
        heights.append(links[-1].pose[2, 3])
        gaps.append(
            max(
                np.linalg.norm(link.pose[:3, 3] - end)
                for link, end in zip(links, ends, strict=True)
            )
        )

    world.step(300, measure)
    assert max(gaps) < 0.004
    if not isinstance(kind, vx.FixedJoint):
        assert min(heights) < -1.0  # it hangs and swings


def test_jointed_bodies_do_not_collide_unless_told(bar):
    def pair(**options):
        world = vx.World(gravity=(0, 0, 0))
        first = world.add(bar)
        second = world.add(bar, pose=at(x=0.02))
        joint = world.add_joint(
            vx.SliderJoint(axis=(0, 0, 1)), first, second, world_from_joint=at(), **options
        )
        world.step(2)
        return world, joint

    assert len(pair()[0].contacts()) == 0
    assert len(pair(collide=True)[0].contacts()) > 0
    world, joint = pair()
    world.remove(joint)
    world.step()
    assert len(world.contacts()) > 0


def test_what_is_removed_leaves_the_rest_as_it_was(bar):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    anchor = world.add(bar, mass=0, pose=at(z=2.0))
    held = world.add(bar, pose=at(z=2.0, x=0.4))
    other = world.add(bar, pose=at(y=1.0, z=0.02), name="other")
    first = world.add_joint(vx.HingeJoint(axis=(0, 1, 0)), anchor, held)
    second = world.add_joint(vx.HingeJoint(axis=(0, 1, 0)), None, other)
    second.follow(first, max_force=5.0)
    world.step(50)
    world.remove(anchor)
    assert world.joints == (second,)
    assert world.bodies[0].number == 0
    assert other.number == 3
    world.step(300)
    assert held.pose[2, 3] < 0.1  # it has fallen
    assert {int(c["body_a"]) for c in world.contacts()} <= {0, 2, 3}
    for gone in (lambda: anchor.pose, lambda: first.position, lambda: world.remove(first)):
        with pytest.raises(vx.SettingsError, match="removed"):
            gone()
    added = world.add(bar)
    assert added.number == 4


def test_motors_wake_their_bodies(bar):
    world = vx.World(gravity=(0, 0, 0))
    body = world.add(bar)
    hinge = world.add_joint(vx.HingeJoint(axis=(0, 0, 1)), None, body)
    world.step(500)
    assert body.sleeping
    # Slower than what Bullet takes for rest.
    hinge.set_target_velocity(0.05, max_force=5.0)
    world.step(2000)
    assert hinge.position == pytest.approx(0.5, abs=1e-2)


@pytest.mark.parametrize(
    ("make", "part"),
    [
        (lambda: vx.HingeJoint(axis=(0, 0, 0)), "axis must not be zero"),
        (lambda: vx.HingeJoint(axis=(0, 0)), r"axis must be three numbers"),
        (lambda: vx.SliderJoint(limits=(1.0, 0.0)), "the lower first, not 1 and 0"),
        (lambda: vx.SliderJoint(limits=(0.0, math.inf)), "pass None for no limits"),
        (lambda: vx.HingeJoint(friction=-1.0), "friction must be at least 0"),
        (lambda: vx.HingeJoint(damping=math.nan), "damping must be finite"),
    ],
)
def test_wrong_settings_of_a_joint(make, part):
    with pytest.raises(vx.SettingsError, match=part):
        make()


def test_wrong_uses_are_refused(bar):
    world = vx.World()
    ground = world.add(vx.Plane(), mass=0, name="ground")
    body = world.add(bar, name="bar")
    hinge = vx.HingeJoint()
    with pytest.raises(vx.SettingsError, match="both 'ground'"):
        world.add_joint(hinge, ground, ground)
    with pytest.raises(vx.SettingsError, match="the world and 'ground' cannot"):
        world.add_joint(hinge, None, ground)
    with pytest.raises(vx.SettingsError, match="another world"):
        world.add_joint(hinge, None, vx.World().add(bar))
    with pytest.raises(vx.InputTypeError, match="not str"):
        world.add_joint("hinge", None, body)
    with pytest.raises(vx.InputTypeError, match="child must be a Body"):
        world.add_joint(hinge, body, None)
    with pytest.raises(vx.PoseError, match="child_from_joint: the last row must be 0, 0, 0, 1"):
        world.add_joint(hinge, None, body, child_from_joint=2 * np.eye(4))
    with pytest.raises(vx.SettingsError, match="not both"):
        world.add_joint(hinge, None, body, child_from_joint=at(), world_from_joint=at())
    slippery = vx.World(solver="nncg")
    loose = slippery.add(bar)
    with pytest.raises(vx.SettingsError, match="'nncg' does not support joints"):
        slippery.add_joint(hinge, None, loose)
    assert world.joints == ()
    joint = world.add_joint(vx.HingeJoint(limits=(0, 1)), None, body, name="elbow")
    with pytest.raises(vx.SettingsError, match="limits of joint 'elbow', 0 to 1, not 2"):
        joint.set_target_position(2.0, max_force=1.0)
    with pytest.raises(vx.SettingsError, match="max_force must be above 0"):
        joint.set_target_velocity(2.0, max_force=0.0)
    with pytest.raises(vx.SettingsError, match="cannot follow itself"):
        joint.follow(joint, max_force=1.0)
    nail = world.add_joint(vx.FixedJoint(), None, body, name="nail")
    with pytest.raises(vx.SettingsError, match="'nail', a FixedJoint, has no axis"):
        nail.set_target_velocity(1.0, max_force=1.0)
    with pytest.raises(vx.SettingsError, match="has no axis"):
        _ = nail.position


@pytest.mark.parametrize("rate", [1000, 200, 60])
def test_boxes_that_turn_on_a_slider_do_not_fly_apart(rate):
    """Nothing touches them. At 1000 Hz they reached 5000 m/s within a second."""
    world = vx.World(gravity=(0, 0, 0), time_step=1.0 / rate, sleeping=False)
    half = (0.05, 0.04, 0.03)
    boxes = [world.add(vx.Box(half), pose=at(x=x)) for x in (0.0, 0.3)]
    world.add_joint(vx.SliderJoint(axis=(1, 0, 0)), *boxes)
    for box in boxes:
        box.angular_velocity = (0.0, 0.0, 5.0)
    boxes[1].linear_velocity = (0.0, 1.5, 0.0)
    inertia = (half[0] ** 2 + half[1] ** 2) / 3.0

    def measure() -> tuple[float, float]:
        """Energy and angular momentum about z."""
        energy = momentum = 0.0
        for box in boxes:
            velocity, spin = box.linear_velocity, float(box.angular_velocity[2])
            energy += 0.5 * float(velocity @ velocity) + 0.5 * inertia * spin**2
            momentum += float(np.cross(box.pose[:3, 3], velocity)[2]) + inertia * spin
        return energy, momentum

    before = measure()
    world.step(2 * rate)
    assert measure() == pytest.approx(before, rel=0.02)


def test_removed_joints_and_bodies_leave_nothing_behind():
    world = vx.World(gravity=(0, 0, 0))
    world.add(vx.Sphere(0.1))

    def seconds_of_steps() -> float:
        world.clear_timings()
        begin = time.perf_counter()
        world.step(2000)
        return time.perf_counter() - begin

    before = min(seconds_of_steps() for _ in range(3))
    for _ in range(20_000):
        body = world.add(vx.Sphere(0.1), pose=np.diag([1.0, 1.0, 1.0, 1.0]), group=0)
        world.remove(world.add_joint(vx.FixedJoint(), None, body))
        world.remove(body)
    assert min(seconds_of_steps() for _ in range(3)) < 3 * before
    assert world.add(vx.Sphere(0.1)).number == 20_001  # numbers are never given twice


def test_limits_in_degrees_are_doubted():
    with pytest.warns(
        vx.UnitWarning, match=r"limits: .*-90 radians are 14\.3 turns; .*radians\(-90"
    ):
        vx.HingeJoint(limits=(-90, 90))
    vx.HingeJoint(limits=(-3 * np.pi, 3 * np.pi))
    vx.SliderJoint(limits=(-90, 90))


@pytest.mark.parametrize("count", [6, 10])
def test_fingers_of_a_hand_move_alike(count):
    """With more than twenty joints, sweeps were left alone to solve them, and fingers were up to 0.49 rad apart."""
    rate = 200
    world = vx.World(1.0 / rate)
    palm = world.add(vx.Box((0.1, 0.01, 0.01)), mass=0.3)
    world.add_joint(
        vx.HingeJoint(axis=(1, 0, 0), damping=0.5), None, palm, world_from_joint=np.eye(4)
    )
    fingers = []
    for i in range(count):
        x = 0.03 * (i - count / 2)
        parent = palm
        joints = []
        for k in range(4):
            link = world.add(
                vx.Box((0.004, 0.015, 0.004)),
                mass=0.016,
                pose=(x, 0.03 + 0.035 * k, 0),
                group=2,
                mask=0,
            )
            axis = (1, 0, 0) if k < 2 else (0, 0, 1)
            joint = vx.HingeJoint(axis=axis, limits=(-0.2, 0.2), damping=0.1)
            place = vx.pose((x, 0.0125 + 0.035 * k, 0))
            joints.append(world.add_joint(joint, parent, link, world_from_joint=place))
            parent = link
        fingers.append(joints)
    world.step(rate // 5)
    angles = np.array([[joint.position for joint in joints] for joints in fingers])
    assert np.abs(angles - angles[0]).max() < 1e-5
    assert angles[0, 0] == pytest.approx(-0.08, abs=0.005)


def follow_motion(joint, world, motion, velocity):
    """Largest error after the first second, rad or m, of a joint that follows a motion for two."""
    errors = []

    def before(world):
        middle = world.time + world.time_step / 2
        joint.set_target_position(motion(world.time), max_force=1e4, velocity=velocity(middle))

    rate = round(1 / world.time_step)
    world.step(rate, before=before)
    world.step(
        rate, lambda world: errors.append(motion(world.time) - joint.position), before=before
    )
    return np.abs(errors).max()


@pytest.mark.parametrize("rate", [1000, 200, 60])
@pytest.mark.parametrize(("kind", "size"), [(vx.HingeJoint, 1.0), (vx.SliderJoint, 0.1)])
def test_targets_that_move_are_followed_without_lag(kind, size, rate):
    def make():
        world = vx.World(time_step=1 / rate, gravity=(0, 0, 0))
        body = world.add(vx.Box((0.1, 0.1, 0.1)))
        return world.add_joint(kind(axis=(0, 0, 1)), None, body), world

    def ramp(t):
        return size * t

    def wave(t):
        return size * math.sin(2 * math.pi * t)

    def speed(t):
        return 2 * math.pi * size * math.cos(2 * math.pi * t)

    lag = follow_motion(*make(), ramp, lambda t: 0.0)
    assert lag == pytest.approx(5 * size / rate, rel=1e-3)
    assert follow_motion(*make(), ramp, lambda t: size) < 1e-9
    assert follow_motion(*make(), wave, lambda t: 0.0) > 4 * 2 * math.pi * size / rate
    assert follow_motion(*make(), wave, speed) < 1e-3 * 2 * math.pi * size * (60 / rate) ** 2


def test_the_speed_limit_holds_for_the_velocity_of_a_target(bar):
    world = vx.World(gravity=(0, 0, 0))
    joint = world.add_joint(vx.HingeJoint(axis=(0, 0, 1)), None, world.add(bar))
    joint.set_target_position(1.0, max_force=1e4, max_speed=2.0, velocity=10.0)
    world.step(10)
    assert joint.velocity == pytest.approx(2.0, rel=1e-6)
    with pytest.raises(vx.SettingsError, match="velocity must be finite"):
        joint.set_target_position(1.0, max_force=1e4, velocity=math.inf)
