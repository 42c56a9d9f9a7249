#!/usr/bin/env python3
"""Checks that a wheel stands on its own: in a fresh environment, with a Bullet that nobody else sees.

usage: tools/check_wheel.py WHEEL CONSTRAINTS

Installs the wheel and pybullet into a new environment in a temporary folder, and there collides two
meshes and simulates them: alone, beside pybullet, and beside the system's Bullet where that is installed,
with all symbols of these in everybody's sight. Fails if the world does not end the same in each
case, if the wheel brings or loads shared libraries of Bullet, if a module shows other symbols than the one
that Python calls, if the wheel is 6 MB or larger, if its bill of materials or a licence of what is on it
is missing, or if it brings packages whose licences ask something of programs that use them.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import venv
import zipfile
from pathlib import Path

MOST_BYTES = 6_000_000
# Of what `pip install voxshell` brings: what asks nothing of programs that use it.
LICENCES = re.compile(
    r"\b(MIT|0?BSD|Apache|ISC|PSF|Python Software Foundation|Zlib)\b", re.IGNORECASE
)
TELL_LICENCES = """
from importlib.metadata import distributions
for package in distributions():
    told = [package.metadata["License-Expression"], package.metadata["License"]]
    told += [c for c in package.metadata.get_all("Classifier", []) if c.startswith("License")]
    print(package.name, "".join(" " + str(text).split("\\n")[0] for text in told if text))
"""
# What is in the process with the world: a script's argument each.
COMPANY = ("nobody", "pybullet before", "pybullet after", "the system's")

SCRIPT = """
import ctypes.util
import os
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


def bullets():
    with open("/proc/self/maps") as maps:
        files = {line.split(maxsplit=5)[5].strip() for line in maps if line.count("/")}
    return sorted(f for f in files if "libBullet" in f or "libLinearMath" in f)


def load_systems():
    for name in ("LinearMath", "BulletCollision", "BulletDynamics"):
        for library in (name, name + "-float64"):
            file = ctypes.util.find_library(library)
            if file:
                ctypes.CDLL(file, mode=os.RTLD_GLOBAL | os.RTLD_NOW)


company = sys.argv[1]
if company == "pybullet before":
    sys.setdlopenflags(os.RTLD_GLOBAL | os.RTLD_NOW)
    fall_in_pybullet()
elif company == "the system's":
    load_systems()
others = bullets()
alone = fall()
assert bullets() == others, bullets()
if company == "pybullet after":
    fall_in_pybullet()
    assert fall() == alone
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
        names = archive.namelist()
    modules = [n for n in names if re.fullmatch(r"voxshell/_(core|bullet)\.[^/]*\.so", n)]
    foreign = [n for n in names if n.endswith((".a", ".h", ".cmake", ".pc")) or ".so" in n]
    foreign = sorted(set(foreign) - set(modules))
    if foreign:
        print(f"{wheel.name} holds what is no part of the package: {', '.join(foreign)}")
        return 1
    lacking = _lacking_licences(wheel)
    if lacking:
        print(f"{wheel.name} says nothing of {', '.join(lacking)}")
        return 1
    for name in modules:
        shown = _shown_symbols(wheel, name)
        if shown != {"PyInit_" + Path(name).name.partition(".")[0]}:
            print(f"{name} shows {len(shown)} symbols: {', '.join(sorted(shown)[:10])}")
            return 1
    with tempfile.TemporaryDirectory() as folder:
        python = _make_environment(Path(folder).resolve() / "env", wheel, constraints)
        # Nothing of this checkout, and no settings that could bring another copy.
        environment = {"PATH": os.defpath, "HOME": folder, "LANG": "C.UTF-8"}
        licences = subprocess.run(
            [str(python), "-I", "-c", TELL_LICENCES], check=True, capture_output=True, text=True
        ).stdout.splitlines()
        unknown = [line for line in licences if not LICENCES.search(line)]
        if unknown:
            print("packages that come with it have other licences: " + "; ".join(unknown))
            return 1
        results = set()
        for company in COMPANY:
            command = [str(python), "-I", "-c", SCRIPT, company]
            result = subprocess.run(
                command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300
            )
            if result.returncode != 0:
                print(f"beside {company}: exit code {result.returncode}\n{result.stderr}")
                return 1
            results.add(result.stdout.splitlines()[-1])
        if len(results) != 1:
            print("the world does not end the same beside other builds of Bullet")
            return 1
        told = subprocess.run(
            [str(python.with_name("voxshell")), "--version"], env=environment, capture_output=True
        )
        if told.returncode != 0 or told.stdout.decode().strip() not in wheel.name:
            print(f"voxshell --version said {told.stdout!r} {told.stderr!r}")
            return 1
    print(f"{wheel.name}: {size / 1e6:.2f} MB, works alone and beside other builds of Bullet")
    return 0


def _lacking_licences(wheel: Path) -> list[str]:
    """Parts that do not have both an entry with a version in the bill of materials, and a licence."""
    with zipfile.ZipFile(wheel) as archive:
        [bill] = [n for n in archive.namelist() if n.endswith("/sboms/voxshell.cdx.json")]
        parts = {part["bom-ref"]: part for part in json.loads(archive.read(bill))["components"]}
        names = [Path(name) for name in archive.namelist() if "/licenses/licenses/" in name]
        licences = {name.stem for name in names if name.suffix == ".txt"}
    expected = {"bullet", "nanobind", "robin-map"}
    versioned = {
        name for name, part in parts.items() if re.fullmatch(r"\d+(\.\d+)+", part["version"])
    }
    return sorted((expected ^ versioned) | (expected ^ licences))


def _shown_symbols(wheel: Path, name: str) -> set[str]:
    """What a shared library in the wheel defines for others."""
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(wheel) as archive:
        library = archive.extract(name, folder)
        told = subprocess.run(
            ["nm", "--dynamic", "--defined-only", library],
            check=True,
            capture_output=True,
            text=True,
        )
    return {line.split()[-1] for line in told.stdout.splitlines()}


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
