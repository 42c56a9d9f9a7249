from __future__ import annotations

import pytest
import voxshell as vx

NEAR = 0.199
"""Where a ball touches one at the origin, and overlaps it a little."""


def ball(
    name: str, attributes: str = "", inside: str = "", joint: str = "<freejoint/>", x: float = 0.0
) -> str:
    geom = f"<geom name='{name}_geom' size='0.1' {attributes}/>"
    return f"<body name='{name}' pos='{x} 0 0'>{joint}{geom}{inside}</body>"


@pytest.fixture
def touching(write):
    """The pairs of bodies that collide, all in one place."""

    def touching(*bodies: str, rules: str = "", **options) -> set[frozenset[str]]:
        world = vx.World(gravity=(0, 0, 0))
        vx.load_mjcf(world, write(rules, f"<worldbody>{''.join(bodies)}</worldbody>"), **options)
        names = {body.number: body.name.partition("/")[2] for body in world.bodies}
        world.step()
        rows = world.contacts()
        return {
            frozenset((names[a], names[b]))
            for a, b in zip(rows["body_a"], rows["body_b"], strict=True)
        }

    return touching


AB = {frozenset(("a", "b"))}


def test_bits_decide_what_collides(touching):
    assert touching(ball("a"), ball("b")) == AB
    assert touching(ball("a", "contype='2'"), ball("b", "contype='4'")) == set()  # conaffinity is 1
    assert touching(ball("a", "contype='3'"), ball("b", "contype='4'")) == AB
    apart = "contype='{}' conaffinity='{}'"
    assert touching(ball("a", apart.format(1, 2)), ball("b", apart.format(1, 2))) == set()
    assert touching(ball("a", apart.format(1, 2)), ball("b", apart.format(2, 0))) == AB
    assert touching(ball("a", apart.format(0, 0)), ball("b")) == set()


def test_parent_and_child_do_not_collide_unless_told(touching):
    tree = ball("a", inside=ball("b", joint="<joint/>", x=NEAR))
    assert touching(tree) == set()
    told = "<option><flag filterparent='disable'/></option>"
    assert touching(tree, rules=told) == AB
    static = ball("a", joint="", inside=ball("b", joint="<joint/>", x=NEAR))
    assert touching(static) == AB


def test_a_chain_of_joints_is_no_way_around(touching):
    joints = "<joint axis='1 0 0'/><joint axis='0 1 0'/>"
    assert touching(ball("a", inside=ball("b", joint=joints, x=NEAR))) == set()


def test_grandchildren_collide_unless_the_call_says_no(touching):
    tree = ball("a", inside=ball("x", "contype='0' conaffinity='0'", joint="<joint/>",
                                 inside=ball("b", joint="<joint/>", x=NEAR)))  # fmt: skip
    assert touching(tree) == AB
    assert touching(tree, self_collision=False) == set()
    assert touching(ball("a"), ball("b"), self_collision=False) == AB


def test_pairs_can_be_excluded_or_named(touching):
    exclude = "<contact><exclude body1='b' body2='a'/><exclude body1='a' body2='none'/></contact>"
    assert touching(ball("a"), ball("b"), rules=exclude) == set()
    off = "contype='0' conaffinity='0'"
    pair = "<contact><pair geom1='a_geom' geom2='b_geom'/></contact>"
    assert touching(ball("a", off), ball("b", off), ball("c", off), rules=pair) == AB


def test_all_contacts_can_be_off(touching):
    off = "<option><flag contact='disable'/></option>"
    assert touching(ball("a"), ball("b"), rules=off) == set()


@pytest.mark.parametrize("bits", [(4, 8), (0, 0)])
def test_a_body_in_a_pair_with_a_plane_does_not_fall_through_it(write, bits):
    apart = f"contype='{bits[0]}' conaffinity='{bits[1]}'"
    plane = "<geom name='floor' type='plane' size='1 1 1'/>"
    body = f"<body name='a' pos='0 0 0.3'><freejoint/><geom name='g' size='0.1' {apart}/></body>"
    path = write(
        f"<worldbody>{plane}{body}</worldbody><contact><pair geom1='floor' geom2='g'/></contact>"
    )
    world = vx.World()
    robot = vx.load_mjcf(world, path)
    world.step(400)
    assert robot.links["a"].pose[2, 3] == pytest.approx(0.1, abs=2e-3)


def test_a_pair_of_a_geom_that_is_not_there_is_said(write):
    path = write(
        f"<worldbody>{ball('a')}</worldbody>",
        "\n<contact><pair geom1='a_geom' geom2='flor'/></contact>",
    )
    with pytest.warns(
        vx.RobotWarning, match=r"<pair> of geoms .* \('a_geom and flor at model.xml:2'\)"
    ):
        vx.load_mjcf(vx.World(), path)
