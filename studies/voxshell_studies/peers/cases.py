"""The bunny, the poses for all peers, and the drop."""

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
"""Longest side of the bunny, meters."""

MASS = 1.0
"""Kilograms."""

BOX_HALF_EXTENTS = (0.3, 0.3, 0.025)
"""Half extents of the box, meters: a slab of 5 cm."""

GROUND_DEPTH = 0.001
"""Depth of the lowest vertex in the plane and in the box, meters."""

PAIR_OFFSETS = ((0.0015, 0.265626), (0.0736, 0.149471))
"""Depth of the deepest vertex or face center of either bunny in the other by libigl, and the
distance along x at which two bunnies with parallel axes have it; both meters."""

POSES = 32
"""Number of poses of a case, around the first one."""

SHIFT, TURN = 1e-4, 5e-4
"""Largest displacement from the first pose, meters along each axis and radians about it: the
typical motion in a step of a haptic loop."""

DROP_HEIGHT = 0.5
"""Initial height of the lowest vertex above the ground, meters."""

UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""The bunny's y axis points up."""

_SEED = 53


@dataclass(frozen=True)
class PeersSettings:
    """Extent of the measurement.

    Attributes:
        case_seconds: Time for which a case is repeated for each peer.
        rates: Steps per second of the drops.
        drop_seconds: Duration of a drop.
        time_limit: Time limit of a peer, seconds; results up to then count.
        parts_time_limit: Time limit of the convex decomposition, seconds.

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
"""Settings of a quick run."""


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
    """Return the scaled bunny with its center of mass at the origin, and its mass properties."""
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
    """Return the cases: bunny on plane, on box, and on bunny, shallow and deep."""
    standing = stand(mesh, GROUND_DEPTH)
    below = np.eye(4)
    below[2, 3] = -BOX_HALF_EXTENTS[2]
    millimeters = f"{GROUND_DEPTH * 1e3:.1f}"
    cases = [
        Case("plane", f"plane {millimeters}", "plane", GROUND_DEPTH, vary(standing), np.eye(4)),
        Case("box", f"box {millimeters}", "box", GROUND_DEPTH, vary(standing), below),
    ]
    for depth, offset in PAIR_OFFSETS:
        pose = np.eye(4)
        pose[0, 3] = offset
        millimeters = f"{depth * 1e3:.1f}"
        cases.append(
            Case(
                f"pair-{millimeters}",
                f"pair {millimeters}",
                "body",
                depth,
                vary(pose),
                np.eye(4),
            )
        )
    return tuple(cases)


def stand(mesh: Mesh, depth: float) -> NDArray[np.float64]:
    """Return ``world_from_body`` of the upright body, its lowest vertex ``depth`` below z = 0."""
    pose = np.eye(4)
    pose[:3, :3] = UPRIGHT
    pose[2, 3] = -depth - (mesh.vertices @ UPRIGHT[2]).min()
    return pose


def vary(pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (POSES, 4, 4): the pose, then poses near it, the same in every run."""
    from trimesh.transformations import euler_matrix

    rng = np.random.default_rng(_SEED)
    poses = np.tile(pose, (POSES, 1, 1))
    for near in poses[1:]:
        near[:3, :3] = euler_matrix(*rng.uniform(-TURN, TURN, 3))[:3, :3] @ near[:3, :3]
        near[:3, 3] += rng.uniform(-SHIFT, SHIFT, 3)
    return poses
