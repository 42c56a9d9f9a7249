"""Bodies of the study of geometry: as default models that are asked, and as solids that know what is true."""

from __future__ import annotations

import warnings
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from voxshell.model.model import Model
from voxshell.query.bounds import ContactBounds, contact_bounds

from voxshell_studies.scenes.geometry import random_rotation
from voxshell_studies.scenes.geometry_bodies import BODIES, make_body, retriangulate, turn_mesh
from voxshell_studies.scenes.solids import as_mesh, import_manifold
from voxshell_studies.surface_truth import Surface

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

RETRIANGULATED = -1
"""The copy with other triangles; 0 is the scene itself, 1 and above are rotated copies."""

ORDERS = (0, 1)
"""Of arguments: a before b, and b before a."""


class _Copy(NamedTuple):
    """A body as one copy of a scene has it: its model, and how its mesh is rotated."""

    model: Model
    rotation: NDArray[np.float64]


@lru_cache(maxsize=64)  # models of many scenes would fill the memory
def build_copy(body: str, copy: int) -> _Copy:
    """The default model of a body, as it is, with other triangles, or rotated by chance.

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
    """The faces of a body."""
    return Surface(make_body(body))


class Pair:
    """Two bodies' models, which are asked in either order, in poses of the bodies' own frames."""

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
        """The answer of a query, b at the origin; order 1 gives b first."""
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
        """Of a's field or b's, metres."""
        return self._models[0 if of_a else 1].model.field.voxel_size

    def state_bounds(self, order: int) -> ContactBounds:
        """What the library states for contacts of the pair; order 1 gives b first."""
        a, b = (each.model for each in self._models)
        return contact_bounds(b, a) if order == 1 else contact_bounds(a, b)


def invert(pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """The inverse of a rigid pose, (4, 4)."""
    inverse = np.eye(4)
    inverse[:3, :3] = pose[:3, :3].T
    inverse[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return inverse


def carry(pose: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places, (n, 3), moved by a pose."""
    return places @ pose[:3, :3].T + pose[:3, 3]


def move(
    pose: NDArray[np.float64], direction: NDArray[np.float64], by: float
) -> NDArray[np.float64]:
    """The pose moved along a direction, metres."""
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
    """What two bodies have in common, exactly, as a ``manifold3d.Manifold`` in b's frame."""
    return _as_solid(a).transform(b_from_a[:3]) ^ _as_solid(b)


def measure_reach(
    a: str, b: str, b_from_a: NDArray[np.float64], places: int
) -> tuple[float, float]:
    """How deep a's surface certainly reaches into b, and b's into a, metres; 0 where they are apart.

    Args:
        a: A key of ``BODIES``.
        b: Likewise.
        b_from_a: Their pose.
        places: How many of the surface of what they have in common are looked at, at most.
    """
    common = overlap(a, b, b_from_a)
    if common.is_empty():
        return 0.0, 0.0
    mesh = as_mesh(common)
    looked_at = np.concatenate([mesh.vertices, mesh.vertices[mesh.faces].mean(axis=1)])
    looked_at = looked_at[:: -(-len(looked_at) // places)]
    # On the surface of what they have in common and deep in one body: on the other one's surface.
    return (
        float(find_surface(b).measure_distances(looked_at).max()),
        float(find_surface(a).measure_distances(carry(invert(b_from_a), looked_at)).max()),
    )


def measure_gap(a: str, b: str, b_from_a: NDArray[np.float64], most: float) -> float:
    """How far two bodies are apart, metres, at most so much."""
    return float(_as_solid(a).transform(b_from_a[:3]).min_gap(_as_solid(b), most))
