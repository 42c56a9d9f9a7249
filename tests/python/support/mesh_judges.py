"""What coal and manifold3d say about two closed meshes in a pose: the judges of real geometry."""

from __future__ import annotations

import coal
import manifold3d as m3
import numpy as np
from solids import as_arrays

MOST_PLACES = 400  # of a surface that are looked at


class MeshPair:
    """Two solids; b stays at the origin, and a is put at ``b_from_a``."""

    def __init__(self, a: m3.Manifold, b: m3.Manifold) -> None:
        self._solids = a, b
        self._surfaces = make_surface(*as_arrays(a)), make_surface(*as_arrays(b))

    def surfaces_within(self, b_from_a: np.ndarray, distance: float) -> bool:
        """Whether the surfaces cross or come this near; not where one solid is deep in the other."""
        return _collide(*self._surfaces, b_from_a, distance)

    def overlap(self, b_from_a: np.ndarray) -> m3.Manifold:
        """What both solids have in common, in b's frame."""
        a, b = self._solids
        return a.transform(b_from_a[:3]) ^ b

    def reaches_deeper(self, b_from_a: np.ndarray, depth: float) -> tuple[bool, bool]:
        """Whether a's surface reaches deeper than this into b, and b's into a.

        Told by places on the surface of what they have in common: its corners, and the middles of
        its triangles. True is proven by a ball about such a place that does not reach the other's
        surface; False says only that none of them is so deep.
        """
        common = self.overlap(b_from_a)
        if common.is_empty():
            return False, False
        corners, triangles = as_arrays(common)
        places = np.concatenate([corners[triangles].mean(axis=1), corners])
        places = places[:: max(1, len(places) // MOST_PLACES)]
        a_from_b = np.linalg.inv(b_from_a)
        places_in_a = places @ a_from_b[:3, :3].T + a_from_b[:3, 3]
        # On the surface of what they have in common, and deep in b: so it is of a's surface.
        a, b = self._surfaces
        return (
            any(is_farther(place, b, depth) for place in places),
            any(is_farther(place, a, depth) for place in places_in_a),
        )


def make_surface(corners: np.ndarray, triangles: np.ndarray) -> coal.BVHModelOBBRSS:
    """Triangles, closed or not, for coal."""
    surface = coal.BVHModelOBBRSS()
    surface.beginModel(len(triangles), len(corners))
    points, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    points.extend(corners)
    faces.extend([coal.Triangle(*(int(i) for i in triangle)) for triangle in triangles])
    surface.addSubModel(points, faces)
    surface.endModel()
    return surface


def is_farther(place: np.ndarray, surface: coal.BVHModelOBBRSS, distance: float) -> bool:
    """Whether a ball of that radius about the place does not reach the surface."""
    pose = np.eye(4)
    pose[:3, 3] = place
    return not _collide(coal.Sphere(distance), surface, pose, 0.0)


def _collide(a, b, b_from_a: np.ndarray, margin: float) -> bool:
    request = coal.CollisionRequest()
    request.num_max_contacts = 1
    request.enable_contact = False
    request.security_margin = margin
    identity = coal.Transform3s.Identity()
    return coal.collide(a, _transform(b_from_a), b, identity, request, coal.CollisionResult()) > 0


def _transform(pose: np.ndarray) -> coal.Transform3s:
    return coal.Transform3s(pose[:3, :3], pose[:3, 3])
