from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from voxshell.model.mass_properties import MassProperties
from voxshell.robots.lumps import Lump
from voxshell.robots.matter import Matter
from voxshell.robots.mjcf.carriers import share_matter


def share(count: int) -> tuple[list[MassProperties], MassProperties]:
    names = [f"c{i}" for i in range(count)]
    lump_of = {name: Lump({name: np.eye(4)}) for name in [*names, "body"]}
    matter = Matter({lump_of["body"]: MassProperties(2.0, np.ones(3), np.diag([1.0, 2.0, 3.0]))})
    share_matter(matter, dict.fromkeys(names, "body"), lump_of)
    return [matter.of_lumps[lump_of[name]] for name in names], matter.of_lumps[lump_of["body"]]


@pytest.mark.parametrize("count", [1, 2, 30])
def test_a_body_and_its_carriers_have_the_matter_of_the_body(count):
    carriers, body = share(count)
    assert sum(it.mass for it in (body, *carriers)) == pytest.approx(2.0)
    assert sum(it.inertia[2, 2] for it in (body, *carriers)) == pytest.approx(3.0)
    assert min(it.mass for it in (body, *carriers)) >= 2.0 / 31 - 1e-12
    assert all(np.array_equal(it.center_of_mass, np.ones(3)) for it in carriers)


def test_a_tenth_goes_to_each():
    carriers, body = share(2)
    assert [it.mass for it in carriers] == [0.2, 0.2]
    assert body.mass == pytest.approx(1.6)


def test_a_body_with_several_joints_is_a_chain_of_links(write):
    joints = "<joint name='x' type='slide' axis='1 0 0'/><joint name='y' axis='0 1 0' pos='0 0 1'/>"
    path = write(
        f"<worldbody><body name='arm'>{joints}<geom type='box' size='1 1 1' mass='5'/>"
        "<body name='tool' pos='0 0 2'><geom size='0.1' mass='5'/></body></body></worldbody>"
    )
    world = vx.World(gravity=(0, 0, 0))
    robot = vx.load_mjcf(world, path)
    assert list(robot.links) == ["world", "arm/x", "arm", "tool"]
    assert sum(body.mass for body in robot.bodies) == pytest.approx(10)
    assert robot.links["arm/x"].body.mass == pytest.approx(1)
    robot.set_targets({"x": 0.5, "y": 0.4}, max_force=1000.0)
    world.step(400)
    expected = vx.pose((0.5, 0, 1)) @ vx.pose(axis_angle=((0, 1, 0), 0.4)) @ vx.pose((0, 0, 1))
    np.testing.assert_allclose(robot.links["tool"].pose, expected, atol=5e-3)
