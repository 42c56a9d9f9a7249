"""Programs that end while other threads use voxshell."""

from __future__ import annotations

import subprocess
import sys

PROGRAM = """
import sys, threading, time
import trimesh
import voxshell as vx

ball = vx.Model.from_mesh(trimesh.creation.icosphere(2, 0.05))
world = vx.World(sleeping=False)
world.add(vx.Plane(), mass=0)
for place in range(10):
    world.add(ball, mass=1, pose=(0.2 * place, 0, 0.06))

def step():
    while True:
        world.step(3)

def query():
    while True:
        vx.contacts(ball, ball, (0.05, 0, 0))

def build():
    while True:
        vx.Model.from_mesh(trimesh.creation.box((0.1, 0.1, 0.1)), cache=False, progress=print_nothing)

def print_nothing(*_):
    pass

for run in (step, query, build):
    threading.Thread(target=run, daemon=True).start()
time.sleep(0.3)
"""


def test_a_program_ends_while_daemon_threads_step_query_and_build():
    """Python ended such threads by unwinding them, and that ended the process with SIGABRT."""
    for _ in range(5):
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM], capture_output=True, text=True, timeout=60
        )
        assert (done.returncode, done.stdout + done.stderr) == (0, "")
