"""A recording for exports: bodies of one shape, a body that stays, and contacts that grow deeper and stronger."""

from __future__ import annotations

import math

import numpy as np
import trimesh
from trimesh.transformations import rotation_matrix
from voxshell.recording import BodyTrack, ContactTrack, Recording

FRAMES, TIME_STEP = 61, 1 / 60


def turn_and_fall() -> Recording:
    """A ball that moves a meter along x and turns one and a half times about z, two alike beside it, and a ground."""
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.1)
    poses = np.array(
        [rotation_matrix(3.0 * math.pi * i / (FRAMES - 1), (0, 0, 1)) for i in range(FRAMES)]
    )
    poses[:, 0, 3] = np.linspace(0.0, 1.0, FRAMES)
    poses[:, 2, 3] = 0.1
    beside = poses.copy()
    beside[:, 1, 3] += 0.5
    ground = trimesh.creation.box((4.0, 4.0, 0.2))
    under = np.tile(np.eye(4), (FRAMES, 1, 1))
    under[:, 2, 3] = -0.1
    frames = [
        ([[x, 0, 0]], [[0, 0, 1]], [0.001 * x + 0.001], [[0, 0, 1 + x]]) for x in poses[:, 0, 3]
    ]
    return Recording(
        TIME_STEP,
        (
            BodyTrack("ball", ball.vertices, ball.faces, (255, 0, 0), poses),
            BodyTrack("a ball/2", ball.vertices, ball.faces, None, beside),
            BodyTrack("Boden ü", ground.vertices, ground.faces, None, under),
        ),
        ContactTrack.from_frames(frames),
    )


def come_later(start: int) -> Recording:
    """The ball of the other recording alone, which is there from a frame on, and the ground."""
    recording = turn_and_fall()
    ball, _, ground = recording.bodies
    late = BodyTrack(ball.name, ball.vertices, ball.faces, ball.color, ball.poses, start)
    return Recording(TIME_STEP, (late, ground), ContactTrack.empty(FRAMES))
