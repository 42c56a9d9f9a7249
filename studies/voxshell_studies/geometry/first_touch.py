"""Distance that a mesh can move along a direction until it touches another, up to rounding.

Two surfaces that approach each other along z first touch where the height of one above the other is
smallest. Over a pair of triangles that height is linear, so its minimum is at a corner of the
overlap of their projections: a vertex of one above a face of the other, or a crossing of two edges.
The search visits these, nearest first, and skips those that cannot be lower than the best so far.

Nothing here uses a distance field, a shell, or any part of the core.
"""

from __future__ import annotations

import heapq
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.model.meshes import Mesh

_PAIRS_AT_ONCE = 2_000
"""Number of pairs of triangles that are compared without splitting the area further."""

_DEEPEST_SPLIT = 24
"""Halvings of the area after which pairs are compared, whatever their number."""

_INSIDE = 1e-9
"""Fraction of a triangle by which a point may be outside and still count as on its border."""

_PARALLEL = 1e-7
"""Sine of the angle below which edges count as parallel; then their ends replace their crossing."""

_ROUNDING = 1e-12
"""Difference below which heights count as equal, meters."""


class _Sheet(NamedTuple):
    """Triangles seen along z, (n, 3, 3), with their planes z = offset + slope . (x, y)."""

    corners: NDArray[np.float64]
    slope: NDArray[np.float64]
    offset: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


def find_first_touch(
    a: Mesh,
    b: Mesh,
    b_from_a: NDArray[np.float64],
    direction: NDArray[np.float64],
    *,
    from_here: bool = False,
) -> float:
    """Return how far a must move along a direction until it touches b.

    Args:
        a: A closed mesh, oriented outward.
        b: Likewise.
        b_from_a: Pose of a in b's frame, (4, 4).
        direction: In b's frame, (3,), unit length.
        from_here: Start in this pose, in which the bodies are apart, and ignore what is behind.
            Otherwise start infinitely far behind.

    Returns:
        Meters; negative if a touches b before it reaches the pose. Infinite if it never does.

    Example:
        >>> from voxshell_studies.scenes.geometry_bodies import make_body
        >>> cube, slab = make_body("cube 50 mm"), make_body("slab 1 m")
        >>> pose = np.eye(4)
        >>> pose[2, 3] = 0.1
        >>> round(find_first_touch(cube, slab, pose, np.array([0.0, 0.0, -1.0])), 9)
        0.075
    """
    frame = _frame_above(-direction)
    moved = a.vertices @ b_from_a[:3, :3].T + b_from_a[:3, 3]
    # Only faces of a that point down can meet faces of b that point up.
    upper = _see(moved @ frame.T, a.faces, -1.0)
    lower = _see(b.vertices @ frame.T, b.faces, 1.0)
    if from_here:
        return _search(upper, lower, -_ROUNDING)
    return _search(upper, lower, -np.inf)


def _frame_above(up: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rows x, y, z of a frame whose z is ``up``."""
    side = np.cross(np.eye(3)[np.argmin(np.abs(up))], up)
    side /= np.linalg.norm(side)
    return np.array([side, np.cross(up, side), up])


def _see(vertices: NDArray[np.float64], faces: NDArray[np.uint32], facing: float) -> _Sheet:
    """Return the triangles that face up (1) or down (-1)."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    # Triangles that are vertical within rounding share their borders with neighbors that are not.
    seen = facing * normals[:, 2] > 1e-10 * lengths
    corners, normals = corners[seen], normals[seen]
    slope = -normals[:, :2] / normals[:, 2:]
    offset = corners[:, 0, 2] - np.einsum("ij,ij->i", slope, corners[:, 0, :2])
    return _Sheet(corners, slope, offset, corners.min(axis=1), corners.max(axis=1))


def _search(upper: _Sheet, lower: _Sheet, floor: float) -> float:
    """Return the smallest height of the upper sheet above the lower, if at least ``floor``."""
    if len(upper.corners) == 0 or len(lower.corners) == 0:
        return np.inf
    corner_low = np.maximum(upper.low.min(axis=0), lower.low.min(axis=0))[:2]
    corner_high = np.minimum(upper.high.max(axis=0), lower.high.max(axis=0))[:2]
    if (corner_low > corner_high).any():
        return np.inf
    best, count = np.inf, 0
    everything = np.arange(len(upper.corners)), np.arange(len(lower.corners))
    waiting = [(-np.inf, 0, 0, corner_low, corner_high, *everything)]
    while waiting:
        bound, _, depth, low, high, ours, theirs = heapq.heappop(waiting)
        if bound >= best - _ROUNDING:
            break
        ours, our_low, our_high = _clip(upper, ours, low, high)
        theirs, their_low, their_high = _clip(lower, theirs, low, high)
        if len(ours) == 0 or len(theirs) == 0:
            continue
        # Triangles that are below all of the other sheet by more than the floor are behind.
        ahead = our_high >= their_low.min() + floor
        ours, our_low, our_high = ours[ahead], our_low[ahead], our_high[ahead]
        if len(ours) == 0:
            continue
        ahead = their_low <= our_high.max() - floor
        theirs, their_low, their_high = theirs[ahead], their_low[ahead], their_high[ahead]
        if len(theirs) == 0:
            continue
        near = our_low - their_high.max() < best
        theirs_near = our_low.min() - their_high < best
        ours, theirs = ours[near], theirs[theirs_near]
        if len(ours) == 0 or len(theirs) == 0:
            continue
        bound = max(float(our_low.min() - their_high.max()), floor)
        if bound >= best - _ROUNDING:
            continue
        if len(ours) * len(theirs) <= _PAIRS_AT_ONCE or depth >= _DEEPEST_SPLIT:
            best = min(best, _compare(upper, ours, lower, theirs, floor))
            continue
        axis = int(np.argmax(high - low))
        middle = 0.5 * (low[axis] + high[axis])
        for side in range(2):
            part_low, part_high = low.copy(), high.copy()
            (part_high if side == 0 else part_low)[axis] = middle
            count += 1
            # Children are bounded by their own area when they are visited, and by this one's
            # before.
            child = _bound(upper, ours, lower, theirs, part_low, part_high, floor)
            if child < best - _ROUNDING:
                heapq.heappush(
                    waiting, (child, count, depth + 1, part_low, part_high, ours, theirs)
                )
    return best


def _bound(
    upper: _Sheet,
    ours: NDArray[np.intp],
    lower: _Sheet,
    theirs: NDArray[np.intp],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    floor: float,
) -> float:
    ours, our_low, _ = _clip(upper, ours, low, high)
    theirs, _, their_high = _clip(lower, theirs, low, high)
    if len(ours) == 0 or len(theirs) == 0:
        return np.inf
    return max(float(our_low.min() - their_high.max()), floor)


def _clip(
    sheet: _Sheet, index: NDArray[np.intp], low: NDArray[np.float64], high: NDArray[np.float64]
) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
    """Return triangles whose bounds meet an area, and the range of their heights above it."""
    within = ((sheet.low[index, :2] <= high) & (sheet.high[index, :2] >= low)).all(axis=1)
    index = index[within]
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    at_middle = sheet.offset[index] + sheet.slope[index] @ middle
    sway = np.abs(sheet.slope[index]) @ half
    lowest = np.maximum(at_middle - sway, sheet.low[index, 2])
    highest = np.minimum(at_middle + sway, sheet.high[index, 2])
    return index, lowest, highest


def _compare(
    upper: _Sheet, ours: NDArray[np.intp], lower: _Sheet, theirs: NDArray[np.intp], floor: float
) -> float:
    """Return the smallest height over all pairs of these triangles."""
    overlap = (
        (upper.low[ours][:, None, :2] <= lower.high[theirs][None, :, :2])
        & (upper.high[ours][:, None, :2] >= lower.low[theirs][None, :, :2])
    ).all(axis=2)
    first, second = np.nonzero(overlap)
    if len(first) == 0:
        return np.inf
    a, b = ours[first], theirs[second]
    heights = [
        _corners_over_faces(upper.corners[a], lower, b),
        -_corners_over_faces(lower.corners[b], upper, a),
        _edges_over_edges(upper.corners[a], lower.corners[b]),
    ]
    every = np.concatenate([height[np.isfinite(height)] for height in heights])
    every = every[every >= floor]
    return float(every.min(initial=np.inf))


def _corners_over_faces(
    corners: NDArray[np.float64], sheet: _Sheet, faces: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Return the height of each corner above the face that is paired with its triangle, or NaN."""
    target = sheet.corners[faces]
    origin = target[:, 0, :2]
    one, two = target[:, 1, :2] - origin, target[:, 2, :2] - origin
    area = _cross(one, two)
    offset = corners[:, :, :2] - origin[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        u = _cross(offset, two[:, None]) / area[:, None]
        v = _cross(one[:, None], offset) / area[:, None]
    within = (u >= -_INSIDE) & (v >= -_INSIDE) & (u + v <= 1.0 + _INSIDE)
    rise = target[:, 1:, 2] - target[:, :1, 2]
    below = target[:, :1, 2] + u * rise[:, :1] + v * rise[:, 1:]
    return np.where(within, corners[:, :, 2] - below, np.nan).ravel()


def _edges_over_edges(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the height of each edge of a above each edge of b where they cross, or NaN."""
    heights = []
    for i in range(3):
        start, along = a[:, i], a[:, (i + 1) % 3] - a[:, i]
        for j in range(3):
            other, other_along = b[:, j], b[:, (j + 1) % 3] - b[:, j]
            between = other[:, :2] - start[:, :2]
            with np.errstate(divide="ignore", invalid="ignore"):
                area = _cross(along[:, :2], other_along[:, :2])
                lengths = np.hypot(*along[:, :2].T) * np.hypot(*other_along[:, :2].T)
                area[np.abs(area) <= _PARALLEL * lengths] = 0.0
                s = _cross(between, other_along[:, :2]) / area
                t = _cross(between, along[:, :2]) / area
                cross = (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0) & (area != 0.0)
                height = start[:, 2] + s * along[:, 2] - other[:, 2] - t * other_along[:, 2]
            heights.append(np.where(cross, height, np.nan))
    return np.concatenate(heights)


def _cross(one: NDArray[np.float64], two: NDArray[np.float64]) -> NDArray[np.float64]:
    return one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0]
