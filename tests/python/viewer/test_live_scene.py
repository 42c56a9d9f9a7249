"""The scene of a live view, without a browser."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import voxshell as vx
from live_worlds import read_frame
from voxshell.viewer.live_scene import LiveScene
from voxshell.viewer.palette import choose_colors
from voxshell.viewer.pins import as_light
from voxshell.viewer.server import silent_server

NOTHING_PULLS = np.zeros((0, 2, 3))


@pytest.fixture
def scene() -> Iterator[LiveScene]:
    with silent_server() as server:
        yield LiveScene(server.scene, {}, lambda *_: None)


def test_bodies_of_one_shape_are_one_node_and_may_come_and_go(scene: LiveScene):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    ball = vx.Sphere(0.1)
    balls = [world.add(ball, pose=(0.3 * i, 0, 1)) for i in range(5)]
    world.add(vx.Box((0.1, 0.1, 0.1)), mass=0)
    scene.show(read_frame(world), NOTHING_PULLS)
    assert len(scene._groups) == 2
    for body in balls[1:3]:
        world.remove(body)
    scene.show(read_frame(world), NOTHING_PULLS)
    node = next(group.node for group in scene._groups.values() if balls[0] in group.bodies)
    assert node.batched_positions == pytest.approx(
        scene.scale * np.array([balls[i].position for i in (0, 3, 4)]), rel=1e-6
    )
    assert len(node.batched_colors) == 3
    for body in list(world.bodies):
        world.remove(body)
    scene.show(read_frame(world), NOTHING_PULLS)
    assert not scene._groups
    assert not scene._grounds


def test_arrows_begin_at_contacts_and_are_as_long_as_their_forces_up_to_a_limit(scene: LiveScene):
    world = vx.World(sleeping=False)
    world.add(vx.Plane(), mass=0)
    world.add(vx.Box((0.1, 0.1, 0.1)), mass=1.0, pose=(0, 0, 0.1))
    world.step(100)
    frame = read_frame(world)
    scene.show(frame, NOTHING_PULLS)
    arrows = scene._find_arrows(frame) / scene.scale
    assert len(arrows) == len(frame.points) == 4
    assert arrows[:, 0] == pytest.approx(frame.points)
    lengths = np.linalg.norm(arrows[:, 1] - arrows[:, 0], axis=1)
    assert scene.extent is not None
    # A weight is a quarter of the body's diameter.
    assert lengths.sum() == pytest.approx(0.25 * scene.extent.body, rel=0.05)
    world.bodies[1].apply_impulse((0, 0, -50.0))
    world.step()
    arrows = scene._find_arrows(read_frame(world)) / scene.scale
    lengths = np.linalg.norm(arrows[:, 1] - arrows[:, 0], axis=1)
    assert lengths.max() <= scene.extent.body * 1.0001


def test_a_ground_is_drawn_a_hair_below_what_lies_on_it(scene: LiveScene):
    world = vx.World()
    plane = world.add(vx.Plane(offset=0.5), mass=0)
    world.add(vx.Box((0.1, 0.1, 0.1)), pose=(0, 0, 0.6))
    scene.show(read_frame(world), NOTHING_PULLS)
    # Display units, of which the view is six long.
    below = 0.5 * scene.scale - float(scene._grounds[plane].position[2])
    assert 0.001 < below < 0.006


def test_what_is_seen_holds_all_near_bodies_and_the_plane_below_but_nothing_far_away(
    scene: LiveScene,
):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    world.add(vx.Box((0.5, 0.5, 0.05)), mass=0, pose=(0, 0, 0.05))
    for x in (-0.5, 0.5):
        world.add(vx.Box((0.1, 0.1, 0.1)), pose=(x, 0, 0.3))
    world.add(vx.Box((0.1, 0.1, 0.1)), mass=0, pose=(100, 0, 0))
    extent = scene.find_extent(read_frame(world))
    assert extent is not None
    assert extent.low == pytest.approx((-0.6, -0.5, 0.0))
    assert extent.high == pytest.approx((0.6, 0.5, 0.4))
    assert extent.body == pytest.approx(0.2 * np.sqrt(3.0))


def test_nothing_is_shown_until_there_is_a_body_other_than_a_plane(scene: LiveScene):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    scene.show(read_frame(world), NOTHING_PULLS)
    assert scene.extent is None
    assert scene.deepest == 0.0
    assert not scene._grounds
    world.add(vx.Sphere(0.1), pose=(0, 0, 0.5))
    scene.show(read_frame(world), NOTHING_PULLS)
    assert scene.extent is not None
    assert len(scene._grounds) == 1


def test_bodies_are_seen_through_or_not(scene: LiveScene):
    world = vx.World()
    world.add(vx.Sphere(0.1))
    scene.show(read_frame(world), NOTHING_PULLS)
    (group,) = scene._groups.values()
    assert group.node.opacity == 0.55
    scene.set_see_through(False)
    assert group.node.opacity is None


def test_the_spring_of_the_mouse_is_an_arrow_as_long_as_it_lasts(scene: LiveScene):
    world = vx.World()
    ball = world.add(vx.Sphere(0.1))
    frame = read_frame(world)
    scene.show(frame, NOTHING_PULLS)
    assert "pulls" not in scene._extras
    lines = np.array([[ball.position, (0.3, 0, 0)]])
    scene.show(frame, lines)
    arrow = scene._extras["pulls"]
    assert arrow.batched_positions == pytest.approx(scene.scale * lines[:, 0], rel=1e-6)
    length = np.linalg.norm(lines[0, 1] - lines[0, 0])
    assert arrow.batched_scales[:, 2] == pytest.approx(scene.scale * length, rel=1e-6)
    scene.show(frame, NOTHING_PULLS)
    assert not arrow.visible
    scene.show(frame, lines)
    assert arrow.visible


def test_bodies_have_the_colors_that_a_replay_gives_them(scene: LiveScene):
    world = vx.World()
    world.add(vx.Box((1.0, 1.0, 0.1)), mass=0)
    shape = vx.Sphere(0.1)
    world.add(shape, pose=(0, 0, 1.0))
    world.add(vx.Box((0.1, 0.1, 0.1)), pose=(0.5, 0, 1.0))
    world.add(shape, pose=(-0.5, 0, 1.0))
    recorder = world.record()
    scene.show(read_frame(world), NOTHING_PULLS)
    world.step(20)
    expected = choose_colors(recorder.recording())
    for group in scene._groups.values():
        colors = as_light(np.array([expected[body.number] for body in group.bodies], np.float64))
        assert group.node.batched_colors.tolist() == colors.tolist()


def test_bodies_are_as_dark_as_their_colors():
    # viser takes colors of meshes as sRGB, and those of instances as linear intensities.
    world = vx.World()
    ball = world.add(vx.Sphere(0.1))
    with silent_server() as server:
        scene = LiveScene(server.scene, {ball: (255, 128, 0)}, lambda *_: None)
        scene.show(read_frame(world), NOTHING_PULLS)
        (group,) = scene._groups.values()
        assert group.node.batched_colors.tolist() == [[255, 55, 0]]
