from __future__ import annotations

import warnings

import numpy as np
import pytest
import voxshell as vx

BALL = "<geom size='0.1'/>"


@pytest.fixture
def load(write):
    def load(*bodies: str, before: str = "", **options):
        path = write(before, f"<worldbody>{''.join(bodies)}</worldbody>")
        return vx.load_mjcf(vx.World(), path, **options)

    return load


def test_a_scene_of_several_bodies_is_one_robot(load):
    root = vx.pose((0, 0, 10))
    robot = load(
        "<geom type='plane' name='floor' size='1 1 1' pos='0 0 -1'/><geom type='box' size='1 1 1'/>",
        f"<body name='table' pos='5 0 0'>{BALL}<body name='leg' pos='1 0 0'>{BALL}</body></body>",
        f"<body name='cup' pos='5 0 1'><freejoint name='free'/>{BALL}</body>",
        f"<body name='lamp' pos='6 0 0' euler='0 0 90'><joint name='turn'/>{BALL}</body>",
        pose=root,
    )
    assert list(robot.links) == ["world/floor", "world", "table", "leg", "cup", "lamp"]
    assert list(robot.joints) == ["turn"]
    assert robot.links["leg"].body is robot.links["table"].body
    assert [robot.links[name].body.motion for name in robot.links] == [
        *["static"] * 4, *["dynamic"] * 2,
    ]  # fmt: skip
    np.testing.assert_allclose(robot.links["leg"].pose[:3, 3], (6, 0, 10))
    np.testing.assert_allclose(robot.links["cup"].pose[:3, 3], (5, 0, 11))
    assert isinstance(robot.links["world/floor"].body.shape, vx.Plane)
    robot._world.step(400)
    assert robot.links["cup"].pose[2, 3] == pytest.approx(10.2, abs=2e-3)


def test_planes_lie_in_any_body_that_stands_still(load):
    plane = "<geom type='plane' size='1 1 1' pos='0 0 1'/>"
    robot = load(
        f"<body name='a' pos='0 0 1'>{BALL}<body name='b' pos='1 0 0'>{plane}</body></body>"
    )
    [name] = [name for name in robot.links if name.startswith("b/")]
    np.testing.assert_allclose(robot.links[name].pose[:3, 3], (1, 0, 2))


def test_a_free_joint_heeds_no_limits_of_its_class(load):
    limited = "<default><joint limited='true' armature='1'/></default>"
    body = f"<body name='a'><joint type='free' armature='0'/>{BALL}</body>"
    assert load(body, before=limited).links["a"].body.motion == "dynamic"


def test_frames_move_what_lies_in_them(load):
    robot = load(
        f"""<frame pos='0 0 1' euler='90 0 0'><body name='a' pos='0 1 0'>
        <frame pos='1 0 0' euler='0 0 90'><joint name='j' axis='1 0 0' pos='1 0 0'/>{BALL}
        <inertial pos='1 0 0' mass='1' diaginertia='1 1 1'/></frame></body></frame>"""
    )
    np.testing.assert_allclose(robot.links["a"].pose[:3, 3], (0, 0, 2), atol=1e-12)
    np.testing.assert_allclose(robot.joints["j"].kind.axis, (0, 1, 0), atol=1e-12)
    np.testing.assert_allclose(robot.links["a"].body.bounds.mean(axis=0), (1, 0, 2), atol=1e-2)


def test_classes_of_bodies_hold_for_what_lies_in_them(load):
    robot = load(
        "<body name='a' childclass='small'><geom/><freejoint/></body><body name='b'><geom/><freejoint/></body>",
        before="<default><geom size='0.2'/><default class='small'><geom size='0.1'/></default></default>",
    )
    sizes = [np.ptp(robot.links[name].body.bounds, axis=0)[0] for name in "ab"]
    np.testing.assert_allclose(sizes, (0.2, 0.4), rtol=0.05)


def test_bodies_and_joints_without_names_are_numbered(load):
    robot = load(f"<body><joint/><joint axis='1 0 0'/>{BALL}<body><joint/>{BALL}</body></body>")
    assert list(robot.links) == ["world", "body 1/body 1/joint 0", "body 1", "body 2"]
    assert list(robot.joints) == ["body 1/joint 0", "body 1/joint 1", "body 2/joint 0"]


def test_geoms_that_are_only_seen_have_a_mass_and_no_surface(load):
    robot = load("<body name='a'><freejoint/><geom size='0.1' mass='3' contype='0' conaffinity='0' rgba='1 0 0 1'/></body>"
                 "<geom type='plane' size='1 1 1'/>")  # fmt: skip
    body = robot.links["a"].body
    assert body.mass == 3.0
    assert robot.colors == {body: (255, 0, 0)}
    robot._world.step(200)
    assert body.pose[2, 3] < -4.0


def test_frictions_are_the_largest_of_the_geoms_or_the_calls(load):
    body = "<body name='a'><freejoint/><geom size='0.1' friction='0.3'/><geom size='0.1' friction='0.7 1 1'/></body>"
    assert load(body).links["a"].body.friction == 0.7
    assert load(body, friction=0.2).links["a"].body.friction == 0.2
    assert (
        load("<body name='a'><freejoint/><geom size='1'/></body>").links["a"].body.friction == 1.0
    )


def test_a_fall_onto_an_ellipsoid_and_a_mesh_of_vertices(load):
    robot = load(
        "<body name='a' pos='0 0 0.5'><freejoint/><geom type='ellipsoid' size='0.3 0.2 0.1'/></body>",
        "<geom type='plane' size='1 1 1'/>",
        "<body name='b' pos='2 0 0.5'><freejoint/><geom type='mesh' mesh='cube'/></body>",
        before="<asset><mesh name='cube' vertex='-.1 -.1 -.1 .1 -.1 -.1 -.1 .1 -.1 .1 .1 -.1 -.1 -.1 .1 .1 -.1 .1 -.1 .1 .1 .1 .1 .1'/></asset>",
    )
    robot._world.step(400)
    assert robot.links["a"].pose[2, 3] == pytest.approx(0.1, abs=5e-3)
    assert robot.links["b"].pose[2, 3] == pytest.approx(0.1, abs=2e-3)


WRONG = {
    "is the second body with that name": f"<body name='a'>{BALL}</body><body name='a'>{BALL}</body>",
    "has a second joint 'j'": f"<body><joint name='j'/><joint name='j'/>{BALL}</body>",
    "can be free": f"<body><freejoint/><joint/>{BALL}</body>",
    "is a plane of a moving body": "<body><joint/><geom type='plane' size='1 1 1'/></body>",
    "has a <replicate>, which is not supported": "<replicate count='2'/>",
    "there is no such class": "<body childclass='none'/>",
    "elements are nested": "<body><frame>" * 60 + "</frame></body>" * 60,
    "limit of 1000 bodies": f"<body>{BALL}</body>" * 1001,
}


@pytest.mark.parametrize("message", WRONG)
def test_wrong_bodies_are_refused_with_file_and_line(load, message):
    with pytest.raises(vx.RobotError) as refusal:
        load(WRONG[message])
    assert message in str(refusal.value)
    assert "model.xml" in str(refusal.value)


def test_a_moving_body_of_nothing_gets_a_little_mass(load):
    with pytest.warns(
        vx.RobotWarning, match=r"1 link without a mass and a shape got 0.1 kg \('a'\)"
    ):
        load("<body name='a'><joint/></body>")


def test_nothing_is_left_of_a_model_that_fails(write):
    world = vx.World()
    huge = "<body pos='1e300 0 0'><freejoint/><geom size='1'/></body>"
    with warnings.catch_warnings(), pytest.raises(vx.RobotError):
        vx.load_mjcf(world, write(f"<worldbody><body>{BALL}</body>{huge}</worldbody>"))
    assert world.bodies == ()


BOX = "<geom type='box' size='.1 .2 .3' pos='.1 .2 .3' euler='0 0 90'/>"
ALIGN = "<freejoint align='true'/>"


def test_free_bodies_can_have_the_frames_of_their_inertias(load):
    def place(joint: str, inside: str = BOX, compiler: str = "") -> np.ndarray:
        body = f"<body name='a' pos='0 0 1'>{joint}{inside}</body>"
        robot = load(body, before=f"<compiler {compiler}/>")
        link = robot.links["a"]
        (low, high), center = link.body.bounds, link.body.pose @ [*link.body._center, 1]
        np.testing.assert_allclose((low + high) / 2, (0.1, 0.2, 1.3), atol=1e-9)
        np.testing.assert_allclose(center[:3], (0.1, 0.2, 1.3), atol=1e-9)
        return link.pose

    there = vx.pose((0.1, 0.2, 1.3), axis_angle=((0, 0, 1), np.pi / 2))
    here = vx.pose((0, 0, 1))
    aligns = "alignfree='true'"
    np.testing.assert_allclose(place(ALIGN), there, atol=1e-12)
    np.testing.assert_allclose(place("<freejoint/>", compiler=aligns), there, atol=1e-12)
    np.testing.assert_allclose(place("<joint type='free'/>", compiler=aligns), there, atol=1e-12)
    np.testing.assert_allclose(place("<freejoint/>"), here)
    np.testing.assert_allclose(place("<freejoint align='false'/>", compiler=aligns), here)
    given = f"{BOX}<inertial pos='.1 .2 .3' mass='1' diaginertia='1 1 1' euler='90 0 0'/>"
    turned = vx.pose((0.1, 0.2, 1.3), axis_angle=((1, 0, 0), np.pi / 2))
    np.testing.assert_allclose(place(ALIGN, given), turned, atol=1e-12)


def test_bodies_that_hold_others_or_have_no_free_joint_are_not_aligned(load):
    inner = f"<body name='b' pos='1 0 0'>{BALL}</body>"
    robot = load(f"<body name='a' pos='0 0 1'>{ALIGN}{BOX}<frame pos='0 0 0'>{inner}</frame></body>",
                 f"<body name='c' pos='5 0 1'><joint/>{BOX}</body>",
                 before="<compiler alignfree='true'/>")  # fmt: skip
    np.testing.assert_allclose(robot.links["a"].pose, vx.pose((0, 0, 1)), atol=1e-12)
    np.testing.assert_allclose(robot.links["c"].pose, vx.pose((5, 0, 1)), atol=1e-12)
