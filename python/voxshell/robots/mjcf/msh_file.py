"""Files in MuJoCo's binary mesh format, ``.msh``."""

from __future__ import annotations

import numpy as np

from voxshell.base.input_files import read_small_file
from voxshell.errors import FileAccessError, MeshError, SettingsError
from voxshell.model.meshes import Mesh, read_mesh

_MOST_BYTES = 1_000_000_000
_HEAD = 4
"""Counts in the header: vertices, normals, texture coordinates, faces; int32."""


def read_msh(path: str) -> Mesh:
    """Return the triangles of a file.

    Raises:
        MeshError: It cannot be read, its length contradicts its counts, or it holds no triangles.
    """
    try:
        data = read_small_file(path, _MOST_BYTES, "mesh")
    except (SettingsError, FileAccessError) as error:
        raise MeshError(str(error)) from None
    counts = np.frombuffer(data[: 4 * _HEAD], "<i4") if len(data) >= 4 * _HEAD else np.zeros(_HEAD)
    vertices, normals, coordinates, faces = map(int, counts)
    words = _HEAD + 3 * vertices + 3 * normals + 2 * coordinates + 3 * faces
    if min(vertices, faces) < 1 or min(normals, coordinates) < 0 or 4 * words != len(data):
        raise MeshError(
            f"cannot read mesh {path}: it is damaged, or not an MSH file; export it again"
        )
    points = np.frombuffer(data, "<f4", 3 * vertices, 4 * _HEAD)
    corners = np.frombuffer(data, "<i4", 3 * faces, 4 * (words - 3 * faces))
    return read_mesh((points.astype(np.float64).reshape(-1, 3), corners.reshape(-1, 3)))
