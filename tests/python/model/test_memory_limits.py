"""Work under limits of memory (RLIMIT_AS), which helper threads meet first: a result or a typed error."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import textwrap

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc and sets RLIMIT_AS")

SWEEP = """
    import json, os, resource, sys
    import numpy as np, trimesh
    import voxshell as vx

    ball = vx.Model.from_mesh(trimesh.creation.icosphere(4), resolution=60, threads=1)
    mesh = trimesh.creation.icosphere(6)
    poses = np.tile(np.eye(4), (20_000, 1, 1))
    poses[:, 0, 3] = np.linspace(1.95, 1.99, len(poses))
    vx.World().add(vx.Sphere(1.0))  # what is loaded late is there, and no memory is left over

    def simulate(threads=1):
        world = vx.World(threads=threads)
        try:
            for number in range(40):
                pose = np.eye(4)
                pose[2, 3] = 1.9 * number
                world.add(ball, pose=pose)
            world.step(2)
        except vx.MemoryLimitError:
            resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY,) * 2)
            try:
                world.step(2)  # as before, or refused
            except vx.SettingsError as error:
                assert "make another world" in str(error)
            raise

    works = {
        "build": lambda: vx.Model.from_mesh(mesh, resolution=120, threads=4),
        "contacts_batch": lambda: vx.contacts_batch(ball, ball, a_poses=poses, threads=4),
        "collide_batch": lambda: vx.collide_batch(ball, ball, a_poses=poses, threads=4),
        "distance_batch": lambda: vx.distance_batch(ball, ball, a_poses=poses, threads=4),
        "simulate": simulate,
        "simulate on threads": lambda: simulate(4),
    }

    def run(work, limit):
        with open("/proc/self/statm") as file:
            used = int(file.read().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + limit, resource.RLIM_INFINITY))
        try:
            work()
        except (vx.MemoryLimitError, MemoryError) as error:
            return 1 if isinstance(error, vx.MemoryLimitError) else 2
        except BaseException as error:
            print(type(error), error, file=sys.stderr)
            return 3
        return 0

    ends = []
    for limit in LIMITS:
        child = os.fork()
        if child == 0:
            os._exit(run(works[WORK], limit))
        ends.append(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    print(json.dumps(ends))
"""


def sweep(work: str, limits: list[int]) -> list[int]:
    """How each child ended: 0 done, 1 MemoryLimitError, 2 MemoryError; below 0, by a signal."""
    program = textwrap.dedent(SWEEP).replace("LIMITS", repr(limits)).replace("WORK", repr(work))
    environment = {**os.environ, "VOXSHELL_CACHE_SIZE": "0"}
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env=environment, timeout=60
    )
    assert run.returncode == 0, run.stderr
    ends = json.loads(run.stdout)
    assert all(end in (0, 1, 2) for end in ends), (ends, run.stderr)
    return ends


@pytest.mark.parametrize(
    ("work", "most"),
    [("build", 60), ("contacts_batch", 600), ("collide_batch", 10), ("distance_batch", 10)],
)
def test_out_of_memory_in_a_helper_thread_is_a_typed_error(work: str, most: int):
    limits = [most * 1_000_000 * (i + 1) // 20 for i in range(20)]
    ends = sweep(work, [*limits, 4_000_000_000])
    assert ends[-1] == 0
    assert 1 in ends


@pytest.mark.parametrize("work", ["simulate", "simulate on threads"])
def test_a_world_whose_memory_ran_out_says_so_and_nothing_else_does(work: str):
    ends = sweep(work, [*(2_000_000 * (i + 1) for i in range(25)), 4_000_000_000])
    assert ends[-1] == 0
    assert 1 in ends


def test_bullet_that_finds_no_memory_to_load_is_a_typed_error():
    program = """
        import resource
        import voxshell as vx

        with open("/proc/self/statm") as file:
            used = int(file.read().split()[0]) * resource.getpagesize()
        ends = set()
        for more in range(0, 12_000_000, 250_000):
            resource.setrlimit(resource.RLIMIT_AS, (used + more, resource.RLIM_INFINITY))
            try:
                vx.World
                break
            except (vx.MemoryLimitError, MemoryError) as error:
                ends.add(type(error).__name__)
        resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY,) * 2)
        vx.World().step()
        print(sorted(ends))
    """
    # Python's compiler reports errors of syntax where it finds no memory: the package is compiled first.
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    subprocess.run(
        [sys.executable, "-c", "import voxshell.simulation"], env=environment, check=True
    )
    run = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(program)], capture_output=True, text=True, timeout=60
    )
    assert run.returncode == 0, run.stderr
    assert "MemoryLimitError" in run.stdout
