"""Which voxel size and point spacing suit a mesh: measured on coarse models, and extrapolated.

Points and the times of builds and contact queries are taken to grow as a + b n^2 with the resolution n:
the surface's share grows so, and the rest does not grow. The field's memory and the measured errors
are taken to follow powers of n, as flat and curved surfaces differ in them. A yes or no costs what it
costs on the finest model that was measured.
"""

from __future__ import annotations

import math
import time
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell.cli.model_facts import field_bound, shell_bound
from voxshell.errors import MemoryLimitError
from voxshell.measuring.poses import find_poses_between
from voxshell.model.accuracy import AccuracyWarning
from voxshell.model.meshes import MeshWarning
from voxshell.model.model import Model
from voxshell.query.queries import collide, contacts

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from voxshell.model.meshes import Mesh

MEASURED = (25, 50, 100)
"""Resolutions that models are built at; the finer ones only while time is left."""

ESTIMATED = (50, 100, 200, 400)
"""Resolutions that are told about."""

PATIENCE = 10.0
"""Seconds of building after which no finer model is measured."""

MOST_BUILD_SECONDS, MOST_BYTES, MOST_QUERY_SECONDS = 30.0, 100e6, 200e-6
"""What a model may cost that is recommended; a query at 1 kHz leaves four fifths of the time."""

DEPTH = 0.002
"""How deep the bodies of a timed query are in one another, as part of the mesh's diagonal."""

_POSES, _SEED = 24, 1
_BRIEF_BUILD = 0.5
"""Seconds; what takes less is built twice, and the faster counts."""


@dataclass(frozen=True)
class Estimate:
    """A voxel size, which is the point spacing as well.

    Attributes:
        resolution: Voxels along the mesh's longest side.
        size: Of voxels and spacing, metres.
        measured: Whether it was built, or extrapolated.
        field_bytes: Memory of the field.
        points: Of the shell.
        error: What building it measures: the field is off by this much on the surface, metres; 99 %
            of the places have less.
        coverage: The same of how far the surface stands out above what the shell sees.
        field_bound: What is proved of the field's error everywhere near the surface, metres.
        shell_bound: What is proved of the way from the surface to the shell, metres.
        build_seconds: To build field and shell, on this machine.
        contacts_seconds: Median time of all contacts of two such bodies that touch.
        collide_seconds: The same of a yes or no.
    """

    resolution: int
    size: float
    measured: bool
    field_bytes: float
    points: float
    error: float
    coverage: float
    field_bound: float
    shell_bound: float
    build_seconds: float
    contacts_seconds: float
    collide_seconds: float


def estimate(
    mesh: Mesh,
    progress: Callable[[str, float], object],
    resolutions: tuple[int, ...] = ESTIMATED,
    measured: tuple[int, ...] = MEASURED,
) -> list[Estimate]:
    """What models of a mesh would be like, by ascending resolution.

    Raises:
        MeshError: The mesh cannot be made a model.
    """
    known = measure(mesh, progress, measured)
    return [
        next((e for e in known if e.resolution == n), None) or _extend(known, n)
        for n in resolutions
    ]


def measure(
    mesh: Mesh, progress: Callable[[str, float], object], resolutions: tuple[int, ...]
) -> list[Estimate]:
    """Builds models, at least two, and measures them."""
    models: list[Model] = []
    seconds: list[float] = []
    for index, resolution in enumerate(resolutions):
        progress(f"build at resolution {resolution}", index / (len(resolutions) + 1))
        if len(models) >= 2 and sum(seconds) > PATIENCE:
            break
        try:
            model, spent = _build(mesh, resolution)
        except MemoryLimitError:
            if len(models) < 2:
                raise
            break
        models.append(model)
        seconds.append(spent)
    progress("time queries", len(resolutions) / (len(resolutions) + 1))
    finest = models[-1]
    depth = DEPTH * float(np.linalg.norm(np.ptp(finest.bounds, axis=0)))
    poses = find_poses_between(finest, _POSES, depth, depth, _SEED)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AccuracyWarning)  # what a size can miss is in the table
        return _estimate_models(models, seconds, resolutions, poses)


def _estimate_models(
    models: list[Model],
    seconds: list[float],
    resolutions: tuple[int, ...],
    poses: NDArray[np.float64],
) -> list[Estimate]:
    """Their figures, with the times of queries that take two bodies of one model."""
    return [
        Estimate(
            resolution=resolution,
            size=model.field.voxel_size,
            measured=True,
            field_bytes=model.field.nbytes,
            points=len(model.shell),
            error=model.accuracy.distance.p99,
            coverage=model.accuracy.coverage.p99,
            field_bound=field_bound(model),
            shell_bound=shell_bound(model),
            build_seconds=spent,
            contacts_seconds=_time(lambda pose, m=model: contacts(m, m, None, pose), poses),
            collide_seconds=_time(lambda pose, m=model: collide(m, m, None, pose), poses),
        )
        for resolution, model, spent in zip(resolutions, models, seconds, strict=False)
    ]


def recommend(estimates: list[Estimate]) -> Estimate:
    """The finest that costs no more than is allowed; the coarsest where none does."""
    affordable = [
        each
        for each in estimates
        if each.build_seconds <= MOST_BUILD_SECONDS
        and each.field_bytes <= MOST_BYTES
        and each.contacts_seconds <= MOST_QUERY_SECONDS
    ]
    return max(affordable, key=lambda each: each.resolution, default=estimates[0])


def _build(mesh: Mesh, resolution: int) -> tuple[Model, float]:
    """A model, and how long it took."""
    seconds = math.inf
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshWarning)  # the mesh's own model has told of it
        for _ in range(2):
            start = time.perf_counter()
            model = Model.from_mesh(mesh, resolution=resolution, cache=False)
            seconds = min(seconds, time.perf_counter() - start)
            if seconds > _BRIEF_BUILD:
                break
    return model, seconds  # pyright: ignore[reportPossiblyUnboundVariable]


def _extend(known: list[Estimate], resolution: int) -> Estimate:
    """From the two finest that were measured."""
    coarse, fine = known[-2:]

    def grow(name: str) -> float:
        low, high = getattr(coarse, name), getattr(fine, name)
        slope = max(high - low, 0.0) / (fine.resolution**2 - coarse.resolution**2)
        return high + slope * (resolution**2 - fine.resolution**2)

    def follow(name: str, least: float, most: float) -> float:
        low, high = getattr(coarse, name), getattr(fine, name)
        power = least
        if low > 0.0 and high > 0.0:
            power = math.log(high / low) / math.log(fine.resolution / coarse.resolution)
        return high * (resolution / fine.resolution) ** min(max(power, least), most)

    return Estimate(
        resolution=resolution,
        size=fine.size * fine.resolution / resolution,
        measured=False,
        field_bytes=follow("field_bytes", 1.0, 2.5),
        points=grow("points"),
        error=follow("error", -2.0, -0.5),
        coverage=follow("coverage", -2.0, -0.5),
        field_bound=follow("field_bound", -1.0, -1.0),
        shell_bound=follow("shell_bound", -1.0, -1.0),
        build_seconds=grow("build_seconds"),
        contacts_seconds=grow("contacts_seconds"),
        collide_seconds=fine.collide_seconds,
    )


def _time(ask: Callable[[NDArray[np.float64]], object], poses: NDArray[np.float64]) -> float:
    """Median over the poses of the least of three, seconds."""
    seconds = np.empty((3, len(poses)))
    for row in seconds:
        for index, pose in enumerate(poses):
            start = time.perf_counter_ns()
            ask(pose)
            row[index] = (time.perf_counter_ns() - start) * 1e-9
    return float(np.median(seconds.min(axis=0)))
