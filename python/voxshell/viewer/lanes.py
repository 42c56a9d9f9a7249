"""Lanes: recordings that a page shows side by side."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voxshell.errors import RecordingError, SettingsError
from voxshell.recording import BodyTrack, Recording

# Frames in which a body is farther from its start than this, in diameters of the body, are not
# framed:
# a body that falls through its ground or is shot away would make everything else tiny.
_REACH_IN_DIAMETERS = 12.0
# Largest growth of the framed box's diagonal that is accepted to show a fixed body completely.
_MOST_GROWTH = 1.5
_DIRECTIONS = 100
_LONGEST_ROW = 6


@dataclass(frozen=True)
class Lane:
    """A recording, its caption, and its place on the page.

    Args:
        label: Caption, of one or more lines; empty for none.
        recording: The recording.
        offset: (3,) meters, world frame, added to everything in the recording.

    Raises:
        RecordingError: The offset is not three finite numbers.
    """

    label: str
    recording: Recording
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        try:
            offset = np.asarray(self.offset, dtype=np.float64)
        except (TypeError, ValueError):
            offset = np.zeros(0)
        if offset.shape != (3,) or not np.isfinite(offset).all():
            raise RecordingError(
                f"lane {self.label!r}: offset must be three finite numbers, got {self.offset!r}"
            )
        object.__setattr__(self, "offset", tuple(offset.tolist()))


def arrange_lanes(
    recordings: Mapping[str, Recording],
    *,
    columns: int | None = None,
    gap: float | None = None,
    up: str = "+z",
) -> tuple[Lane, ...]:
    """Arrange recordings in rows without overlap, the first one at the back left.

    Args:
        recordings: Recordings by caption, in reading order.
        columns: Lanes in a row; None chooses a number that suits a wide screen.
        gap: Distance of neighbors, meters; None chooses a fifth of a lane.
        up: The world axis that points up, such as "+z" or "+y".

    Raises:
        RecordingError: There is no recording.
        SettingsError: An option is invalid.

    Example:
        >>> import numpy as np
        >>> from voxshell.recording import BodyTrack, ContactTrack
        >>> body = BodyTrack("flag", np.eye(3), [[0, 1, 2]], None, np.eye(4)[None])
        >>> recording = Recording(0.005, (body,), ContactTrack.empty(1))
        >>> [lane.label for lane in arrange_lanes({"fine": recording, "coarse": recording})]
        ['fine', 'coarse']
    """
    if not recordings:
        raise RecordingError("nothing to arrange: no recordings")
    if columns is None:
        rows = math.ceil(len(recordings) / _LONGEST_ROW)
        columns = math.ceil(len(recordings) / rows)
    if columns < 1:
        raise SettingsError(f"columns must be at least 1, got {columns}")
    right, forward, upward = view_axes(up)
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for recording in recordings.values():
        lane_low, lane_high = activity_bounds(recording)
        low, high = np.minimum(low, lane_low), np.maximum(high, lane_high)
    size = high - low
    width, depth = float(np.abs(right @ size)), float(np.abs(forward @ size))
    if gap is None:
        gap = 0.22 * width
    if not (math.isfinite(gap) and gap >= 0.0):
        raise SettingsError(f"gap must be meters, at least 0, got {gap!r}")
    rows = math.ceil(len(recordings) / columns)
    # A row is set back by its height, so that the row in front does not hide its bottom.
    tall = float(np.abs(upward @ size))
    lanes = []
    for index, (label, recording) in enumerate(recordings.items()):
        row, column = divmod(index, columns)
        across = (column - 0.5 * (columns - 1)) * (width + gap)
        back = (0.5 * (rows - 1) - row) * (depth + gap + tall)
        x, y, z = (across * right + back * forward).tolist()
        lanes.append(Lane(label, recording, (x, y, z)))
    return tuple(lanes)


def view_axes(up: str) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the unit vectors right, forward (away from the viewer) and up, world frame.

    Raises:
        SettingsError: ``up`` is none of "+x", "-x", "+y", "-y", "+z", "-z".

    Example:
        >>> view_axes("+z")[1]
        array([0., 1., 0.])
    """
    axes = {"x": 0, "y": 1, "z": 2}
    if len(up) != 2 or up[0] not in "+-" or up[1] not in axes:
        raise SettingsError(f"up must be '+x', '-x', '+y', '-y', '+z' or '-z', not {up!r}")
    upward = np.zeros(3)
    upward[axes[up[1]]] = 1.0 if up[0] == "+" else -1.0
    right = np.array([0.0, 1.0, 0.0]) if up[1] == "x" else np.array([1.0, 0.0, 0.0])
    return right, np.cross(upward, right), upward


def activity_bounds(recording: Recording) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the box in which the moving bodies move (all bodies, if none moves).

    Frames in which a body is far from its start do not count. A fixed body, such as a bolt under
    its nut, is included completely if the box becomes at most half as long again.

    Returns:
        low (3,) and high (3,), meters, world frame.
    """
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for body in moving_bodies(recording):
        tips = _outermost_points(body)
        start = body.poses[0, :3, :3] @ tips[0] + body.poses[0, :3, 3]
        reach = _REACH_IN_DIAMETERS * body_diameter(body)
        path = np.einsum("fij,pj->fpi", body.poses[:, :3, :3], tips) + body.poses[:, None, :3, 3]
        near = path[np.linalg.norm(path[:, 0] - start, axis=1) <= reach]
        low = np.minimum(low, near.min(axis=(0, 1)))
        high = np.maximum(high, near.max(axis=(0, 1)))
    longest = _MOST_GROWTH * np.linalg.norm(high - low)
    boxes = [(low, high)]
    for body in recording.bodies:
        corners = body.vertices @ body.poses[0, :3, :3].T + body.poses[0, :3, 3]
        with_low = np.minimum(low, corners.min(axis=0))
        with_high = np.maximum(high, corners.max(axis=0))
        if body.fixed and np.linalg.norm(with_high - with_low) <= longest:
            boxes.append((with_low, with_high))
    lows, highs = zip(*boxes, strict=True)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def moving_bodies(recording: Recording) -> tuple[BodyTrack, ...]:
    """Return the bodies that move, or all bodies if none does."""
    return tuple(body for body in recording.bodies if not body.fixed) or recording.bodies


def body_diameter(body: BodyTrack) -> float:
    """Return the diagonal of the box around a body, meters."""
    return float(np.linalg.norm(np.ptp(body.vertices, axis=0)))


def _outermost_points(body: BodyTrack) -> NDArray[np.float64]:
    """Return the outermost vertices in directions all around, (k, 3), body frame.

    A few dozen vertices represent the whole surface: the box around them is too short by less than
    1 %.
    """
    index = np.arange(_DIRECTIONS) + 0.5
    height = 1.0 - 2.0 * index / _DIRECTIONS
    turn = np.pi * (1.0 + 5.0**0.5) * index
    ring = np.sqrt(1.0 - height**2)
    directions = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
    return body.vertices[np.unique(np.argmax(body.vertices @ directions.T, axis=0))]
