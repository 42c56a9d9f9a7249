"""Advice on voxel size and point spacing: measured on coarse models, and extrapolated.

Points and the times of builds and contact queries are assumed to grow as a + b n^2 with the
resolution n, because the part due to the surface grows so, and the rest is constant. The field's
memory and the measured errors are assumed to follow powers of n, which differ between flat and
curved surfaces. The time of a collision query (yes or no) is that of the finest measured model.
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
from voxshell.measuring.touching_poses import find_poses_between
from voxshell.model.accuracy import AccuracyWarning
from voxshell.model.meshes import MeshWarning
from voxshell.model.model import Model
from voxshell.query.queries import collide, contacts

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from voxshell.model.meshes import Mesh

MEASURED = (25, 50, 100)
"""Resolutions of measured models; the finer ones only while there is time."""

ESTIMATED = (50, 100, 200, 400)
"""Resolutions in the advice."""

PATIENCE = 10.0
"""Seconds of building after which no finer model is measured."""

MOST_BUILD_SECONDS, MOST_BYTES, MOST_QUERY_SECONDS = 30.0, 100e6, 200e-6
"""Limits of a recommended model; at 1 kHz, a query leaves four fifths of the time."""

DEPTH = 0.002
"""Depth of the bodies' overlap in timed queries, as a fraction of the mesh's diagonal."""

_POSES, _SEED = 24, 1
_BRIEF_BUILD = 0.5
"""A build of less than these seconds is repeated, and the faster one counts."""


@dataclass(frozen=True)
class Estimate:
    """Properties of models with a voxel size, which is also the point spacing.

    Attributes:
        resolution: Voxels along the mesh's longest side.
        size: Size of voxels and spacing, meters.
        measured: True if the model was built, False if it is extrapolated.
        field_bytes: Memory of the field.
        points: Number of points of the shell.
        error: Error of the field on the surface, measured when the model is built, meters; 99 % of
            the places have less.
        coverage: Likewise, how far the surface rises above the shell.
        field_bound: Proven bound of the field's error near the surface, meters.
        shell_bound: Proven bound of the distance from the surface to the shell, meters.
        build_seconds: Time to build field and shell on this machine.
        contacts_seconds: Median time of all contacts of two such bodies that touch.
        collide_seconds: Median time of a collision query (yes or no).
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
    """Return the properties of models of a mesh, by ascending resolution.

    Raises:
        MeshError: No model can be built from the mesh.
    """
    known = measure(mesh, progress, measured)
    return [
        next((e for e in known if e.resolution == n), None) or _extend(known, n)
        for n in resolutions
    ]


def measure(
    mesh: Mesh, progress: Callable[[str, float], object], resolutions: tuple[int, ...]
) -> list[Estimate]:
    """Build at least two models and measure them."""
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
        warnings.simplefilter("ignore", AccuracyWarning)  # the table shows these errors
        return _estimate_models(models, seconds, resolutions, poses)


def _estimate_models(
    models: list[Model],
    seconds: list[float],
    resolutions: tuple[int, ...],
    poses: NDArray[np.float64],
) -> list[Estimate]:
    """Return the models' properties, with times of queries of two bodies of one model."""
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
    """Return the finest model within the limits; the coarsest if none is."""
    affordable = [
        each
        for each in estimates
        if each.build_seconds <= MOST_BUILD_SECONDS
        and each.field_bytes <= MOST_BYTES
        and each.contacts_seconds <= MOST_QUERY_SECONDS
    ]
    return max(affordable, key=lambda each: each.resolution, default=estimates[0])


def _build(mesh: Mesh, resolution: int) -> tuple[Model, float]:
    """Return a model and the time that it took to build."""
    seconds = math.inf
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshWarning)  # the mesh's own model has warned already
        for _ in range(2):
            start = time.perf_counter()
            model = Model.from_mesh(mesh, resolution=resolution, cache=False)
            seconds = min(seconds, time.perf_counter() - start)
            if seconds > _BRIEF_BUILD:
                break
    return model, seconds  # pyright: ignore[reportPossiblyUnboundVariable]


def _extend(known: list[Estimate], resolution: int) -> Estimate:
    """Extrapolate from the two finest measured models."""
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
    """Return the median over the poses of the shortest of three times, seconds."""
    seconds = np.empty((3, len(poses)))
    for row in seconds:
        for index, pose in enumerate(poses):
            start = time.perf_counter_ns()
            ask(pose)
            row[index] = (time.perf_counter_ns() - start) * 1e-9
    return float(np.median(seconds.min(axis=0)))
