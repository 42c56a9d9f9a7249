"""A body of a recording: its surface, and its pose in every frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voxshell.base.arguments import as_color, as_integer
from voxshell.base.pose_forms import make_all_rigid, read_poses
from voxshell.base.rotations import CORRECTED
from voxshell.errors import PoseError, RecordingError, SettingsError
from voxshell.recording.arrays import as_floats, as_integers, as_points, keep


@dataclass(frozen=True, eq=False)
class BodyTrack:
    """The surface of a body and its pose in every frame.

    Args:
        name: Unique within its recording.
        vertices: (n, 3) float, meters, body frame.
        faces: (m, 3) int, indices of vertices, counterclockwise when seen from outside.
        color: (red, green, blue), each 0 to 255; None lets the viewer choose.
        poses: ``world_from_body`` of each frame: (frames, 4, 4), (frames, 3) or (frames, 7)
            float64, or another form of many poses that :func:`voxshell.pose` lists. Stored as
            (frames, 4, 4).
        start: The first frame in which the body is there. It is not shown before; its poses there
            are those of this frame.

    Raises:
        RecordingError: A shape is wrong, a number is not finite or beyond 1e30, a face refers to a missing vertex,
            a pose is not rigid, or there is no frame ``start``.

    Arrays are copied, and the copies are read-only.

    Example:
        >>> import numpy as np
        >>> track = BodyTrack("flag", np.eye(3), [[0, 1, 2]], None, np.eye(4)[None])
        >>> track.frame_count
        1
        >>> BodyTrack("flag", np.eye(3), [[0, 1, 3]], None, np.eye(4)[None])
        Traceback (most recent call last):
        voxshell.errors.RecordingError: body 'flag': faces refer to vertices 0 to 3, but there are 3
    """

    name: str
    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    color: tuple[int, int, int] | None
    poses: NDArray[np.float64]
    start: int = 0

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.strip():
            raise RecordingError(f"a body needs a name, got {self.name!r}")
        where = f"body {self.name!r}"
        vertices = as_points(self.vertices, f"{where}: vertices")
        faces = as_integers(self.faces, f"{where}: faces")
        if faces.ndim != 2 or faces.shape[1] != 3:
            raise RecordingError(f"{where}: faces must have shape (m, 3), got {faces.shape}")
        if len(vertices) == 0 or len(faces) == 0:
            raise RecordingError(
                f"{where}: nothing to show, {len(vertices)} vertices and {len(faces)} faces"
            )
        if faces.min() < 0 or faces.max() >= len(vertices):
            raise RecordingError(
                f"{where}: faces refer to vertices {faces.min()} to {faces.max()}, "
                f"but there are {len(vertices)}"
            )
        keep(self, "vertices", vertices)
        keep(self, "faces", faces)
        keep(self, "poses", _as_poses(self.poses, f"{where}: poses"))
        last = len(self.poses) - 1
        try:
            object.__setattr__(self, "start", as_integer(self.start, "start", 0, last))
        except SettingsError as error:
            raise RecordingError(f"{where}: {error}") from None
        if self.start:
            poses = self.poses.copy()
            poses[: self.start] = poses[self.start]
            keep(self, "poses", poses)
        if self.color is not None:
            try:
                object.__setattr__(self, "color", as_color(self.color, f"{where}: color"))
            except SettingsError as error:
                raise RecordingError(f"{error}; None lets the viewer choose") from None

    def __repr__(self) -> str:
        frames, faces = len(self.poses), len(self.faces)
        start = f", from frame {self.start} on" if self.start else ""
        return (
            f"BodyTrack({self.name!r}, {len(self.vertices)} vertices, "
            f"{faces} face{'' if faces == 1 else 's'}, "
            f"{frames} frame{'' if frames == 1 else 's'}{start}{', fixed' if self.fixed else ''})"
        )

    @property
    def frame_count(self) -> int:
        """Number of frames."""
        return len(self.poses)

    @property
    def fixed(self) -> bool:
        """True if the body has the same pose in every frame in which it is there."""
        return bool(np.all(self.poses == self.poses[0]))


def _as_poses(value: ArrayLike, what: str) -> NDArray[np.float64]:
    """Return a new (frames, 4, 4) array of rigid transforms."""
    try:
        poses = as_floats(read_poses(value, what), what)
    except PoseError as error:
        raise RecordingError(str(error)) from None
    if poses.ndim != 3 or poses.shape[1:] != (4, 4) or len(poses) == 0:
        raise RecordingError(f"{what} must have shape (frames, 4, 4), got {poses.shape}")
    rotations = poses[:, :3, :3]
    stretch = np.abs(rotations.transpose(0, 2, 1) @ rotations - np.eye(3)).max(axis=(1, 2))
    bottom = np.abs(poses[:, 3] - (0.0, 0.0, 0.0, 1.0)).max(axis=1)
    bad = (stretch > CORRECTED) | (bottom > 0.0) | (np.linalg.det(rotations) < 0.0)
    if bad.any():
        frame = int(np.argmax(bad))
        raise RecordingError(
            f"{what} must be rigid world_from_body matrices; {int(bad.sum())} of {len(poses)} are "
            f"not, first frame {frame}: rotation off by {stretch[frame]:.3g}, determinant "
            f"{np.linalg.det(rotations[frame]):.3g}, last row {poses[frame, 3].tolist()}"
        )
    try:
        return make_all_rigid(poses, what)
    except PoseError as error:
        raise RecordingError(str(error)) from None
