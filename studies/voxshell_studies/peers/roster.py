"""The list of peers."""

from __future__ import annotations

import importlib
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from voxshell_studies.peers.measure import measure

if TYPE_CHECKING:
    from collections.abc import Iterator

    from voxshell_studies.peers.protocol import CaseResult, Contender, DropResult, Job


@dataclass(frozen=True)
class Peer:
    """A row of the table.

    Attributes:
        key: Short name.
        label: Label for people.
        module: The module of its ``set_up``.
        variant: The argument of ``set_up``.
        needs_parts: True if it collides convex parts.
    """

    key: str
    label: str
    module: str
    variant: str = ""
    needs_parts: bool = False


_HERE = "voxshell_studies.peers"

REFERENCE = "voxshell"
"""Key of the row to which ratios refer."""

# "voxels", "analytic": the kind of the ground.
PEERS = (
    Peer(REFERENCE, "voxshell, voxels", f"{_HERE}.ours", "voxels"),
    Peer("voxshell-analytic", "voxshell, analytic", f"{_HERE}.ours", "analytic"),
    Peer("voxshell-bullet", "voxshell in Bullet, voxels", f"{_HERE}.bullet", "voxels"),
    Peer("voxshell-bullet-analytic", "voxshell in Bullet, analytic", f"{_HERE}.bullet", "analytic"),
    Peer("bullet-gimpact", "Bullet GImpact", f"{_HERE}.bullet", "gimpact"),
    Peer("bullet-hull", "Bullet convex hull", f"{_HERE}.bullet", "hull"),
    Peer("bullet-parts", "Bullet + CoACD", f"{_HERE}.bullet", "parts", needs_parts=True),
    Peer("mujoco-hull", "MuJoCo hull", f"{_HERE}.mujoco", "hull"),
    Peer("mujoco-parts", "MuJoCo + CoACD", f"{_HERE}.mujoco", "parts", needs_parts=True),
    Peer("mujoco-sdf", "MuJoCo SDF", f"{_HERE}.mujoco", "sdf"),
    Peer("ode", "ODE trimesh", f"{_HERE}.ode"),
    Peer("coal", "coal", f"{_HERE}.coal"),
    Peer("fcl", "fcl", f"{_HERE}.fcl"),
    Peer("drake", "Drake hydroelastic", f"{_HERE}.drake"),
)


@dataclass(frozen=True)
class Prepared:
    """The report of a peer when it is ready.

    Attributes:
        version: Version of its library.
        settings: Its settings.
        timed: What its times include.
        seconds: Time from the mesh until it was ready, including the import of its library.
    """

    version: str
    settings: dict[str, object]
    timed: str
    seconds: float


def work(peer: Peer, job: Job) -> Iterator[Prepared | CaseResult | DropResult]:
    """Set up a peer and measure it."""
    module = importlib.import_module(peer.module)
    start = time.perf_counter()
    contender: Contender = module.set_up(job, peer.variant)
    seconds = time.perf_counter() - start
    yield Prepared(contender.version, contender.settings, contender.timed, seconds)
    yield from measure(contender, job)
