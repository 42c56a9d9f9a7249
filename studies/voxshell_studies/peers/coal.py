"""coal: triangles in trees of oriented boxes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell_studies.peers.protocol import load_library, seconds_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell_studies.peers.protocol import Case, Job, Other

MOST_CONTACTS = 1_000_000
"""Largest number of contacts: all."""

BREAK_DISTANCE = 0.0
"""Distance up to which separated volumes are examined, meters. The default of 1 mm gives the same
contacts in three times the time."""


def set_up(job: Job, variant: str) -> Coal:
    """Return a contender that calls ``coal.collide`` for all contacts; ``variant`` is not used."""
    return Coal(job)


class Coal:
    """The mesh in a BVHModelOBBRSS."""

    timed = "coal.collide called from Python, all contacts"

    def __init__(self, job: Job) -> None:
        self._coal = coal = load_library("coal", "coal")
        self.version: str = coal.__version__
        self.settings: dict[str, object] = {
            "tree": "OBBRSS",
            "contacts": "all",
            "break_distance": BREAK_DISTANCE,
        }
        self._job = job
        vertices = coal.StdVec_Vec3s()
        vertices.extend(job.mesh.vertices)
        triangles = coal.StdVec_Triangle()
        triangles.extend([coal.Triangle(*face) for face in job.mesh.faces.tolist()])
        self._body = coal.BVHModelOBBRSS()
        self._body.beginModel(len(triangles), len(vertices))
        self._body.addSubModel(vertices, triangles)
        self._body.endModel()

    def meet(self, case: Case) -> _Query:
        """Return the pair of a case."""
        match case.other:
            case "plane":
                other = self._coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
            case "box":
                other = self._coal.Box(*(2.0 * half for half in self._job.box_half_extents))
            case "body":
                other = self._body
        return _Query(self._coal, self._body, other, case.other_pose)

    def drop(self, other: Other, rate: float) -> None:
        """Return None: coal has no dynamics."""


class _Query:
    def __init__(self, coal: Any, body: Any, other: Any, other_pose: NDArray[np.float64]) -> None:
        self._coal = coal
        self._body = body
        self._other = other
        self._other_pose = coal.Transform3s(other_pose[:3, :3], other_pose[:3, 3])
        self._request = coal.CollisionRequest()
        self._request.num_max_contacts = MOST_CONTACTS
        self._request.enable_contact = True
        self._request.break_distance = BREAK_DISTANCE
        self._result = coal.CollisionResult()

    def ask(self, pose: NDArray[np.float64]) -> float:
        at = self._coal.Transform3s(pose[:3, :3], pose[:3, 3])
        self._result.clear()
        return seconds_of(
            lambda: self._coal.collide(
                self._body, at, self._other, self._other_pose, self._request, self._result
            )
        )

    def answer(self) -> tuple[int, float | None]:
        count = self._result.numContacts()
        # Signed distances: negative where the bodies overlap.
        distances = [self._result.getContact(i).penetration_depth for i in range(count)]
        return count, max(0.0, -min(distances, default=0.0))
