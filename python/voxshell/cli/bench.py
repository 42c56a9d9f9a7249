"""``voxshell bench``: times of queries of a mesh on this machine."""

from __future__ import annotations

import json
import time
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from cyclopts import Parameter
from rich.console import Console

from voxshell.base.arguments import as_integer
from voxshell.cli.bodies import DEFAULTS, ModelOptions, describe_model, read_body, refuse_unused
from voxshell.cli.model_facts import describe_facts
from voxshell.cli.progress import open_progress, tracked
from voxshell.cli.tables import list_facts, new_table
from voxshell.errors import SettingsError
from voxshell.measuring.environment import describe_environment
from voxshell.measuring.files import finite
from voxshell.measuring.timing import pinned
from voxshell.measuring.touching_poses import find_poses_between
from voxshell.measuring.units import format_length, format_time
from voxshell.model.model import Model
from voxshell.query.distances import distance
from voxshell.query.queries import collide, contacts, manifold
from voxshell.query.scratch import QueryScratch

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from voxshell.cli.progress import Track

LEAST_DEPTH, MOST_DEPTH = 0.25, 1.0
"""Depths of the bodies' overlap, in voxels."""

_STEP = 0.01
"""Displacement between consecutive queries of a series, in voxels."""


def bench(
    mesh: str,
    /,
    *,
    poses: int = 200,
    repeats: int = 5,
    seed: int = 1,
    options: ModelOptions = DEFAULTS,
    json_only: Annotated[bool, Parameter(name="--json", negative="")] = False,
) -> None:
    """Time queries of two copies of a mesh that touch in random poses.

    Each query runs in every pose on one core: once without a scratch, and once with a scratch
    after a move by a hundredth of a voxel. The time of a pose is the least of its repeats. The
    table shows the median and the 99th percentile over the poses.

    For example:

        voxshell bench bunny.vxs
        voxshell bench part.stl --scale 0.001 --tolerance 0.0001 --poses 1000

    Args:
        mesh: A model file (.vxs), or a mesh file.
        poses: Number of poses.
        repeats: Number of times each pose is timed.
        seed: Seed of the random poses.
        options: How to build a model from a mesh.
        json_only: Print only JSON, in seconds and meters.
    """
    refuse_unused(options, mesh)
    as_integer(poses, "poses", 1, 1_000_000)
    as_integer(repeats, "repeats", 1, 10_000)
    as_integer(seed, "seed", 0, 2**31 - 1)
    with open_progress(Console(quiet=json_only, stderr=True)) as progress:
        with tracked(progress, "read") as track:
            model = read_body(mesh, options, track.update)
        if not isinstance(model, Model):
            raise SettingsError(f"{mesh} is a shape; give a mesh or a model, which has points")
        with tracked(progress, "find poses"):
            voxel = model.field.voxel_size
            found = find_poses_between(model, poses, LEAST_DEPTH * voxel, MOST_DEPTH * voxel, seed)
        with tracked(progress, "time queries") as track, pinned():
            times = _time_all(model, found, repeats, track)
    counts = [len(contacts(model, model, None, pose)) for pose in found]
    rows = {
        name: {"median": float(np.median(t)), "p99": float(np.percentile(t, 99))}
        for name, t in times.items()
    }
    if json_only:
        result = {
            "model": describe_model(model),
            "poses": poses,
            "repeats": repeats,
            "seed": seed,
            "depths": [LEAST_DEPTH * voxel, MOST_DEPTH * voxel],
            "mean_contacts": float(np.mean(counts)),
            "seconds": rows,
            "environment": describe_environment(),
        }
        print(json.dumps(finite(result)))
        return
    console = Console(highlight=False)
    console.print(list_facts(describe_facts(model)))
    table = new_table("query", "median", "p99")
    for name, row in rows.items():
        table.add_row(name, format_time(row["median"]), format_time(row["p99"]))
    console.print(table)
    depths = f"{format_length(LEAST_DEPTH * voxel)} to {format_length(MOST_DEPTH * voxel)}"
    console.print(
        f"two copies, {depths} deep in one another, in {poses} random poses: "
        f"{np.mean(counts):.1f} contacts on average; from Python, on one core"
    )


def _time_all(
    model: Model, poses: NDArray[np.float64], repeats: int, track: Track
) -> dict[str, NDArray[np.float64]]:
    """Return the time of each query and pose, the shortest of the repeats, seconds."""
    scratch = QueryScratch()
    queries: dict[str, Callable[[Any], object]] = {
        "collide": lambda pose: collide(model, model, None, pose),
        "contacts": lambda pose: contacts(model, model, None, pose),
        "contacts, in a series": lambda pose: contacts(model, model, None, pose, scratch=scratch),
        "manifold": lambda pose: manifold(model, model, None, pose),
        "distance": lambda pose: distance(model, model, None, pose),
        "distance, in a series": lambda pose: distance(model, model, None, pose, scratch=scratch),
    }
    step = _STEP * model.field.voxel_size
    times = {name: np.full(len(poses), np.inf) for name in queries}
    for repeat in range(repeats):
        for index, pose in enumerate(poses):
            near = pose.copy()
            near[:3, 3] += step / np.sqrt(3.0)
            for name, ask in queries.items():
                if name.endswith("series"):
                    ask(near)
                start = time.perf_counter_ns()
                ask(pose)
                seconds = (time.perf_counter_ns() - start) * 1e-9
                times[name][index] = min(times[name][index], seconds)
            if index % 32 == 0:
                track.advance((repeat + index / len(poses)) / repeats)
    return times
