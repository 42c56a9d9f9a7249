"""Bunnies poured into a bin: many concave bodies that lean on each other.

World frame: z up, the bin's floor at z = 0, its middle on the z axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Literal

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.model.meshes import Mesh, read_mesh
from voxshell.model.model import Model
from voxshell.model.shapes import Box
from voxshell.simulation.comparison_shapes import ConvexDecomposition, GImpact
from voxshell.simulation.world import World
from voxshell_studies.scenes.bunny import find_bunny
from voxshell_studies.scenes.drop import choose_bullet_solver, decompose
from voxshell_studies.scenes.solids import as_mesh, import_manifold

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.simulation.body import Body
    from voxshell.simulation.body_shapes import Shape

Method = Literal["voxshell", "decomposition", "gimpact"]
METHODS: tuple[Method, ...] = ("voxshell", "decomposition", "gimpact")
"""Models in a bin that is a model, and Bullet's ways with a mesh in a bin of five of its boxes."""

_WALL = 0.03
_PITCH = 1.4
"""Of bodies at the start, in sizes."""


@dataclass(frozen=True)
class PourSettings:
    """Settings of the pouring.

    Attributes:
        mesh: Path of another mesh; the bunny by default.
        count: Bodies.
        size: Of the body's longest side, meters.
        voxel_size: Of the body, meters,
        bin_voxel_size: and of the bin.
        bin_size: Inside, meters.
        mass: Of each body, kilograms.
        rate: Steps a second.
        seconds: How long is simulated.
        slow_steps: Of GImpact, in the heap that the models made; it takes seconds a step.
        seed: Of the orientations at the start.

    Raises:
        SettingsError: A number is out of range.
    """

    mesh: str = ""
    count: int = 100
    size: float = 0.1
    voxel_size: float = 0.002
    bin_voxel_size: float = 0.005
    bin_size: tuple[float, ...] = (0.45, 0.45, 0.6)
    mass: float = 0.1
    rate: float = 200.0
    seconds: float = 5.0
    slow_steps: int = 3
    seed: int = 1

    def __post_init__(self) -> None:
        for name in ("size", "voxel_size", "bin_voxel_size", "mass", "rate", "seconds"):
            as_positive(getattr(self, name), name)
        for name in ("count", "slow_steps"):
            as_integer(getattr(self, name), name, 1, 10_000)
        for side in self.bin_size:
            as_positive(side, "bin_size")

    def build_mesh(self) -> Mesh:
        """The body's triangles, about the middle of its bounds."""
        return _build_mesh(self.mesh, self.size)

    def build_model(self) -> Model:
        """Of the body."""
        return _build_model(self.mesh, self.size, self.voxel_size)

    def build_bin(self) -> Mesh:
        """The bin's triangles."""
        outer = np.add(self.bin_size, (2.0 * _WALL, 2.0 * _WALL, 0.0))
        solids = import_manifold()
        shell = solids.Manifold.cube((*outer[:2], outer[2] + _WALL), center=False).translate(
            (-0.5 * outer[0], -0.5 * outer[1], -_WALL)
        )
        hole = solids.Manifold.cube(tuple(self.bin_size), center=False).translate(
            (-0.5 * self.bin_size[0], -0.5 * self.bin_size[1], 0.0)
        )
        return as_mesh(shell - hole.scale((1.0, 1.0, 2.0)))

    def compute_starts(self) -> NDArray[np.float64]:
        """World_from_body, (count, 4, 4): in layers over the bin's floor, turned at random."""
        from trimesh.transformations import random_rotation_matrix

        rng = np.random.default_rng(self.seed)
        poses = np.array([random_rotation_matrix(rng.random(3)) for _ in range(self.count)])
        pitch = _PITCH * self.size
        row = max(int(min(self.bin_size[:2]) / pitch), 1)
        numbers = np.arange(self.count)
        poses[:, 0, 3] = (numbers % row - 0.5 * (row - 1)) * pitch
        poses[:, 1, 3] = (numbers // row % row - 0.5 * (row - 1)) * pitch
        poses[:, 2, 3] = (numbers // row**2 + 0.8) * pitch
        return poses

    def find_lost(self, poses: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which bodies are outside the bin, or nowhere, (count,)."""
        places = poses[:, :3, 3]
        half = 0.5 * np.array(self.bin_size[:2])
        inside = np.isfinite(poses).all(axis=(1, 2)) & (np.abs(places[:, :2]) < half).all(axis=1)
        return ~(inside & (places[:, 2] > 0.0))


@cache
def _build_mesh(path: str, size: float) -> Mesh:
    mesh = read_mesh(path or find_bunny())
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    return Mesh((mesh.vertices - 0.5 * (low + high)) * (size / (high - low).max()), mesh.faces)


@cache
def _build_model(path: str, size: float, voxel_size: float) -> Model:
    return Model.from_mesh(_build_mesh(path, size), voxel_size=voxel_size)


@cache
def _build_hulls(path: str, size: float) -> ConvexDecomposition:
    return decompose(_build_mesh(path, size))


def build_world(
    settings: PourSettings, method: Method, poses: NDArray[np.float64]
) -> tuple[World, list[Body]]:
    """The bin and the bodies, in given poses, (count, 4, 4). Nothing sleeps.

    Raises:
        MissingExtraError: A library that makes the bin or the decomposition is not installed.
    """
    ours = method == "voxshell"
    world = World(
        shell="fewest",
        time_step=1.0 / settings.rate,
        sleeping=False,
        **({} if ours else choose_bullet_solver(method)),
    )
    if ours:
        world.add(
            Model.from_mesh(settings.build_bin(), voxel_size=settings.bin_voxel_size), mass=0.0
        )
    else:
        for middle, half in find_plates(settings):
            pose = np.eye(4)
            pose[:3, 3] = middle
            world.add(Box(half), mass=0.0, pose=pose)
    shape = _build_shape(settings, method)
    matter = settings.build_model().mass_properties(settings.mass)
    return world, [
        world.add(shape, mass=settings.mass, pose=pose, inertia=matter) for pose in poses
    ]


def _build_shape(settings: PourSettings, method: Method) -> Shape:
    if method == "decomposition":
        return _build_hulls(settings.mesh, settings.size)
    return settings.build_model() if method == "voxshell" else GImpact(settings.build_mesh())


def find_plates(settings: PourSettings) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Middles and half extents of the bin's floor and walls."""
    inside = 0.5 * np.array(settings.bin_size)
    half = np.add(inside, (_WALL, _WALL, 0.0))
    plates = [(np.array([0.0, 0.0, -0.5 * _WALL]), np.array([half[0], half[1], 0.5 * _WALL]))]
    for axis in (0, 1):
        for side in (-1.0, 1.0):
            middle = np.array([0.0, 0.0, inside[2]])
            middle[axis] = side * (inside[axis] + 0.5 * _WALL)
            extents = half.copy()
            extents[axis] = 0.5 * _WALL
            plates.append((middle, extents))
    return plates
