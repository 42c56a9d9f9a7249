"""After restoring a state the same steps give the same bits."""

from __future__ import annotations

import hashlib
import pickle
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at


@pytest.fixture(scope="module")
def ring():
    return vx.Model.from_mesh(trimesh.creation.torus(0.08, 0.025), voxel_size=0.005)


def heap(ring, brick):
    """Rings fall into a heap, some asleep by the time of the state."""
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    world.add(brick, mass=0, pose=at(z=0.03))
    for i in range(5):
        turned = trimesh.transformations.rotation_matrix(0.4 * i, (1, 2, 3))
        turned[:3, 3] = 0.03 * i, -0.02 * i, 0.15 + 0.12 * i
        world.add(ring, mass=0.3, pose=turned)
    world.add(brick, mass=0.5, pose=at(x=1.0, z=0.0301))  # asleep soon, far away
    return world, None


@cache
def make_flush_brick():
    """By tolerance, as models are by default."""
    return vx.Model.from_mesh(trimesh.creation.box(extents=(0.2, 0.1, 0.06)))


def stack(ring, brick):
    world = vx.World(contact="regular")
    world.add(vx.Plane(), mass=0)
    for i in range(3):
        world.add(make_flush_brick(), pose=at(z=0.0301 + 0.0601 * i), restitution=0.2)
    return world, None


def own_shapes(ring, brick):
    """Bullet's own algorithms, which collect points over steps."""
    world = vx.World()
    world.add(vx.Box((1, 1, 0.1)), mass=0, pose=at(z=-0.1))
    hull = vx.ConvexHull(trimesh.creation.icosphere(1, radius=0.1).vertices)
    for i in range(3):
        world.add(hull, pose=at(x=0.02 * i, z=0.15 + 0.25 * i))
    world.add(vx.GImpact(trimesh.creation.box(extents=(0.2, 0.2, 0.1))), pose=at(x=0.5, z=0.1))
    pieces = [(vx.Box((0.1, 0.02, 0.02)), at()), (ring, at(z=0.1))]
    world.add(vx.Compound(pieces), pose=at(x=-0.5, z=0.3))
    return world, None


def machine(ring, brick):
    """Jointed bodies with motors, one of several turns."""
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    base = world.add(brick, mass=2.0, pose=at(z=0.0301))
    arm = world.add(vx.Box((0.02, 0.02, 0.15)), mass=0.5, pose=at(z=0.25))
    bob = world.add(ring, mass=0.2, pose=at(x=0.2, z=0.4))
    shoulder = world.add_joint(
        vx.HingeJoint(axis=(0, 0, 1)), base, arm, world_from_joint=at(z=0.06)
    )
    world.add_joint(vx.PointJoint(), arm, bob, world_from_joint=at(z=0.4))
    slider = world.add(vx.Box((0.03, 0.03, 0.03)), pose=at(y=0.5, z=0.2))
    rail = world.add_joint(
        vx.SliderJoint(axis=(0, 0, 1), limits=(-0.1, 0.1), damping=0.5), None, slider
    )
    shoulder.set_target_position(8.0, max_force=1.0, max_speed=6.0)
    rail.follow(shoulder, multiplier=0.01, max_force=50.0)
    return world, None


def driven(ring, brick):
    """A kinematic plate, forces, groups and a pair set apart."""
    world = vx.World(solver="nncg")
    plate = world.add(brick, motion="kinematic")
    rider = world.add(ring, pose=at(z=0.06), friction=1.0, mass=0.4)
    ghost = world.add(vx.Sphere(0.05), pose=at(z=0.3), group=2, mask=2)
    passing = world.add(vx.Capsule(0.02, 0.1), pose=at(z=0.4), linear_damping=0.3)
    world.set_collision(passing, rider, False)

    def push(world):
        pose = plate.pose.copy()
        pose[0, 3] += 0.2 * world.time_step
        plate.pose = pose
        ghost.apply_force((0.0, 0.1, 9.0))

    return world, push


def tray(ring, brick):
    """Bullet's own shapes on one that tips: the normals of their contacts turn with it."""
    world = vx.World()
    board = world.add(vx.Box((0.5, 0.25, 0.025)), mass=20.0, pose=at(z=-0.025))
    world.add(vx.Box((0.05, 0.05, 0.01)), mass=1.0, pose=at(x=0.1, z=0.01), friction=0.7)
    world.add(vx.Cylinder(0.05, 0.02), mass=1.0, pose=at(x=-0.1, z=0.01), friction=0.7)
    hinge = world.add_joint(vx.HingeJoint(axis=(0, 1, 0)), None, board)
    hinge.set_target_velocity(0.3, max_force=1e4)
    return world, None


WORLDS = {build.__name__: build for build in (heap, stack, own_shapes, machine, driven, tray)}


def run(world, before, steps):
    """Everything of every step that can be read."""
    trace = []

    def take(world):
        for body in world.bodies:
            trace.append(body.pose.tobytes())
            trace.append(body.linear_velocity.tobytes() + body.angular_velocity.tobytes())
            trace.append(bytes([body.sleeping]))
        for joint in world.joints:
            if not isinstance(joint.kind, vx.PointJoint):
                trace.append(np.array([joint.position, joint.velocity]).tobytes())
            trace.append(joint.reaction.force.tobytes() + joint.reaction.torque.tobytes())
        trace.append(world.contacts().tobytes())

    world.step(steps, take, before=before)
    return trace


@pytest.mark.parametrize("kind", WORLDS)
@pytest.mark.parametrize("steps_before", [0, 90, 500])
def test_same_steps_give_the_same_bits(kind, steps_before, ring, brick):
    world, before = WORLDS[kind](ring, brick)
    world.step(steps_before, before=before)
    state = world.save_state()
    contacts = world.contacts()
    poses = [body.pose for body in world.bodies]
    first = run(world, before, 200)
    if not (kind == "stack" and steps_before == 500):  # asleep by then
        assert first[: len(first) // 200] != first[-len(first) // 200 :]
    for _ in range(2):
        world.restore_state(state)
        assert world.contacts().tobytes() == contacts.tobytes()
        for body, pose in zip(world.bodies, poses, strict=True):
            assert (body.pose == pose).all()
        assert run(world, before, 200) == first


@pytest.mark.parametrize("kind", WORLDS)
@pytest.mark.parametrize("steps_before", [0, 90])
def test_another_world_with_an_equal_scene_continues_with_the_same_bits(
    kind, steps_before, ring, brick, tmp_path
):
    first, before = WORLDS[kind](ring, brick)
    first.step(steps_before, before=before)
    state = first.save_state()
    path = state.save(tmp_path / "state.npz")
    contacts = first.contacts()
    expected = run(first, before, 100)
    for saved in (state, vx.WorldState.load(path)):
        other, push = WORLDS[kind](ring, brick)
        other.step(7, before=push)  # it has a past of its own
        other.restore_state(saved)
        assert other.time == steps_before / 200
        assert other.contacts().tobytes() == contacts.tobytes()
        assert run(other, push, 100) == expected


def digest(trace):
    return hashlib.sha256(b"".join(trace)).hexdigest()


@pytest.mark.parametrize("kind", ["heap", "stack", "machine"])
def test_another_process_continues_with_the_same_bits(kind, ring, brick, tmp_path):
    first, before = WORLDS[kind](ring, brick)
    first.step(120, before=before)
    first.save_state().save(tmp_path / "state.npz")
    ring.save(tmp_path / "ring.vxs")
    brick.save(tmp_path / "brick.vxs")
    expected = digest(run(first, before, 100))
    program = f"""
import sys
sys.path[:0] = {[str(Path(__file__).parent), *sys.path]!r}
import voxshell as vx
from test_state import WORLDS, digest, run
ring, brick = (vx.Model.load(f"{{name}}.vxs") for name in ("ring", "brick"))
world, before = WORLDS[{kind!r}](ring, brick)
world.restore_state(vx.WorldState.load("state.npz"))
print(digest(run(world, before, 100)))
"""
    child = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert child.stdout.strip() == expected


def test_a_scene_is_equal_although_bodies_were_removed_from_its_world(ring):
    def make(extra):
        world = vx.World()
        aside = world.add(vx.Sphere(0.1), pose=(9, 0, 0)) if extra else None
        ground = world.add(vx.Plane(), mass=0, name="ground")
        body = world.add(ring, pose=(0, 0, 0.3), name="ring")
        ball = world.add(vx.Sphere(0.05), pose=(0, 0, 0.6), name="ball")
        joint = world.add_joint(vx.HingeJoint(), ring_or(world, ground), ball, name="hinge")
        follower = world.add(vx.Sphere(0.05), pose=(1, 0, 0.6), name="follower")
        second = world.add_joint(vx.HingeJoint(), None, follower, name="second")
        second.follow(joint, max_force=5.0)
        world.set_collision(body, ball, False)
        if aside is not None:
            world.set_collision(aside, body, False)
            world.remove(aside)
        return world

    def ring_or(world, ground):
        return ground

    first, second = make(True), make(False)
    first.step(60)
    state = first.save_state()
    expected = [it.pose.tobytes() for _ in range(50) for it in (first.step(), *first.bodies)[1:]]
    second.restore_state(state)
    found = [it.pose.tobytes() for _ in range(50) for it in (second.step(), *second.bodies)[1:]]
    assert found == expected
    assert [body.number for body in first.bodies] != [body.number for body in second.bodies]


def test_of_which_some_slept_and_some_were_in_contact(ring, brick):
    world, _ = heap(ring, brick)
    world.step(500)
    assert world.bodies[-1].sleeping
    assert len(world.contacts()) > 10
    world.save_state()
    assert world.bodies[-1].sleeping
    assert len(world.contacts()) > 10


def test_saving_hardly_disturbs_a_stack(ring, brick):
    plain, _ = stack(ring, brick)
    saved, _ = stack(ring, brick)
    plain.step(300)
    saved.step(150)
    saved.save_state()
    saved.step(150)
    for a, b in zip(plain.bodies, saved.bodies, strict=True):
        np.testing.assert_allclose(a.pose, b.pose, atol=1e-4)


def test_settings_and_motors_go_back_too(ring, brick):
    world, _ = machine(ring, brick)
    state = world.save_state()
    first = run(world, None, 50)
    world.restore_state(state)
    world.joints[0].release()
    world.bodies[1].friction = 0.0
    world.bodies[1].linear_damping = 0.9
    world.set_collision(world.bodies[0], world.bodies[1], False)
    world.step(50)
    world.restore_state(state)
    assert run(world, None, 50) == first


def test_forces_not_yet_spent_are_in_the_state(ring):
    world = vx.World(gravity=(0, 0, 0))
    body = world.add(ring, mass=2.0)
    body.apply_force((4.0, 0.0, 0.0))
    body.apply_torque((0.0, 0.0, 1.0))
    state = world.save_state()
    for _ in range(2):
        world.step()
        assert body.linear_velocity[0] == pytest.approx(2.0 / 200.0)
        assert body.angular_velocity[2] > 0.0
        world.restore_state(state)


def test_reactions_of_joints_are_in_the_state():
    world = vx.World()
    lift = world.add(vx.Box((0.1, 0.1, 0.1)), mass=1.0, pose=(0, 0, 1.0))
    joint = world.add_joint(vx.SliderJoint(axis=(0, 0, 1)), None, lift)
    joint.set_target_position(0.0, max_force=1000.0, max_speed=0.5)
    world.step(50)
    force = joint.reaction.force
    state = world.save_state()
    np.testing.assert_array_equal(joint.reaction.force, force)
    world.step(10, before=lambda _: lift.apply_force((50, 0, -200)))
    assert abs(joint.reaction.force[0]) > 10
    world.restore_state(state)
    np.testing.assert_array_equal(joint.reaction.force, force)


def test_saving_changes_no_contact_that_is_shown():
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    tray = world.add(vx.Box((0.5, 0.1, 0.02)), mass=1.0, pose=(0, 0, 0.5))
    tray.angular_velocity = (0, 1, 0)
    for i in range(4):
        world.add(vx.Cone(radius=0.05, height=0.1), mass=0.1, pose=(0.2 * i - 0.3, 0, 0.57))
    shown = 0
    for _ in range(100):
        world.step()
        before = world.contacts()
        world.save_state()
        for name in before.dtype.names:
            np.testing.assert_array_equal(world.contacts()[name], before[name], err_msg=name)
        shown += len(before)
    assert shown > 100


def test_states_are_for_their_world_and_its_bodies(ring):
    world = vx.World()
    body = world.add(ring, name="ring")
    other = vx.World()
    state = world.save_state()
    with pytest.raises(vx.SettingsError, match="another world"):
        other.restore_state(state)
    with pytest.raises(vx.InputTypeError, match="list"):
        world.restore_state([])
    joint = world.add_joint(vx.FixedJoint(), None, body, name="nail")
    with pytest.raises(vx.SettingsError, match=r"joints have changed .* 1 added \('nail'\)"):
        world.restore_state(state)
    world.remove(joint)
    world.restore_state(state)
    world.remove(body)
    with pytest.raises(vx.SettingsError, match=r"bodies have changed .* 1 removed \('ring'\)"):
        world.restore_state(state)


def make_scene(
    ring, *, time_step=0.005, mass=1.0, name="ring", radius=0.1, limits=None, extra=False
):
    world = vx.World(time_step)
    world.add(vx.Plane(), mass=0)
    body = world.add(ring, mass=mass, name=name, pose=(0, 0, 1))
    world.add(vx.Sphere(radius), pose=(1, 0, 1))
    world.add_joint(vx.HingeJoint(limits=limits), None, body, name="hinge")
    if extra:
        world.add(vx.Sphere(0.1))
    return world


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"time_step": 0.004}, "the world was made with another time_step"),
        ({"mass": 2.0}, "body 1 of the world, 'ring', has another mass"),
        ({"name": "nut"}, "body 1 of the world, 'nut', has another name"),
        ({"radius": 0.2}, "body 2 of the world, 'body 2', has another .*inertia|shape"),
        ({"limits": (0.0, 1.0)}, "joint 0 of the world, 'hinge', has another limits"),
        ({"extra": True}, "it has 3 bodies, and the world has 4"),
    ],
)
def test_files_of_other_scenes_are_refused_with_what_differs(ring, tmp_path, changes, message):
    world = make_scene(ring)
    path = world.save_state().save(tmp_path / "state.npz")
    other = make_scene(ring, **changes)
    before = [body.pose for body in other.bodies]
    with pytest.raises(vx.SettingsError, match=f"another world, whose scene differs: {message}"):
        other.restore_state(vx.WorldState.load(path))
    for body, pose in zip(other.bodies, before, strict=True):
        np.testing.assert_array_equal(body.pose, pose)
    make_scene(ring).restore_state(vx.WorldState.load(path))


def test_states_say_what_they_are(ring, tmp_path):
    state = make_scene(ring).save_state()
    assert repr(state) == "WorldState(3 bodies, 1 joints)"
    assert repr(vx.WorldState.load(state.save(tmp_path / "a.npz"))) == repr(state)
    with pytest.raises(vx.InputTypeError, match=r"from World\.save_state\(\) or WorldState\.load"):
        vx.WorldState()
    with pytest.raises(vx.SettingsError, match=r"a state needs a file name that ends in \.npz"):
        state.save(tmp_path / "state.vxs")
    with pytest.raises(vx.MissingFileError, match="does not exist"):
        state.save(tmp_path / "none" / "a.npz")


def fall(model):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    body = world.add(model, pose=at(z=0.2))
    world.step(150)
    return body.pose.tobytes()


def test_models_are_shared_between_threads(ring):
    alone = fall(ring)
    with ThreadPoolExecutor(4) as threads:
        assert set(threads.map(fall, [ring] * 8)) == {alone}


def test_models_can_be_pickled(ring):
    assert fall(pickle.loads(pickle.dumps(ring))) == fall(ring)
