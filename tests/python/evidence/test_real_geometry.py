"""Contacts against the meshes themselves, with coal and manifold3d as judges.

Where the shell's surface reaches deeper into the other mesh than the stated bound
(:func:`voxshell.contact_bounds`), contact is reported; where the meshes are farther apart than the
field is off, it is not. Poses: a third far, a third touching, a third deep, as seen by coal; of
parts that fit one another, half are about the fit.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import parts
import pytest
import solids
import voxshell as vx
from mesh_judges import MeshPair
from parts import MM, Part, random_rotation

POSES = 1_000  # a pair
FULLY_JUDGED = 5  # one in so many poses is judged even where the answer needs no proof
ROUNDING = 1e-6  # metres; coordinates here are below a metre


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


@pytest.mark.parametrize(
    "name", ["bunny-bunny", "bunny-box", "nut-bolt", "pinion-gear", "bolt-box"]
)
def test_contact_is_what_the_meshes_say_within_the_stated_bounds(name: str, bunny_path: Path):
    pair = make_pair(name, bunny_path)
    judge = MeshPair(pair.a.solid, pair.b.solid)
    a, b = pair.a.build(), pair.b.build()
    bounds = {shell: vx.contact_bounds(a, b, shell=shell) for shell in ("a", "b")}
    size = float(np.linalg.norm(a.bounds, axis=1).max() + np.linalg.norm(b.bounds, axis=1).max())
    rng = np.random.default_rng(17)
    clearance = max(bound.clearance for bound in bounds.values()) + ROUNDING
    in_contact = clear = proven = judged = 0
    for index in range(POSES):
        b_from_a = place(
            pair, judge, index, max(bound.overlap for bound in bounds.values()), size, rng
        )
        world_from_b = np.eye(4)
        world_from_b[:3, :3] = random_rotation(rng)
        world_from_b[:3, 3] = rng.uniform(-1.0, 1.0, 3)
        poses = (world_from_b @ b_from_a, world_from_b)
        touches = {shell: vx.collide(a, b, *poses, shell=shell) for shell in ("a", "b")}
        in_contact += any(touches.values())

        if not judge.surfaces_within(b_from_a, clearance) and judge.overlap(b_from_a).is_empty():
            clear += 1
            assert not any(touches.values()), f"pose {index}: {touches} for meshes that are apart"
        elif index % FULLY_JUDGED == 0 or not all(touches.values()):
            judged += 1
            for column, (shell, bound) in enumerate(bounds.items()):
                deep = judge.reaches_deeper(b_from_a, bound.overlap + ROUNDING)[column]
                proven += deep
                assert touches[shell] or not deep, f"pose {index}: {shell}'s surface is deep inside"

    print(
        f"{name}: of {POSES} poses {in_contact} in contact, {clear} clear; "
        f"contact proven for {proven} of {2 * judged} shells"
    )
    assert 0.3 * POSES <= in_contact <= 0.8 * POSES
    assert clear >= 0.15 * POSES
    assert proven >= 0.15 * 2 * judged


# ---- one body inside the other -------------------------------------------------------------------


def fine_ball_in_coarse_box() -> tuple[vx.Model, vx.Model]:
    ball = vx.Model.from_mesh(
        solids.as_arrays(solids.ball(20 * MM)), resolution=30, target_points=3_000
    )
    box = vx.Model.from_mesh(
        solids.as_arrays(solids.box((0.2, 0.2, 0.2))), resolution=40, target_points=500
    )
    return ball, box


def inner_poses() -> list[np.ndarray]:
    rng = np.random.default_rng(5)
    poses = []
    for _ in range(20):
        pose = np.eye(4)
        pose[:3, :3] = random_rotation(rng)
        pose[:3, 3] = rng.uniform(-0.06, 0.06, 3)
        poses.append(pose)
    return poses


def test_a_body_inside_another_with_more_points_is_in_contact():
    ball, _ = fine_ball_in_coarse_box()
    box = vx.Model.from_mesh(
        solids.as_arrays(solids.box((0.2, 0.2, 0.2))), resolution=40, target_points=9_000
    )
    for pose in inner_poses():
        assert vx.collide(ball, box, pose)
        assert vx.collide(box, ball, b_pose=pose)


def test_a_body_inside_another_with_fewer_points_is_in_contact():
    ball, box = fine_ball_in_coarse_box()
    for pose in inner_poses():
        assert vx.collide(ball, box, pose)
        assert vx.collide(box, ball, b_pose=pose)
