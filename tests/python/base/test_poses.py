"""Poses as people write them: every form, everywhere, and rotations that are a little off."""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.base.pose_forms import make_rigid
from voxshell.recording import BodyTrack

HALF = math.sqrt(0.5)
POSITION = (0.1, 0.2, 0.05)
MATRIX = vx.pose(POSITION, axis_angle=((0, 0, 1), math.pi / 2))
FORMS = {
    "list": MATRIX.tolist(),
    "seven": (*POSITION, 0, 0, HALF, HALF),
    "pair": (POSITION, (0, 0, HALF, HALF)),
    "arrays": [np.array(POSITION), np.array((0, 0, HALF, HALF), np.float32)],
    "rounded": MATRIX + np.diag((0.0, 0.0, 4e-5, 0.0)),
}
SCALED = np.diag([1.01, 1.01, 1.01, 1.0])


def test_a_rotation_matrix_with_a_position():
    assert (vx.pose(POSITION, rotation=MATRIX[:3, :3]) == MATRIX).all()
    rounded = vx.pose(rotation=np.round(vx.pose(euler=(0.1, 0.2, 0.3))[:3, :3], 4))
    assert np.abs(rounded[:3, :3].T @ rounded[:3, :3] - np.eye(3)).max() < 1e-15


@pytest.mark.parametrize(
    ("rotation", "message"),
    [
        (np.diag([1.0, 1.0, -1.0]), "rotation: it mirrors"),
        (
            np.eye(3) * 1.01,
            r"rotation: the rotation is not orthonormal \(error 0.0201, at most 0.001\)",
        ),
        (np.eye(4), r"rotation must be \(3, 3\) numbers"),
        (np.full((3, 3), np.nan), "rotation: an entry is not finite"),
    ],
)
def test_what_is_no_rotation_matrix_is_refused(rotation, message):
    with pytest.raises(vx.PoseError, match=message):
        vx.pose(rotation=rotation)


@pytest.mark.parametrize("euler", [(0, 0, 90), (-45, 0, 0), (0, 15.0, 0), (np.float32(170), 0, 0)])
def test_angles_in_degrees_are_doubted(euler):
    with pytest.warns(vx.UnitWarning, match=r"angles are in radians, and .* math\.radians"):
        vx.pose(euler=euler)


def test_angles_in_radians_are_not_doubted():
    vx.pose(euler=(-10, 6.28, 3))
    vx.pose(euler=(0, 0, 94.3))  # as of a body that turns on and on


@pytest.fixture(scope="module")
def box() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.box((0.1, 0.2, 0.3)), resolution=20)


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_every_form_is_the_same_pose_everywhere(box: vx.Model, form):
    plane = vx.Plane()
    exact = vx.contacts(box, plane, MATRIX)
    assert len(exact) > 10
    np.testing.assert_allclose(vx.contacts(box, plane, form).depths, exact.depths, atol=1e-7)
    assert vx.collide(box, plane, form)
    assert vx.distance(box, plane, form).distance == pytest.approx(-0.1, abs=1e-6)
    for poses in (form, [form, form], [form, POSITION]):
        batch = vx.contacts_batch(box, plane, poses)
        np.testing.assert_allclose(batch[0].depths, exact.depths, atol=1e-7)
    swept = vx.sweep(box, plane, (0.1, 0.2, 1.0), a_end=form)
    np.testing.assert_allclose(
        swept.a_pose, vx.interpolate_pose((0.1, 0.2, 1.0), form, swept.fraction), atol=1e-9
    )
    world = vx.World()
    body = world.add(box, pose=form)
    compound = vx.Compound([(vx.Sphere(0.1), form)])
    other = world.add(compound)
    other.pose = form
    for pose in (body.pose, other.pose, compound.parts[0][1]):
        np.testing.assert_allclose(pose, MATRIX, atol=1e-7)
    world.add_joint(vx.FixedJoint(), body, other, world_from_joint=form)
    faces, poses = [[0, 1, 2]], [form, form]
    track = BodyTrack("box", np.eye(3), cast("Any", faces), None, cast("Any", poses))
    np.testing.assert_allclose(track.poses, [MATRIX, MATRIX], atol=1e-7)


def test_many_positions_and_quaternions_are_many_poses(box: vx.Model):
    places = np.array([(0, 0, z) for z in (0.2, 0.1, 0.05)])
    turns = np.tile((0, 0, HALF, HALF), (3, 1))
    matrices = np.array([vx.pose(place, xyzw=turns[0]) for place in places])
    expected = vx.collide_batch(box, vx.Plane(), matrices)
    assert expected.tolist() == [False, True, True]
    for poses in (places, np.hstack([places, turns]), (places, turns)):
        np.testing.assert_array_equal(vx.collide_batch(box, vx.Plane(), poses), expected)


def test_rotations_a_little_off_become_the_nearest():
    rng = np.random.default_rng(1)
    for _ in range(200):
        exact = vx.pose(rng.normal(size=3), axis_angle=(rng.normal(size=3), rng.uniform(0, 6)))
        assert make_rigid(exact, "pose") is exact
        rough = exact.copy()
        rough[:3, :3] += rng.uniform(-1e-4, 1e-4, (3, 3))
        u, _, v = np.linalg.svd(rough[:3, :3])
        np.testing.assert_allclose(make_rigid(rough, "pose")[:3, :3], u @ v, atol=1e-14)


@pytest.mark.parametrize(
    ("pose", "message"),
    [
        (SCALED, r"not orthonormal \(error 0.0201, at most 0.001\); scale the mesh"),
        (np.diag([1.0, 1.0, -1.0, 1.0]), "mirrors .*mirror the mesh"),
        (np.diag([1.0, 1.0, -1.0001, 1.0]), "mirrors .*mirror the mesh"),
        (
            vx.pose((1, 2, 3)).T,
            "last row must be 0, 0, 0, 1, and is off by 3; .* transposed, so pass pose\\.T",
        ),
        ((0, 0, 0, 0, 0, 0, 2), "has the length 2 instead of 1"),
        ((0, 0, math.nan), "not finite"),
        (np.eye(3), "not an array of shape \\(3, 3\\) and type float64; for a rotation"),
    ],
)
def test_what_is_no_pose_is_refused(box: vx.Model, pose, message):
    for use in (
        lambda: vx.contacts(box, vx.Plane(), pose),
        lambda: vx.World().add(box, pose=pose),
    ):
        with pytest.raises(vx.PoseError, match=message):
            use()


def test_rotations_of_each_kind_agree():
    turned = vx.pose(axis_angle=((0, 0, 2), 0.3))
    q = (0, 0, math.sin(0.15), math.cos(0.15))
    for same in (vx.pose(xyzw=q), vx.pose(wxyz=(q[3], *q[:3])), vx.pose(euler=(0, 0, 0.3))):
        np.testing.assert_allclose(same, turned, atol=1e-15)
    x, y, z = (
        vx.pose(axis_angle=(axis, a)) for axis, a in zip(np.eye(3), (0.1, 0.2, 0.3), strict=True)
    )
    np.testing.assert_allclose(vx.pose(euler=(0.1, 0.2, 0.3)), z @ y @ x, atol=1e-15)


@pytest.mark.parametrize(
    ("rotation", "message"),
    [
        ({"xyzw": (0, 0, 0, 1), "euler": (0, 0, 0)}, "at most one rotation, not xyzw and euler"),
        ({"xyzw": (0, 0, 0, 1.01)}, "length 1.01"),
        ({"wxyz": (0, 0, 0)}, "wxyz must be"),
        ({"euler": (0, 0, math.inf)}, "finite"),
        ({"axis_angle": (0, 0, 1)}, "pair"),
        ({"axis_angle": ((0, 0, 0), 1.0)}, "zero"),
        ({"position": (0, 0)}, "position must be"),
    ],
)
def test_wrong_rotations_are_refused(rotation, message):
    with pytest.raises(vx.PoseError, match=message):
        vx.pose(**rotation)


# ---- bodies --------------------------------------------------------------------------------------


@pytest.mark.parametrize("motion", ["dynamic", "kinematic", "static"])
def test_position_and_orientation_can_be_read_and_set(motion):
    body = vx.World().add(vx.Box((0.1, 0.2, 0.3)), motion=motion, pose=MATRIX)
    np.testing.assert_allclose(body.position, POSITION, atol=1e-15)
    np.testing.assert_allclose(body.orientation_xyzw, (0, 0, HALF, HALF), atol=1e-12)
    body.position = (1, 2, 3)
    np.testing.assert_allclose(body.pose, vx.pose((1, 2, 3), xyzw=(0, 0, HALF, HALF)), atol=1e-12)
    body.orientation_xyzw = (0, 1, 0, 0)
    np.testing.assert_allclose(body.pose, vx.pose((1, 2, 3), xyzw=(0, 1, 0, 0)), atol=1e-12)
    with pytest.raises(vx.SettingsError, match="position"):
        body.position = (1, 2)
    with pytest.raises(vx.PoseError, match="length 2"):
        body.orientation_xyzw = (0, 0, 0, 2)
    np.testing.assert_array_equal(body.position, (1, 2, 3))


@pytest.mark.parametrize(
    "name",
    [
        "pose",
        "position",
        "orientation_xyzw",
        "linear_velocity",
        "angular_velocity",
        "bounds",
        "surface_velocity",
    ],
)
def test_arrays_of_a_body_are_read_only(name: str):
    body = vx.World().add(vx.Sphere(0.1))
    with pytest.raises(ValueError, match="read-only"):
        getattr(body, name)[...] = 1.0
    assert getattr(body, name).copy().flags.writeable


def test_impulses_and_velocities_at_points_follow_from_mass_and_inertia():
    center = np.array((0.05, -0.02, 0.03))
    tensor = np.diag((0.02, 0.03, 0.04))
    matter = vx.MassProperties(2.0, center, tensor)
    world = vx.World(gravity=(0, 0, 0))
    pose = vx.pose((1, 2, 3), euler=(0.3, -0.4, 0.5))
    body = world.add(vx.Box((0.2, 0.2, 0.2)), mass=2.0, inertia=matter, pose=pose)
    impulse, point = np.array((0.1, -0.2, 0.3)), np.array((1.1, 2.2, 2.9))
    body.apply_impulse(impulse, at=point)
    middle = pose[:3, :3] @ center + pose[:3, 3]
    inertia = pose[:3, :3] @ tensor @ pose[:3, :3].T
    spin = np.linalg.solve(inertia, np.cross(point - middle, impulse))
    np.testing.assert_allclose(body.linear_velocity, impulse / 2.0, atol=1e-12)
    np.testing.assert_allclose(body.angular_velocity, spin, atol=1e-9)
    np.testing.assert_allclose(
        body.velocity_at(point), impulse / 2.0 + np.cross(spin, point - middle), atol=1e-9
    )
    np.testing.assert_allclose(body.velocity_at(middle), impulse / 2.0, atol=1e-9)
    with pytest.raises(vx.SettingsError, match="point"):
        body.velocity_at((1, 2))


# ---- the world -----------------------------------------------------------------------------------


def test_time_counts_steps_and_goes_back_with_states():
    world = vx.World(time_step=0.01, gravity=(0, 0, -1))
    world.step(10)
    state = world.save_state()
    world.step(5, callback=lambda _: None)
    assert world.time == pytest.approx(0.15)
    world.restore_state(state)
    assert world.time == pytest.approx(0.1)
    np.testing.assert_array_equal(world.gravity, (0, 0, -1))
    with pytest.raises(ValueError, match="read-only"):
        world.gravity[2] = 0.0

    def interrupt(world: vx.World) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        world.step(5, callback=interrupt)
    assert world.time == pytest.approx(0.11)


def test_meshes_and_files_become_models_of_bodies(tmp_path, box: vx.Model):
    mesh = trimesh.creation.box((0.1, 0.2, 0.3))
    mesh.export(tmp_path / "part.stl")
    box.save(tmp_path / "part.vxs")
    world = vx.World()
    default = vx.Model.from_mesh(mesh)
    for shape in (mesh, tmp_path / "part.stl", str(tmp_path / "part.stl")):
        body = world.add(shape, pose=(0, 0, 1))
        assert isinstance(body.shape, vx.Model)
        assert body.shape.tolerance == pytest.approx(default.tolerance)
    saved = world.add(tmp_path / "part.vxs").shape
    assert isinstance(saved, vx.Model)
    assert saved.shell.points.tobytes() == box.shell.points.tobytes()
    with pytest.raises(vx.VoxshellError, match="missing"):
        world.add("missing.stl")
    with pytest.raises(vx.VoxshellError, match="missing"):
        world.add("missing.vxs")
    assert len(world.bodies) == 4


def test_reprs_say_what_is_there():
    world = vx.World(time_step=0.01)
    ball = world.add(vx.Sphere(0.1), mass=2.0, pose=(1, 2, 3), name="ball")
    assert repr(ball) == ("Body(0, 'ball', Sphere(radius=0.1), mass=2 kg, position=(1, 2, 3) m)")
    ground = world.add(vx.Plane(), mass=0)
    assert "static" in repr(ground)
    world.step(2)
    assert repr(world) == "World(2 bodies, 0 joints, time=0.02 s, time_step=0.01 s)"
    world.remove(ball)
    assert repr(ball) == "Body(0, 'ball', Sphere(radius=0.1), mass=2 kg, removed)"


class Turn:
    """Like a rotation of scipy."""

    def as_matrix(self) -> np.ndarray:
        return np.eye(3)


class Transform(Turn):
    """Like a rigid transform of scipy."""

    translation = np.zeros(3)


@pytest.mark.parametrize(
    ("pose", "advice"),
    [
        ((0, 0, 1, 0, 0, 0), r"angles in radians, call voxshell\.pose\(position, euler=\.\.\.\)"),
        (((0, 0, 1), (0, 0, 0)), r"in radians, call voxshell\.pose\(position, euler=\.\.\.\)"),
        ([[0, 0, 1]], r"reshape it to \(3,\)"),
        (np.zeros((3, 1)), r"reshape it to \(3,\)"),
        (Turn(), r"call voxshell\.pose\(position, xyzw=rotation\.as_quat\(\)\)"),
        (((0, 0, 1), Turn()), r"call voxshell\.pose\(position, xyzw=rotation\.as_quat\(\)\)"),
        (Transform(), r"pass the matrix that its as_matrix\(\) returns"),
    ],
)
def test_what_is_nearly_a_pose_is_refused_with_the_way_to_pass_it(pose, advice: str):
    with pytest.raises(vx.PoseError, match=f"; .*{advice}$"):
        vx.World().add(vx.Sphere(0.1), pose=pose)


@pytest.mark.parametrize(
    ("option", "advice"),
    [
        ("degrees", r"angles are radians; pass euler=numpy\.radians\(\(\.\.\.\)\)"),
        ("axis", r"pass axis_angle=\(axis, angle\), with the angle in radians"),
        ("angle", r"pass axis_angle=\(axis, angle\), with the angle in radians"),
        ("quat", r"pass xyzw=\.\.\. \(real part last\) or wxyz=\.\.\. \(real part first\)"),
        ("matrix", r"is a pose by itself; pass a \(3, 3\) one as rotation=\.\.\."),
    ],
)
def test_options_of_other_libraries_say_what_to_pass(option: str, advice: str):
    with pytest.raises(vx.InputTypeError, match=f"no argument '{option}': .*{advice}"):
        vx.pose((0, 0, 1), **{option: 1})
