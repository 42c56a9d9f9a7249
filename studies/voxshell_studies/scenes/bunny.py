"""The Stanford bunny, from where Debian and Ubuntu keep it, as the experiments use it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.errors import MeshError
from voxshell.model.meshes import Mesh, read_mesh
from voxshell.model.model import Model
from voxshell.model.shapes import Box
from voxshell.simulation.body_shapes import mesh_of

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.model.mass_properties import MassProperties

_DEBIAN_PATH = Path("/usr/share/glmark2/models/bunny.obj")


def find_bunny() -> Path:
    """The path of the Stanford bunny: 34,835 vertices, closed, y up.

    Raises:
        MeshError: The package that has it is not installed.
    """
    if not _DEBIAN_PATH.is_file():
        raise MeshError(
            f"the Stanford bunny is not at {_DEBIAN_PATH}; "
            "install it (Debian, Ubuntu: apt install glmark2-data) or give another mesh"
        )
    return _DEBIAN_PATH


# Drawn uniformly (numpy's default_rng(53), normalized Gaussians) and rounded; the first is upright.
ORIENTATIONS_WXYZ: tuple[tuple[float, float, float, float], ...] = (
    (0.7071068, 0.7071068, 0.0, 0.0),
    (0.0687, -0.5296, 0.5857, -0.6097),
    (-0.5119, 0.2315, 0.5946, 0.5751),
    (0.8650, 0.2571, -0.2227, 0.3688),
    (0.6249, 0.0713, -0.7535, -0.1915),
    (0.1528, -0.6650, -0.2093, -0.7004),
    (0.8292, 0.3319, -0.0657, 0.4449),
    (0.2973, -0.9272, 0.0487, -0.2224),
    (0.7664, -0.2075, -0.5861, 0.1613),
    (-0.5262, -0.5550, 0.5382, -0.3542),
    (-0.6698, 0.0093, -0.6406, 0.3755),
    (-0.3002, 0.0356, 0.5698, 0.7642),
    (-0.9046, -0.1996, -0.1620, 0.3401),
    (-0.1935, -0.4105, 0.6669, 0.5910),
    (0.0514, -0.8329, -0.0552, -0.5482),
    (0.8831, 0.2188, 0.1606, 0.3826),
    (0.4562, -0.7666, 0.3942, 0.2208),
    (-0.8962, 0.4150, 0.1535, -0.0325),
    (0.3614, -0.5499, 0.7094, -0.2524),
    (-0.4922, 0.8066, 0.3256, 0.0339),
    (0.1638, 0.3063, 0.8374, 0.4221),
    (0.8144, -0.3717, -0.4216, 0.1441),
    (0.4719, -0.0284, -0.8314, -0.2920),
    (0.4805, 0.4449, -0.6098, 0.4464),
    (0.4132, 0.3320, 0.8074, 0.2591),
    (0.8531, -0.2321, -0.4428, 0.1492),
    (0.3755, -0.8005, 0.3983, 0.2439),
    (-0.5911, -0.1515, 0.5929, 0.5255),
    (-0.4230, 0.3130, 0.0317, 0.8497),
    (-0.0884, 0.3192, -0.7598, 0.5595),
    (-0.0210, -0.7256, -0.6611, -0.1898),
    (-0.5650, 0.6125, -0.4768, -0.2796),
    (0.9808, -0.0146, 0.1660, 0.1009),
    (-0.0362, 0.0917, -0.8695, 0.4841),
    (0.1632, 0.1007, -0.7509, 0.6320),
    (-0.6602, -0.0425, -0.3285, -0.6741),
    (0.6298, 0.5780, 0.5188, -0.0025),
    (-0.4355, 0.0898, -0.0692, -0.8930),
    (0.6319, 0.4390, -0.3319, -0.5457),
    (-0.0337, 0.0938, 0.9778, 0.1844),
    (-0.5084, 0.3251, -0.6061, -0.5180),
    (0.2994, -0.1293, -0.8495, -0.4148),
    (-0.3829, -0.8314, -0.3897, 0.1017),
    (-0.1366, -0.4452, 0.3769, 0.8007),
    (0.5410, -0.6712, -0.5035, 0.0580),
    (0.1687, -0.8789, 0.4457, 0.0200),
    (-0.5447, -0.7844, 0.0025, -0.2965),
    (0.5408, -0.2620, -0.1653, 0.7820),
    (-0.7319, 0.6445, 0.1206, -0.1854),
    (-0.5109, 0.0681, 0.7461, 0.4215),
    (0.0073, 0.9177, -0.3433, 0.1999),
    (0.8004, 0.0620, 0.5884, 0.0971),
    (-0.4568, 0.5848, -0.3061, 0.5964),
    (0.5513, 0.7265, 0.4032, -0.0755),
    (-0.5726, -0.3244, -0.3255, 0.6789),
    (-0.8264, 0.4985, -0.1256, 0.2299),
    (0.5486, 0.3744, 0.6327, -0.3981),
    (-0.2990, -0.9405, -0.1406, -0.0790),
    (0.2113, 0.3092, 0.6343, 0.6763),
    (-0.7450, -0.2397, -0.4985, -0.3728),
)
"""Of the bunny in the experiments, as unit quaternions but for rounding: world_from_body."""


@dataclass(frozen=True)
class BunnySettings:
    """What experiments with the bunny share.

    Attributes:
        size: Its longest side, meters.
        voxel_size: Meters.
        fine_points, coarse_points: Of the two shells.
        mass: Kilograms; the inertia is that of the surface, as in the thesis.
        orientations: How many of :data:`ORIENTATIONS_WXYZ`.

    Raises:
        SettingsError: A number is out of range.
    """

    size: float = 0.2115
    voxel_size: float = 0.002
    fine_points: int = 35_596
    coarse_points: int = 799
    mass: float = 1.0
    orientations: int = 10

    def __post_init__(self) -> None:
        for name in ("size", "voxel_size", "mass"):
            as_positive(getattr(self, name), name)
        for name in ("fine_points", "coarse_points"):
            as_integer(getattr(self, name), name, 1, 2**31 - 1)
        as_integer(self.orientations, "orientations", 1, len(ORIENTATIONS_WXYZ))

    def build_model(self, shell: Literal["fine", "coarse"] = "fine") -> Model:
        """The bunny's model, its origin at the surface's center of mass."""
        points = {"fine": self.fine_points, "coarse": self.coarse_points}[shell]
        return _build_model(self.size, self.voxel_size, points)

    def build_mesh(self) -> Mesh:
        """The bunny's triangles, in the model's frame."""
        return _build_mesh(self.size)

    @property
    def mass_properties(self) -> MassProperties:
        """Of the surface."""
        return self.build_model().mass_properties(self.mass, "surface")


@cache
def _build_mesh(size: float) -> Mesh:
    mesh = read_mesh(find_bunny())
    vertices = mesh.vertices * (size / np.ptp(mesh.vertices, axis=0).max())
    corners = vertices[mesh.faces]
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    center = np.average(corners.mean(axis=1), axis=0, weights=areas)
    return Mesh(vertices - center, mesh.faces)


@cache
def _build_model(size: float, voxel_size: float, points: int) -> Model:
    return Model.from_mesh(_build_mesh(size), voxel_size=voxel_size, target_points=points)


@cache
def build_block(half_extents: tuple[float, float, float], voxel_size: float) -> Model:
    """A block of voxels about its middle, for the ground."""
    return Model.from_mesh(mesh_of(Box(half_extents)), voxel_size=voxel_size)


def compute_pose(mesh: Mesh, orientation: int, height: float) -> NDArray[np.float64]:
    """``world_from_body`` in one of the orientations, (4, 4).

    Args:
        mesh: Of the body.
        orientation: Row of :data:`ORIENTATIONS_WXYZ`.
        height: Of the lowest vertex over z = 0, meters; the body's origin is above the world's.
    """
    from trimesh.transformations import quaternion_matrix

    pose = np.array(quaternion_matrix(ORIENTATIONS_WXYZ[orientation]))
    pose[2, 3] = height - (mesh.vertices @ pose[2, :3]).min()
    return pose


def find_lowest(mesh: Mesh, pose: NDArray[np.float64]) -> float:
    """Height of the mesh's lowest vertex, meters: the truth about how deep a body sinks."""
    return float((mesh.vertices @ pose[2, :3]).min() + pose[2, 3])
