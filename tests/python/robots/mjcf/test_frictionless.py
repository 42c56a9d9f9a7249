from __future__ import annotations

import math
import warnings

import numpy as np
import pytest
import voxshell as vx

SLOPE = math.radians(10.0)
SECONDS = 1.0


def floor(attributes: str = "") -> str:
    return f"<geom name='floor' type='plane' size='5 5 1' euler='0 10 0' {attributes}/>"


def block(name: str, attributes: str = "", y: float = 0.0) -> str:
    """A block that lies on the floor, whose slope goes down along x."""
    geom = f"<geom name='{name}_geom' type='box' size='0.1 0.1 0.1' {attributes}/>"
    place = f"pos='{0.1 * math.sin(SLOPE)} {y} {0.1 * math.cos(SLOPE)}' euler='0 10 0'"
    return f"<body name='{name}' {place}><freejoint/>{geom}</body>"


@pytest.fixture
def slide(write):
    """How far blocks slide in a second, by name, and the warnings."""

    def slide(*parts: str, rules: str = "", **options) -> tuple[dict[str, float], list[str]]:
        world = vx.World()
        path = write("\n", rules, "<worldbody>", *parts, "</worldbody>")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            robot = vx.load_mjcf(world, path, **options)
        blocks = {name: link for name, link in robot.links.items() if not name.startswith("world")}
        begins = {name: link.pose[:3, 3] for name, link in blocks.items()}
        world.step(round(SECONDS / world.time_step))
        way = {
            name: float(np.linalg.norm(link.pose[:3, 3] - begins[name]))
            for name, link in blocks.items()
        }
        return way, [str(each.message) for each in caught]

    return slide


FREE = 0.5 * 9.81 * math.sin(SLOPE) * SECONDS**2
SLICK = "condim='1'"
PAIR = "<contact><pair geom1='floor' geom2='a_geom' {}/></contact>"


def test_blocks_slide_where_both_geoms_are_without_friction(slide):
    way, said = slide(floor(SLICK), block("a", SLICK))
    assert way["a"] == pytest.approx(FREE, rel=0.02)
    assert not said
    for geoms in ((floor(), block("a", SLICK)), (floor(SLICK), block("a"))):
        way, said = slide(*geoms)
        assert way["a"] < 0.01
        assert not said


def test_the_geom_of_higher_priority_decides(slide):
    way, said = slide(floor(), block("a", f"{SLICK} priority='1'"))
    assert way["a"] == pytest.approx(FREE, rel=0.02)
    way, said = slide(floor(SLICK), block("a", "condim='3' priority='-1'"))
    assert way["a"] == pytest.approx(FREE, rel=0.02)
    assert not said


def test_a_pair_can_be_without_friction(slide):
    for attributes in ("friction='0 0 0 0 0'", SLICK):
        way, said = slide(floor(), block("a"), rules=PAIR.format(attributes))
        assert way["a"] == pytest.approx(FREE, rel=0.02)
        assert not said


def test_a_pair_has_friction_whatever_its_geoms_say(slide):
    way, said = slide(floor(SLICK), block("a", SLICK), rules=PAIR.format(""))
    assert way["a"] < 0.01
    assert not said


def test_what_bodies_cannot_have_is_said_once_with_its_line(slide):
    """The floor lets block a slide, and holds block b."""
    way, said = slide(floor(SLICK), block("a", SLICK), block("b", y=1.0))
    assert way["b"] < 0.01
    [message] = said
    assert 'contacts without friction (condim="1"): a body has one friction' in message
    assert "'floor at model.xml:2', 'a_geom at model.xml:2'" in message
    [message] = slide(floor(), block("a"), block("b", y=1.0), rules=PAIR.format(SLICK))[1]
    assert (
        "friction of a <pair>: that of its bodies counts ('floor and a_geom at model.xml:2')"
        in message
    )


def test_the_friction_of_a_pair_is_said_where_it_is_not_that_of_the_bodies(slide):
    half = "friction='0.5'"
    said = slide(floor(half), block("a", half), rules=PAIR.format("friction='0.7 0.7'"))[1]
    assert "friction of a <pair>" in said[0]
    # A world multiplies the frictions of bodies.
    assert not slide(floor(half), block("a", half), rules=PAIR.format("friction='0.25 0.25'"))[1]


def test_the_friction_of_the_call_comes_before_all(slide):
    way, said = slide(floor(SLICK), block("a", SLICK), friction=1.0)
    assert way["a"] < 0.01
    assert not said


def test_a_tree_that_meets_only_itself_keeps_its_friction(write):
    """It may stand on a floor that is added otherwise."""
    inner = f"<body name='b' pos='0.5 0 0'><joint/><geom size='0.1' {SLICK}/></body>"
    middle = f"<body name='x' pos='0.5 0 0'><joint/><geom size='0.1' contype='0' conaffinity='0'/>{inner}</body>"
    path = write(
        f"<worldbody><body name='a'><freejoint/><geom size='0.1' {SLICK}/>{middle}</body></worldbody>"
    )
    with pytest.warns(vx.RobotWarning, match="contacts without friction"):
        robot = vx.load_mjcf(vx.World(), path)
    assert [robot.links[name].body.friction for name in "ab"] == [1.0, 1.0]
