"""Trees against the flat loop, over pairs that are odd in every way that matters to queries."""

from __future__ import annotations

from functools import cache
from typing import Any

import fast_paths
import numpy as np
import parts
import trimesh
import voxshell as vx

from soak.task import CORE, Check, Outcome, Task, Totals

POSES = 30  # a case: each of the settings of fast_paths three times


def model(mesh: trimesh.Trimesh, **settings: Any) -> vx.Model:
    """Of a mesh, wherever it lies, about its origin."""
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    return vx.Model.from_mesh(mesh, **settings)


def with_itself(body: vx.Model) -> fast_paths.Pair:
    return fast_paths.Pair(body, body)


def torus(**settings: Any) -> vx.Model:
    return model(trimesh.creation.torus(0.1, 0.03, 32, 16), **settings)


def box(*extents: float, **settings: Any) -> vx.Model:
    return model(trimesh.creation.box(extents), **settings)


def ball(radius: float, **settings: Any) -> vx.Model:
    return model(trimesh.creation.icosphere(2, radius), **settings)


def tube() -> vx.Model:
    """Open at both ends: a sheet."""
    whole = trimesh.creation.cylinder(0.05, 0.2, sections=24)
    sides = np.abs(whole.face_normals[:, 2]) < 0.5
    return model(trimesh.Trimesh(whole.vertices, whole.faces[sides]), open="sheet", resolution=40)


def nut() -> vx.Model:
    return vx.Model.from_mesh(parts.solids.as_arrays(parts.nut().solid), resolution=40)


def bolt() -> vx.Model:
    return vx.Model.from_mesh(parts.solids.as_arrays(parts.bolt().solid), tolerance=2e-4)


def ball_in_cone() -> vx.ConvexPolyhedron:
    return vx.ConvexPolyhedron(trimesh.creation.cone(0.1, 0.2, sections=12))


PAIRS = {
    "ring in ring": lambda: fast_paths.Pair(torus(resolution=40), torus(resolution=25)),
    "ring by tolerance in itself": lambda: with_itself(torus(tolerance=1e-3)),
    "box by tolerance, edges as segments": lambda: fast_paths.Pair(
        box(0.2, 0.15, 0.1, tolerance=1e-3), box(0.1, 0.1, 0.1, tolerance=2e-3)
    ),
    "segments in a uniform ring": lambda: fast_paths.Pair(
        box(0.2, 0.04, 0.04, tolerance=1e-3), torus(resolution=40)
    ),
    "nut on a bolt by tolerance": lambda: fast_paths.Pair(nut(), bolt(), parts.screwed_on),
    "thin plate and rod": lambda: fast_paths.Pair(
        box(0.2, 0.2, 0.002, voxel_size=2e-3, point_spacing=8e-3),
        model(trimesh.creation.cylinder(0.003, 0.3, sections=12), resolution=100),
    ),
    "tube as a sheet": lambda: fast_paths.Pair(tube(), ball(0.04, resolution=20)),
    "twelve points": lambda: fast_paths.Pair(
        ball(0.1, resolution=16, target_points=12), torus(resolution=25)
    ),
    "a tenth of a millimeter": lambda: fast_paths.Pair(
        ball(5e-5, resolution=20), box(1e-4, 6e-5, 3e-5, resolution=20)
    ),
    "a kilometer": lambda: fast_paths.Pair(
        ball(500.0, resolution=20), box(1000.0, 300.0, 400.0, resolution=20)
    ),
    "plane": lambda: fast_paths.Pair(
        box(0.2, 0.15, 0.1, tolerance=1e-3), vx.Plane(normal=(0.1, -0.2, 0.9), offset=0.03)
    ),
    "box by formula": lambda: fast_paths.Pair(torus(resolution=40), vx.Box((0.1, 0.05, 0.02))),
    "capsule": lambda: fast_paths.Pair(torus(tolerance=1e-3), vx.Capsule(0.03, 0.2)),
    "cylinder": lambda: fast_paths.Pair(box(0.1, 0.1, 0.1, resolution=25), vx.Cylinder(0.04, 0.3)),
    "cone": lambda: fast_paths.Pair(ball(0.05, resolution=25), vx.Cone(0.1, 0.2)),
    "convex polyhedron": lambda: fast_paths.Pair(torus(resolution=30), ball_in_cone()),
}


@cache
def asker(name: str) -> fast_paths.Asker:
    return fast_paths.Asker(PAIRS[name](), np.random.default_rng(0))


def prepare() -> Check:
    names = list(PAIRS)

    def check(case: int) -> Outcome:
        name = names[case % len(names)]
        asks = asker(name)
        rng = asks.rng = np.random.default_rng([case, 1])
        poses = fast_paths.far_touching_or_deep(asks.pair, POSES, rng)
        in_contact, contacts = fast_paths.compare_all(asks, 0, poses, rng)
        thirds = ("far", "touching", "deep")
        collided = {name: float(in_contact[i::3].sum()) for i, name in enumerate(thirds)}
        return Outcome(POSES, {"contacts": contacts, **collided})

    return check


def doubt(totals: Totals) -> str:
    third = totals.count / 3
    far, touching, deep = (totals.tallies[name] / third for name in ("far", "touching", "deep"))
    if totals.count >= POSES * len(PAIRS) and not (far <= 0.1 and touching >= 0.3 and deep >= 0.6):
        return f"{far:.0%}, {touching:.0%}, {deep:.0%} of far, touching, deep poses collide"
    return ""


def describe(totals: Totals) -> str:
    hits = sum(totals.tallies[name] for name in ("far", "touching", "deep"))
    each = totals.tallies["contacts"] / max(hits, 1)
    fractions = [
        f"{totals.tallies[name] / (totals.count / 3):.0%} of {name}"
        for name in ("far", "touching", "deep")
    ]
    return f"{', '.join(fractions)} poses collide, {each:,.0f} contacts each; {len(PAIRS)} pairs"


TASK = Task(
    promise="Tree queries return the same bits as the flat loop",
    oracle="the flat loop over all points and edge segments",
    unit="poses",
    target=1_000_000,
    prepare=prepare,
    sources=(*CORE, "tests/python/support/fast_paths.py", "tests/python/support/parts.py"),
    describe=describe,
    doubt=doubt,
)
