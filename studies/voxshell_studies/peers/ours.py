"""voxshell itself: calls from Python that return all contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import voxshell
from voxshell import Box, Model, Plane, QueryScratch, contacts
from voxshell.simulation.body_shapes import mesh_of

from voxshell_studies.peers.protocol import seconds_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from voxshell.query.contact_set import Contacts

    from voxshell_studies.peers.protocol import Case, Job, Other

RESOLUTION = 300
"""Voxels along the body's longest side."""

POINTS = 34_835
"""Number of points of the shell: as many as the bunny's vertices."""


def set_up(job: Job, variant: str) -> Queries:
    """Return a contender that calls :func:`voxshell.contacts`.

    Args:
        job: The job.
        variant: "voxels": the ground is a model, a slab; "analytic": a plane or a box.
    """
    return Queries(job, variant)


class Queries:
    """Calls of ``contacts``."""

    timed = "a call from Python, all contacts"

    def __init__(self, job: Job, variant: str) -> None:
        self.version = voxshell.__version__
        self._body, self._grounds = make_shapes(job, variant)
        self._has_pairs = variant == "voxels"
        self.settings: dict[str, object] = describe_models(self._body, variant) | {
            "scratch": "kept from call to call"
        }

    def meet(self, case: Case) -> _Query | None:
        """Return the pair of a case."""
        if case.other == "body":
            return _Query(self._body, self._body, case) if self._has_pairs else None
        ground, ground_pose = self._grounds[case.other]
        return _Query(self._body, ground, case, ground_pose)

    def drop(self, other: Other, rate: float) -> None:
        """Return None: queries have no dynamics."""


class _Query:
    def __init__(
        self,
        body: Model,
        other: Model | Plane | Box,
        case: Case,
        other_pose: NDArray[np.float64] | None = None,
    ) -> None:
        self._body = body
        self._other = other
        self._other_pose = case.other_pose if other_pose is None else other_pose
        self._scratch = QueryScratch()
        self._found: Contacts | None = None

    def ask(self, pose: NDArray[np.float64]) -> float:
        def find() -> None:
            self._found = contacts(
                self._body,
                self._other,
                pose,
                self._other_pose,
                shell="fewest",
                scratch=self._scratch,
            )

        return seconds_of(find)

    def answer(self) -> tuple[int, float | None]:
        assert self._found is not None
        return len(self._found), float(self._found.depths.max(initial=0.0))


def make_shapes(
    job: Job, variant: str
) -> tuple[Model, dict[str, tuple[Model | Plane | Box, NDArray[np.float64]]]]:
    """Return the body's model, and the shapes for the plane and the box, each with its pose.

    Models are built without the cache, because preparation is timed.
    """
    import numpy as np

    body = Model.from_mesh(job.mesh, resolution=RESOLUTION, target_points=POINTS, cache=False)
    below = np.eye(4)
    below[2, 3] = -job.box_half_extents[2]
    box = Box(job.box_half_extents)
    if variant == "voxels":
        slab = Model.from_mesh(mesh_of(box), voxel_size=body.field.voxel_size, cache=False)
        return body, {"plane": (slab, below), "box": (slab, below)}
    return body, {"plane": (Plane(), np.eye(4)), "box": (box, below)}


def describe_models(body: Model, variant: str) -> dict[str, object]:
    """Return the settings of the models, for the table."""
    return {
        "voxel_size": body.field.voxel_size,
        "points": len(body.shell),
        "ground": "model of the box" if variant == "voxels" else "analytic",
    }
