"""What a live view costs: seconds of a step without it, with nobody watching, and with a page open.

usage: benchmarks/live_view.py [BODIES] [SHAPES]

A page is a socket that takes what a browser would take, and counts frames and bytes.
"""

from __future__ import annotations

import sys
import threading
import time
from typing import Any

import msgspec
import numpy as np
import viser
import voxshell as vx
from websockets.sync.client import connect

_STEPS = 400
_WATCHED_SECONDS = 10.0
_CAMERA = {
    "wxyz": (1.0, 0.0, 0.0, 0.0),
    "position": (0.0, 0.0, 5.0),
    "fov": 1.0,
    "near": 0.01,
    "far": 100.0,
    "image_height": 600,
    "image_width": 800,
    "look_at": (0.0, 0.0, 0.0),
    "up_direction": (0.0, 0.0, 1.0),
}
"""The first message of a page; the server counts a page from then on."""


def main(bodies: int, shapes: int) -> None:
    """Times steps of boxes that lie on the ground, and prints what it finds."""
    world = vx.World(sleeping=False)
    world.add(vx.Plane(), mass=0)
    boxes = [vx.Box((0.05, 0.05, 0.05 + 1e-4 * number)) for number in range(shapes)]
    for number in range(bodies):
        place = 0.2 * np.array((number % 10, number // 10 % 10, 1 + number // 100))
        world.add(boxes[number % shapes], pose=place)
    world.step(_STEPS)  # falls and comes to rest
    print(f"{bodies} boxes of {shapes} shapes, {len(world.contacts())} contacts")
    print(f"  no view:          {time_step(world):8.1f} us a step, one step a call")
    with world.view(port=0) as view:
        print(f"  nobody watches:   {time_step(world):8.1f} us")
        counts = [0, 0]
        client = connect(
            view.address.replace("http", "ws"),
            origin=view.address.rsplit("/", 2)[0],
            subprotocols=[f"viser-v{viser.__version__}"],
            max_size=None,
        )
        client.send(msgspec.msgpack.encode({"type": "ViewerCameraMessage", **_CAMERA}))
        threading.Thread(target=count, args=(client, counts), daemon=True).start()
        while view.page_count == 0:
            time.sleep(0.01)
        time.sleep(1.0)
        before = view.frame_count
        counts[:] = 0, 0
        steps, start = 0, time.perf_counter()
        while time.perf_counter() < start + _WATCHED_SECONDS:
            world.step()
            steps += 1
        seconds = time.perf_counter() - start
        print(f"  page open:        {1e6 * seconds / steps:8.1f} us")
        print(
            f"  the page takes {(view.frame_count - before) / seconds:.1f} frames/s, "
            f"{counts[0] / seconds:.0f} messages/s, {counts[1] / seconds / 1e6:.2f} MB/s"
        )
        client.close()


def time_step(world: vx.World) -> float:
    """Microseconds, the least of five rounds: other programs only make it longer."""
    rounds = []
    for _ in range(5):
        start = time.perf_counter()
        for _ in range(_STEPS):
            world.step()
        rounds.append((time.perf_counter() - start) / _STEPS)
    return 1e6 * min(rounds)


def count(client: Any, counts: list[int]) -> None:
    """Adds the messages and bytes that arrive to two counts, until the socket is closed."""
    for message in client:
        counts[0] += 1
        counts[1] += len(message)


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:]]
    main(*(numbers + [100, 1][len(numbers) :]))
