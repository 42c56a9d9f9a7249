from __future__ import annotations

import os
import subprocess
import sys
import textwrap

import pytest


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
@pytest.mark.parametrize(
    ("call", "ending"),
    [
        ("world.step(1)", 42),
        ("body.pose", 42),
        ("world.ray_cast((0, 0, 1), (0, 0, -1))", 42),
        ("world.remove(joint)", 42),
        ("del world, body, joint", 0),
        ("other.step(1)", 0),
    ],
)
def test_a_world_that_another_thread_steps_is_lost_in_a_child(call: str, ending: int):
    """It waited for ever."""
    program = f"""
        import os, signal, sys, threading, time
        import voxshell as vx

        world, other = vx.World(), vx.World()
        body = world.add(vx.Sphere(0.1))
        joint = world.add_joint(vx.HingeJoint(), None, body)
        other.add(vx.Sphere(0.1))
        ended = threading.Event()
        def step():
            while not ended.is_set():
                world.step(10_000)
        thread = threading.Thread(target=step)
        thread.start()
        time.sleep(0.1)
        child = os.fork()
        if child == 0:
            signal.alarm(10)
            try:
                {call}
            except vx.SimulationError as error:
                assert "when the process forked" in str(error)
                os._exit(42)
            sys.exit(0)
        ended.set()
        thread.join()
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
        world.step(1)
    """
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", textwrap.dedent(program)],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert (done.stdout, done.stderr) == (f"{ending}\n", "")
