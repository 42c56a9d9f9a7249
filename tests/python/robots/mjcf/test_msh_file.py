from __future__ import annotations

import struct

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.robots.mjcf.msh_file import read_msh


def pack(mesh, normals=0, coordinates=0):
    head = struct.pack("<4i", len(mesh.vertices), normals, coordinates, len(mesh.faces))
    between = b"\0" * 4 * (3 * normals + 2 * coordinates)
    return (
        head + mesh.vertices.astype("<f4").tobytes() + between + mesh.faces.astype("<i4").tobytes()
    )


def test_vertices_and_faces_are_read(tmp_path):
    box = trimesh.creation.box((1, 2, 3))
    (tmp_path / "box.msh").write_bytes(pack(box, normals=8, coordinates=8))
    mesh = read_msh(str(tmp_path / "box.msh"))
    np.testing.assert_allclose(mesh.vertices, box.vertices)
    np.testing.assert_array_equal(mesh.faces, box.faces)


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: data[:-4],
        lambda data: data + b"\0" * 4,
        lambda data: data[:12],
        lambda data: struct.pack("<4i", 8, -1, 0, 13) + data[16:],
        lambda data: data[:-4] + struct.pack("<i", 8),
    ],
)
def test_damaged_files_are_refused(tmp_path, damage):
    (tmp_path / "box.msh").write_bytes(damage(pack(trimesh.creation.box())))
    with pytest.raises(vx.MeshError):
        read_msh(str(tmp_path / "box.msh"))
