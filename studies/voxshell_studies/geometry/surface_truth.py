"""Reference for a mesh's surface: the faces nearest to a place, and the normals that they permit.

Nothing here uses a distance field, a shell, or any part of the core.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray
    from voxshell.model.meshes import Mesh

TIE = 1e-5
"""Excess distance at which a face still counts as nearest, meters."""

TIE_FRACTION = 0.01
"""Likewise, as a fraction of the distance."""

_PAIRS_AT_ONCE = 500_000
"""Pairs of a place and a face that are compared at once: 12 MB."""

_SAME_PLACE = 1e-7
"""Distance within which closest places on neighboring faces are the same corner or edge, meters."""


class Surface:
    """The faces of a closed mesh, prepared for queries near them."""

    def __init__(self, mesh: Mesh) -> None:
        corners = mesh.vertices[mesh.faces]
        crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        twice_area = np.linalg.norm(crossed, axis=1)
        sound = twice_area > 1e-16
        self._corners = corners[sound]
        self.normals: NDArray[np.float64] = crossed[sound] / twice_area[sound, None]
        self._low, self._high = self._corners.min(axis=1), self._corners.max(axis=1)

    def measure_distances(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return distances from places, (n, 3), to the nearest faces, (n,), meters; never negative.

        Example:
            >>> from voxshell_studies.scenes.geometry_bodies import make_body
            >>> Surface(make_body("cube 50 mm")).measure_distances(np.zeros((1, 3)))
            array([0.025])
        """
        return np.array([distances.min() for _, distances, _ in self._find_near(places, 0.0)])

    def find_nearest(
        self, places: NDArray[np.float64]
    ) -> list[tuple[float, list[NDArray[np.float64]]]]:
        """Return the distances of places, (n, 3), to the nearest faces, and their normals.

        Faces that meet in the closest corner or edge are nearest together: their unit normals form
        one array, (k, 3). In the middle of a wall, several places are nearest.
        """
        return [self._group(*near) for near in self._find_near(places, TIE)]

    def _group(
        self,
        faces: NDArray[np.intp],
        distances: NDArray[np.float64],
        places: NDArray[np.float64],
    ) -> tuple[float, list[NDArray[np.float64]]]:
        least = float(distances.min())
        near = distances <= least + TIE + TIE_FRACTION * least
        groups: list[tuple[NDArray[np.float64], list[int]]] = []
        for face, closest in zip(faces[near], places[near], strict=True):
            for where, members in groups:
                if np.abs(where - closest).max() <= _SAME_PLACE:
                    members.append(int(face))
                    break
            else:
                groups.append((closest, [int(face)]))
        return least, [self.normals[members] for _, members in groups]

    def find_entry(
        self, place: NDArray[np.float64], backward: NDArray[np.float64]
    ) -> NDArray[np.float64] | None:
        """Return the normal of the face through which a place inside was entered, (3,).

        Args:
            place: A place inside, (3,).
            backward: Direction from which it came, (3,).
        """
        a, b, c = (self._corners[:, i] for i in range(3))
        one, two = b - a, c - a
        crossed = np.cross(backward, two)
        volume = np.einsum("ij,ij->i", one, crossed)
        with np.errstate(divide="ignore", invalid="ignore"):
            offset = place - a
            u = np.einsum("ij,ij->i", offset, crossed) / volume
            turned = np.cross(offset, one)
            v = turned @ backward / volume
            away = np.einsum("ij,ij->i", two, turned) / volume
            hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1.0 + 1e-9) & (away > -1e-9)
        hit &= self.normals @ backward > 0.0
        if not hit.any():
            return None
        return self.normals[np.flatnonzero(hit)[np.argmin(away[hit])]]

    def _find_near(
        self, places: NDArray[np.float64], slack: float
    ) -> Iterator[tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]]:
        """Return faces within ``slack`` of the nearest, their distances and closest places."""
        at_once = max(1, _PAIRS_AT_ONCE // len(self.normals))
        for first in range(0, len(places), at_once):
            some = places[first : first + at_once]
            beyond = np.maximum(self._low - some[:, None], some[:, None] - self._high)
            np.maximum(beyond, 0.0, out=beyond)
            bound = np.einsum("ijk,ijk->ij", beyond, beyond)
            # The face whose box is nearest bounds the distance of the nearest face.
            closest = find_closest(some, self._corners[bound.argmin(axis=1)])
            reach = np.linalg.norm(closest - some, axis=1)
            reach += slack + TIE_FRACTION * reach + _SAME_PLACE
            which, faces = np.nonzero(bound <= reach[:, None] ** 2)
            closest = find_closest(some[which], self._corners[faces])
            distances = np.linalg.norm(closest - some[which], axis=1)
            ends = np.searchsorted(which, np.arange(1, len(some)))
            yield from zip(
                np.split(faces, ends),
                np.split(distances, ends),
                np.split(closest, ends),
                strict=True,
            )


def find_closest(places: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the closest place on each triangle, (n, 3, 3), to its paired place, (n, 3), as (n, 3).

    Example:
        >>> triangle = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
        >>> find_closest(np.array([[0.2, 0.3, 2.0]]), triangle).round(9)
        array([[0.2, 0.3, 0. ]])
    """
    a, b, c = (corners[:, i] for i in range(3))
    best = np.full(len(corners), np.inf)
    closest = np.empty_like(a)
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        length = np.einsum("ij,ij->i", along, along)
        with np.errstate(divide="ignore", invalid="ignore"):
            fraction = np.einsum("ij,ij->i", places - start, along) / length
        fraction = np.clip(np.nan_to_num(fraction), 0.0, 1.0)
        on_edge = start + fraction[:, None] * along
        distance = np.linalg.norm(on_edge - places, axis=1)
        nearer = distance < best
        best[nearer], closest[nearer] = distance[nearer], on_edge[nearer]
    normal = np.cross(b - a, c - a)
    square = np.einsum("ij,ij->i", normal, normal)
    height = np.einsum("ij,ij->i", places - a, normal) / square
    foot = places - height[:, None] * normal
    within = np.ones(len(corners), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        within &= np.einsum("ij,ij->i", np.cross(end - start, foot - start), normal) >= 0.0
    closest[within] = foot[within]
    return closest


def measure_angle(direction: NDArray[np.float64], normals: NDArray[np.float64]) -> float:
    """Return the angle of a unit direction to the cone of normals, (k, 3), radians; 0 inside.

    Example:
        >>> corner = np.eye(3)
        >>> float(np.degrees(measure_angle(np.array([0.6, 0.8, 0.0]), corner)).round(6))
        0.0
        >>> float(np.degrees(measure_angle(np.array([0.0, 0.0, 1.0]), corner[:2])).round(6))
        90.0
    """
    nearest = _project(direction, normals)
    length = float(np.linalg.norm(nearest))
    cosines = normals @ direction
    cosine = max(float(cosines.max()), nearest @ direction / length if length > 1e-9 else -1.0)
    return float(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _project(direction: NDArray[np.float64], rays: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the closest place to a direction in a cone of rays (Lawson and Hanson 1974)."""
    weights = np.zeros(len(rays))
    used = np.zeros(len(rays), dtype=bool)
    for _ in range(3 * len(rays)):
        gain = rays @ (direction - weights @ rays)
        gain[used] = -np.inf
        if used.all() or gain.max() <= 1e-12:
            break
        used[np.argmax(gain)] = True
        while used.any():
            trial = np.zeros(len(rays))
            trial[used] = np.linalg.lstsq(rays[used].T, direction, rcond=None)[0]
            if (trial[used] > 0.0).all():
                weights = trial
                break
            falling = used & (trial <= 0.0)
            with np.errstate(divide="ignore", invalid="ignore"):
                steps = weights[falling] / (weights[falling] - trial[falling])
            weights = weights + np.nan_to_num(steps).min() * (trial - weights)
            used &= weights > 1e-12
            weights[~used] = 0.0
    return weights @ rays
