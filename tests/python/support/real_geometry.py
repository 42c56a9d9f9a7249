"""Contacts at many poses of a pair of real parts, judged by their meshes with coal and manifold3d.

Where the shell's surface reaches deeper into the other mesh than the stated bound
(:func:`voxshell.contact_bounds`), contact must be reported; where the meshes are farther apart than
the field is off, it must not. Poses: a third far, a third touching, a third deep, as seen by coal; of
parts that fit one another, half are about the fit.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import parts
import solids
import voxshell as vx
from mesh_judges import MeshPair
from parts import MM, Part, random_rotation

FULLY_JUDGED = 5  # one in so many poses is judged even where the answer needs no proof
ROUNDING = 1e-6  # meters; coordinates here are below a meter
NAMES = ("bunny-bunny", "bunny-box", "nut-bolt", "pinion-gear", "bolt-box")


@dataclass
class Pair:
    a: Part
    b: Part
    fit: parts.Fit | None = None


def make_pair(name: str, bunny_path: Path) -> Pair:
    bunny = Part(solids.simplified_bunny(bunny_path, length=0.2, tolerance=1 * MM), 3 * MM)
    box = Part(solids.box((0.12, 0.08, 0.06)).refine_to_length(10 * MM), 3 * MM)
    return {
        "bunny-bunny": Pair(bunny, bunny),
        "bunny-box": Pair(bunny, box),
        "nut-bolt": Pair(parts.nut(), parts.bolt(), parts.screwed_on),
        "pinion-gear": Pair(parts.pinion(), parts.gear(), parts.in_mesh),
        "bolt-box": Pair(
            parts.bolt(), Part(solids.box((30 * MM,) * 3).refine_to_length(3 * MM), 0.4 * MM)
        ),
    }[name]


def place(
    pair: Pair, judge: MeshPair, index: int, scale: float, size: float, rng: np.random.Generator
) -> np.ndarray:
    """b_from_a: far, touching or deep by turns; `scale` is the bound, `size` the bodies' reach."""
    if pair.fit and index % 2:
        fitting = pair.fit(rng)
        jitter = (0.1, 0.5, 2.0)[index // 2 % 3] * scale
        fitting[:3, 3] += rng.uniform(-jitter, jitter, 3)
        return fitting
    b_from_a = np.eye(4)
    b_from_a[:3, :3] = random_rotation(rng)
    outwards = rng.normal(size=3)
    outwards /= np.linalg.norm(outwards)
    near, far = 0.0, size
    for _ in range(12):
        middle = 0.5 * (near + far)
        b_from_a[:3, 3] = middle * outwards
        near, far = (middle, far) if judge.surfaces_within(b_from_a, 0.0) else (near, middle)
    gap = (rng.uniform(1.0, 10.0), rng.uniform(-2.0, 1.0), rng.uniform(-12.0, -2.0))[index % 3]
    b_from_a[:3, 3] = (far + gap * scale) * outwards
    return b_from_a


@dataclass(frozen=True)
class Verdict:
    """What the meshes say about one pose."""

    in_contact: bool  # as voxshell says
    clear: bool  # proven apart
    judged: bool
    proven: int  # of the two shells, those that must be in contact


class Court:
    """A pair of parts with its models, its bounds and its judge."""

    def __init__(self, pair: Pair) -> None:
        self._pair = pair
        self._judge = MeshPair(pair.a.solid, pair.b.solid)
        self._a, self._b = pair.a.build(), pair.b.build()
        self._bounds = {
            shell: vx.contact_bounds(self._a, self._b, shell=shell) for shell in ("a", "b")
        }
        self._scale = max(bound.overlap for bound in self._bounds.values())
        self._clearance = max(bound.clearance for bound in self._bounds.values()) + ROUNDING
        self._size = sum(
            float(np.linalg.norm(model.bounds, axis=1).max()) for model in (self._a, self._b)
        )

    def judge(self, index: int, rng: np.random.Generator) -> Verdict:
        """One pose; raises AssertionError where voxshell and the meshes disagree."""
        a, b, judge = self._a, self._b, self._judge
        b_from_a = place(self._pair, judge, index, self._scale, self._size, rng)
        world_from_b = np.eye(4)
        world_from_b[:3, :3] = random_rotation(rng)
        world_from_b[:3, 3] = rng.uniform(-1.0, 1.0, 3)
        poses = (world_from_b @ b_from_a, world_from_b)
        touches = {shell: vx.collide(a, b, *poses, shell=shell) for shell in ("a", "b")}
        in_contact = any(touches.values())
        apart = not judge.surfaces_within(b_from_a, self._clearance)
        if apart and judge.overlap(b_from_a).is_empty():
            assert not in_contact, f"pose {index}: {touches} for meshes that are apart"
            return Verdict(in_contact, clear=True, judged=False, proven=0)
        if index % FULLY_JUDGED and all(touches.values()):
            return Verdict(in_contact, clear=False, judged=False, proven=0)
        proven = 0
        for column, (shell, bound) in enumerate(self._bounds.items()):
            deep = judge.reaches_deeper(b_from_a, bound.overlap + ROUNDING)[column]
            proven += deep
            assert touches[shell] or not deep, f"pose {index}: {shell}'s surface is deep inside"
        return Verdict(in_contact, clear=False, judged=True, proven=proven)
