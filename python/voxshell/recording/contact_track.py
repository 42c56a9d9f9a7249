"""The contacts of a recording, frame by frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voxshell.base.lengths import limit
from voxshell.errors import RecordingError
from voxshell.recording.arrays import as_floats, as_integers, as_points, keep

_UNIT_TOLERANCE = 1e-3


@dataclass(frozen=True, eq=False)
class ContactTrack:
    """The contacts of all frames, concatenated; frame i has rows offsets[i] to offsets[i + 1].

    Args:
        offsets: (frames + 1,) int, ascending from 0 to k.
        points: (k, 3) float, meters, world frame.
        normals: (k, 3) float, unit length, world frame, on body b, pointing toward body a.
        depths: (k,) float, meters, positive where the bodies overlap.
        forces: (k, 3) float, newtons, world frame: the normal force of each contact in the step
            before the frame, on body a, or on body b if a is not dynamic. None means zeros: no
            forces were computed.

    Raises:
        RecordingError: The lengths disagree, a number is not finite or beyond 1e30, or a normal is
            not of unit length.

    Arrays are copied, and the copies are read-only.

    Example:
        >>> track = ContactTrack.from_frames([
        ...     ([], [], []),
        ...     ([[0, 0, 0], [1, 0, 0]], [[0, 0, 1], [0, 0, 1]], [0.002, 0.001]),
        ... ])
        >>> track.counts
        array([0, 2])
        >>> track.frame(1).depths
        array([0.002, 0.001])
    """

    offsets: NDArray[np.int64]
    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    depths: NDArray[np.float64]
    forces: NDArray[np.float64] = None  # pyright: ignore[reportAssignmentType]: an array once it is made

    def __post_init__(self) -> None:
        offsets = as_integers(self.offsets, "contacts: offsets")
        points = as_points(self.points, "contacts: points")
        normals = as_points(self.normals, "contacts: normals")
        depths = as_floats(self.depths, "contacts: depths").reshape(-1)
        if offsets.ndim != 1 or len(offsets) < 2:
            raise RecordingError(
                f"contacts: offsets must have shape (frames + 1,), got {offsets.shape}"
            )
        forces = (
            np.zeros((len(points), 3))
            if self.forces is None
            else as_points(self.forces, "contacts: forces")
        )
        if not len(points) == len(normals) == len(depths) == len(forces):
            raise RecordingError(
                f"contacts: {len(points)} points, {len(normals)} normals, {len(depths)} depths and "
                f"{len(forces)} forces"
            )
        if offsets[0] != 0 or offsets[-1] != len(points):
            raise RecordingError(
                f"contacts: offsets must run from 0 to {len(points)}, "
                f"got {offsets[0]} to {offsets[-1]}"
            )
        falls = np.flatnonzero(np.diff(offsets) < 0)
        if len(falls):
            frame = falls[0]
            raise RecordingError(
                f"contacts: offsets decrease from {offsets[frame]} to {offsets[frame + 1]} "
                f"at frame {frame}"
            )
        if len(normals):
            error = np.abs(np.linalg.norm(normals, axis=1) - 1.0)
            worst = int(np.argmax(error))
            if error[worst] > _UNIT_TOLERANCE:
                raise RecordingError(
                    f"contacts: normal {worst} has length "
                    f"{np.linalg.norm(normals[worst]):.6g} instead of 1 "
                    f"({int(np.sum(error > _UNIT_TOLERANCE))} such normals)"
                )
        keep(self, "offsets", offsets)
        keep(self, "points", points)
        keep(self, "normals", normals)
        keep(self, "depths", depths)
        keep(self, "forces", forces)

    @classmethod
    def empty(cls, frames: int) -> ContactTrack:
        """Return a track of ``frames`` frames without contacts.

        Example:
            >>> ContactTrack.empty(3).counts
            array([0, 0, 0])
        """
        nothing = np.zeros((0, 3))
        return cls(np.zeros(frames + 1, dtype=np.int64), nothing, nothing, np.zeros(0))

    @classmethod
    def from_frames(cls, frames: Sequence[tuple[ArrayLike, ...]]) -> ContactTrack:
        """Concatenate the contacts of single frames.

        Args:
            frames: For each frame its points (k, 3), normals (k, 3), depths (k,) and, optionally,
                forces (k, 3), in the units and frame of the class; k may differ between frames and
                may be 0.

        Raises:
            RecordingError: As for the class.
        """
        points = [as_points(frame[0], "contacts: points") for frame in frames]
        normals = [as_points(frame[1], "contacts: normals") for frame in frames]
        depths = [as_floats(frame[2], "contacts: depths").reshape(-1) for frame in frames]
        forces = [
            as_points(frame[3], "contacts: forces") if len(frame) > 3 else np.zeros((len(p), 3))
            for frame, p in zip(frames, points, strict=True)
        ]
        for index, (p, n, d, f) in enumerate(zip(points, normals, depths, forces, strict=True)):
            if not len(p) == len(n) == len(d) == len(f):
                raise RecordingError(
                    f"contacts: frame {index} has {len(p)} points, {len(n)} normals, "
                    f"{len(d)} depths and {len(f)} forces"
                )
        if not frames:
            raise RecordingError("contacts: a recording needs at least one frame, got none")
        offsets = np.concatenate([[0], np.cumsum([len(p) for p in points])])
        return cls(offsets, *map(np.concatenate, (points, normals, depths, forces)))

    def __repr__(self) -> str:
        frames, contacts = len(self.offsets) - 1, len(self.depths)
        deepest = self.depths.max(initial=0.0)
        return (
            f"ContactTrack({frames} frame{'' if frames == 1 else 's'}, "
            f"{contacts} contact{'' if contacts == 1 else 's'}"
            f"{f', {limit(deepest)} deep' if deepest > 0.0 else ''})"
        )

    @property
    def frame_count(self) -> int:
        """Number of frames."""
        return len(self.offsets) - 1

    @property
    def counts(self) -> NDArray[np.int64]:
        """Number of contacts in each frame, (frames,)."""
        return np.diff(self.offsets)

    def frame(self, index: int) -> ContactTrack:
        """Return the contacts of one frame, as a track of one frame.

        Raises:
            IndexError: There is no such frame.
        """
        if not 0 <= index < self.frame_count:
            raise IndexError(f"frame {index} of {self.frame_count}")
        part = slice(int(self.offsets[index]), int(self.offsets[index + 1]))
        points = self.points[part]
        return ContactTrack(
            np.array([0, len(points)]),
            points,
            self.normals[part],
            self.depths[part],
            self.forces[part],
        )
