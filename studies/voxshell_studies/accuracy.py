"""True depth of two overlapping meshes, compared with shells of several resolutions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.errors import MissingExtraError
from voxshell.measuring.touching_poses import find_poses_between
from voxshell.model.model import Model
from voxshell.testing import contacts_flat

from voxshell_studies.part import Part
from voxshell_studies.scenes.bunny import BunnySettings

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell_studies.part import Tables


@dataclass(frozen=True)
class AccuracySettings(BunnySettings):
    """Settings of the accuracy.

    Attributes:
        poses: Number of poses, in any orientation and direction. Each takes a few seconds of exact
            overlap.
        least_depth, most_depth: Displacement after the first touch, meters; negative moves the
        bodies apart.
        reference_voxel_size: Voxel size of the reference, whose flat loop is the truth, meters.
        seed: Seed of the poses.
    """

    poses: int = 60
    least_depth: float = -0.002
    most_depth: float = 0.005
    reference_voxel_size: float = 0.0005
    seed: int = 54

    def __post_init__(self) -> None:
        super().__post_init__()
        as_integer(self.poses, "poses", 1, 100_000)
        as_positive(self.reference_voxel_size, "reference_voxel_size")


def plan(settings: AccuracySettings) -> list[Part]:
    """One part."""
    return [Part("depths", measure_depths, {"settings": settings}, cost=5.0 + 0.3 * settings.poses)]


def measure_depths(settings: AccuracySettings) -> Tables:
    """Measure every pose.

    Returns:
        "depths": the deepest contact by each shell, meters; the exact overlap, and what the shells
        make of it, m3.
    """
    mesh = settings.build_mesh()
    fine, coarse = settings.build_model("fine"), settings.build_model("coarse")
    truth = Model.from_mesh(
        mesh,
        voxel_size=settings.reference_voxel_size,
        point_spacing=settings.reference_voxel_size,
    )
    poses = find_poses_between(
        fine, settings.poses, settings.least_depth, settings.most_depth, settings.seed
    )
    solid = _as_solid(mesh)
    rows = []
    for pose in poses:
        overlap = solid ^ solid.transform(pose[:3])
        rows.append(
            (
                *(_find_depth(model, pose) for model in (fine, coarse, truth)),
                overlap.volume(),
                *(_add_volume(model, pose) for model in (fine, coarse)),
            )
        )
    names = ("fine", "coarse", "truth", "volume", "fine_volume", "coarse_volume")
    return {"depths": dict(zip(names, np.array(rows).T, strict=True))}


def _find_depth(model: Model, pose: NDArray[np.float64]) -> float:
    """Return the depth by the flat loop over all points of both, meters; 0 without contact."""
    found = contacts_flat(model, model, None, pose, shell="both")
    return float(found.depths.max(initial=0.0))


def _add_volume(model: Model, pose: NDArray[np.float64]) -> float:
    """Return the sum of areas times depths, m3: the volume of a shallow overlap."""
    found = contacts_flat(model, model, None, pose, shell="a")
    return float(model.shell.areas[found.ids].astype(np.float64) @ found.depths)


def _as_solid(mesh: Any) -> Any:
    try:
        import manifold3d  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise MissingExtraError(
            "exact overlaps need manifold3d: pip install voxshell-studies"
        ) from error
    return manifold3d.Manifold(
        manifold3d.Mesh64(mesh.vertices, np.asarray(mesh.faces, dtype=np.uint64))
    )
