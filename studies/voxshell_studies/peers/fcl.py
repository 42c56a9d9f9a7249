"""fcl: triangles in trees of oriented boxes, by its Python package python-fcl."""

from __future__ import annotations

from importlib import metadata
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell_studies.peers.protocol import load_library, seconds_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell_studies.peers.protocol import Case, Job, Other

MOST_CONTACTS = 1_000_000
"""Largest number of contacts: all."""


def set_up(job: Job, variant: str) -> Fcl:
    """Return a contender that calls ``fcl.collide`` for all contacts; ``variant`` is not used."""
    return Fcl(job)


class Fcl:
    """The mesh in a BVHModel."""

    timed = "fcl.collide called from Python, all contacts"

    def __init__(self, job: Job) -> None:
        self._fcl = fcl = load_library("fcl", "python-fcl")
        self.version = f"python-fcl {metadata.version('python-fcl')}"
        self.settings: dict[str, object] = {"tree": "OBBRSS", "contacts": "all"}
        self._job = job
        self._body = fcl.BVHModel()
        self._body.beginModel(len(job.mesh.vertices), len(job.mesh.faces))
        self._body.addSubModel(job.mesh.vertices, job.mesh.faces)
        self._body.endModel()

    def meet(self, case: Case) -> _Query:
        """Return the pair of a case."""
        match case.other:
            case "plane":
                other = self._fcl.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
            case "box":
                other = self._fcl.Box(*(2.0 * half for half in self._job.box_half_extents))
            case "body":
                other = self._body
        return _Query(self._fcl, self._body, other, case.other_pose)

    def drop(self, other: Other, rate: float) -> None:
        """Return None: fcl has no dynamics."""


class _Query:
    def __init__(self, fcl: Any, body: Any, other: Any, other_pose: NDArray[np.float64]) -> None:
        self._fcl = fcl
        self._body = fcl.CollisionObject(body, fcl.Transform())
        self._other = fcl.CollisionObject(
            other, fcl.Transform(other_pose[:3, :3], other_pose[:3, 3])
        )
        self._result: Any = None

    def ask(self, pose: NDArray[np.float64]) -> float:
        fcl = self._fcl
        self._body.setTransform(fcl.Transform(pose[:3, :3], pose[:3, 3]))
        request = fcl.CollisionRequest(num_max_contacts=MOST_CONTACTS, enable_contact=True)
        self._result = fcl.CollisionResult()
        return seconds_of(lambda: fcl.collide(self._body, self._other, request, self._result))

    def answer(self) -> tuple[int, float | None]:
        depths = [contact.penetration_depth for contact in self._result.contacts]
        return len(depths), max(0.0, max(depths, default=0.0))
