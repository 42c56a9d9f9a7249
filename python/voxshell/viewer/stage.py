"""The stage: the scale of the scene, its grounds, and the camera."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voxshell.recording import BodyTrack, Recording
from voxshell.viewer.lanes import (
    Lane,
    activity_bounds,
    body_diameter,
    moving_bodies,
    view_axes,
)

# Diagonal of a scene in display units. The player's clipping planes, shadows and camera speed suit
# scenes of this size, so millimeters and kilometers look alike.
_SCENE_DIAGONAL = 6.0
_FIELD_OF_VIEW = math.radians(32.0)
# Aspect ratio of the first view; on a narrower window, the page moves the camera back.
VIEW_ASPECT = 1.85
_MARGIN = 0.08  # around what moves, as a fraction of the stage's width
_LOOKS = 24  # instants of a recording at which a camera that follows paths looks
_THICKNESS = 0.08  # of grounds, as a fraction of the stage's width
# Vertical range of the picture to fill, from -1 to 1: below the heading, above captions in front.
_VIEW_LEFT, _VIEW_RIGHT, _VIEW_BOTTOM, _VIEW_TOP = -0.93, 0.93, -0.80, 0.76


@dataclass(frozen=True, eq=False)
class Slab:
    """A ground as drawn: a thin plate below the bodies, whatever the size of the real one.

    Args:
        low: (3,) meters, world frame of the recording.
        high: (3,) likewise.
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Camera:
    """A first view.

    Args:
        position: (3,) display units.
        target: (3,) display units, the point that the camera looks at.
        field_of_view: Vertical, radians.
    """

    position: NDArray[np.float64]
    target: NDArray[np.float64]
    field_of_view: float

    @property
    def view_height(self) -> float:
        """Height of the picture at the target, display units."""
        distance = float(np.linalg.norm(self.target - self.position))
        return 2.0 * distance * math.tan(0.5 * self.field_of_view)


@dataclass(frozen=True, eq=False)
class Stage:
    """The space of every lane; each lane has its own frame.

    Args:
        low: (3,) meters, lower corner of the visible box, world frame of every recording.
        high: (3,) upper corner, likewise.
        scale: Display units per meter.
        cell: Distance of grid lines, meters: 1, 2 or 5 times a power of ten.
        body_size: Diagonal of a typical moving body, meters.
        columns: Largest number of lanes in a row.
        rows: Number of rows.
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    scale: float
    cell: float
    body_size: float
    columns: int
    rows: int


def plan_stage(lanes: Sequence[Lane], *, up: str) -> Stage:
    """Return one stage for all lanes, so that they have the same scale."""
    right, forward, upward = view_axes(up)
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for lane in lanes:
        lane_low, lane_high = activity_bounds(lane.recording)
        low, high = np.minimum(low, lane_low), np.maximum(high, lane_high)
    level = 1.0 - np.abs(upward)
    width = max(float((level * (high - low)).max()), 1e-9)
    margin = width * (_MARGIN * level + _THICKNESS * np.abs(upward))
    low, high = low - margin, high + margin
    offsets = np.array([lane.offset for lane in lanes])
    diagonal = float(np.linalg.norm(high - low + np.ptp(offsets, axis=0)))
    sizes = [body_diameter(body) for lane in lanes for body in moving_bodies(lane.recording)]
    return Stage(
        low,
        high,
        _SCENE_DIAGONAL / diagonal,
        nice_length(0.1 * width),
        float(np.median(sizes)),
        columns=len(np.unique(np.round(offsets @ right / diagonal, 6))),
        rows=len(np.unique(np.round(offsets @ forward / diagonal, 6))),
    )


def find_slabs(recording: Recording, stage: Stage, *, up: str) -> dict[str, Slab]:
    """Return the bodies that are grounds, by name: level fixed boxes under everything that moves.

    Boxes that are not there from the first frame on are bodies like others.

    Args:
        recording: The recording.
        stage: The stage; slabs are cut to it.
        up: The world axis that points up.
    """
    right, forward, upward = view_axes(up)
    moving = [body for body in recording.bodies if not body.fixed]
    floor = min((_start_height(body, upward) for body in moving), default=-math.inf)
    slabs = {}
    for body in recording.bodies:
        if not body.fixed or body.start > 0 or not _is_level_box(body):
            continue
        corners = body.vertices @ body.poses[0, :3, :3].T + body.poses[0, :3, 3]
        low, high = corners.min(axis=0), corners.max(axis=0)
        if float((corners @ upward).max()) > floor:
            continue
        level = np.abs(right) + np.abs(forward) > 0.5
        inner_low = np.where(level, np.maximum(low, stage.low), low)
        inner_high = np.where(level, np.minimum(high, stage.high), high)
        if (inner_low >= inner_high).any():
            continue
        width = float(((1.0 - np.abs(upward)) * (stage.high - stage.low)).max())
        thickness = min(float(np.abs(upward @ (high - low))), _THICKNESS * width)
        top = upward * float((corners @ upward).max())
        ends = np.stack([top, top - upward * thickness])
        slabs[body.name] = Slab(
            np.where(level, inner_low, ends.min(axis=0)),
            np.where(level, inner_high, ends.max(axis=0)),
        )
    return slabs


def find_ground_height(recordings: Sequence[Recording], stage: Stage, *, up: str) -> float:
    """Return the height of the highest ground, meters along ``up``: of a slab, or under what moves."""
    _, _, upward = view_axes(up)
    heights = []
    for recording in recordings:
        slabs = find_slabs(recording, stage, up=up).values()
        tops = [max(upward @ slab.low, upward @ slab.high) for slab in slabs]
        low, high = activity_bounds(recording)
        heights.append(max(tops, default=min(upward @ low, upward @ high)))
    return float(max(heights))


def find_paths(recording: Recording) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Return boxes, low (3,) and high (3,) in meters, that hold all that moves at some instants.

    They also hold fixed bodies of about the same size; see
    :func:`~voxshell.viewer.lanes.activity_bounds`.
    """
    frames = np.unique(np.linspace(0, recording.frame_count - 1, _LOOKS).round().astype(np.int64))
    boxes = []
    for body in moving_bodies(recording):
        low, high = body.vertices.min(axis=0), body.vertices.max(axis=0)
        corners = np.array([np.where(bits, high, low) for bits in np.ndindex(2, 2, 2)])
        for frame in frames:
            places = corners @ body.poses[frame, :3, :3].T + body.poses[frame, :3, 3]
            boxes.append((places.min(axis=0), places.max(axis=0)))
    all_low, all_high = activity_bounds(recording)
    tolerance = 1e-9 * float(np.linalg.norm(all_high - all_low))
    for body in recording.bodies:
        places = body.vertices @ body.poses[0, :3, :3].T + body.poses[0, :3, 3]
        low, high = places.min(axis=0), places.max(axis=0)
        if (
            body.fixed
            and (low >= all_low - tolerance).all()
            and (high <= all_high + tolerance).all()
        ):
            boxes.append((low, high))
    return boxes


def place_camera(
    boxes: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]],
    *,
    rows: int,
    up: str,
    aspect: float = VIEW_ASPECT,
) -> Camera:
    """Return a camera that sees all boxes from the front and slightly above, as near as possible.

    Args:
        boxes: low (3,) and high (3,) of each, display units.
        rows: Rows of lanes; for more than one, the camera is higher.
        up: The world axis that points up.
        aspect: Width of the picture over its height.
    """
    right, forward, upward = view_axes(up)
    corners = np.array(
        [
            np.where([(bits >> axis) & 1 for axis in range(3)], high, low)
            for low, high in boxes
            for bits in range(8)
        ]
    )
    height = math.radians(21.0 if rows == 1 else 28.0)
    away = math.cos(height) * forward - math.sin(height) * upward
    above = math.sin(height) * forward + math.cos(height) * upward
    tangent = math.tan(0.5 * _FIELD_OF_VIEW)
    target = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    distance = 2.0 * float(np.linalg.norm(corners - target, axis=1).max()) / tangent
    wanted = np.array([_VIEW_RIGHT - _VIEW_LEFT, _VIEW_TOP - _VIEW_BOTTOM])
    middle = 0.5 * np.array([_VIEW_RIGHT + _VIEW_LEFT, _VIEW_TOP + _VIEW_BOTTOM])
    # Each iteration is exact except for perspective, so the error shrinks quickly.
    for _ in range(40):
        seen = corners - (target - distance * away)
        depth = seen @ away
        x = seen @ right / (depth * tangent * aspect)
        y = seen @ above / (depth * tangent)
        shift_x = 0.5 * (x.min() + x.max()) - middle[0]
        shift_y = 0.5 * (y.min() + y.max()) - middle[1]
        target = target + distance * tangent * (shift_x * aspect * right + shift_y * above)
        fill = max(np.ptp(x) / wanted[0], np.ptp(y) / wanted[1])
        distance *= 1.0 + 0.7 * (float(fill) - 1.0)
    return Camera(target - distance * away, target, _FIELD_OF_VIEW)


def _start_height(body: BodyTrack, upward: NDArray[np.float64]) -> float:
    center = 0.5 * (body.vertices.min(axis=0) + body.vertices.max(axis=0))
    return float(upward @ (body.poses[0, :3, :3] @ center + body.poses[0, :3, 3]))


def _is_level_box(body: BodyTrack) -> bool:
    """Return whether every vertex is a corner of an axis-aligned box."""
    corners = body.vertices @ body.poses[0, :3, :3].T + body.poses[0, :3, 3]
    low, high = corners.min(axis=0), corners.max(axis=0)
    tolerance = 1e-6 * float(np.abs(high - low).max())
    at_corner = np.minimum(corners - low, high - corners).max() <= tolerance
    return bool(at_corner and ((high - low) > tolerance).all())


def nice_length(length: float) -> float:
    """Return 1, 2 or 5 times a power of ten, at least ``length``."""
    power = 10.0 ** math.floor(math.log10(length))
    return power * next(step for step in (1.0, 2.0, 5.0, 10.0) if step * power >= length)
