"""Views of running worlds: pauses, speed, and that nothing else changes. No browser is needed."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import voxshell as vx
from live_worlds import PATIENCE, Screen, make_world, stepping, wait_for
from voxshell.simulation.live_frame import LiveFrame, take_frame

pytestmark = pytest.mark.usefixtures("screens")


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


def test_a_step_waits_for_the_speed_of_a_watched_view():
    world, _ = make_world(time_step=0.01)
    with world.view(speed=1.0, wait=0.0) as view:
        start = time.monotonic()
        world.step(1000)  # ten seconds, without a page
        view.count_pages(1)
        start = time.monotonic()
        world.step(50)
        # Only from below: a busy machine may take any time.
        assert time.monotonic() - start > 0.4


@pytest.mark.parametrize("ending", ["a page draws", "close"])
def test_the_first_step_of_a_view_with_a_speed_waits_for_a_page_and_says_so(
    ending: str, capsys: pytest.CaptureFixture[str]
):
    world, _ = make_world()
    view = world.view(speed=50.0)
    thread = threading.Thread(target=world.step, args=(5,))
    thread.start()
    assert is_still(world)
    assert thread.is_alive()
    if ending == "close":
        view.close()
    else:
        view.count_pages(1)
        assert is_still(world)
        assert thread.is_alive()
        view.begin()
    thread.join(PATIENCE)
    assert world.time == pytest.approx(5 * world.time_step)
    told = f"voxshell: open {view.address} to watch; the first step waits 30 s for it\n"
    assert capsys.readouterr() == ("", told)
    view.close()


@pytest.mark.parametrize(
    ("options", "told"),
    [({}, ""), ({"speed": 1.0, "wait": 0}, ""), ({"wait": 0.1}, "waits 0.1 s")],
)
def test_a_run_goes_on_without_a_page(
    options: dict[str, float], told: str, capsys: pytest.CaptureFixture[str]
):
    world, _ = make_world()
    with world.view(**options):
        world.step(5)
        world.step(5)
    said = capsys.readouterr().err
    assert told in said
    assert said.count("\n") == bool(told)


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


def test_long_steps_do_not_lower_the_mean_rate_of_frames(monkeypatch: pytest.MonkeyPatch):
    world, _ = make_world()
    read: list[float] = []

    def count(*arguments: object) -> LiveFrame | None:
        read.append(clock.now)
        return take_frame(*arguments)  # pyright: ignore[reportArgumentType]

    clock = Clock()
    monkeypatch.setattr("voxshell.simulation.live_view.time", clock)
    monkeypatch.setattr("voxshell.simulation.live_view.take_frame", count)
    with world.view(frames_per_second=30.0) as view:
        view.count_pages(1)
        read.clear()
        for _ in range(400):  # ten seconds
            clock.now += 0.025
            world.step()
        # Whether a frame is read after 25 or 50 ms, on average it is after 33.
        assert 299 <= len(read) <= 301


class Clock:
    """A clock that only the test moves."""

    now = 0.0

    def perf_counter(self) -> float:
        return self.now
