"""Bodies in pairs, and the poses in which those that fit one another do. Meters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import solids
import voxshell as vx
from manifold3d import Manifold
from voxshell_studies.scenes.bolt import make_bolt, make_nut
from voxshell_studies.scenes.gear import make_gear

MM = 1e-3

Fit = Callable[[np.random.Generator], np.ndarray]
"""A pose, b_from_a, in which part a fits into part b."""


@dataclass
class Part:
    solid: Manifold
    voxel_size: float

    def build(self) -> vx.Model:
        return vx.Model.from_mesh(solids.as_arrays(self.solid), voxel_size=self.voxel_size)


PITCH = 6 * MM
_THREAD = {"radius": 10 * MM, "depth": 1.5 * MM, "pitch": PITCH, "segments": 32, "sections": 12}
GEAR_TEETH, PINION_TEETH, GEAR_MODULE = 24, 12, 3 * MM


def bolt() -> Part:
    return Part(make_bolt(**_THREAD, length=24 * MM, head=6 * MM), 0.4 * MM)


def nut() -> Part:
    return Part(make_nut(**_THREAD, height=9 * MM, clearance=0.7 * MM), 0.4 * MM)


def gear() -> Part:
    return Part(_gear(GEAR_TEETH, 8 * MM), 0.6 * MM)


def pinion() -> Part:
    return Part(_gear(PINION_TEETH, 5 * MM), 0.6 * MM)


def _gear(teeth: int, bore: float) -> Manifold:
    return make_gear(teeth, GEAR_MODULE, 10 * MM, bore, 0.9 * MM).refine_to_length(4 * MM)


def screwed_on(rng: np.random.Generator) -> np.ndarray:
    """The nut on the bolt."""
    turn = rng.uniform(0.3, 2.0)
    return turned_about_z(2.0 * np.pi * turn, (0.0, 0.0, turn * PITCH))


def in_mesh(rng: np.random.Generator) -> np.ndarray:
    """The pinion with the gear."""
    roll = rng.uniform(0.0, 2.0 * np.pi)
    ratio = GEAR_TEETH / PINION_TEETH
    pinion_pose = turned_about_z(np.pi + np.pi / PINION_TEETH - roll * ratio)
    axes = 0.5 * (GEAR_TEETH + PINION_TEETH) * GEAR_MODULE
    return (
        turned_about_z(-roll)
        @ turned_about_z(0.0, (axes, 0.0, 0.0))
        @ turned_about_z(roll)
        @ (turned_about_z(-roll) @ pinion_pose)
    )


def turned_about_z(
    angle: float, translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> np.ndarray:
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    pose[:3, 3] = translation
    return pose


def random_rotation(rng: np.random.Generator) -> np.ndarray:
    """Uniform: a normalized Gaussian quaternion."""
    w, x, y, z = (lambda q: q / np.linalg.norm(q))(rng.normal(size=4))
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
