"""Costs of default models: builds, memory, and queries, compared with a uniform model."""

from __future__ import annotations

import time
import warnings
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from voxshell.measuring.timing import pinned
from voxshell.model.model import Model
from voxshell.query.batch import contacts_batch

from voxshell_studies.geometry.models import move
from voxshell_studies.geometry.pairs import meet
from voxshell_studies.part import as_columns
from voxshell_studies.scenes.geometry import BUILT
from voxshell_studies.scenes.geometry_bodies import make_body

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell_studies.geometry.settings import GeometrySettings
    from voxshell_studies.part import Columns, Tables

COMPARED = "bunny 0.2 m"
"""The body whose models are compared."""

KINDS = ("uniform", "tolerance", "default")
"""The compared models: many voxels, equally accurate by tolerance, and default."""

ASKED = ("a", "both")
"""Choices of the shell to time."""

_DEPTH = 1e-3
"""Overlap of the bodies in timed queries, meters."""

_SHIFTS = np.linspace(-1e-4, 1e-4, 8)
"""Deviation of a batch's poses from that depth, as between consecutive steps, meters."""

_ROUNDS = 3
"""Repetitions of each batch and each build, in turn."""

_HALVINGS = 5
"""Range in which the tolerance is searched, as factors."""


class _Build(NamedTuple):
    model: Model
    seconds: float
    warned: bool


def _build(body: str, **settings: float) -> _Build:
    mesh = make_body(body)
    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("always")
        start = time.perf_counter()
        model = Model.from_mesh(mesh, cache=False, **settings)  # pyright: ignore[reportArgumentType]
        return _Build(model, time.perf_counter() - start, len(given) > 0)


def _count_bytes(model: Model) -> int:
    """Return the memory of field and shell, bytes."""
    shell = model.shell
    arrays = (shell.points, shell.normals, shell.areas, shell.edges)
    return model.field.nbytes + sum(array.nbytes for array in arrays)


def time_builds(settings: GeometrySettings) -> Tables:
    """Build bodies at default settings.

    Returns:
        "builds", a row a body of ``BUILT``: seconds, bytes of field and shell, points, voxel size,
        meters, and whether there were warnings.
    """
    rows = []
    for body in BUILT[: settings.builds]:
        model, seconds, warned = _build(body)
        size = model.field.voxel_size
        rows.append((seconds, _count_bytes(model), len(model.shell), size, float(warned)))
    return {"builds": as_columns(("seconds", "bytes", "points", "voxel_size", "warnings"), rows)}


def compare_costs(settings: GeometrySettings) -> Tables:
    """Compare a uniform model, an equally accurate one by tolerance, and a default one.

    Equally accurate is the model whose field's 99 % error is not larger.

    Returns:
        "builds", a row a kind and round: "kind" as in :data:`KINDS`, seconds, bytes of field and
        shell, points, edge segments, "tolerance" (0 if uniform), and the 99 % errors of field and
        shell, meters. "queries", a row a pose: seconds a ``contacts`` of a model with itself, a
        column a kind and shell.
    """
    uniform = _build(COMPARED, resolution=settings.compared_resolution).model
    tolerance = _find_tolerance(uniform.accuracy.distance.p99)
    options: tuple[dict[str, float], ...] = (
        {"resolution": settings.compared_resolution},
        {"tolerance": tolerance},
        {},
    )
    rows = []
    models: list[Model] = []
    for _ in range(_ROUNDS):
        models.clear()
        for kind, each in enumerate(options):
            model, seconds, _ = _build(COMPARED, **each)
            models.append(model)
            accuracy = model.accuracy
            rows.append(
                (
                    *(kind, seconds, _count_bytes(model), len(model.shell), len(model.shell.edges)),
                    *(model.tolerance or 0.0, accuracy.distance.p99, accuracy.coverage.p99),
                )
            )
    names = ("kind", "seconds", "bytes", "points", "segments", "tolerance", "field", "shell")
    return {"builds": as_columns(names, rows), "queries": _time_queries(settings, models)}


def _find_tolerance(error: float) -> float:
    """Return the largest tolerance found whose 99 % error of the field is not larger, meters."""
    low, high = 0.5 * error, 4.0 * error
    for _ in range(_HALVINGS):
        middle = float(np.sqrt(low * high))
        if _build(COMPARED, tolerance=middle).model.accuracy.distance.p99 <= error:
            low = middle
        else:
            high = middle
    return low


def _time_queries(settings: GeometrySettings, models: list[Model]) -> Columns:
    mesh = make_body(COMPARED)
    rng = np.random.default_rng(settings.seed)
    rows = []
    with pinned():
        while len(rows) < settings.compared_poses:
            meeting = meet(mesh, mesh, rng)
            if meeting is None:
                continue
            poses = np.array(
                [move(meeting.pose, meeting.direction, _DEPTH + shift) for shift in _SHIFTS]
            )
            taken = [
                [_time(m, poses, shell) for m in models for shell in ASKED] for _ in range(_ROUNDS)
            ]
            rows.append(np.median(taken, axis=0))
    return as_columns([f"{kind}_{shell}" for kind in KINDS for shell in ASKED], rows)


def _time(model: Model, poses: NDArray[np.float64], shell: str) -> float:
    """Return seconds per query, after one that warms up the caches."""
    contacts_batch(model, model, poses[0], shell=shell, threads=1)  # pyright: ignore[reportArgumentType]
    start = time.perf_counter()
    contacts_batch(model, model, poses, shell=shell, threads=1)  # pyright: ignore[reportArgumentType]
    return (time.perf_counter() - start) / len(poses)
