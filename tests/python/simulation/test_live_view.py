"""Views of running worlds: pauses, drags, and that nothing else changes. No browser is needed."""

from __future__ import annotations

import gc
import signal
import subprocess
import sys
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.simulation.live_frame import LiveFrame, take_frame
from voxshell.simulation.live_pull import Pulls, effective_mass
from voxshell.simulation.live_view import LiveView

PATIENCE = 60.0
"""Seconds after which a test gives up; none measures how long anything takes."""


class Screen:
    """A page without a server, which keeps what it was shown."""

    address = "http://127.0.0.1:1/secret/"

    def __init__(self, *_: object, **__: object) -> None:
        self.frames: list[LiveFrame] = []
        self.closed = False

    def show(self, frame: LiveFrame, *, last: bool) -> None:
        self.frames.append(frame)

    def close(self) -> None:
        self.closed = True


@pytest.fixture(autouse=True)
def screens(monkeypatch: pytest.MonkeyPatch) -> list[Screen]:
    made: list[Screen] = []

    def make(*_: object, **__: object) -> Screen:
        made.append(Screen())
        return made[-1]

    monkeypatch.setattr("voxshell.viewer.live_page.LivePage", make)
    return made


def make_world(**options: object) -> tuple[vx.World, list[vx.Body]]:
    world = vx.World(**options)
    world.add(vx.Plane(), mass=0)
    model = vx.Model.from_mesh(trimesh.creation.icosphere(2, radius=0.1), voxel_size=0.02)
    return world, [
        world.add(model, pose=(0.03 * i, 0.0, 0.15 + 0.22 * i), mass=1.0 + i) for i in range(3)
    ]


def wait_for(wanted: Callable[[], bool], what: str) -> None:
    end = time.monotonic() + PATIENCE
    while not wanted():
        assert time.monotonic() < end, what
        time.sleep(0.005)


@contextmanager
def stepping(world: vx.World) -> Iterator[threading.Thread]:
    """Steps in a thread until the block ends; the view must not hold it up by then."""
    end = threading.Event()

    def run() -> None:
        while not end.is_set():
            world.step()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield thread
    finally:
        end.set()
        thread.join(PATIENCE)
        assert not thread.is_alive()


@pytest.mark.parametrize("recorded", [False, True])
def test_a_viewed_world_takes_the_same_steps_bit_for_bit(screens: list[Screen], recorded: bool):
    plain, bodies = make_world()
    viewed, seen = make_world()
    recorders = [world.record(every=3) for world in (plain, viewed)] if recorded else []
    with viewed.view(frames_per_second=1000) as view:
        for _ in range(60):
            plain.step(5)
        viewed.step(100)
        view.count_pages(1)
        for _ in range(100):
            viewed.step(2)
        wait_for(lambda: len(screens[0].frames) > 1, "nothing is shown")
    for body, other in zip(bodies, seen, strict=True):
        assert body.pose.tobytes() == other.pose.tobytes()
        assert body.linear_velocity.tobytes() == other.linear_velocity.tobytes()
    if recorded:
        first, second = (recorder.recording() for recorder in recorders)
        assert first.bodies[1].poses.tobytes() == second.bodies[1].poses.tobytes()
        assert first.contacts.depths.tobytes() == second.contacts.depths.tobytes()


def test_nothing_is_read_while_no_page_is_open(screens: list[Screen], monkeypatch):
    world, _ = make_world()
    with world.view():
        monkeypatch.setattr(
            "voxshell.simulation.live_view.take_frame", lambda *_: pytest.fail("read")
        )
        world.step(50)
        assert len(screens[0].frames) == 1  # what the page begins with


def test_the_newest_state_is_shown_once_nobody_steps(screens: list[Screen]):
    world, bodies = make_world()
    with world.view(frames_per_second=0.1) as view:
        view.count_pages(1)
        world.step(37)
        wait_for(lambda: screens[0].frames[-1].time == world.time, "the last step is not shown")
        assert np.array_equal(screens[0].frames[-1].poses[1], bodies[0].pose)


def test_a_page_that_opens_late_sees_where_bodies_are(screens: list[Screen]):
    world, _ = make_world()
    with world.view() as view:
        world.step(50)
        view.count_pages(1)
        wait_for(lambda: screens[0].frames[-1].time == world.time, "an old state is shown")


def test_a_pause_blocks_steps_until_it_ends():
    world, _ = make_world()
    # The view ends first: a run that waits for it would not.
    with stepping(world), world.view() as view:
        view.pause()
        assert view.paused
        wait_for(lambda: is_still(world), "steps go on")
        before = world.time
        for number in range(1, 4):
            view.allow_step()
            wait_for(lambda n=number: steps_since(world, before) >= n, "no step")
        assert is_still(world)
        assert steps_since(world, before) == 3
        view.resume()
        wait_for(lambda: world.time > before + 10 * world.time_step, "the pause does not end")


def steps_since(world: vx.World, before: float) -> int:
    return round((world.time - before) / world.time_step)


def is_still(world: vx.World) -> bool:
    before = world.time
    time.sleep(0.1)
    return world.time == before


def test_a_pause_holds_up_a_run_of_many_steps_in_one_call():
    world, _ = make_world()
    with world.view(paused=True) as view:
        thread = threading.Thread(target=world.step, args=(10,))
        thread.start()
        view.allow_step()
        wait_for(lambda: world.time > 0.0, "no step")
        assert is_still(world)
        assert world.time == world.time_step
        view.resume()
        thread.join(PATIENCE)
        assert world.time == pytest.approx(10 * world.time_step)


@pytest.mark.parametrize("ending", ["close", "the last page leaves"])
def test_a_paused_run_goes_on_after(ending: str):
    world, _ = make_world()
    view = world.view()
    view.count_pages(2)
    with stepping(world):
        view.pause()
        wait_for(lambda: is_still(world), "steps go on")
        view.count_pages(-1)
        assert is_still(world)
        before = world.time
        if ending == "close":
            view.close()
        else:
            view.count_pages(-1)
        wait_for(lambda: world.time > before, "the run still waits")
    view.close()


def test_control_c_ends_a_paused_run():
    code = """
import voxshell as vx
world = vx.World()
world.add(vx.Sphere(0.1))
with world.view(port=0, paused=True):
    print("waiting", flush=True)
    world.step(1000)
"""
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stdout.readline() == "waiting\n"
        time.sleep(0.5)
        assert process.poll() is None
        process.send_signal(signal.SIGINT)
        process.wait(PATIENCE)
        assert process.stderr.read().rstrip().endswith("KeyboardInterrupt")


def test_a_world_has_one_view_at_a_time(screens: list[Screen]):
    world, _ = make_world()
    view = world.view()
    with pytest.raises(
        vx.SettingsError, match=r"has a view already, at http://127.0.0.1:1/secret/"
    ):
        world.view()
    view.close()
    view.close()
    assert screens[0].closed
    assert not view.is_open
    assert repr(view) == "LiveView(closed)"
    with world.view() as second:
        assert second.is_open
        world.step(3)


def test_a_view_ends_with_its_world(screens: list[Screen]):
    world, _ = make_world()
    world.view()
    gone = weakref.ref(world)
    del world, _
    gc.collect()
    assert gone() is None
    assert screens[0].closed


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"port": -1}, "port must be from 0 to 65535"),
        ({"speed": 0.0}, "speed must be above 0"),
        ({"frames_per_second": 0}, "frames_per_second must be above 0"),
    ],
)
def test_bad_options_are_refused(options: dict[str, float], message: str, screens: list[Screen]):
    world, _ = make_world()
    with pytest.raises(vx.SettingsError, match=message):
        world.view(**options)
    assert screens == []


def test_a_step_waits_for_the_speed_of_a_watched_view():
    world, _ = make_world(time_step=0.01)
    with world.view(speed=1.0) as view:
        start = time.monotonic()
        world.step(1000)  # ten seconds, without a page
        view.count_pages(1)
        start = time.monotonic()
        world.step(50)
        # Only from below: a busy machine may take any time.
        assert time.monotonic() - start > 0.4


# ---- drags ---------------------------------------------------------------------------------------


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
    pulls = Pulls(np.zeros(3), world.time_step)
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


# ---- frames --------------------------------------------------------------------------------------


def read(world: vx.World) -> LiveFrame:
    frame = take_frame(world._simulation, world.bodies, world.gravity, world.time_step)
    assert frame is not None
    return frame


def test_forces_on_a_resting_body_carry_it_whichever_body_of_the_pair_it_is():
    for ground_first in (True, False):
        world = vx.World(sleeping=False)
        add_ground = lambda world=world: world.add(vx.Box((1, 1, 0.1)), mass=0, pose=(0, 0, -0.1))  # noqa: E731
        if ground_first:
            add_ground()
        world.add(vx.Box((0.1, 0.1, 0.1)), mass=3.0, pose=(0, 0, 0.1))
        if not ground_first:
            add_ground()
        world.step(400)
        assert read(world).forces.sum(axis=0) == pytest.approx((0, 0, 3.0 * 9.81), abs=0.3)


def test_the_energy_of_a_tumbling_fall_is_kept():
    world = vx.World(time_step=1 / 1000)
    box = world.add(vx.Box((0.1, 0.2, 0.3)), mass=2.0)
    box.angular_velocity = (3.0, 1.0, 0.2)
    box.linear_velocity = (1.0, 0.0, 2.0)
    before = read(world)
    world.step(300)
    after = read(world)
    assert abs(after.potential - before.potential) > 1.0
    assert after.kinetic + after.potential == pytest.approx(
        before.kinetic + before.potential,
        abs=0.04,  # steps of a fall lose m g^2 t dt / 2
    )


def test_an_empty_world_can_be_viewed(screens: list[Screen]):
    world = vx.World()
    with world.view() as view:
        view.count_pages(1)
        world.step(3)
        world.add(vx.Sphere(0.1))
        world.step(3)
        wait_for(lambda: len(screens[0].frames[-1].bodies) == 1, "a new body is not shown")


def test_threads_add_remove_drag_and_close_while_another_steps():
    world, bodies = make_world()
    view = world.view(frames_per_second=1000)
    view.count_pages(1)
    with stepping(world):
        for _ in range(30):
            body = world.add(vx.Sphere(0.05), pose=(0.5, 0, 0.5))
            view.pulls.grab("hand", body, np.zeros(3), 0.1)
            view.pulls.move("hand", np.array((0.5, 0.1, 0.5)))
            bodies[0].apply_impulse((0.01, 0, 0))
            world.remove(body)
        view.close()
    assert len(view.pulls) == 0
