"""Bodies that are dragged, without a browser."""

from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from live_worlds import make_world
from voxshell.simulation.live_pull import Pulls, effective_mass
from voxshell.simulation.live_view import LiveView

pytestmark = pytest.mark.usefixtures("screens")


def drag(
    view: LiveView,
    world: vx.World,
    body: vx.Body,
    local: np.ndarray,
    target: np.ndarray,
    steps: int,
) -> np.ndarray:
    """Where the grabbed point is after each step."""
    diameter = float(np.linalg.norm(np.ptp(body.bounds, axis=0)))
    view.pulls.grab("hand", body, local, diameter)
    view.pulls.move("hand", target)
    path = []
    world.step(steps, lambda _: path.append(body.pose[:3, :3] @ local + body.pose[:3, 3]))
    view.pulls.release("hand")
    return np.array(path)


@pytest.mark.parametrize("local", [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.1, 0.05, -0.05)])
def test_the_grabbed_point_comes_to_the_pointer_and_stays(local: tuple[float, float, float]):
    world = vx.World(gravity=(0, 0, 0))
    body = world.add(vx.Box((0.1, 0.05, 0.05)), mass=3.0)
    target = np.array(local) + np.array((0.1, -0.05, 0.08))
    with world.view() as view:
        path = drag(view, world, body, np.array(local), target, 800)
    gaps = np.linalg.norm(path - target, axis=1)
    assert gaps[0] > 0.12
    assert gaps[-1] < 1e-3
    # Critically damped: once near, it does not swing out again, but for the body's turning.
    assert gaps[np.argmax(gaps < 0.01) :].max() < 0.02


def test_light_and_heavy_bodies_follow_alike():
    paths = []
    for mass in (0.01, 500.0):
        world = vx.World(gravity=(0, 0, 0))
        body = world.add(vx.Box((0.1, 0.05, 0.05)), mass=mass)
        with world.view() as view:
            paths.append(drag(view, world, body, np.array((0.1, 0, 0)), np.array((0, 0, 0.3)), 200))
    assert np.abs(paths[0] - paths[1]).max() < 1e-9
    assert np.abs(np.diff(paths[0], axis=0)).max() > 1e-3


def test_a_body_hangs_on_the_spring_a_fiftieth_of_its_diameter_below_the_pointer():
    world = vx.World(time_step=1 / 1000)
    ball = world.add(vx.Sphere(0.5), mass=4.0, linear_damping=0.5)
    with world.view() as view:
        view.pulls.grab("hand", ball, np.zeros(3), 1.0)
        world.step(3000)
    assert ball.position[2] == pytest.approx(-0.02, rel=0.05)


def test_a_far_pointer_pulls_no_harder_than_one_a_diameter_away():
    world = vx.World(gravity=(0, 0, 0))
    ball = world.add(vx.Sphere(0.1), mass=2.0)
    pulls = Pulls(world.time_step)
    pulls.grab("hand", ball, np.zeros(3), 0.2)
    forces = []
    for distance in (0.1, 0.2, 5.0):
        pulls.move("hand", np.array((distance, 0, 0)))
        forces.append(pulls._held["hand"].compute_force()[0][0])
    assert forces[1] == pytest.approx(2.0 * forces[0])
    assert forces[2] == pytest.approx(forces[1])


def test_a_release_lets_the_body_move_freely():
    world = vx.World(gravity=(0, 0, 0))
    ball = world.add(vx.Sphere(0.1))
    with world.view() as view:
        drag(view, world, ball, np.zeros(3), np.array((0.2, 0, 0)), 10)
        speed = ball.linear_velocity[0]
        assert speed > 0.0
        world.step(10)
        assert ball.linear_velocity[0] == speed


def test_a_removed_body_is_let_go():
    world, bodies = make_world()
    with world.view() as view:
        view.pulls.grab("hand", bodies[0], np.zeros(3), 0.2)
        view.pulls.grab("other", bodies[1], np.zeros(3), 0.2)
        world.remove(bodies[0])
        world.step()
        assert len(view.pulls) == 1
        world.remove(bodies[1])
        assert len(view.pulls.find_lines()) == 0
        assert len(view.pulls) == 0


def test_the_effective_mass_is_what_a_push_meets_on_average():
    world = vx.World(gravity=(0, 0, 0))
    rod = world.add(vx.Box((0.5, 0.02, 0.03)), mass=2.0)
    point = np.array((0.5, 0.02, 0.0))
    yields = []
    for axis in np.eye(3):
        rod.linear_velocity = rod.angular_velocity = (0, 0, 0)
        rod.apply_impulse(axis, at=point)
        yields.append(rod.velocity_at(point) @ axis)
    assert effective_mass(rod, point) == pytest.approx(1.0 / np.mean(yields))


def test_a_hand_holds_one_body_and_a_hand_that_holds_nothing_moves_nothing():
    world, bodies = make_world()
    pulls = Pulls(world.time_step)
    pulls.move("hand", np.ones(3))
    pulls.release("hand")
    assert len(pulls) == 0
    for body in bodies:
        pulls.grab("hand", body, np.zeros(3), 0.2)
    pulls.grab("other", bodies[0], np.zeros(3), 0.2)
    assert [pull.body for pull in pulls._held.values()] == [bodies[-1], bodies[0]]
    pulls.move("hand", np.ones(3))
    lines = pulls.find_lines()
    assert lines[:, 0] == pytest.approx(np.array([bodies[-1].position, bodies[0].position]))
    assert lines[:, 1] == pytest.approx(np.array([(1, 1, 1), bodies[0].position]))
    pulls.release_all()
    assert pulls.find_lines().shape == (0, 2, 3)
