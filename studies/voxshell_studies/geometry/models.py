"""Bodies of the geometry study: as default models for queries, and as solids for the truth."""

from __future__ import annotations

import warnings
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from voxshell.base.poses import invert
from voxshell.model.model import Model
from voxshell.query.bounds import ContactBounds, contact_bounds

from voxshell_studies.geometry.surface_truth import Surface
from voxshell_studies.scenes.geometry import random_rotation
from voxshell_studies.scenes.geometry_bodies import BODIES, make_body, retriangulate, turn_mesh
from voxshell_studies.scenes.solids import as_mesh, import_manifold

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

RETRIANGULATED = -1
"""Number of the copy with other triangles; 0 is the scene, 1 and above are rotated copies."""

ORDERS = (0, 1)
"""Orders of arguments: a before b, and b before a."""


class _Copy(NamedTuple):
    """A body in one copy of a scene: its model, and the rotation of its mesh."""

    model: Model
    rotation: NDArray[np.float64]


@lru_cache(maxsize=64)  # the models of many scenes would fill the memory
def build_copy(body: str, copy: int) -> _Copy:
    """Return the default model of a body: as it is, with other triangles, or randomly rotated.

    Args:
        body: A key of ``BODIES``.
        copy: 0, :data:`RETRIANGULATED`, or the number of a rotated copy.
    """
    mesh, rotation = make_body(body), np.eye(3)
    if copy == RETRIANGULATED:
        mesh = retriangulate(mesh)
    elif copy > 0:
        rotation = random_rotation(np.random.default_rng((copy, list(BODIES).index(body))))
        mesh = turn_mesh(mesh, rotation)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return _Copy(Model.from_mesh(mesh), rotation)


@cache
def find_surface(body: str) -> Surface:
    """Return the faces of a body."""
    return Surface(make_body(body))


class Pair:
    """The models of two bodies, for queries in either order and in the bodies' own frames."""

    def __init__(self, a: str, b: str, copy: int = 0) -> None:
        self.a, self.b = a, b
        self._models = build_copy(a, copy), build_copy(b, copy)

    def ask(
        self,
        query: Callable[..., Any],
        b_from_a: NDArray[np.float64],
        order: int,
        **options: object,
    ) -> Any:
        """Return the result of a query with b at the origin; in order 1, b is the first body."""
        pair = []
        for (model, rotation), pose in zip(self._models, (b_from_a, np.eye(4)), strict=True):
            turned = pose.copy()
            turned[:3, :3] = pose[:3, :3] @ rotation.T
            pair.append((model, turned))
        if order == 1:
            pair.reverse()
        (first, first_pose), (second, second_pose) = pair
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return query(first, second, first_pose, second_pose, **options)

    def find_voxel_size(self, of_a: bool) -> float:
        """Return the voxel size of a's or b's field, meters."""
        return self._models[0 if of_a else 1].model.field.voxel_size

    def state_bounds(self, order: int) -> ContactBounds:
        """Return the library's bounds for contacts of the pair; in order 1, b is the first body."""
        a, b = (each.model for each in self._models)
        return contact_bounds(b, a) if order == 1 else contact_bounds(a, b)


def carry(pose: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return places, (n, 3), transformed by a pose."""
    return places @ pose[:3, :3].T + pose[:3, 3]


def move(
    pose: NDArray[np.float64], direction: NDArray[np.float64], by: float
) -> NDArray[np.float64]:
    """Return the pose moved along a direction, meters."""
    moved = pose.copy()
    moved[:3, 3] += by * direction
    return moved


@cache
def _as_solid(body: str) -> Any:
    solids = import_manifold()
    mesh = make_body(body)
    return solids.Manifold(
        solids.Mesh64(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.uint64))
    )


def overlap(a: str, b: str, b_from_a: NDArray[np.float64]) -> Any:
    """Return the exact intersection of two bodies, a ``manifold3d.Manifold`` in b's frame."""
    return _as_solid(a).transform(b_from_a[:3]) ^ _as_solid(b)


def measure_reach(
    a: str, b: str, b_from_a: NDArray[np.float64], places: int
) -> tuple[float, float]:
    """Return proven depths of a's surface in b and of b's in a, meters; 0 if they are apart.

    Args:
        a: A key of ``BODIES``.
        b: Likewise.
        b_from_a: Their pose.
        places: Largest number of places on the surface of their intersection to measure.
    """
    common = overlap(a, b, b_from_a)
    if common.is_empty():
        return 0.0, 0.0
    mesh = as_mesh(common)
    looked_at = np.concatenate([mesh.vertices, mesh.vertices[mesh.faces].mean(axis=1)])
    looked_at = looked_at[:: -(-len(looked_at) // places)]
    # A place on the intersection's surface that is deep in one body is on the other's surface.
    return (
        float(find_surface(b).measure_distances(looked_at).max()),
        float(find_surface(a).measure_distances(carry(invert(b_from_a), looked_at)).max()),
    )


def measure_gap(a: str, b: str, b_from_a: NDArray[np.float64], most: float) -> float:
    """Return the distance of two bodies, meters, up to a limit."""
    return float(_as_solid(a).transform(b_from_a[:3]).min_gap(_as_solid(b), most))
