from __future__ import annotations

import pytest
import voxshell as vx
from voxshell.robots.mjcf.overlaps import keep_overlaps_apart


def pair(world: vx.World, distance: float) -> tuple[vx.Body, vx.Body]:
    """Balls of 0.2 m."""
    return world.add(vx.Sphere(0.1), name="r/a"), world.add(
        vx.Sphere(0.1), pose=(distance, 0, 0), name="r/b"
    )


@pytest.mark.parametrize(
    ("distance", "found"), [(0.0, ["a and b"]), (0.19, ["a and b"]), (0.198, []), (0.3, [])]
)
def test_bodies_that_overlap_by_a_fiftieth_are_kept_apart(distance, found):
    world = vx.World(gravity=(0, 0, 0))
    assert keep_overlaps_apart(world, [pair(world, distance)]) == found
    world.step()
    assert (len(world.contacts()) > 0) == (distance == 0.198)


def test_an_arm_that_is_folded_into_itself_is_not_thrown_about(write):
    """Hulls of grippers overlap by centimeters, which threw light fingers at 50 m/s."""
    geom = "<geom type='box' size='0.02 0.02 0.1' mass='0.03'/>"
    inner = (
        f"<body name='{{}}' pos='0.01 0 0'><joint axis='0 1 0' pos='0 0 -0.1'/>{geom}{{}}</body>"
    )
    tree = inner.format("a", inner.format("b", inner.format("c", inner.format("d", ""))))
    world = vx.World()
    with pytest.warns(vx.RobotWarning, match=r"overlap at the start .*'a and c'.*'a and d'"):
        robot = vx.load_mjcf(world, write(f"<worldbody>{tree}</worldbody>"))
    speeds = []
    world.step(100, lambda _: speeds.extend(abs(it.linear_velocity).max() for it in robot.bodies))
    assert max(speeds) < 10.0


def test_bodies_of_different_trees_that_overlap_collide(write):
    balls = "".join(f"<body pos='{x} 0 0'><freejoint/><geom size='0.1'/></body>" for x in (0, 0.15))
    world = vx.World(gravity=(0, 0, 0))
    vx.load_mjcf(world, write(f"<worldbody>{balls}</worldbody>"))
    world.step()
    assert len(world.contacts()) > 0
