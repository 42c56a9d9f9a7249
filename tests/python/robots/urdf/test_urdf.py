"""Robots from URDF files: what is read, what is refused, and a gripper that carries a mug."""

from __future__ import annotations

import importlib
import os
import re
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx

INERTIAL = """<inertial><origin xyz="0.1 0 0"/><mass value="2"/>
  <inertia ixx="0.01" iyy="0.02" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial>"""
BALL = """<collision><geometry><sphere radius="0.05"/></geometry></collision>"""


def link(name, content=INERTIAL + BALL):
    return f'<link name="{name}">{content}</link>'


def joint(name, kind, parent, child, content=""):
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{content}</joint>"
    )


LIMIT = '<limit lower="-1" upper="0.5" effort="30" velocity="2"/>'


@pytest.fixture
def write(tmp_path):
    def write(*content):
        path = tmp_path / "robot.urdf"
        path.write_text(f'<robot name="tester">{"".join(content)}</robot>')
        return path

    return write


@pytest.fixture(scope="module")
def example():
    folder = Path(__file__).parents[4] / "examples/python"
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        yield importlib.import_module("11_urdf_gripper")


@pytest.fixture
def gripper(example, tmp_path):
    return example.build(tmp_path)


def hold(gripper, example, **options):
    """Takes the mug, lifts and holds it; the deepest that the fingers were in it, meters."""
    world, robot, mug = gripper
    fingers = {robot.links[name].body.number for name in ("outer", "inner")}
    deepest = [0.0]

    def measure(world):
        contacts = world.contacts()
        for a, b in (
            (contacts["body_a"], contacts["body_b"]),
            (contacts["body_b"], contacts["body_a"]),
        ):
            between = np.isin(a, [*fingers]) & (b == mug.number)
            deepest[0] = max(deepest[0], contacts["depth"][between].max(initial=0.0))

    example.take(world, robot, note=measure, **options)
    world.step(1000, measure)
    return deepest[0]


def test_gripper_lifts_a_mug_by_its_wall(gripper, example):
    world, robot, mug = gripper
    on_the_ground = mug.pose
    deepest = hold(gripper, example)
    assert mug.pose[2, 3] > 0.1  # for a second and more
    assert mug.pose[2, 2] > 0.99
    assert 0.0 < deepest < 0.5e-3  # a quarter of a voxel
    # One finger is inside the mug, the other outside: neither has passed through the wall.
    distances = {
        name: np.linalg.norm((np.linalg.inv(mug.pose) @ robot.links[name].pose)[:2, 3])
        for name in ("inner", "outer")
    }
    assert distances["inner"] < example.WALL < distances["outer"]
    assert robot.positions["turn"] == pytest.approx(example.TURN, abs=1e-3)
    assert robot.positions["lift"] == pytest.approx(-0.05, abs=1e-3)
    robot.set_targets({"grip": 0.0})
    world.step(1000)
    assert mug.pose[2, 3] == pytest.approx(on_the_ground[2, 3], abs=0.05)  # it has fallen
    assert mug.pose[2, 3] < 0.06


def test_gripper_that_does_not_close_lifts_nothing(gripper, example):
    _, robot, mug = gripper
    before = mug.pose
    hold(gripper, example, close=0.0)
    np.testing.assert_allclose(mug.pose, before, atol=1e-3)
    assert robot.positions["lift"] == pytest.approx(-0.05, abs=1e-3)


def test_gripped_mug_restores_to_the_bit(gripper, example):
    world, robot, mug = gripper
    example.take(world, robot)
    state = world.save_state()

    def carry():
        robot.set_targets({"turn": -0.3})
        trace = []
        world.step(300, lambda world: trace.append(mug.pose.tobytes() + world.contacts().tobytes()))
        return trace

    first = carry()
    world.restore_state(state)
    assert carry() == first
    assert mug.pose[2, 3] > 0.1


def test_follower_mirrors_its_leader(gripper):
    world, robot, _ = gripper
    robot.set_targets({"grip": 0.015, "lift": 0.0})
    world.step(600)
    assert robot.positions["grip"] == pytest.approx(0.015, abs=1e-4)
    assert robot.positions["follower"] == pytest.approx(0.015, abs=1e-4)
    with pytest.raises(vx.SettingsError, match="'follower' mimics another"):
        robot.set_targets({"follower": 0.0})


def test_joint_types_limits_and_frames(write):
    path = write(
        link("base", BALL),
        link("arm"),
        link("slide"),
        link("wheel"),
        link("flange", ""),
        link("cargo"),
        joint(
            "shoulder",
            "revolute",
            "base",
            "arm",
            '<origin xyz="0 0 1" rpy="0 0 1.57079632679"/><axis xyz="0 1 0"/>'
            + LIMIT
            + '<dynamics friction="0.5" damping="0.1"/>',
        ),
        joint("rail", "prismatic", "arm", "slide", '<origin xyz="0.3 0 0"/>' + LIMIT),
        joint("axle", "continuous", "arm", "wheel", '<axis xyz="0 0 2"/>'),
        joint("bolt", "fixed", "slide", "flange", '<origin xyz="0 0 0.1"/>'),
        joint("free", "floating", "base", "cargo", '<origin xyz="5 0 0"/>'),
    )
    world = vx.World(gravity=(0, 0, 0))
    root = trimesh.transformations.rotation_matrix(0.5, (0, 0, 1))
    root[:3, 3] = 1, 2, 3
    robot = vx.load_urdf(world, path, pose=root)
    assert list(robot.joints) == ["shoulder", "rail", "axle"]
    assert [robot.joints[name].kind.limits for name in robot.joints] == [(-1, 0.5), (-1, 0.5), None]
    assert (robot.joints["shoulder"].kind.friction, robot.joints["shoulder"].kind.damping) == (
        0.5,
        0.1,
    )
    assert np.array(robot.joints["rail"].kind.axis).tolist() == [1, 0, 0]
    assert robot.links["base"].body.mass == 0.0
    assert robot.links["flange"].body is robot.links["slide"].body
    assert len(world.bodies) == 5
    assert robot.positions == pytest.approx(dict.fromkeys(robot.joints, 0.0), abs=1e-9)
    turned = trimesh.transformations.rotation_matrix(np.pi / 2, (0, 0, 1))
    turned[2, 3] = 1
    np.testing.assert_allclose(robot.links["arm"].pose, root @ turned, atol=1e-9)
    robot.set_targets({"shoulder": 0.4, "rail": -0.2}, max_speed=1.5)
    robot.set_target_velocities({"axle": 9.0}, max_force=5.0)
    world.step(400)
    assert robot.positions["shoulder"] == pytest.approx(0.4, abs=2e-3)
    assert robot.positions["rail"] == pytest.approx(-0.2, abs=2e-3)
    assert robot.positions["axle"] == pytest.approx(18.0, rel=0.03)  # turns are counted
    bent = turned @ trimesh.transformations.rotation_matrix(0.4, (0, 1, 0))
    bent = bent @ trimesh.transformations.translation_matrix((0.3 - 0.2, 0, 0.1))
    np.testing.assert_allclose(robot.links["flange"].pose, root @ bent, atol=5e-3)
    robot.remove()
    assert world.bodies == ()
    assert world.joints == ()


def test_links_held_by_fixed_joints_weigh_together(write):
    """Two halves of a bar are the bar."""
    half = """<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/>
      </inertial><collision><geometry><box size="0.5 0.1 0.1"/></geometry></collision>"""
    path = write(
        link("left", half),
        link("right", half),
        link("tool", ""),
        joint("weld", "fixed", "left", "right", '<origin xyz="0.5 0 0"/>'),
        joint("mount", "fixed", "right", "tool", '<origin xyz="0.25 0 0"/>'),
    )
    world = vx.World(gravity=(0, 0, 0))
    robot = vx.load_urdf(world, path, fixed_base=False)
    (body,) = robot.bodies
    assert body.mass == 2.0
    body.apply_impulse((0, 1, 0), at=(0.75, 0, 0))
    np.testing.assert_allclose(body.linear_velocity, (0, 0.5, 0), atol=1e-12)
    inertia = 2 * 0.05 + 2 * 0.25**2
    np.testing.assert_allclose(body.angular_velocity, (0, 0, 0.5 / inertia), atol=1e-9)
    np.testing.assert_allclose(body.bounds, [[-0.25, -0.05, -0.05], [0.75, 0.05, 0.05]], atol=2e-3)
    np.testing.assert_allclose(robot.links["tool"].pose[:3, 3], (0.75, 0, 0))


def test_a_link_smaller_than_the_voxel_size_gets_a_smaller_one(write, tmp_path):
    trimesh.creation.box((0.008, 0.004, 0.004)).export(tmp_path / "screw.stl")
    mesh = """<collision><geometry><mesh filename="package://some_robot/screw.stl"/></geometry></collision>"""
    robot = vx.load_urdf(vx.World(), write(link("base", mesh)), voxel_size=0.01)
    [body] = robot.bodies
    assert body.shape.field.voxel_size == pytest.approx(0.008)


def test_models_are_uniform_or_built_to_a_tolerance(write, tmp_path):
    trimesh.creation.box((0.1, 0.05, 0.05)).export(tmp_path / "part.stl")
    path = write(
        link("a", '<collision><geometry><mesh filename="part.stl"/></geometry></collision>')
    )
    [body] = vx.load_urdf(vx.World(), path).bodies
    assert body.shape.tolerance is None
    assert body.shape.field.voxel_size == pytest.approx(0.001)
    [body] = vx.load_urdf(vx.World(), path, tolerance=0.0003).bodies
    assert body.shape.tolerance == pytest.approx(0.0003)
    for sizes in ({"resolution": 50}, {"voxel_size": 0.001}):
        with pytest.raises(vx.SettingsError, match="give only one of tolerance, voxel_size and re"):
            vx.load_urdf(vx.World(), path, tolerance=0.0003, **sizes)
    with pytest.raises(vx.SettingsError, match="tolerance must be"):
        vx.load_urdf(vx.World(), path, tolerance=-1.0)


def test_links_that_cannot_collide_are_not_judged(write, tmp_path):
    """Two thin plates of a robot, which would miss each other, and a third one beside it."""
    trimesh.creation.box((1.0, 1.0, 0.004)).export(tmp_path / "plate.stl")
    mesh = INERTIAL + '<collision><geometry><mesh filename="plate.stl"/></geometry></collision>'
    path = write(
        link("a", mesh), link("b", mesh), joint("x", "continuous", "a", "b", '<origin xyz="0 0 1"/>'),
    )  # fmt: skip
    world = vx.World()
    vx.load_urdf(world, path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        world.step()
    plate = vx.Model.from_mesh(trimesh.creation.box((1.0, 1.0, 0.004)), resolution=100)
    world.add(plate, pose=(9, 0, 0))
    with pytest.warns(
        vx.AccuracyWarning,
        match=r"^contacts between '.*' may be missed .* load robots with tolerance=0\.0002",
    ):
        world.step()


@pytest.mark.parametrize("mesh_as", ["model", "hull"])
def test_meshes_are_scaled_and_placed(write, tmp_path, mesh_as):
    trimesh.creation.box(bounds=[(0, 0, 0), (10, 20, 40)]).export(tmp_path / "part.stl")
    mesh = """<collision><origin xyz="1 0 0" rpy="0 0 1.57079632679"/>
      <geometry><mesh filename="package://some_robot/part.stl" scale="0.01 -0.01 0.01"/></geometry></collision>"""
    world = vx.World()
    robot = vx.load_urdf(world, write(link("base", mesh)), mesh_as=mesh_as, resolution=40)
    body = robot.links["base"].body
    assert isinstance(body.shape, vx.Model if mesh_as == "model" else vx.ConvexHull)
    np.testing.assert_allclose(body.bounds, [[1, 0, 0], [1.2, 0.1, 0.4]], atol=4e-3)
    hit = world.ray_cast((1.1, 0.05, 1), (1.1, 0.05, -1))[0]
    assert hit["point"][2] == pytest.approx(0.4, abs=2e-3)


def test_robots_do_not_hit_themselves_unless_told(write):
    path = write(
        link("base"), link("a"), link("b"),
        joint("x", "continuous", "base", "a"), joint("y", "continuous", "base", "b"),
    )  # fmt: skip
    for self_collision in (False, True):
        world = vx.World(gravity=(0, 0, 0))
        vx.load_urdf(world, path, self_collision=self_collision)
        world.step(2)
        assert (len(world.contacts()) > 0) == self_collision


WRONG = {
    'has <limit lower="low">; give 1 finite number': [
        link("a"), link("b"), joint("x", "revolute", "a", "b", '<limit lower="low" upper="1"/>'),
    ],
    "it is not valid XML": ["<link"],
    "it has no <link>": [],
    "link 'a' has a mass of -2 kg": [link("a", INERTIAL.replace('"2"', '"-2"'))],
    "link 'a' has a sphere of [-0.05] m": [link("a", BALL.replace("0.05", "-0.05"))],
    "link 'a' has a mesh 'no.stl' that is missing": [
        link("a", '<collision><geometry><mesh filename="no.stl"/></geometry></collision>'),
    ],
    "joint 'x' has the type 'planar'": [link("a"), link("b"), joint("x", "planar", "a", "b")],
    "joint 'x' has an axis of [0.0, 0.0, 0.0]": [
        link("a"), link("b"), joint("x", "continuous", "a", "b", '<axis xyz="0 0 0"/>'),
    ],
    "joint 'x' has a child 'c', but there is no such link": [
        link("a"), joint("x", "fixed", "a", "c"),
    ],
    "link 'b' is the child of two joints, 'x' and 'y'": [
        link("a"), link("b"), joint("x", "fixed", "a", "b"), joint("y", "fixed", "a", "b"),
    ],
    "one link that is not a joint's child, but has 2 ('a', 'b')": [link("a"), link("b")],
    "links 'b', 'c' form a loop": [
        link("a"), link("b"), link("c"), joint("x", "fixed", "b", "c"), joint("y", "fixed", "c", "b"),
    ],
    "link 'a' is the second link of that name; the first is in line 1": [link("a"), link("a")],
    "joint 'y' mimics 'z', which is not a moving joint": [
        link("base"), link("a"), joint("y", "continuous", "base", "a", '<mimic joint="z"/>'),
    ],
}  # fmt: skip


@pytest.mark.parametrize("message", WRONG)
def test_wrong_files_are_refused_by_name(write, message):
    path = write(*WRONG[message])
    world = vx.World()
    with pytest.raises(vx.RobotError) as refusal:
        vx.load_urdf(world, path)
    assert str(path) in str(refusal.value)
    assert message in str(refusal.value)
    assert world.bodies == ()


OTHER_KINDS = {
    "<COLLADA/>": "it is a <COLLADA>, not a <robot>: it is a mesh; pass it to voxshell.Model.from_mesh",
    '<mujoco model="m"/>': "it is a <mujoco>, not a <robot>: load MJCF files with load_mjcf",
    "<sdf version='1.6'/>": "it is a <sdf>, not a <robot>: SDF files are not read; convert it to URDF",
    '<robot name="r" xmlns:xacro="x"><xacro:include filename="a.xacro"/></robot>': "it has no <link>, "
    "but <xacro:include>: it is a xacro file that is not expanded; run xacro ",
}


@pytest.mark.parametrize("text", OTHER_KINDS)
def test_files_of_other_kinds_are_named(tmp_path, text):
    path = tmp_path / "robot.urdf"
    path.write_text(text)
    with pytest.raises(vx.RobotError, match=re.escape(OTHER_KINDS[text])) as refusal:
        vx.load_urdf(vx.World(), path)
    assert str(path) in str(refusal.value)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("part.stl", "it is a mesh, not a URDF file; pass it to voxshell.Model.from_mesh"),
        ("part.OBJ", "it is a mesh, not a URDF file; pass it to voxshell.Model.from_mesh"),
        ("part.vxs", "it is a model, not a URDF file; pass it to voxshell.Model.load"),
        ("part.txt", "it is not valid XML: "),
    ],
)
def test_meshes_and_models_are_not_called_damaged_xml(tmp_path, name, message):
    path = tmp_path / name
    path.write_bytes(b"solid part\0")
    with pytest.raises(vx.RobotError, match=re.escape(f"{path}: {message}")):
        vx.load_urdf(vx.World(), path)


def test_damaged_meshes_are_named_with_their_link(write, tmp_path):
    (tmp_path / "bad.stl").write_bytes(b"solid nothing")
    path = write(
        link("a", '<collision><geometry><mesh filename="bad.stl"/></geometry></collision>')
    )
    with pytest.raises(vx.RobotError, match=r"robot\.urdf:1: link 'a': .*bad\.stl"):
        vx.load_urdf(vx.World(), path)


def test_a_sphere_that_is_a_point_is_left_out_with_a_warning(write):
    point = '<collision><geometry><sphere radius="0.0"/></geometry></collision>'
    path = write(link("a", BALL + point))
    with pytest.warns(vx.RobotWarning, match=r"not simulated: a sphere of radius 0 \('a'\)"):
        robot = vx.load_urdf(vx.World(), path)
    assert isinstance(robot.links["a"].body.shape, vx.Sphere)
    assert robot.links["a"].body.shape.radius == 0.05


@pytest.mark.parametrize("mesh_as", ["model", "hull"])
@pytest.mark.parametrize(
    "faces",
    [[(0, 1, 2), (1, 3, 2)], [(0, 1, 2), (1, 3, 2), (0, 2, 1), (1, 2, 3)], [(0, 1, 2), (1, 2, 3)]],
    ids=["open", "both sides", "wound both ways"],
)
def test_a_flat_mesh_becomes_a_thin_sheet_with_a_warning(write, tmp_path, mesh_as, faces):
    corners = [(0, 0, 0.1), (1, 0, 0.1), (0, 1, 0.1), (1, 1, 0.1)]
    trimesh.Trimesh(corners, faces, process=False).export(tmp_path / "flat.obj")
    flat = '<collision><geometry><mesh filename="flat.obj"/></geometry></collision>'
    path = write(link("a", flat), link("b", flat), joint("j", "revolute", "a", "b", LIMIT))
    world = vx.World()
    with pytest.warns(vx.RobotWarning, match=r"became sheets 5 mm thick \('a', 'b'\)"):
        robot = vx.load_urdf(world, path, mesh_as=mesh_as, fixed_base=True)
    size = np.ptp(robot.links["a"].body.shape.mesh.vertices, axis=0)
    np.testing.assert_allclose(size, (1.0, 1.0, 0.005), atol=0.006)
    balls = [
        world.add(vx.Sphere(0.05), pose=(*place, 0.3))
        for place in ((0.25, 0.2), (0.75, 0.8))  # each over one triangle
    ]
    world.step(200)
    for ball in balls:
        assert ball.position[2] == pytest.approx(0.1525, abs=2e-3)


def test_a_flat_mesh_without_a_mass_weighs_as_its_sheet_does(write, tmp_path):
    trimesh.creation.box((1, 1, 0)).export(tmp_path / "flat.stl")
    path = write(
        '<link name="a"><collision><geometry><mesh filename="flat.stl"/></geometry></collision></link>'
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        robot = vx.load_urdf(vx.World(), path, fixed_base=False)
    assert [each.category for each in caught] == [vx.RobotWarning]
    assert robot.links["a"].body.mass == pytest.approx(1000.0 * 0.005, rel=0.01)


def test_a_mesh_that_is_a_line_is_refused_by_link_and_line(write, tmp_path):
    (tmp_path / "line.obj").write_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3\nf 2 4 3\n")
    path = write(
        link("a", '<collision><geometry><mesh filename="line.obj"/></geometry></collision>')
    )
    with pytest.raises(vx.RobotError, match=r"'a': .*line\.obj: .*or give it a thickness"):
        vx.load_urdf(vx.World(), path, mesh_as="hull")


def test_wrong_calls_are_refused(write, tmp_path):
    path = write(link("base"), link("a"), joint("x", "continuous", "base", "a"))
    world = vx.World()
    with pytest.raises(vx.MissingFileError, match=r"cannot read .*none\.urdf: it does not exist"):
        vx.load_urdf(world, tmp_path / "none.urdf")
    with pytest.raises(vx.SettingsError, match="'model' or 'hull', not 'box'"):
        vx.load_urdf(world, path, mesh_as="box")
    robot = vx.load_urdf(world, path)
    with pytest.raises(vx.SettingsError, match="no moving joint 'z'; it has 'x'"):
        robot.set_targets({"z": 1.0})
    with pytest.raises(vx.SettingsError, match="no effort for joint 'x'; pass max_force"):
        robot.set_targets({"x": 1.0})
    robot.set_targets({"x": 1.0}, max_force=1.0)


def test_without_pycollada_it_says_what_to_install(write, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "collada", None)
    (tmp_path / "part.dae").write_text("<COLLADA/>")
    mesh = '<collision><geometry><mesh filename="part.dae"/></geometry></collision>'
    with pytest.raises(vx.MissingExtraError, match=r"voxshell\[urdf\]"):
        vx.load_urdf(vx.World(), write(link("a", mesh)))


def test_a_missing_mass_is_computed_from_the_shape(write):
    path = write(link("base", ""), link("a", BALL), joint("x", "continuous", "base", "a"))
    with pytest.warns(
        vx.RobotWarning, match=r"without a mass got that of .* at 1000 kg/m3 \('a'\)"
    ):
        robot = vx.load_urdf(vx.World(), path)
    assert robot.links["a"].body.mass == pytest.approx(1000 * 4 / 3 * np.pi * 0.05**3)


def test_what_moves_without_mass_and_shape_gets_a_little_mass(write):
    path = write(link("base", ""), link("a", ""), joint("x", "continuous", "base", "a"))
    with pytest.warns(vx.RobotWarning, match=r"without a mass and a shape got 0.1 kg \('a'\)"):
        robot = vx.load_urdf(vx.World(), path)
    assert robot.links["a"].body.mass == 0.1


@pytest.mark.parametrize("moments", ["0 0 0", "0.01 -0.02 0.03"])
def test_an_inertia_that_no_body_has_is_computed_from_the_shape(write, moments):
    x, y, z = moments.split()
    tensor = f'<inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="0" ixz="0" iyz="0"/>'
    box = '<collision><geometry><box size="0.2 0.4 0.6"/></geometry></collision>'
    path = write(link("a", f'<inertial><mass value="3"/>{tensor}</inertial>{box}'))
    with pytest.warns(vx.RobotWarning, match=r"without a valid inertia got .*\('a'\)"):
        robot = vx.load_urdf(vx.World(gravity=(0, 0, 0)), path, fixed_base=False)
    (body,) = robot.bodies
    body.apply_torque_impulse((0, 0, 1))
    np.testing.assert_allclose(body.angular_velocity, (0, 0, 12 / (3 * (0.04 + 0.16))), rtol=1e-9)


@pytest.mark.parametrize("limit", ["", "<limit effort='1'/>", "<limit lower='1' upper='-1'/>"])
def test_a_joint_without_limits_moves_without_an_end(write, limit):
    path = write(link("a"), link("b"), joint("x", "revolute", "a", "b", limit))
    with pytest.warns(vx.RobotWarning, match=r"without <limit>.*\('x'\)"):
        robot = vx.load_urdf(vx.World(), path)
    assert robot.joints["x"].kind.limits is None


def test_a_follower_without_an_effort_follows(write):
    path = write(
        link("base"), link("a"), link("b"), joint("x", "continuous", "base", "a"),
        joint("y", "continuous", "base", "b", '<mimic joint="x"/>'),
    )  # fmt: skip
    world = vx.World(gravity=(0, 0, 0))
    with pytest.warns(
        vx.RobotWarning, match=r"1 joint with <mimic> and without an effort got .*\('y'\)"
    ):
        robot = vx.load_urdf(world, path)
    robot.set_targets({"x": 0.5}, max_force=10.0)
    world.step(200)
    assert robot.positions["y"] == pytest.approx(0.5, abs=1e-2)


def test_the_axis_of_a_fixed_joint_does_not_matter(write):
    path = write(link("a"), link("b"), joint("x", "fixed", "a", "b", '<axis xyz="0 0 0"/>'))
    assert len(vx.load_urdf(vx.World(), path).bodies) == 1


def test_padding_after_the_last_element_does_not_matter(write):
    path = write(link("a"))
    path.write_bytes(path.read_bytes() + b"\r\n\0\0")
    assert list(vx.load_urdf(vx.World(), path).links) == ["a"]


def test_optional_variables_of_the_environment_have_their_default(write, monkeypatch):
    origin = '<origin xyz="$(optenv PLACE_OF_B 0.1 0 0.2)"/>'
    path = write(link("a"), link("b"), joint("x", "continuous", "a", "b", origin))
    robot = vx.load_urdf(vx.World(), path)
    np.testing.assert_allclose(robot.links["b"].pose[:3, 3], (0.1, 0, 0.2))
    monkeypatch.setenv("PLACE_OF_B", "1 2 3")
    robot = vx.load_urdf(vx.World(), path)
    np.testing.assert_allclose(robot.links["b"].pose[:3, 3], (1, 2, 3))


@pytest.mark.parametrize(
    "name", ["package://bot/parts/box.stl", "package://parts/box.stl", "parts\\box.stl",
             "$(find bot)/parts/box.stl", "model://bot/parts/box.stl", " parts/box.stl"],
)  # fmt: skip
def test_meshes_are_found_from_the_folder_upwards(tmp_path, name):
    folder = tmp_path / "bot"
    (folder / "parts").mkdir(parents=True)
    (folder / "urdf").mkdir()
    trimesh.creation.box((0.1, 0.2, 0.3)).export(folder / "parts/box.stl")
    mesh = f'<collision><geometry><mesh filename="{name}"/></geometry></collision>'
    path = folder / "urdf/bot.urdf"
    path.write_text(f'<robot name="bot">{link("a", mesh)}</robot>')
    (body,) = vx.load_urdf(vx.World(), path, mesh_as="hull").bodies
    np.testing.assert_allclose(np.ptp(body.bounds, axis=0), (0.1, 0.2, 0.3), atol=5e-3)


def test_collada_meshes_have_a_unit(write, tmp_path):
    pytest.importorskip("collada")
    data = trimesh.creation.box((100, 200, 300)).export(file_type="dae")
    text = data.decode().replace("<asset>", '<asset><unit name="millimeter" meter="0.001"/>')
    (tmp_path / "part.dae").write_text(text)
    mesh = '<collision><geometry><mesh filename="part.dae"/></geometry></collision>'
    (body,) = vx.load_urdf(vx.World(), write(link("a", mesh)), mesh_as="hull").bodies
    np.testing.assert_allclose(np.ptp(body.bounds, axis=0), (0.1, 0.2, 0.3), atol=5e-3)


def test_ball_joints_and_capsules(write):
    capsule = '<collision><geometry><capsule radius="0.1" length="0.4"/></geometry></collision>'
    path = write(link("a"), link("b", INERTIAL + capsule), joint("x", "spherical", "a", "b"))
    world = vx.World()
    robot = vx.load_urdf(world, path)
    assert list(robot.ball_joints) == ["x"]
    assert robot.joints == {}
    np.testing.assert_allclose(
        np.ptp(robot.links["b"].body.bounds, axis=0), (0.2, 0.2, 0.6), atol=5e-3
    )
    robot.remove()
    assert world.joints == ()


def test_colors_of_visuals_are_kept(write):
    shape = "<geometry><sphere radius='1'/></geometry>"
    path = write(
        '<material name="red"><color rgba="1 0 0 1"/></material>',
        link("a", INERTIAL + BALL + f'<visual>{shape}<material name="red"/></visual>'),
        link("b", INERTIAL + BALL
             + f'<visual>{shape}<material><color rgba="0 0.2 1 1"/></material></visual>'),
        joint("x", "continuous", "a", "b"),
    )  # fmt: skip
    world = vx.World()
    robot = vx.load_urdf(world, path)
    recorder = world.record()
    world.step()
    tracks = recorder.recording(colors=robot.colors).bodies
    assert [track.color for track in tracks] == [(255, 0, 0), (0, 51, 255)]
    assert [robot.colors[body] for body in robot.bodies] == [(255, 0, 0), (0, 51, 255)]


def test_a_mesh_that_refers_to_a_pipe_keeps_no_robot_waiting(tmp_path: Path):
    """An `mtllib` that named a pipe waited until something was written into it."""
    os.mkfifo(tmp_path / "pipe")
    tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    (tmp_path / "part.obj").write_text("mtllib pipe\n" + tetrahedron)
    (tmp_path / "robot.urdf").write_text(
        '<robot name="r"><link name="l"><collision><geometry><mesh filename="part.obj"/></geometry>'
        "</collision></link></robot>"
    )
    program = "import sys, voxshell as vx; print(vx.load_urdf(vx.World(), sys.argv[1]))"
    command = [sys.executable, "-c", program, str(tmp_path / "robot.urdf")]
    run = subprocess.run(command, capture_output=True, text=True, timeout=30)
    assert "1 link" in run.stdout


@pytest.mark.parametrize("effort", ["0", "-1", "inf"])
def test_an_effort_that_is_no_force_is_quoted(write, effort):
    limit = f'<limit lower="-1" upper="0.5" effort="{effort}" velocity="2"/>'
    robot = vx.load_urdf(
        vx.World(), write(link("base"), link("a"), joint("x", "revolute", "base", "a", limit))
    )
    text = f"the file states effort=\"{effort}\" for joint 'x'; pass max_force"
    with pytest.raises(vx.SettingsError, match=text):
        robot.set_targets({"x": 0.1})


def test_a_warning_about_models_of_robots_begins_with_what_helps_robots(write, tmp_path):
    trimesh.creation.box((1.0, 1.0, 0.004)).export(tmp_path / "plate.stl")
    mesh = INERTIAL + '<collision><geometry><mesh filename="plate.stl"/></geometry></collision>'
    path = write(link("a", mesh))
    world = vx.World()
    vx.load_urdf(world, path)
    vx.load_urdf(world, path, fixed_base=False, pose=(0, 0, 1))
    remedy = r"mm; load robots with tolerance=0\.0002 \(voxshell\.contact_bounds reports the effect\), or "
    with pytest.warns(vx.AccuracyWarning, match=remedy) as caught:
        world.step()
    assert "voxel_size=" not in str(caught[0].message)
    plate = vx.Model.from_mesh(trimesh.creation.box((1.0, 1.0, 0.0041)), resolution=100)
    world.add(plate, pose=(9, 0, 0))
    with pytest.warns(
        vx.AccuracyWarning, match=r"tolerance=0\.0002, and build the model of 'body 2' to a to"
    ):
        world.step()
