"""Worlds to be viewed, stepped in threads, and a page without a server or a browser."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import trimesh
import voxshell as vx
from voxshell.simulation.live_frame import LiveFrame, take_frame

PATIENCE = 60.0
"""Seconds after which a test gives up; none measures how long anything takes."""


class Screen:
    """A page without a server, which keeps what it was shown."""

    address = "http://127.0.0.1:1/secret/"

    def __init__(self, view: object, **options: object) -> None:
        self.options = options
        self.frames: list[LiveFrame] = []
        self.closed = False

    def show(self, frame: LiveFrame, *, last: bool) -> None:
        self.frames.append(frame)

    def close(self) -> None:
        self.closed = True


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


def read_frame(world: vx.World) -> LiveFrame:
    """The world as a view reads it."""
    frame = take_frame(world._simulation, world.bodies, world.gravity, world.time_step)
    assert frame is not None
    return frame
