#!/usr/bin/env python3
"""Times sweeps: bunnies that pass each other or collide, a peg in a hole, and a box that slides close by.

Bodies are models at default settings; with --uniform, bunnies are made of voxels of 2 mm. One thread, warm.
A bunny of 0.21 m moves by its own length, straight or turning by up to 1.5 radians, at a random distance
from another. Where python-fcl is installed, its continuous collision of the same meshes and motions stands
beside a torus and a box.

    .venv/bin/python benchmarks/sweep.py
    .venv/bin/python benchmarks/sweep.py --uniform
"""

from __future__ import annotations

import argparse
import math
import time
from typing import TYPE_CHECKING, Any

import numpy as np
import trimesh
import voxshell as vx
from trimesh.transformations import random_rotation_matrix, rotation_matrix, translation_matrix
from voxshell.measuring.timing import pinned
from voxshell_studies.scenes.bunny import BunnySettings

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

MOTIONS = 400
REPEATS = 3


def seconds_of(work: Callable[[], object]) -> float:
    """The least of a few runs, after one to warm up."""
    work()
    least = math.inf
    for _ in range(REPEATS):
        start = time.perf_counter()
        work()
        least = min(least, time.perf_counter() - start)
    return least


def describe(seconds: list[float]) -> str:
    """Median, 90 and 99 % and the most, microseconds."""
    if not seconds:
        return "-"
    values = np.array(seconds) * 1e6
    figures = [*np.percentile(values, (50, 90, 99)), values.max()]
    return "  ".join(f"{figure:9.1f}" for figure in figures)


def bunny_motions(
    mesh: vx.Mesh, turns: bool
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Where a begins, where it ends, where b stands."""
    rng = np.random.default_rng(1)
    size = float(np.ptp(mesh.vertices, axis=0).max())
    center = mesh.vertices.mean(axis=0)
    for _ in range(MOTIONS):
        start, standing = (random_rotation_matrix(rng.random(3)) for _ in range(2))
        along = rng.normal(size=3)
        along /= np.linalg.norm(along)
        aside = np.cross(along, rng.normal(size=3))
        aside *= rng.uniform(0.0, 1.2) * size / np.linalg.norm(aside)
        end = start.copy()
        if turns:
            end = rotation_matrix(rng.uniform(0.0, 1.5), rng.normal(size=3)) @ start
        start[:3, 3] = aside - 1.5 * size * along - start[:3, :3] @ center
        end[:3, 3] = aside - 0.5 * size * along - end[:3, :3] @ center
        standing[:3, 3] = -standing[:3, :3] @ center
        yield start, end, standing


def time_bunnies(uniform: bool) -> None:
    """Those that pass, and those that touch."""
    settings = BunnySettings()
    mesh = settings.build_mesh()
    options: dict[str, Any] = {}
    if uniform:
        options = {"voxel_size": settings.voxel_size, "target_points": settings.fine_points}
    model = vx.Model.from_mesh(mesh, **options)
    scratch = vx.QueryScratch()
    print(f"\nbunnies of {len(model.shell)} points that move by their length, us")
    print(f"{'':>22}  {'motions':>7}  {'median':>9}  {'90 %':>9}  {'99 %':>9}  {'most':>9}")
    for turns in (False, True):
        times: dict[bool, list[float]] = {False: [], True: []}
        for start, end, standing in bunny_motions(mesh, turns):

            def ask(
                start: np.ndarray = start, end: np.ndarray = end, standing: np.ndarray = standing
            ) -> vx.Sweep:
                return vx.sweep(model, model, start, standing, a_end=end, scratch=scratch)

            times[ask().touches].append(seconds_of(ask))
        for touches, name in ((False, "pass"), (True, "touch")):
            title = f"{name}, {'turning' if turns else 'straight'}"
            print(f"{title:>22}  {len(times[touches]):7d}  {describe(times[touches])}")


def time_close_motions() -> None:
    """Bodies that move along each other without touching."""
    plate = trimesh.creation.annulus(r_min=0.01, r_max=0.03, height=0.02, sections=256)
    hole = vx.Model.from_mesh(plate)
    peg = vx.Model.from_mesh(trimesh.creation.cylinder(radius=0.0098, height=0.05, sections=256))
    table = vx.Model.from_mesh(trimesh.creation.box((0.1, 0.1, 0.02)))
    box = vx.Model.from_mesh(trimesh.creation.box((0.05, 0.04, 0.03)))
    scratch = vx.QueryScratch()
    print("\nbodies that move along each other, ms")

    def show(what: str, a: vx.Model, b: vx.Model, start: np.ndarray, end: np.ndarray) -> None:
        seconds = seconds_of(lambda: vx.sweep(a, b, start, a_end=end, scratch=scratch))
        print(f"  {1e3 * seconds:9.3f}  {what}")

    show(
        "peg through a hole with 0.2 mm of play, by 0.1 m",
        *(peg, hole),
        *(translation_matrix((0, 0, z)) for z in (0.05, -0.05)),
    )
    for gap in (0.01, 0.001, 0.0001):
        show(
            f"box of 5 cm over a table, {1e3 * gap:g} mm above it, by 4 cm",
            *(box, table),
            *(translation_matrix((x, 0, 0.025 + gap)) for x in (-0.02, 0.02)),
        )


def time_beside_fcl() -> None:
    """A box at a torus: ours, and fcl's conservative advancement on the triangles."""
    meshes = (
        trimesh.creation.box((0.12, 0.05, 0.02)),
        trimesh.creation.torus(0.08, 0.025, major_sections=64, minor_sections=32),
    )
    a, b = (vx.Model.from_mesh(mesh) for mesh in meshes)
    rng = np.random.default_rng(5)
    motions = []
    for _ in range(100):
        start = random_rotation_matrix(rng.random(3))
        end = rotation_matrix(rng.uniform(0.0, 2.0), rng.normal(size=3)) @ start
        away = rng.normal(size=3)
        away /= np.linalg.norm(away)
        start[:3, 3] = rng.uniform(0.2, 0.3) * away
        end[:3, 3] = rng.uniform(-0.05, 0.05, 3) - rng.uniform(-0.1, 0.25) * away
        motions.append((start, end))
    scratch = vx.QueryScratch()
    ours = [
        seconds_of(lambda s=start, e=end: vx.sweep(a, b, s, a_end=e, scratch=scratch))
        for start, end in motions
    ]
    print("\nbox at a torus of 4096 triangles, us: median, 90 %, 99 %, most")
    print(f"  voxshell {describe(ours)}")
    try:
        import fcl
    except ImportError:
        print("  fcl       not installed (pip install python-fcl)")
        return
    bodies = []
    for mesh in meshes:
        body = fcl.BVHModel()
        body.beginModel(len(mesh.vertices), len(mesh.faces))
        body.addSubModel(mesh.vertices, mesh.faces)
        body.endModel()
        bodies.append(body)

    def transform(pose: np.ndarray) -> Any:
        return fcl.Transform(pose[:3, :3], pose[:3, 3])

    def ask(start: np.ndarray, end: np.ndarray) -> float:
        request = fcl.ContinuousCollisionRequest(
            num_max_iterations=1000,
            toc_err=1e-4,
            ccd_motion_type=fcl.CCDMotionType.CCDM_LINEAR,
            ccd_solver_type=fcl.CCDSolverType.CCDC_CONSERVATIVE_ADVANCEMENT,
        )
        moving = fcl.CollisionObject(bodies[0], transform(start))
        still = fcl.CollisionObject(bodies[1], fcl.Transform())
        result = fcl.ContinuousCollisionResult()
        return fcl.continuousCollide(
            moving, transform(end), still, fcl.Transform(), request, result
        )

    theirs = [seconds_of(lambda s=start, e=end: ask(s, e)) for start, end in motions]
    print(f"  fcl      {describe(theirs)}")


def main() -> None:
    """Runs what the arguments name."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--uniform", action="store_true", help="bunnies of voxels of 2 mm")
    options = parser.parse_args()
    with pinned():
        time_bunnies(options.uniform)
        if not options.uniform:
            time_close_motions()
            time_beside_fcl()


if __name__ == "__main__":
    main()
