#!/usr/bin/env python3
"""Checks that a wheel stands on its own: in a fresh environment, without the system's Bullet.

usage: tools/check_wheel.py WHEEL CONSTRAINTS

Installs the wheel and pybullet into a new environment in a temporary folder, and there collides two
meshes, simulates them, and does the same beside pybullet in one process. Fails if the wheel is 6 MB or
larger, or if any library of Bullet is loaded from outside the environment.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import venv
import zipfile
from pathlib import Path

MOST_BYTES = 6_000_000

SCRIPT = """
import sys
import numpy as np
import trimesh
import voxshell as vx

ball = trimesh.creation.icosphere(3, radius=0.1)
ring = trimesh.creation.torus(major_radius=0.2, minor_radius=0.05)
a, b = (vx.Model.from_mesh(mesh, voxel_size=0.01, cache=False) for mesh in (ball, ring))
pose = np.eye(4)
pose[0, 3] = 0.06
assert len(vx.contacts(a, b, pose)) > 3


def fall():
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    pose = np.eye(4)
    pose[2, 3] = 0.3
    body = world.add(b, mass=0.2, pose=pose)
    world.step(300)
    assert 0.03 < body.pose[2, 3] < 0.06, body.pose
    return body.pose.tobytes()


def fall_in_pybullet():
    import pybullet

    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.81)
    plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE)
    pybullet.createMultiBody(0, plane)
    sphere = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=0.1)
    body = pybullet.createMultiBody(1.0, sphere, basePosition=(0, 0, 0.3))
    for _ in range(480):
        pybullet.stepSimulation()
    height = pybullet.getBasePositionAndOrientation(body)[0][2]
    assert abs(height - 0.1) < 0.005, height
    return client


if "before" in sys.argv:
    fall_in_pybullet()
alone = fall()
if "after" in sys.argv:
    fall_in_pybullet()
    assert fall() == alone
with open("/proc/self/maps") as maps:
    files = {line.split(maxsplit=5)[5].strip() for line in maps if line.count("/")}
bullet = sorted(f for f in files if "libBullet" in f or "libLinearMath" in f)
outside = [f for f in bullet if not f.startswith(sys.prefix)]
assert bullet and not outside, (bullet, outside)
print(alone.hex())
"""


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    wheel, constraints = Path(arguments[0]).resolve(), Path(arguments[1]).resolve()
    size = wheel.stat().st_size
    if size >= MOST_BYTES:
        print(f"{wheel.name} has {size / 1e6:.1f} MB; it must stay below {MOST_BYTES / 1e6:g} MB")
        return 1
    with zipfile.ZipFile(wheel) as archive:
        foreign = [n for n in archive.namelist() if n.endswith((".a", ".h", ".cmake", ".pc"))]
    if foreign:
        print(f"{wheel.name} holds what is no part of the package: {', '.join(foreign)}")
        return 1
    with tempfile.TemporaryDirectory() as folder:
        python = _make_environment(Path(folder).resolve() / "env", wheel, constraints)
        # Nothing of this checkout, and no settings that could bring another copy.
        environment = {"PATH": os.defpath, "HOME": folder, "LANG": "C.UTF-8"}
        results = set()
        for mode in ("alone", "before", "after"):
            command = [str(python), "-I", "-c", SCRIPT, mode]
            result = subprocess.run(
                command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300
            )
            if result.returncode != 0:
                print(f"pybullet {mode}: exit code {result.returncode}\n{result.stderr}")
                return 1
            results.add(result.stdout.splitlines()[-1])
        if len(results) != 1:
            print("the world does not end the same beside pybullet")
            return 1
        told = subprocess.run(
            [str(python.with_name("voxshell")), "--version"], env=environment, capture_output=True
        )
        if told.returncode != 0 or told.stdout.decode().strip() not in wheel.name:
            print(f"voxshell --version said {told.stdout!r} {told.stderr!r}")
            return 1
    print(f"{wheel.name}: {size / 1e6:.2f} MB, works in a fresh environment and beside pybullet")
    return 0


def _make_environment(folder: Path, wheel: Path, constraints: Path) -> Path:
    """A new environment with the wheel and pybullet; its interpreter."""
    venv.create(folder, with_pip=True, symlinks=True)
    python = folder / "bin" / "python"
    arguments = ["--disable-pip-version-check", "--no-input", "--quiet"]
    subprocess.run(
        [
            *(str(python), "-m", "pip", "install", *arguments, "--constraint", str(constraints)),
            *(str(wheel), "pybullet"),
        ],
        check=True,
    )
    return python


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
