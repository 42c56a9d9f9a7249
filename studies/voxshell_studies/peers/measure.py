"""Measurement of a prepared peer: all cases, then its drops."""

from __future__ import annotations

import math
import time
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from voxshell_studies.peers.protocol import CaseResult, DropResult

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from voxshell_studies.peers.protocol import Case, Contender, Job, Other, Query

MOST_PASSES = 200
"""Smallest number of queries of a case: enough for a p99."""

SUNK = 0.005
"""Depth beyond which bodies do not count as resting, meters."""

REST_SPEED, REST_SPIN = 0.01, 0.1
"""Largest speeds of a body at rest, m/s and rad/s."""

LAST_SECONDS = 1.0
"""Final seconds of a drop, which determine the outcome."""


def measure(contender: Contender, job: Job) -> Iterator[CaseResult | DropResult]:
    """Yield results as they become available; a peer's exception becomes the result's problem."""
    for case in job.cases:
        try:
            query = contender.meet(case)
            if query is not None:
                yield measure_case(query, case, job.case_seconds)
        except Exception as error:
            yield CaseResult(case.key, problem=describe(error))
    grounds: tuple[Other, Other] = ("plane", "box")
    for other in grounds:
        for rate in job.rates:
            try:
                result = follow_drop(contender, job, other, rate)
            except Exception as error:
                result = DropResult(other, rate, problem=describe(error))
            if result is not None:
                yield result


def measure_case(query: Query, case: Case, seconds: float) -> CaseResult:
    """Return the result at the first pose, and times of passes through all poses."""
    query.ask(case.poses[0])
    contacts, depth = query.answer()
    passes: list[list[float]] = []
    end = time.perf_counter() + seconds
    while not passes or (len(passes) < MOST_PASSES and time.perf_counter() < end):
        passes.append([query.ask(pose) for pose in case.poses])
    times = np.array(passes)
    return CaseResult(
        case.key,
        median=float(np.median(times)),
        p99=float(np.percentile(times, 99)),
        least=float(np.median(times.min(axis=0))),
        queries=times.size,
        contacts=contacts,
        depth=depth,
    )


def follow_drop(contender: Contender, job: Job, other: Other, rate: float) -> DropResult | None:
    """Simulate a drop; return None if the peer has no dynamics."""
    fall = contender.drop(other, rate)
    if fall is None:
        return None
    steps = max(2, round(job.drop_seconds * rate))
    poses = np.array([fall.step() for _ in range(steps)])
    return judge_drop(poses, job, other, rate)


def judge_drop(poses: NDArray[np.float64], job: Job, other: Other, rate: float) -> DropResult:
    """Return the outcome of a drop.

    "through": its center ended below the surface. "off": beyond the box's sides. "sinks": its
    lowest vertex is deeper than :data:`SUNK`. "moves": it did not come to rest. Else it "rests".
    "unstable": a pose is not finite.

    Args:
        poses: (steps, 4, 4) ``world_from_body`` after each step.
        job: The job with the drop.
        other: The ground.
        rate: Steps per second.
    """
    if not np.isfinite(poses).all():
        return DropResult(other, rate, "unstable")
    # One product per step: the vertices of all steps together would not fit into memory.
    lowest = np.array([(job.mesh.vertices @ pose[2, :3]).min() + pose[2, 3] for pose in poses])
    last = max(2, math.ceil(LAST_SECONDS * rate))
    end = poses[-last:]
    speed = np.linalg.norm(np.diff(end[:, :3, 3], axis=0), axis=1).max() * rate
    spin = max(_angle(a, b) for a, b in pairwise(end)) * rate
    center = poses[-1, :3, 3]
    half = job.box_half_extents
    if other == "box" and (np.abs(center[:2]) > half[:2]).any():
        outcome = "off"
    elif center[2] < 0.0:
        outcome = "through"
    elif lowest[-1] < -SUNK:
        outcome = "sinks"
    elif speed > REST_SPEED or spin > REST_SPIN:
        outcome = "moves"
    else:
        outcome = "rests"
    return DropResult(
        other,
        rate,
        outcome,
        deepest=max(0.0, -float(lowest.min())),
        rest_height=float(lowest[-1]),
        speed=float(speed),
        spin=float(spin),
    )


def describe(error: BaseException) -> str:
    r"""Return the kind of an error and its message in one line.

    Example:
        >>> describe(ValueError("too many\ncontacts"))
        'ValueError: too many contacts'
    """
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text[:300]}" if text else type(error).__name__


def _angle(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Return the angle between the rotations of two poses, radians; accurate if small, too."""
    turn = a[:3, :3].T @ b[:3, :3]
    sine = np.linalg.norm(
        [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
    )
    return math.atan2(float(sine), float(np.trace(turn)) - 1.0)
