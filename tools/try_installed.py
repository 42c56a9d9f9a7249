"""Collides two meshes, simulates one beside a pile of boxes with the voxshell that is installed, and prints the ends.

usage: tools/try_installed.py [COMPANY]

COMPANY says which other Bullet is in the process: that of nobody, the default; "pybullet before" or "pybullet
after", which runs a world of its own before or after; or "the system's" shared libraries. All their
symbols are in everybody's sight. Fails if voxshell uses or loads any of them.
"""

from __future__ import annotations

import ctypes.util
import os
import sys

import trimesh
import voxshell as vx


def main(company: str) -> None:
    """Runs everything, and prints the poses of the bodies at their end."""
    ball = trimesh.creation.icosphere(3, radius=0.1)
    ring = trimesh.creation.torus(major_radius=0.2, minor_radius=0.05)
    # The last bits of sines in numpy depend on the processor.
    for mesh in (ball, ring):
        mesh.vertices = mesh.vertices.round(9)
    a, b = (vx.Model.from_mesh(mesh, voxel_size=0.01, cache=False) for mesh in (ball, ring))
    assert len(vx.contacts(a, b, (0.06, 0.0, 0.0))) > 3

    if company == "pybullet before":
        sys.setdlopenflags(os.RTLD_GLOBAL | os.RTLD_NOW)
        _fall_in_pybullet()
    elif company == "the system's":
        _load_systems()
    others = _list_bullets()
    brick = vx.Model.from_mesh(trimesh.creation.box((0.1, 0.12, 0.08)), cache=False)
    alone = _fall(b, brick)
    assert _list_bullets() == others, _list_bullets()
    if company == "pybullet after":
        _fall_in_pybullet()
        assert _fall(b, brick) == alone
    print(alone.hex())


def _fall(ring: vx.Model, brick: vx.Model) -> bytes:
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    body = world.add(ring, mass=0.2, pose=(0.0, 0.0, 0.3))
    pile = [world.add(brick, mass=0.2, pose=(1.0, 0.001 * i, 0.05 + 0.09 * i)) for i in range(3)]
    world.step(300)
    assert 0.03 < body.pose[2, 3] < 0.06, body.pose
    return b"".join(each.pose.tobytes() for each in (body, *pile))


def _fall_in_pybullet() -> None:
    import pybullet  # pyright: ignore[reportMissingImports]

    pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.81)
    plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE)
    pybullet.createMultiBody(0, plane)
    sphere = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=0.1)
    body = pybullet.createMultiBody(1.0, sphere, basePosition=(0, 0, 0.3))
    for _ in range(480):
        pybullet.stepSimulation()
    height = pybullet.getBasePositionAndOrientation(body)[0][2]
    assert abs(height - 0.1) < 0.005, height


def _list_bullets() -> list[str]:
    """The shared libraries of Bullet in this process."""
    with open("/proc/self/maps") as maps:
        files = {line.split(maxsplit=5)[5].strip() for line in maps if line.count("/")}
    return sorted(f for f in files if "libBullet" in f or "libLinearMath" in f)


def _load_systems() -> None:
    for name in ("LinearMath", "BulletCollision", "BulletDynamics"):
        for library in (name, name + "-float64"):
            file = ctypes.util.find_library(library)
            if file:
                ctypes.CDLL(file, mode=os.RTLD_GLOBAL | os.RTLD_NOW)


if __name__ == "__main__":
    main(*sys.argv[1:] or ["nobody"])
