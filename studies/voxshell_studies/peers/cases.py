"""The bunny, the poses that all peers are asked about, and the drop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from voxshell.base.arguments import as_positive, as_real
from voxshell.errors import SettingsError
from voxshell.model.mass_properties import MassProperties
from voxshell.model.meshes import Mesh, read_mesh

from voxshell_studies.peers.protocol import Case, Job
from voxshell_studies.scenes.bunny import find_bunny

if TYPE_CHECKING:
    from numpy.typing import NDArray

LENGTH = 0.3
"""Of the bunny's longest side, meters."""

MASS = 1.0
"""Kilograms."""

BOX_HALF_EXTENTS = (0.3, 0.3, 0.025)
"""Of the box, meters: a slab 5 cm thick."""

GROUND_DEPTH = 0.001
"""Of the lowest vertex in the plane and in the box, meters."""

PAIR_OFFSETS = ((0.0015, 0.265626), (0.0736, 0.149471))
"""Depth of the deepest vertex or face center of either bunny in the other, as libigl has it, and
distance along x at which two bunnies with the same axes have it; both meters."""

POSES = 32
"""A case has so many, around the first."""

SHIFT, TURN = 1e-4, 5e-4
"""Largest move of the body away from the first pose, meters along each axis and radians about it:
what a body does from one step of a haptic loop to the next."""

DROP_HEIGHT = 0.5
"""Of the lowest vertex over the ground, meters."""

UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""The bunny's y axis points up."""

_SEED = 53


@dataclass(frozen=True)
class PeersSettings:
    """How much is measured.

    Attributes:
        case_seconds: How long a case is repeated for each peer.
        rates: Of the drops, steps a second.
        drop_seconds: How long a drop is followed.
        time_limit: Of a peer, seconds; what it has measured by then counts.
        parts_time_limit: Of the convex decomposition, seconds.

    Raises:
        SettingsError: A number is out of range.
    """

    case_seconds: float = 2.0
    rates: tuple[float, ...] = (200.0, 100.0, 60.0, 30.0, 20.0, 10.0, 5.0)
    drop_seconds: float = 4.0
    time_limit: float = 600.0
    parts_time_limit: float = 1800.0

    def __post_init__(self) -> None:
        if as_real(self.case_seconds, "case_seconds") < 0.0:
            raise SettingsError(f"case_seconds must be at least 0, not {self.case_seconds:g}")
        for rate in self.rates:
            as_positive(rate, "rates")
        for name in ("drop_seconds", "time_limit", "parts_time_limit"):
            as_positive(getattr(self, name), name)


QUICK = PeersSettings(
    case_seconds=0.3, rates=(200.0, 60.0, 20.0), drop_seconds=2.5, time_limit=120.0
)
"""Settings of a look at it."""


def make_job(settings: PeersSettings) -> Job:
    """Return the bunny at all poses.

    Raises:
        MeshError: The bunny is not installed.
    """
    mesh, mass_properties = load_body()
    drop_pose = stand(mesh, -DROP_HEIGHT)
    return Job(
        mesh=mesh,
        mass_properties=mass_properties,
        box_half_extents=BOX_HALF_EXTENTS,
        cases=make_cases(mesh),
        case_seconds=settings.case_seconds,
        drop_pose=drop_pose,
        rates=settings.rates,
        drop_seconds=settings.drop_seconds,
    )


def load_body() -> tuple[Mesh, MassProperties]:
    """Return the bunny, scaled, its center of mass at the origin, and its mass properties as a solid."""
    import trimesh

    mesh = read_mesh(find_bunny())
    longest = np.ptp(mesh.vertices, axis=0).max()
    solid = trimesh.Trimesh(mesh.vertices * (LENGTH / longest), mesh.faces, process=False)
    solid.apply_translation(-solid.center_mass)
    solid.density = MASS / solid.volume
    return (
        Mesh(np.ascontiguousarray(solid.vertices), mesh.faces),
        MassProperties(MASS, np.zeros(3), np.array(solid.moment_inertia)),
    )


def make_cases(mesh: Mesh) -> tuple[Case, ...]:
    """Bunny on plane, on box, and on bunny, shallow and deep."""
    standing = stand(mesh, GROUND_DEPTH)
    below = np.eye(4)
    below[2, 3] = -BOX_HALF_EXTENTS[2]
    millimetres = f"{GROUND_DEPTH * 1e3:.1f}"
    cases = [
        Case("plane", f"plane {millimetres}", "plane", GROUND_DEPTH, vary(standing), np.eye(4)),
        Case("box", f"box {millimetres}", "box", GROUND_DEPTH, vary(standing), below),
    ]
    for depth, offset in PAIR_OFFSETS:
        pose = np.eye(4)
        pose[0, 3] = offset
        millimetres = f"{depth * 1e3:.1f}"
        cases.append(
            Case(
                f"pair-{millimetres}",
                f"pair {millimetres}",
                "body",
                depth,
                vary(pose),
                np.eye(4),
            )
        )
    return tuple(cases)


def stand(mesh: Mesh, depth: float) -> NDArray[np.float64]:
    """``world_from_body`` of the upright body whose lowest vertex is ``depth`` below z = 0."""
    pose = np.eye(4)
    pose[:3, :3] = UPRIGHT
    pose[2, 3] = -depth - (mesh.vertices @ UPRIGHT[2]).min()
    return pose


def vary(pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """(POSES, 4, 4): the pose, then poses near it, the same on every run."""
    from trimesh.transformations import euler_matrix

    rng = np.random.default_rng(_SEED)
    poses = np.tile(pose, (POSES, 1, 1))
    for near in poses[1:]:
        near[:3, :3] = euler_matrix(*rng.uniform(-TURN, TURN, 3))[:3, :3] @ near[:3, :3]
        near[:3, 3] += rng.uniform(-SHIFT, SHIFT, 3)
    return poses
