"""True depths of the bodies' overlap, by libigl's signed distances to the exact meshes."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import metadata
from typing import TYPE_CHECKING

import numpy as np
from voxshell.model.shapes import Box
from voxshell.simulation.body_shapes import mesh_of

from voxshell_studies.peers.protocol import load_library

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray
    from voxshell.model.meshes import Mesh

    from voxshell_studies.peers.protocol import Job


@dataclass(frozen=True)
class Truth:
    """True depths of a case in its first pose. Meters; 0 without overlap.

    Attributes:
        case: Its key.
        depth: The larger of the next two.
        body_depth: Depth of the body's deepest sample in the other body.
        other_depth: Likewise, with the roles exchanged.
        version: Version of libigl.
    """

    case: str
    depth: float
    body_depth: float
    other_depth: float
    version: str


def find_truths(job: Job) -> Iterator[Truth]:
    """Compute the true depth; samples are all vertices and the centers of all faces.

    Raises:
        MissingExtraError: libigl is not installed.
    """
    igl = load_library("igl", "libigl")
    version = metadata.version("libigl")

    def deepest(samples: NDArray[np.float64], mesh: Mesh) -> float:
        distances = igl.signed_distance(
            np.ascontiguousarray(samples),
            np.ascontiguousarray(mesh.vertices, np.float64),
            np.ascontiguousarray(mesh.faces, np.int64),
            sign_type=igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL,
        )[0]
        return max(0.0, -float(np.min(distances)))

    samples = _sample(job.mesh)
    for case in job.cases:
        body_from_other = np.linalg.inv(case.poses[0]) @ case.other_pose
        other_from_body = np.linalg.inv(body_from_other)
        placed = _move(samples, other_from_body)
        if case.other == "plane":
            body, other = max(0.0, -float(placed[:, 2].min())), 0.0
        else:
            mesh = job.mesh if case.other == "body" else mesh_of(Box(job.box_half_extents))
            body = deepest(placed, mesh)
            other = deepest(_move(_sample(mesh), body_from_other), job.mesh)
        yield Truth(case.key, max(body, other), body, other, version)


def _sample(mesh: Mesh) -> NDArray[np.float64]:
    return np.concatenate([mesh.vertices, mesh.vertices[mesh.faces].mean(axis=1)])


def _move(points: NDArray[np.float64], pose: NDArray[np.float64]) -> NDArray[np.float64]:
    return points @ pose[:3, :3].T + pose[:3, 3]
