from __future__ import annotations

import copy
import math
import pickle
import warnings

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at


@pytest.fixture(scope="module")
def ball():
    return vx.Model.from_mesh(trimesh.creation.icosphere(4, radius=0.1), voxel_size=0.005)


@pytest.mark.parametrize("restitution", [0.0, 0.5, 0.9])
@pytest.mark.parametrize("phase", [0.0, 0.013, 0.031, 0.047])
def test_rebound_is_true(ball, restitution, phase):
    start = 0.6 + phase
    world = vx.World(gravity=(0, 0, -10), sleeping=False)
    world.add(vx.Plane(), mass=0, restitution=1.0)
    body = world.add(ball, pose=at(z=start), restitution=restitution)
    heights, energies = [], []

    def note(world):
        z, v = body.pose[2, 3], body.linear_velocity[2]
        heights.append(z)
        energies.append(10.0 * z + 0.5 * v * v)

    world.step(200, callback=note)
    rising = np.flatnonzero(np.diff(heights) > 1e-6)
    apex = max(heights[rising[0] :]) if rising.size else 0.1
    ratio = (apex - 0.1) / (start - 0.1)
    assert ratio == pytest.approx(restitution**2, abs=0.02)
    assert max(energies) <= 10.0 * start * 1.01


def test_contacts_describe_a_resting_brick(brick):
    world = vx.World(sleeping=False)
    ground = world.add(vx.Plane(), mass=0)
    body = world.add(brick, mass=2.0, pose=at(z=0.0301))
    world.step(300)
    contacts = world.contacts()
    assert len(contacts) >= 4
    for contact in contacts:
        assert {int(contact["body_a"]), int(contact["body_b"])} == {ground.number, body.number}
        toward_a = 1.0 if contact["body_a"] == body.number else -1.0
        np.testing.assert_allclose(contact["normal"], (0, 0, toward_a), atol=1e-6)
        np.testing.assert_allclose(
            contact["point_a"] - contact["point_b"],
            -contact["depth"] * contact["normal"],
            atol=1e-5,  # and the slip that friction remembers
        )
    # They carry the weight: their impulses in a step are mass times gravity times the step.
    assert contacts["impulse"].sum() == pytest.approx(2.0 * 9.81 / 200.0, rel=0.05)


@pytest.mark.parametrize("inertia", [np.eye(3), [1.0, 1.0, 1.0], 1.0, None])
def test_an_inertia_of_another_type_is_refused_with_what_is_allowed(brick, inertia):
    """numpy's "truth value of an array is ambiguous" came out."""
    with pytest.raises(vx.InputTypeError, match=r"inertia must be 'solid', .* a MassProperties"):
        vx.World().add(brick, inertia=inertia)


def test_sleeping_and_waking(brick):
    world = vx.World(sleeping=True)
    world.add(vx.Plane(), mass=0)
    body = world.add(brick, pose=at(z=0.0305))
    world.step(1000)
    assert body.sleeping
    before = body.pose
    world.step(10)
    np.testing.assert_array_equal(body.pose, before)
    body.linear_velocity = (0, 0, 1.0)
    assert not body.sleeping
    world.step(10)
    assert body.pose[2, 3] > before[2, 3] + 0.02


def test_pose_can_be_set(ball):
    world = vx.World(gravity=(0, 0, 0))
    body = world.add(ball)
    pose = trimesh.transformations.rotation_matrix(1.0, (0, 1, 0), (0.5, 0, 0))
    body.pose = pose
    np.testing.assert_allclose(body.pose, pose, atol=1e-12)


def test_same_bits_on_every_run(ball, brick):
    def run():
        world = vx.World()
        world.add(vx.Plane(), mass=0)
        bodies = [
            world.add(shape, pose=at(0.02 * i, 0.01 * i, 0.15 + 0.22 * i))
            for i, shape in enumerate([brick, ball, brick, ball])
        ]
        world.step(400)
        return np.array([body.pose for body in bodies]).tobytes()

    assert run() == run()


def test_timings_have_a_row_a_step(brick):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    world.add(brick, pose=at(z=0.029))
    assert world.timings.shape == (0,)
    world.step(7)
    timings = world.timings
    assert timings.shape == (7,)
    assert (timings["query"] > 0).all()
    parts = timings["query"] + timings["reduction"] + timings["manifold"]
    assert (parts <= timings["narrow_phase"]).all()
    assert (timings["narrow_phase"] <= timings["step"]).all()


def test_timings_are_bounded_and_can_be_cleared():
    world = vx.World()
    world.step(5)
    world.clear_timings()
    assert world.timings.shape == (0,)
    world.step(100_007)
    timings = world.timings
    assert timings.shape == (100_000,)
    assert (timings["step"] > 0).all()


def test_callback_sees_every_step_and_may_stop_the_run(ball):
    world = vx.World()
    world.add(ball)
    seen = []

    def callback(world):
        seen.append(len(world.timings))
        if len(seen) == 3:
            raise StopIteration

    with pytest.raises(StopIteration):
        world.step(10, callback=callback)
    assert seen == [1, 2, 3]


# Coarse models still share out their pairs among threads. The slow case takes the default ones, to rest.
@pytest.mark.parametrize(
    ("count", "resolution", "steps"),
    [(12, 50, 60), pytest.param(27, None, 150, marks=pytest.mark.slow)],
)
def test_a_heap_falls_the_same_way_on_any_number_of_threads(count, resolution, steps):
    torus, blob, ground = (
        vx.Model.from_mesh(mesh, resolution=resolution)
        for mesh in (
            trimesh.creation.torus(0.08, 0.03),
            trimesh.creation.icosphere(2, radius=0.07),
            trimesh.creation.box(extents=(1.0, 1.0, 0.1)),
        )
    )

    def drop(threads):
        world = vx.World(threads=threads)
        world.add(ground, mass=0)
        bodies = [
            world.add(
                (torus, blob)[i % 2],
                pose=at(0.15 * (i % 3), 0.15 * (i // 3 % 3), 0.2 + 0.15 * (i // 9)),
            )
            for i in range(count)
        ]
        world.step(steps)
        return np.array([body.pose for body in bodies]), world.contacts()

    poses, contacts = drop(1)
    assert len(contacts) > 30
    for threads in (None, 2, 5):
        others, other_contacts = drop(threads)
        np.testing.assert_array_equal(others, poses)
        np.testing.assert_array_equal(other_contacts, contacts)


@pytest.mark.parametrize(
    ("settings", "part"),
    [
        ({"time_step": 0.0}, "time_step"),
        ({"time_step": float("nan")}, "time_step"),
        ({"gravity": (0, 0)}, "gravity"),
        ({"gravity": (0, 0, float("inf"))}, "gravity"),
        ({"contact": "none"}, "'auto', 'regular' or 'segmented'"),
        ({"level": 0}, "level"),
        ({"level": 13}, "level"),
        ({"contact": "regular", "level": 3}, "level"),
        ({"margin": -1e-3}, "margin"),
        ({"ccd_motion_threshold": -1e-3}, "ccd_motion_threshold"),
        ({"ccd_motion_threshold": float("nan")}, "ccd_motion_threshold"),
        ({"split_impulse_threshold": "x"}, "split_impulse_threshold"),
        ({"solver": "none"}, "'sequential_impulse', 'nncg', 'dantzig'"),
        ({"iterations": 0}, "iterations"),
        ({"iterations": 2.5}, "iterations"),
        ({"friction_directions": 3}, "friction_directions"),
        ({"threads": 0}, "threads"),
        ({"threads": 2000}, "threads"),
        ({"threads": "all"}, "threads"),
        # These raised an OverflowError and a TypeError.
        ({"time_step": 1e300}, "shorter time_step"),
        ({"friction_directions": np.array([2])}, "friction_directions"),
    ],
)
def test_wrong_settings_of_a_world(settings, part):
    with pytest.raises(vx.SettingsError, match=part):
        vx.World(**settings)


@pytest.mark.parametrize(
    ("settings", "error", "part"),
    [
        ({"mass": -1.0}, vx.SettingsError, "mass"),
        ({"mass": float("nan")}, vx.SettingsError, "mass"),
        ({"friction": -0.1}, vx.SettingsError, "friction"),
        ({"restitution": 1.5}, vx.SettingsError, "restitution"),
        ({"inertia": "hollow"}, vx.SettingsError, "inertia"),
        ({"pose": np.ones((4, 4))}, vx.PoseError, "pose"),
        ({"pose": np.eye(3)}, vx.PoseError, "pose"),
    ],
)
def test_wrong_settings_of_a_body(ball, settings, error, part):
    world = vx.World()
    with pytest.raises(error, match=part):
        world.add(ball, **settings)
    assert world.bodies == ()
    world.step(1)


def test_what_cannot_be_simulated_is_refused(ball):
    world = vx.World()
    with pytest.raises(vx.InputTypeError, match="not int"):
        world.add(1)
    with pytest.raises(vx.SettingsError, match="leave out mass"):
        world.add(vx.Plane(), mass=1.0)
    with pytest.raises(vx.SettingsError, match="n, the number of steps, must"):
        world.step(-1)
    body = world.add(ball)
    with pytest.raises(vx.PoseError):
        body.pose = np.zeros((4, 4))
    with pytest.raises(vx.SettingsError, match="linear_velocity"):
        body.linear_velocity = (0, float("nan"), 0)


def test_bodies_outlive_nothing_they_need():
    def make():
        world = vx.World()
        world.add(vx.Plane(), mass=0)
        model = vx.Model.from_mesh(trimesh.creation.icosphere(2, radius=0.1), voxel_size=0.02)
        return world.add(model, pose=at(z=0.2))

    body = make()  # the world object is gone, its simulation is not
    assert body.pose[2, 3] == 0.2


@pytest.mark.parametrize("ccd_motion_threshold", [None, np.inf])
def test_without_ccd_fast_bodies_penetrate_first(ball, ccd_motion_threshold):
    # At 2 m/s and 200 Hz a step is 10 mm; it begins 4 mm above the ground.
    world = vx.World(gravity=(0, 0, 0), ccd_motion_threshold=ccd_motion_threshold)
    world.add(vx.Plane(), mass=0)
    body = world.add(ball, pose=trimesh.transformations.translation_matrix([0, 0, 0.104]))
    body.linear_velocity = (0.0, 0.0, -2.0)
    world.step()
    assert (body.pose[2, 3] < 0.095) == (ccd_motion_threshold == np.inf)
    assert body.pose[2, 3] > 0.0995 or ccd_motion_threshold == np.inf


def test_two_bodies_of_one_model_warn_once():
    sparse = vx.Model.from_mesh(trimesh.creation.box(), voxel_size=0.05, target_points=100)
    world = vx.World()
    world.add(sparse, mass=0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        world.step()  # there is nothing to meet yet
    world.add(sparse, pose=at(z=2.0))
    with pytest.warns(
        vx.AccuracyWarning, match="^contacts between 'body 0' and 'body 1' may be missed"
    ):
        world.step()
    for i in range(3):
        world.add(sparse, mass=i, pose=at(x=3.0 * (i + 1)))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            world.step()


def test_bodies_and_joints_cannot_be_changed_from_outside(brick):
    world = vx.World()
    for number in range(6):
        world.add_joint(vx.HingeJoint(), None, world.add(brick, pose=at(x=number)))
    before = world.bodies, world.joints
    for joint in world.joints[:3]:
        world.remove(joint)
    for body in world.bodies:
        world.remove(body)
    assert (world.bodies, world.joints) == ((), ())
    assert [len(each) for each in before] == [6, 6]
    for name in ("bodies", "joints"):
        with pytest.raises(AttributeError, match=name):
            setattr(world, name, [])


@pytest.mark.parametrize("name", ["timestep", "gravityy", "solver"])
def test_a_world_has_no_attributes_but_its_own(name):
    with pytest.raises(AttributeError, match=f"no attribute '{name}'"):
        setattr(vx.World(), name, 1)


@pytest.mark.parametrize("name", ["time_step"])
def test_what_a_world_keeps_is_told_with_what_to_do_instead(name):
    with pytest.raises(AttributeError, match=rf"cannot change: pass {name}=\.\.\. to voxshell"):
        setattr(vx.World(), name, 1)


def test_a_class_made_from_world_may_have_attributes():
    class Lab(vx.World):
        pass

    lab = Lab()
    lab.robot = "arm"
    assert lab.robot == "arm"


@pytest.mark.parametrize("duplicate", [pickle.dumps, copy.copy, copy.deepcopy])
def test_worlds_and_what_belongs_to_them_are_not_copied(duplicate, brick):
    world = vx.World()
    body = world.add(brick)
    joint = world.add_joint(vx.HingeJoint(), None, body)
    for what, remedy in (
        (world, r"save_state\(\)"),
        (world.save_state(), r"restore_state\(\)"),
        (body, "add another one"),
        (joint, "add another one"),
        (world.record(), r"recording\(\)"),
    ):
        with pytest.raises(vx.InputTypeError, match=f"cannot be copied or pickled.*{remedy}"):
            duplicate(what)


ARRAY = np.ones(2)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (
            lambda w, _: vx.World(contact=["auto"]),
            vx.SettingsError,
            "contact must be 'auto', 'regular' or 'segmented', not",
        ),
        (lambda w, _: vx.World(solver=ARRAY), vx.SettingsError, "solver must be 'coulomb', "),
        (
            lambda w, _: vx.World(shell={}),
            vx.SettingsError,
            "shell must be 'auto' or 'fewest', not",
        ),
        (lambda w, _: vx.World(sleeping="no"), vx.SettingsError, "sleeping must be True or False"),
        (lambda w, _: vx.World(ccd_motion_threshold=ARRAY), vx.SettingsError, "must be a number"),
        (lambda w, _: w.step(1, 3), vx.InputTypeError, "callback must be callable, not int"),
        (lambda w, _: w.step(1, before=3), vx.InputTypeError, "before must be callable, not int"),
        (lambda w, _: w.remove("x"), vx.InputTypeError, "must be a Body or a Joint, not str"),
        (lambda w, _: w.add(vx.Sphere(1), name=5), vx.InputTypeError, "name must be a string"),
        (
            lambda w, _: w.add(vx.Sphere(1), motion=ARRAY),
            vx.SettingsError,
            "motion must be 'dynamic', ",
        ),
        (lambda w, j: setattr(j.child, "name", 5), vx.InputTypeError, "name must be a string"),
        (lambda w, j: setattr(j, "name", None), vx.InputTypeError, "name must be a string"),
        (
            lambda w, j: w.set_collision(j.child, w.bodies[1], "no"),
            vx.SettingsError,
            "collide must be True or False",
        ),
        (
            lambda w, j: w.add_joint(vx.PointJoint(), None, j.child, collide=1),
            vx.SettingsError,
            "collide must be True or False",
        ),
        (
            lambda w, j: w.add_joint(vx.PointJoint(), None, j.child, name=5),
            vx.InputTypeError,
            "name must be a string",
        ),
        (lambda w, j: j.follow(None, max_force=1), vx.InputTypeError, "leader must be a Joint"),
        (
            lambda w, j: j.set_target_position(0, max_force=1, max_speed=ARRAY),
            vx.SettingsError,
            "max_speed must be a number",
        ),
        (lambda w, _: vx.Compound(3), vx.InputTypeError, "parts must be pairs of a shape and"),
        (lambda w, _: vx.ConvexDecomposition(5), vx.InputTypeError, "hulls must be arrays of"),
        (
            lambda w, _: w.record().save_html("a.html", title=None),
            vx.InputTypeError,
            "title must be a string, not NoneType",
        ),
    ],
)
def test_arguments_of_a_wrong_type_are_told_with_the_right_one(call, error, message):
    world = vx.World()
    joint = world.add_joint(vx.HingeJoint(), None, world.add(vx.Sphere(0.1)))
    world.add(vx.Sphere(0.1), pose=at(x=1))
    with pytest.raises(error, match=message):
        call(world, joint)


@pytest.mark.parametrize("size", [1e-5, 1e-6, 1e-7, 1e-9])
def test_thin_round_bodies_fall(size):
    """Their vertices were merged to none."""
    world = vx.World()
    for place, shape in enumerate((vx.Cylinder(size, 1), vx.Cylinder(1, size), vx.Cone(size, 1))):
        body = world.add(shape, pose=at(x=3 * place))
        world.step(10)
        assert body.position[2] == pytest.approx(-9.81 * 55 / 200**2, rel=1e-3)


def test_gravity_changes_from_the_next_step_on():
    def fall(change):
        world = vx.World() if change else vx.World(gravity=(1.0, 0, 2.0))
        body = world.add(vx.Sphere(0.1))
        if change:
            world.gravity = (1.0, 0, 2.0)
        world.step(100)
        return body.pose.tobytes() + body.linear_velocity.tobytes()

    assert fall(True) == fall(False)


def test_a_change_of_gravity_wakes_bodies_and_the_same_gravity_does_not():
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    box = world.add(vx.Box((0.1, 0.1, 0.1)), pose=(0, 0, 0.1))
    world.step(600)
    assert box.sleeping
    world.gravity = (0.0, 0.0, -9.81)
    assert box.sleeping
    world.gravity = (0.0, 0.0, 1.0)
    assert not box.sleeping
    world.step(200)
    assert box.linear_velocity[2] == pytest.approx(1.0)


def test_what_rests_slides_when_gravity_tilts():
    world = vx.World()
    world.add(vx.Plane(), mass=0, friction=1.0)
    box = world.add(vx.Box((0.1, 0.1, 0.1)), pose=(0, 0, 0.1), friction=0.5)
    world.step(100)
    world.gravity = (4.0, 0, -9.81)  # less than the friction
    world.step(200)
    assert abs(box.position[0]) < 1e-4
    world.gravity = (6.0, 0, -9.81)
    world.step(200)
    assert box.linear_velocity[0] == pytest.approx(6.0 - 0.5 * 9.81, rel=0.01)


def test_states_contain_gravity():
    world = vx.World()
    ball = world.add(vx.Sphere(0.1))
    state = world.save_state()
    world.gravity = (0, 0, 3.0)
    world.restore_state(state)
    np.testing.assert_array_equal(world.gravity, (0, 0, -9.81))
    world.step()
    assert ball.linear_velocity[2] == pytest.approx(-9.81 / 200)


@pytest.mark.parametrize(
    ("gravity", "message"),
    [
        (1, "gravity must be three numbers in m/s2"),
        ((0, 0, math.nan), "gravity"),
        ((0, 0, -1e11), "gravity moves bodies by"),
    ],
)
def test_wrong_gravity_is_refused_and_changes_nothing(gravity, message):
    world = vx.World()
    with pytest.raises(vx.SettingsError, match=message):
        world.gravity = gravity
    np.testing.assert_array_equal(world.gravity, (0, 0, -9.81))
    with pytest.raises(ValueError, match="read-only"):
        world.gravity[2] = 0.0


def test_gravity_in_millimeters_is_doubted():
    with pytest.warns(vx.UnitWarning, match="gravity is 9810 m/s2"):
        vx.World().gravity = (0, 0, -9810)
    with pytest.warns(vx.UnitWarning, match=r"9810 m/s2, 1000 times that of the Earth"):
        vx.World(gravity=(0, 0, -9810))
    vx.World(gravity=(0, 0, -1000.0))


def test_a_body_that_is_added_is_refused_with_what_to_pass_instead():
    world, other = vx.World(), vx.World()
    ball = world.add(vx.Sphere(0.1), name="ball")
    for into, state in ((world, "is in this world already"), (other, "belongs to another world")):
        with pytest.raises(vx.InputTypeError, match=f"^body 'ball' {state}; .* pass its shape"):
            into.add(ball)  # pyright: ignore[reportArgumentType]
    world.remove(ball)
    with pytest.raises(vx.InputTypeError, match=r"^body 'ball' has been removed from its world; "):
        world.add(ball)  # pyright: ignore[reportArgumentType]
    assert world.add(ball.shape).shape is ball.shape
