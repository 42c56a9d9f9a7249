"""One world used by several threads: each call waits for its turn, steps let others in between."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import suppress

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at

MAY_FAIL = (vx.SettingsError, vx.RecordingError)
"""Bodies that another thread has removed, and states of a world that another thread has changed."""


def run_together(works: list[Callable[[], object]], seconds: float) -> list[BaseException]:
    """Calls each again and again, in a thread of its own; returns what they must not raise."""
    end = time.monotonic() + seconds
    raised: list[BaseException] = []
    calls = [0] * len(works)

    def repeat(index: int) -> None:
        try:
            while time.monotonic() < end:
                with suppress(*MAY_FAIL):
                    works[index]()
                calls[index] += 1
        except BaseException as error:
            raised.append(error)

    threads = [threading.Thread(target=repeat, args=(i,)) for i in range(len(works))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert min(calls) > 0, calls
    return raised


def test_eight_threads_on_one_world_do_not_crash():
    model = vx.Model.from_mesh(trimesh.creation.icosphere(2, radius=0.1), voxel_size=0.02)
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    balls = [world.add(model, pose=at(z=0.1 + 0.2 * i)) for i in range(4)]
    recorder = world.record(every=50)

    def add_and_remove() -> None:
        body = world.add(model, pose=at(z=1.0))
        joint = world.add_joint(vx.HingeJoint(), None, body)
        joint.set_target_velocity(1.0, max_force=1.0)
        world.remove(body)

    def go_back() -> None:
        world.restore_state(world.save_state())

    def read_all() -> None:
        for body in list(world.bodies):
            body.pose, body.linear_velocity, body.bounds, body.sleeping, body.friction  # noqa: B018

    def push() -> None:
        for ball in balls:
            ball.apply_impulse((0.01, 0.0, 0.0))
            ball.friction = 0.4

    raised = run_together(
        [
            lambda: world.step(20),
            lambda: world.step(5, callback=lambda world: world.contacts()),
            add_and_remove,
            go_back,
            lambda: world.ray_cast(np.tile([0.0, 0.0, 3.0], (50, 1)), np.zeros((50, 3))),
            lambda: (world.query_contacts(balls[0]), world.contacts(), world.timings),
            read_all,
            lambda: (push(), recorder.recording()),
        ],
        seconds=3.0,
    )
    assert raised == []


def test_bodies_are_read_from_another_thread_while_the_world_steps():
    world = vx.World(sleeping=False)
    world.add(vx.Plane(), mass=0)
    balls = [world.add(vx.Sphere(0.1), pose=at(z=0.2 * i)) for i in range(100)]
    is_done = threading.Event()
    waits: list[float] = []

    def read() -> None:
        while not is_done.is_set():
            begin = time.perf_counter()
            balls[0].pose  # noqa: B018
            waits.append(time.perf_counter() - begin)

    thread = threading.Thread(target=read)
    thread.start()
    begin = time.perf_counter()
    world.step(300)
    lasted = time.perf_counter() - begin
    is_done.set()
    thread.join()
    assert len(waits) > 50  # between steps, not only before and after all of them
    assert float(np.median(waits)) < lasted / 50


def test_callbacks_of_a_step_use_their_world():
    world = vx.World()
    ball = world.add(vx.Sphere(0.1))
    seen = []

    def use(world: vx.World) -> None:
        ball.apply_force((0.0, 0.0, 1.0))
        world.remove(world.add(vx.Sphere(0.1), pose=at(z=5.0)))
        state = world.save_state()
        world.step(1)
        world.restore_state(state)
        seen.append((len(world.contacts()), len(world.query_contacts(ball, margin=0.0))))

    world.step(3, callback=use, before=use)
    assert len(seen) == 6


def test_two_threads_that_step_share_the_steps():
    world = vx.World()
    world.add(vx.Sphere(0.1))
    threads = [threading.Thread(target=world.step, args=(500,)) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(world.timings) == 1000


def test_a_body_that_another_thread_removed_is_a_typed_error():
    world = vx.World()
    ball = world.add(vx.Sphere(0.1))
    world._simulation.remove_body(ball.number)  # as between a check and the call
    with pytest.raises(vx.SettingsError, match="the world has no body 0"):
        world.query_contacts(ball, world.add(vx.Sphere(0.1)))


def test_a_recording_that_is_read_during_steps_is_whole():
    """A recording that was read while a frame was taken had bodies with more frames than contacts, or raised."""
    world = vx.World(sleeping=False)
    world.add(vx.Sphere(0.1))
    recorder = world.record()
    frames = []

    def add_and_step() -> None:
        world.add(vx.Sphere(0.1), pose=at(x=float(len(world.bodies))))
        world.step(2)

    def read() -> None:
        recording = recorder.recording()
        frames.append(
            {len(track.poses) for track in recording.bodies} | {recording.contacts.frame_count}
        )

    assert run_together([add_and_step, read, read], seconds=1.5) == []
    assert all(len(lengths) == 1 for lengths in frames)
