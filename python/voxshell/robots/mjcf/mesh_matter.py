"""Mass properties of meshes by MuJoCo's rules."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from voxshell.model.mass_properties import MassProperties

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.model.meshes import Mesh


def weigh_mesh(mesh: Mesh, kind: str) -> MassProperties:
    """Return mass properties at density 1; the mass is 0 if the mesh encloses nothing.

    Args:
        mesh: The surface.
        kind: "legacy" adds up the pyramids from the mean of the faces as if none overlapped, so a
            surface may be open; "exact" and "convex" use signed volumes; "shell" is a skin of 1
            kg/m2.
    """
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2.0
    areas = np.linalg.norm(normals, axis=1)
    middles = corners.mean(axis=1)
    if not areas.sum() > 0.0:
        return _nothing()
    apex = areas @ middles / areas.sum()
    if kind == "shell":
        weights = areas
        center = apex
    else:
        weights = _weigh_pyramids(corners, normals, apex, kind)
        total = weights.sum()
        if not total > 0.0:
            return _nothing()
        center = weights @ (0.75 * middles + 0.25 * apex) / total
        weights = _weigh_pyramids(corners, normals, center, kind)
    mass = float(weights.sum())
    arms = corners - center
    sums = arms.sum(axis=1)
    # Integral of x x^T over a triangle, or over the pyramid on it with its apex at the origin.
    factor = 1.0 / 12.0 if kind == "shell" else 1.0 / 20.0
    spread = np.einsum("f,fki,fkj->ij", weights, arms, arms)
    spread += np.einsum("f,fi,fj->ij", weights, sums, sums)
    spread *= factor
    return MassProperties(mass, center, np.trace(spread) * np.eye(3) - spread)


def _weigh_pyramids(
    corners: NDArray[np.float64], normals: NDArray[np.float64], apex: NDArray[np.float64], kind: str
) -> NDArray[np.float64]:
    volumes = np.einsum("fi,fi->f", corners[:, 0] - apex, normals) / 3.0
    return np.abs(volumes) if kind == "legacy" else volumes


def _nothing() -> MassProperties:
    return MassProperties(0.0, np.zeros(3), np.zeros((3, 3)))
