from __future__ import annotations

import warnings
from itertools import combinations

import numpy as np
import pytest
import voxshell as vx
from voxshell.robots.assembly import Assembly, check_place
from voxshell.robots.description import (
    Collision,
    Inertial,
    JointDescription,
    LinkDescription,
    Primitive,
    RobotDescription,
)
from voxshell.robots.lumps import find_lumps
from voxshell.robots.matter import complete_matter
from voxshell.robots.shapes import MeshSettings, Shaper

BALL = (Collision(Primitive("sphere", (0.1,)), np.eye(4)),)
MATTER = Inertial(1.0, np.zeros(3), np.eye(3) * 0.01)


def link(name, friction=None):
    return LinkDescription(name, f"f:{name}", BALL, MATTER, None, friction)


def joint(kind, parent, child, *, position=0.0, start=0.0, axis=(0.0, 2.0, 0.0)):
    frame = vx.pose((0, 0, 0.5))
    return JointDescription(
        f"{child}_joint", "f:9", kind, parent, child, vx.pose((1, 0, 0)), frame, position, start,
        axis, None, None, None, 0.0, 0.0, None,
    )  # fmt: skip


def add(world, links, joints, *, friction=None, place=None, apart=(), collide=True):
    robot = RobotDescription("f", "r", {links[0].name: np.eye(4)}, {it.name: it for it in links}, joints)  # fmt: skip
    lumps = find_lumps(robot)
    unique = list(dict.fromkeys(lumps.values()))
    shaper = Shaper(robot, MeshSettings(None, None, "model"))
    return Assembly(
        robot, lumps, complete_matter(robot, unique[1:]), {it: shaper.shape_of(it) for it in unique},
        np.eye(4) if place is None else place, friction=friction, joints_collide=collide,
        apart=combinations(unique, 2) if apart == "all" else apart,
    ).add(world)  # fmt: skip


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_joints_begin_where_they_should_and_read_so(kind):
    """The file has the links at position 0.2, and the joint begins at 0.5."""
    place = vx.pose((0, 0, 7))
    world = vx.World(gravity=(0, 0, 0))
    robot = add(world, [link("a"), link("b")], [joint(kind, "a", "b", position=0.2, start=0.5)], place=place)  # fmt: skip
    assert robot.positions["b_joint"] == pytest.approx(0.5)
    moved = vx.pose((0, 0.3, 0))
    if kind == "revolute":
        frame = vx.pose((0, 0, 0.5))
        moved = frame @ vx.pose(axis_angle=((0, 1, 0), 0.3)) @ np.linalg.inv(frame)
    np.testing.assert_allclose(robot.links["b"].pose, place @ vx.pose((1, 0, 0)) @ moved, atol=1e-9)


def test_bodies_have_the_friction_of_the_call_or_the_largest_of_the_file():
    links = [link("a"), link("b", 0.2), link("c", 0.7)]
    joints = [joint("floating", "a", "b"), joint("fixed", "b", "c")]
    by_name = {it.name: it for it in links}
    assert len(by_name) == 3
    robot = add(vx.World(), links, joints)
    assert robot.links["b"].body.friction == 0.7
    assert robot.links["a"].body.friction == 0.5
    assert add(vx.World(), links, joints, friction=0.1).links["b"].body.friction == 0.1


@pytest.mark.parametrize(
    ("apart", "collide", "count"), [((), True, 1), ((), False, 0), ("all", True, 0)]
)
def test_links_collide_unless_they_are_apart_or_a_joint_says_so(apart, collide, count):
    world = vx.World(gravity=(0, 0, 0))
    near = joint("revolute", "a", "b")
    near = JointDescription(**{**near.__dict__, "parent_from_child": vx.pose((0.1, 0, 0))})
    add(world, [link("a"), link("b")], [near], apart=apart, collide=collide)
    world.step()
    assert min(len(world.contacts()), 1) == count


def test_nothing_is_left_of_a_robot_that_fails():
    world = vx.World()
    with pytest.raises(vx.RobotError, match=r"^f: "):
        add(world, [link("a"), link("b")], [joint("prismatic", "a", "b", start=1e300)])
    assert world.bodies == ()


def test_arguments_are_checked_before_the_file():
    world = vx.World()
    assert check_place(world, None, 0.5).tolist() == np.eye(4).tolist()
    turned = vx.pose((0, 0, 1), xyzw=(0, 0, 1, 0))
    for form in (turned, (0, 0, 1, 0, 0, 1, 0), ((0, 0, 1), (0, 0, 1, 0))):
        assert check_place(world, form, 0.5).tolist() == turned.tolist()
    assert check_place(world, (0, 0, 1), 0.5).tolist() == vx.pose((0, 0, 1)).tolist()
    with pytest.raises(
        vx.InputTypeError,
        match="world must be a World, not str; the world comes first, and then the path",
    ):
        check_place("world", None, 0.5)
    with pytest.raises(vx.PoseError):
        check_place(world, np.zeros((4, 4)), 0.5)
    with pytest.raises(vx.SettingsError, match="friction"):
        check_place(world, None, -1.0)


def test_an_inertia_that_no_body_has_loads_with_a_warning(tmp_path):
    path = tmp_path / "robot.urdf"
    text = (
        '<robot name="r"><link name="{}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="{}" '
        'ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry><sphere radius="1"/></geometry>'
        "</collision></link></robot>"
    )
    path.write_text(text.format("disk", 5))
    world = vx.World(gravity=(0, 0, 0))
    with pytest.warns(vx.RobotWarning, match="1 link with an impossible inertia had .*disk"):
        [disk] = vx.load_urdf(world, path, fixed_base=False).bodies
    disk.apply_torque_impulse((0, 0, 1))
    assert disk.angular_velocity[2] == pytest.approx(0.5)
    path.write_text(text.format("rounded", 2.01))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        vx.load_urdf(world, path, fixed_base=False, pose=(9, 0, 0))


def test_targets_must_have_names():
    robot = add(vx.World(), [link("a"), link("b")], [joint("revolute", "a", "b")])
    with pytest.raises(vx.InputTypeError, match="positions must map the names of joints to num"):
        robot.set_targets([0.5, 0.1])
    with pytest.raises(vx.InputTypeError, match="velocities must map the names of joints to num"):
        robot.set_target_velocities(3)


def test_a_missing_world_is_explained(tmp_path):
    for load in (vx.load_urdf, vx.load_mjcf):
        name = load.__name__
        with pytest.raises(
            vx.InputTypeError, match=f"needs path: the world comes first, as in {name}"
        ):
            load(tmp_path / "a.xml")
        with pytest.raises(
            vx.InputTypeError, match=r"not .*Path; the world comes first, and then the"
        ):
            load(tmp_path / "a.xml", vx.World())
