"""The input and the output of every peer.

Lengths are in meters, times in seconds. World frame: z up, the ground's surface at z = 0. Body
frame: the origin is the center of mass.
"""

from __future__ import annotations

import importlib
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, Protocol

from voxshell.errors import MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray
    from voxshell.model.mass_properties import MassProperties
    from voxshell.model.meshes import Mesh

Other = Literal["plane", "box", "body"]
"""The other body: the plane z = 0, a box with its top at z = 0, or a second bunny."""

Status = Literal["measured", "missing", "failed", "timed out", "skipped"]
"""Status of a peer; all except the first have a reason."""


@dataclass(frozen=True, eq=False)
class Case:
    """A pair of bodies whose contacts are queried.

    Attributes:
        key: Short name.
        label: Label for people.
        other: The other body.
        depth: Depth of the body in the other in the first pose, meters, by set-up.
        poses: (k, 4, 4) ``world_from_body``; the result is that of the first, all are timed.
        other_pose: (4, 4) ``world_from_other``.
    """

    key: str
    label: str
    other: Other
    depth: float
    poses: NDArray[np.float64]
    other_pose: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Job:
    """The work of a peer.

    Attributes:
        mesh: The body, closed, in its body frame.
        mass_properties: Mass properties of the body.
        box_half_extents: Half extents of the box, meters.
        cases: Pairs to query.
        case_seconds: Time to repeat a case's poses; each pose is queried at least once.
        drop_pose: (4, 4) initial ``world_from_body`` of drops.
        rates: Steps per second of the drops, each onto the plane and onto the box.
        drop_seconds: Duration of a drop.
        parts: Points of the convex parts that represent the body, for peers that need them.
    """

    mesh: Mesh
    mass_properties: MassProperties
    box_half_extents: tuple[float, float, float]
    cases: tuple[Case, ...]
    case_seconds: float
    drop_pose: NDArray[np.float64]
    rates: tuple[float, ...]
    drop_seconds: float
    parts: tuple[NDArray[np.float64], ...] = ()


class Query(Protocol):
    """A pair that is ready for queries."""

    def ask(self, pose: NDArray[np.float64]) -> float:
        """Find the contacts with the body at a pose; return the seconds that this took."""
        ...

    def answer(self) -> tuple[int, float | None]:
        """Return the number of contacts of the last query, and the largest reported depth, meters.

        None: this peer reports no depths.
        """
        ...


class Fall(Protocol):
    """A drop that is ready to run."""

    def step(self) -> NDArray[np.float64]:
        """Advance by a time step; return ``world_from_body``, (4, 4); not finite if it diverged."""
        ...


class Contender(Protocol):
    """A peer that has prepared the body."""

    version: str
    settings: dict[str, object]
    timed: str

    def meet(self, case: Case) -> Query | None:
        """Return the pair of a case; None if this peer cannot measure it."""
        ...

    def drop(self, other: Other, rate: float) -> Fall | None:
        """Return the body above the plane or box, with steps of 1 / rate; None without dynamics."""
        ...


@dataclass(frozen=True)
class CaseResult:
    """The results of a peer in a case.

    Attributes:
        case: Key of the case.
        median, p99: Seconds per query.
        least: Median over the poses of the fastest of a pose's queries, seconds: this removes the
            effect of other load.
        queries: Number of timed queries.
        contacts: Number of contacts in the first pose.
        depth: The largest reported depth there, meters; None if the peer reports none.
        problem: Why there are no figures; empty if there are.
    """

    case: str
    median: float = float("nan")
    p99: float = float("nan")
    least: float = float("nan")
    queries: int = 0
    contacts: int = 0
    depth: float | None = None
    problem: str = ""


@dataclass(frozen=True)
class DropResult:
    """The outcome of a drop.

    Attributes:
        other: The ground.
        rate: Steps per second.
        outcome: "rests", "moves", "sinks", "through", "off" or "unstable"; see
            :func:`voxshell_studies.peers.measure.judge_drop`. Empty where there was a problem.
        deepest: Largest depth of the mesh's lowest vertex below the surface, meters.
        rest_height: Height of the mesh's lowest vertex at the end, meters.
        speed, spin: Largest in the last second, m/s and rad/s.
        problem: Why there is no outcome; empty if there is one.
    """

    other: Other
    rate: float
    outcome: str = ""
    deepest: float = float("nan")
    rest_height: float = float("nan")
    speed: float = float("nan")
    spin: float = float("nan")
    problem: str = ""


@dataclass
class PeerResult:
    """A row of the table.

    Attributes:
        key: Key of the peer.
        label: Label for people.
        status: Its status.
        reason: Why it was not, or not completely, measured.
        version: Version of its library.
        settings: Its settings.
        timed: What its times include.
        preparation: Seconds from the mesh to the collision shape, without the decomposition.
        load: The system's load average at the start; above the number of cores, other work
            competed.
        cases: In the order of the job.
        drops: Likewise.
    """

    key: str
    label: str
    status: Status
    reason: str = ""
    version: str = ""
    settings: dict[str, object] = field(default_factory=dict)
    timed: str = ""
    preparation: float = float("nan")
    load: float = float("nan")
    cases: list[CaseResult] = field(default_factory=list)
    drops: list[DropResult] = field(default_factory=list)


def load_library(module: str, package: str) -> Any:
    """Import the library of a peer.

    Raises:
        MissingExtraError: It is not installed, or cannot be loaded.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise MissingExtraError(
            f"pip install {package}, or all: voxshell-studies[peers] ({error})"
        ) from error


def seconds_of(call: Callable[[], object]) -> float:
    """Return the duration of a call."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start
