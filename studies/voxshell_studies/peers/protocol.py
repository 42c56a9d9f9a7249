"""What every peer is given and what it must give back.

Lengths are meters, times seconds. World frame: z up, the ground's surface at z = 0. Body frame: the
origin is the center of mass.
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
"""What the body meets: the plane z = 0, a box whose top is in it, or a second body of its kind."""

Status = Literal["measured", "missing", "failed", "timed out", "skipped"]
"""How a peer came off; all but the first have a reason."""


@dataclass(frozen=True, eq=False)
class Case:
    """A pair of bodies whose contacts are asked for.

    Attributes:
        key: Short name.
        label: For people.
        other: What the body meets.
        depth: How deep the body is in the other in the first pose, meters, as it was set up.
        poses: (k, 4, 4) ``world_from_body``; the first is answered, all are timed.
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
    """What a peer has to do.

    Attributes:
        mesh: The body, closed, in its body frame.
        mass_properties: Of the body.
        box_half_extents: Of the box, meters.
        cases: Pairs to ask about.
        case_seconds: How long to repeat a case's poses; each pose is asked about once at least.
        drop_pose: (4, 4) ``world_from_body`` from which the body falls.
        rates: Steps a second of the drops, each onto the plane and onto the box.
        drop_seconds: How long a drop is followed.
        parts: Points of the convex parts that stand for the body, for peers that need them.
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
    """A pair, ready to be asked about."""

    def ask(self, pose: NDArray[np.float64]) -> float:
        """Find the contacts with the body at a pose; returns the seconds that this took."""
        ...

    def answer(self) -> tuple[int, float | None]:
        """Return how many contacts the last question gave, and the deepest depth reported, meters.

        None: this peer reports no depths.
        """
        ...


class Fall(Protocol):
    """A drop, ready to be followed."""

    def step(self) -> NDArray[np.float64]:
        """Advance by a time step; returns ``world_from_body``, (4, 4); not finite if it blew up."""
        ...


class Contender(Protocol):
    """A peer that has prepared the body."""

    version: str
    settings: dict[str, object]
    timed: str

    def meet(self, case: Case) -> Query | None:
        """Return the pair of a case; None where this peer has nothing to measure there."""
        ...

    def drop(self, other: Other, rate: float) -> Fall | None:
        """Return the body above the plane or box, in steps of 1 / rate; None: it does no dynamics."""
        ...


@dataclass(frozen=True)
class CaseResult:
    """What a peer did with a case.

    Attributes:
        case: Key of the case.
        median, p99: Seconds a query.
        least: Median over the poses of the least of a pose's queries, seconds: what is left when other
            work's turns are taken out.
        queries: How many were timed.
        contacts: In the first pose.
        depth: The deepest depth reported there, meters; None where the peer reports none.
        problem: Why there are no figures; empty where there are.
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
    """How a drop ended.

    Attributes:
        other: What the body fell on.
        rate: Steps a second.
        outcome: "rests", "moves", "sinks", "through", "off" or "unstable"; see
            :func:`voxshell_studies.peers.measure.judge_drop`. Empty where there was a problem.
        deepest: How far the mesh's lowest vertex was below the surface at worst, meters.
        rest_height: Height of the mesh's lowest vertex at the end, meters.
        speed, spin: Largest in the last second, m/s and rad/s.
        problem: Why there is no outcome; empty where there is one.
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
        key: Of the peer.
        label: For people.
        status: How it came off.
        reason: Why it was not, or not wholly, measured.
        version: Of its library.
        settings: Those that it was run with.
        timed: What its times are of.
        preparation: Seconds from the mesh to what collides, without the parts.
        load: The system's load average when it began; above the cores, other work took turns.
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
    """Return how long a call takes."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start
