"""Bodies made with manifold3d."""

from __future__ import annotations

from typing import Any

import numpy as np
from voxshell.errors import MissingExtraError
from voxshell.model.meshes import Mesh


def import_manifold() -> Any:
    """The module ``manifold3d``.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import manifold3d  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise MissingExtraError(
            "this body is made with manifold3d: pip install voxshell-studies"
        ) from error
    return manifold3d


def as_mesh(solid: Any) -> Mesh:
    """The surface of a ``manifold3d.Manifold``."""
    mesh = solid.to_mesh64()
    return Mesh(np.array(mesh.vert_properties[:, :3]), np.array(mesh.tri_verts, dtype=np.uint32))


def simplify(mesh: Mesh, error: float) -> Mesh:
    """A mesh with fewer triangles, at most ``error`` meters off; itself where it encloses no solid."""
    solids = import_manifold()
    # It takes no arrays that cannot be written to, as those of models are.
    solid = solids.Manifold(
        solids.Mesh64(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.uint64))
    )
    return mesh if solid.is_empty() else as_mesh(solid.simplify(error))
