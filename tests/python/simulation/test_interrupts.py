"""Ctrl-C stops a world between two steps."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import time

import pytest
import voxshell as vx
from poses import at


def test_ctrl_c_stops_a_long_run():
    program = """
        import voxshell as vx
        world = vx.World()
        world.add(vx.Sphere(0.1))
        print("running", flush=True)
        world.step(2_000_000_000)
    """
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(program)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "running\n"
    process.send_signal(signal.SIGINT)
    try:
        _, errors = process.communicate(timeout=20)
    finally:
        process.kill()
    assert "KeyboardInterrupt" in errors


def test_ctrl_c_stops_heavy_steps_within_about_one_of_them():
    world = vx.World(solver="sequential_impulse", iterations=600_000, sleeping=False)
    world.add(vx.Plane(), mass=0)
    world.add(vx.Box((0.1, 0.1, 0.1)), pose=at(z=0.1))
    world.step(2)
    assert world.timings["step"][-1] > 0.02  # of many such steps, it must not do more

    def stop(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, stop)
    delay = 0.2
    try:
        signal.setitimer(signal.ITIMER_REAL, delay)
        begin = time.perf_counter()
        with pytest.raises(KeyboardInterrupt):
            world.step(2_000_000_000)
        late = time.perf_counter() - begin - delay
    finally:
        signal.signal(signal.SIGALRM, before)
    assert late < 3 * world.timings["step"].max() + 0.02
