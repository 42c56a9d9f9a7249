from __future__ import annotations

import pytest
import voxshell as vx


def test_a_name_as_an_index_says_how_to_find_a_body_by_name():
    world = vx.World()
    ball = world.add(vx.Sphere(0.1), name="ball")
    with pytest.raises(vx.InputTypeError, match=r"by name: \{body.name: body for body in") as error:
        world.bodies["ball"]  # pyright: ignore[reportArgumentType, reportCallIssue]
    advice = str(error.value).split("by name: ")[1]
    assert eval(advice, {"world": world}) is ball


def test_a_name_that_several_bodies_have_finds_all_of_them():
    world = vx.World()
    balls = [world.add(vx.Sphere(0.1), name="ball") for _ in range(2)]
    world.add(vx.Sphere(0.1), name="other")
    with pytest.raises(vx.InputTypeError, match="2 bodies have this name: ") as error:
        world.bodies["ball"]  # pyright: ignore[reportArgumentType, reportCallIssue]
    assert eval(str(error.value).split("this name: ")[1], {"world": world}) == balls


def test_it_is_a_tuple():
    world = vx.World()
    balls = [world.add(vx.Sphere(0.1), pose=(0, 0, z)) for z in range(3)]
    assert world.bodies == tuple(balls)
    assert world.bodies[1] is balls[1]
    assert world.bodies[-2:] == (balls[1], balls[2])
    assert isinstance(world.bodies, tuple)
    with pytest.raises(IndexError):
        world.bodies[3]
