"""The drop: narrow-phase times, contacts, penetration and rest of several methods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell_studies.scenes.drop import build_world

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from voxshell.recording import Recording

    from voxshell_studies.scenes.drop import DropSettings, DropShapes, Method

FULL_OPERATION = (250, 600)
"""First and last step (excluded) in which the thesis times the narrow phase (section 5.3)."""

REST_STEPS = 100
"""Number of final steps that count as rest."""


@dataclass(frozen=True, eq=False)
class DropRun:
    """The results of one method, step by step.

    Attributes:
        method: The method.
        narrow_phase: (steps,) seconds; of all pairs, here one.
        query, reduction, manifold: (steps,) seconds; the models' parts of it, or 0.
        contacts: (steps,) points in Bullet's manifolds.
        depth: (steps,) meters; the deepest contact reported, 0 without contact.
        speed: (steps,) m/s; of the center of mass.
        angular_speed: (steps,) rad/s.
        lowest: (steps,) meters; height of the mesh's lowest vertex over the ground, whatever shape
            collided: the true depth to which the body sinks or height at which it floats.
        recording: Poses and contacts.
    """

    method: Method
    narrow_phase: NDArray[np.float64]
    query: NDArray[np.float64]
    reduction: NDArray[np.float64]
    manifold: NDArray[np.float64]
    contacts: NDArray[np.int64]
    depth: NDArray[np.float64]
    speed: NDArray[np.float64]
    angular_speed: NDArray[np.float64]
    lowest: NDArray[np.float64]
    recording: Recording

    @property
    def steps(self) -> int:
        """Number of steps."""
        return len(self.narrow_phase)


@dataclass(frozen=True)
class DropSummary:
    """One row of the table. Times are in seconds, lengths in meters, over all steps.

    Attributes:
        median, p99: Of the narrow phase in full operation.
        query_median, reduction_median, manifold_median: Of the models' parts of it.
        mean_contacts: In full operation.
        deepest: Deepest reported contact in all steps.
        rest_depth: Deepest reported contact at rest.
        rest_speed, rest_angular_speed: Largest at rest, m/s and rad/s.
        rest_lowest: Lowest height of the mesh's lowest vertex at rest.
        ratio: Median, as a multiple of the fine VPS's in this run.
    """

    key: str
    steps: int
    median: float
    p99: float
    query_median: float
    reduction_median: float
    manifold_median: float
    mean_contacts: float
    deepest: float
    rest_depth: float
    rest_speed: float
    rest_angular_speed: float
    rest_lowest: float
    ratio: float


def run_drop(
    shapes: DropShapes,
    method: Method,
    settings: DropSettings,
    steps: int,
    progress: Callable[[float], object] | None = None,
    *,
    rotation: NDArray[np.float64] | None = None,
) -> DropRun:
    """Simulate one method.

    Args:
        shapes: From :func:`voxshell_studies.scenes.drop.build_shapes`.
        method: The collision method of body and ground.
        settings: Settings of the drop.
        steps: Number of steps.
        progress: Called after each step with the completed fraction of the steps.
        rotation: Initial rotation, (4, 4); upright by default.
    """
    world, body = build_world(shapes, method, settings, rotation=rotation)
    vertices = shapes.mesh.vertices
    recorder = world.record()
    contacts = np.zeros(steps, np.int64)
    depth, speed, angular_speed, lowest = np.zeros((4, steps))
    for step in range(steps):
        world.step()
        points = world.contacts()
        contacts[step] = len(points)
        depth[step] = max(points["depth"].max(initial=0.0), 0.0)
        speed[step] = np.linalg.norm(body.linear_velocity)
        angular_speed[step] = np.linalg.norm(body.angular_velocity)
        pose = body.pose
        lowest[step] = (vertices @ pose[2, :3]).min() + pose[2, 3]
        if progress is not None:
            progress((step + 1) / steps)
    timings = world.timings
    return DropRun(
        method=method,
        narrow_phase=timings["narrow_phase"],
        query=timings["query"],
        reduction=timings["reduction"],
        manifold=timings["manifold"],
        contacts=contacts,
        depth=depth,
        speed=speed,
        angular_speed=angular_speed,
        lowest=lowest,
        recording=recorder.recording(),
    )


def summarize(runs: list[DropRun]) -> list[DropSummary]:
    """Return the table of runs; ratios need a run of the fine VPS and are NaN without one."""
    full = slice(*FULL_OPERATION)
    medians = {run.method.key: _median(run.narrow_phase[full]) for run in runs}
    fine = medians.get("vps-fine", np.nan)
    rest = slice(-REST_STEPS, None)
    return [
        DropSummary(
            key=run.method.key,
            steps=run.steps,
            median=medians[run.method.key],
            p99=_percentile(run.narrow_phase[full], 99),
            query_median=_median(run.query[full]),
            reduction_median=_median(run.reduction[full]),
            manifold_median=_median(run.manifold[full]),
            mean_contacts=float(run.contacts[full].mean()) if run.contacts[full].size else np.nan,
            deepest=float(run.depth.max()),
            rest_depth=float(run.depth[rest].max()),
            rest_speed=float(run.speed[rest].max()),
            rest_angular_speed=float(run.angular_speed[rest].max()),
            rest_lowest=float(run.lowest[rest].min()),
            ratio=medians[run.method.key] / fine,
        )
        for run in runs
    ]


def _median(values: NDArray[np.float64]) -> float:
    return _percentile(values, 50)


def _percentile(values: NDArray[np.float64], percent: float) -> float:
    return float(np.percentile(values, percent)) if values.size else np.nan
