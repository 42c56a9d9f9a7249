"""Contacts against the meshes themselves, with coal and manifold3d as judges (support/real_geometry.py)."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
import solids
import voxshell as vx
from parts import MM, random_rotation
from real_geometry import NAMES, Court, make_pair

POSES = int(os.environ.get("VOXSHELL_POSES", "300"))  # a pair


@pytest.mark.parametrize("name", NAMES)
def test_contact_is_what_the_meshes_say_within_the_stated_bounds(name: str, bunny_path: Path):
    court = Court(make_pair(name, bunny_path))
    rng = np.random.default_rng(17)
    verdicts = [court.judge(index, rng) for index in range(POSES)]
    in_contact = sum(verdict.in_contact for verdict in verdicts)
    clear = sum(verdict.clear for verdict in verdicts)
    judged = sum(verdict.judged for verdict in verdicts)
    proven = sum(verdict.proven for verdict in verdicts)

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
