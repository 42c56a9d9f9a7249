"""Every fast path finds what the flat loop over all points finds, to the last bit.

Six pairs; a third of their poses far apart, a third touching, a third deep. Of parts that fit one
another, half of the touching and deep poses are about the fit. VOXSHELL_POSES=20000 asks for so
many poses a pair; CONTRIBUTING.md says when. `./dev soak` runs more pairs, and counts.
"""

from __future__ import annotations

import os
from itertools import pairwise

import dirty_meshes
import numpy as np
import parts
import pytest
import solids
import trimesh
import voxshell as vx
from fast_paths import Asker, Pair, compare_all, far_touching_or_deep
from parts import MM

POSES = int(os.environ.get("VOXSHELL_POSES", "480"))  # a pair
CHUNK = 240  # poses whose contacts are held at once

RING_GEAR = "differential/diff_ring.stl"
NAMES = ("bunny-bunny", "nut-bolt", "pinion-gear", "ring-bunny", "box-bunny", "bunny-plane")


def make_pair(name: str, bunny: vx.Model) -> Pair:
    match name:
        case "bunny-bunny":
            return Pair(bunny, bunny)
        case "nut-bolt":
            return Pair(parts.nut().build(), parts.bolt().build(), parts.screwed_on)
        case "pinion-gear":
            return Pair(parts.pinion().build(), parts.gear().build(), parts.in_mesh)
        case "ring-bunny":
            path = dirty_meshes.fetch([RING_GEAR]) / RING_GEAR
            mesh = trimesh.load_mesh(path)
            assert mesh.is_watertight
            assert mesh.euler_number < 0, "no holes"
            mesh.apply_translation(-mesh.bounds.mean(axis=0))
            mesh.apply_scale(0.2 / mesh.extents.max())
            return Pair(vx.Model.from_mesh(mesh, voxel_size=2 * MM), bunny)
        case "box-bunny":
            corners, triangles = solids.as_arrays(solids.box((0.16, 0.12, 0.05)))
            return Pair(vx.Model.from_mesh((corners, triangles), voxel_size=2 * MM), bunny)
        case _:
            return Pair(bunny, vx.Plane(normal=(0.1, -0.2, 0.9), offset=0.03))


@pytest.mark.parametrize("name", NAMES)
def test_every_fast_path_finds_what_the_flat_loop_finds(name: str, fine_bunny: vx.Model):
    pair = make_pair(name, fine_bunny)
    rng = np.random.default_rng(NAMES.index(name))
    asker = Asker(pair, rng)
    in_contact = np.zeros(POSES, dtype=bool)
    contacts = 0
    for start, end in pairwise([*range(0, POSES, CHUNK), POSES]):
        b_from_a = far_touching_or_deep(pair, end - start, rng)
        in_contact[start:end], found = compare_all(asker, start, b_from_a, rng)
        contacts += found

    far, touching, deep = (float(in_contact[third::3].mean()) for third in range(3))
    print(
        f"{name}: {POSES} poses, {in_contact.mean():.1%} in contact (far {far:.1%}, touching "
        f"{touching:.1%}, deep {deep:.1%}), {contacts / max(in_contact.sum(), 1):.0f} contacts each"
    )
    assert far <= 0.1
    assert touching >= 0.4
    assert deep >= 0.6
    assert 0.35 <= in_contact.mean() <= 0.7
