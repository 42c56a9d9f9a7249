"""Recordings: what every body and contact of a simulation did, step by step.

A recording is plain data in numpy arrays. It knows nothing of how it is shown;
:meth:`Recording.save_html` hands it to the viewer, which is an optional part.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voxshell.base.arguments import as_path
from voxshell.base.notebook import make_frame, make_table
from voxshell.base.outputs import check_output_file, check_suffix
from voxshell.base.pose_forms import make_all_rigid, read_poses
from voxshell.base.rotations import CORRECTED
from voxshell.errors import MissingExtraError, PoseError, RecordingError

_UNIT_TOLERANCE = 1e-3
_MOST_SHOWN = 8_000_000
"""Bytes of a replay in a notebook, which keeps it in its file."""
_MOST_RAW = 40_000_000
"""Bytes of the numbers of such a replay before they are packed."""


@dataclass(frozen=True, eq=False)
class BodyTrack:
    """One body's surface and its pose in every frame.

    Args:
        name: Unique within its recording.
        vertices: (n, 3) float, metres, body frame.
        faces: (m, 3) int, indices of vertices, outward counter-clockwise.
        color: (red, green, blue), each 0 to 255; None lets the viewer choose.
        poses: ``world_from_body`` of each frame: (frames, 4, 4), (frames, 3) or (frames, 7) float64, or
            another form of many poses that :func:`voxshell.pose` lists. Stored as (frames, 4, 4).

    Raises:
        RecordingError: If a shape is wrong, a number is not finite, a face names a vertex that is
            not there, or a pose is not rigid.

    Arrays are copied, and the copies are read-only.

    Example:
        >>> import numpy as np
        >>> track = BodyTrack("flag", np.eye(3), [[0, 1, 2]], None, np.eye(4)[None])
        >>> track.frame_count
        1
        >>> BodyTrack("flag", np.eye(3), [[0, 1, 3]], None, np.eye(4)[None])
        Traceback (most recent call last):
        voxshell.errors.RecordingError: body 'flag': faces name vertices 0 to 3, but there are 3
    """

    name: str
    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    color: tuple[int, int, int] | None
    poses: NDArray[np.float64]

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.strip():
            raise RecordingError(f"a body needs a name, got {self.name!r}")
        where = f"body {self.name!r}"
        vertices = _as_points(self.vertices, f"{where}: vertices")
        faces = _as_integers(self.faces, f"{where}: faces")
        if faces.ndim != 2 or faces.shape[1] != 3:
            raise RecordingError(f"{where}: faces must have shape (m, 3), got {faces.shape}")
        if len(vertices) == 0 or len(faces) == 0:
            raise RecordingError(
                f"{where}: nothing to show, {len(vertices)} vertices and {len(faces)} faces"
            )
        if faces.min() < 0 or faces.max() >= len(vertices):
            raise RecordingError(
                f"{where}: faces name vertices {faces.min()} to {faces.max()}, "
                f"but there are {len(vertices)}"
            )
        _keep(self, "vertices", vertices)
        _keep(self, "faces", faces)
        _keep(self, "poses", _as_poses(self.poses, f"{where}: poses"))
        object.__setattr__(self, "color", _as_color(self.color, f"{where}: color"))

    @property
    def frame_count(self) -> int:
        """Number of frames."""
        return len(self.poses)

    @property
    def fixed(self) -> bool:
        """Whether the body has the same pose in every frame."""
        return bool(np.all(self.poses == self.poses[0]))


@dataclass(frozen=True, eq=False)
class ContactTrack:
    """The contacts of every frame, concatenated; frame i holds offsets[i] to offsets[i + 1].

    Args:
        offsets: (frames + 1,) int, from 0 to k, never falling.
        points: (k, 3) float, metres, world frame.
        normals: (k, 3) float, unit length, world frame, on body b, pointing towards body a.
        depths: (k,) float, metres, positive where the bodies overlap.

    Raises:
        RecordingError: If the lengths disagree, a number is not finite, or a normal is not unit.

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

    def __post_init__(self) -> None:
        offsets = _as_integers(self.offsets, "contacts: offsets")
        points = _as_points(self.points, "contacts: points")
        normals = _as_points(self.normals, "contacts: normals")
        depths = _as_floats(self.depths, "contacts: depths").reshape(-1)
        if offsets.ndim != 1 or len(offsets) < 2:
            raise RecordingError(
                f"contacts: offsets must have shape (frames + 1,), got {offsets.shape}"
            )
        if not len(points) == len(normals) == len(depths):
            raise RecordingError(
                f"contacts: {len(points)} points, {len(normals)} normals and {len(depths)} depths"
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
                f"contacts: offsets fall from {offsets[frame]} to {offsets[frame + 1]} "
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
        _keep(self, "offsets", offsets)
        _keep(self, "points", points)
        _keep(self, "normals", normals)
        _keep(self, "depths", depths)

    @classmethod
    def empty(cls, frames: int) -> ContactTrack:
        """No contact in any of ``frames`` frames.

        Example:
            >>> ContactTrack.empty(3).counts
            array([0, 0, 0])
        """
        nothing = np.zeros((0, 3))
        return cls(np.zeros(frames + 1, dtype=np.int64), nothing, nothing, np.zeros(0))

    @classmethod
    def from_frames(cls, frames: Sequence[tuple[ArrayLike, ArrayLike, ArrayLike]]) -> ContactTrack:
        """Concatenates the contacts of single frames.

        Args:
            frames: For each frame its points (k, 3), normals (k, 3) and depths (k,), in the
                units and frame of the class; k differs from frame to frame and may be 0.

        Raises:
            RecordingError: As for the class.
        """
        points = [_as_points(frame[0], "contacts: points") for frame in frames]
        normals = [_as_points(frame[1], "contacts: normals") for frame in frames]
        depths = [_as_floats(frame[2], "contacts: depths").reshape(-1) for frame in frames]
        for index, (p, n, d) in enumerate(zip(points, normals, depths, strict=True)):
            if not len(p) == len(n) == len(d):
                raise RecordingError(
                    f"contacts: frame {index} has {len(p)} points, {len(n)} normals "
                    f"and {len(d)} depths"
                )
        if not frames:
            raise RecordingError("contacts: a recording needs at least one frame, got none")
        offsets = np.concatenate([[0], np.cumsum([len(p) for p in points])])
        return cls(offsets, np.concatenate(points), np.concatenate(normals), np.concatenate(depths))

    @property
    def frame_count(self) -> int:
        """Number of frames."""
        return len(self.offsets) - 1

    @property
    def counts(self) -> NDArray[np.int64]:
        """(frames,) number of contacts in each frame."""
        return np.diff(self.offsets)

    def frame(self, index: int) -> ContactTrack:
        """The contacts of one frame, as a track of one frame.

        Raises:
            IndexError: If there is no such frame.
        """
        if not 0 <= index < self.frame_count:
            raise IndexError(f"frame {index} of {self.frame_count}")
        part = slice(int(self.offsets[index]), int(self.offsets[index + 1]))
        points = self.points[part]
        return ContactTrack(
            np.array([0, len(points)]), points, self.normals[part], self.depths[part]
        )


@dataclass(frozen=True, eq=False)
class Recording:
    """What every body and contact did, at equal time steps.

    Args:
        time_step: Seconds between frames.
        bodies: At least one; all with the same number of frames, and names of their own.
        contacts: As many frames as the bodies.

    Raises:
        RecordingError: If the time step is not positive, or numbers of frames or names clash.

    Example:
        >>> import numpy as np
        >>> poses = np.tile(np.eye(4), (3, 1, 1))
        >>> poses[:, 2, 3] = [0.3, 0.2, 0.1]
        >>> body = BodyTrack("flag", np.eye(3), [[0, 1, 2]], (90, 140, 210), poses)
        >>> recording = Recording(0.005, (body,), ContactTrack.empty(3))
        >>> recording.frame_count, recording.duration
        (3, 0.01)
    """

    time_step: float
    bodies: tuple[BodyTrack, ...]
    contacts: ContactTrack

    def __post_init__(self) -> None:
        time_step = float(self.time_step)
        if not (np.isfinite(time_step) and time_step > 0.0):
            raise RecordingError(f"time_step must be positive seconds, got {self.time_step!r}")
        bodies = tuple(self.bodies)
        if not bodies:
            raise RecordingError("a recording needs at least one body, got none")
        names = [body.name for body in bodies]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise RecordingError(f"{len(twice)} body name(s) used more than once: {twice}")
        frames = bodies[0].frame_count
        for body in bodies:
            if body.frame_count != frames:
                raise RecordingError(
                    f"body {body.name!r} has {body.frame_count} frames, "
                    f"body {names[0]!r} has {frames}"
                )
        if self.contacts.frame_count != frames:
            raise RecordingError(
                f"contacts have {self.contacts.frame_count} frames, the bodies have {frames}"
            )
        object.__setattr__(self, "time_step", time_step)
        object.__setattr__(self, "bodies", bodies)

    @property
    def frame_count(self) -> int:
        """Number of frames."""
        return self.contacts.frame_count

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (self.frame_count - 1) * self.time_step

    def save_html(
        self, path: str | PathLike[str], *, title: str = "Replay", label: str = "", **options: Any
    ) -> Path:
        """Writes one offline page that replays the recording in a browser.

        Args:
            path: The file to write, ending in .html; replaced whole or not at all.
            title: Heading of the page.
            label: Caption under the bodies.
            **options: Passed on to :func:`voxshell.viewer.replay.save_replay`, which also shows
                several recordings side by side.

        Returns:
            The path written.

        Raises:
            MissingExtraError: If the viewer is not installed.
            RecordingError: If an option makes no sense.
            SettingsError: If the path ends in anything but .html, is a folder, a device or a pipe, or there is no
                folder to write into.
            FileAccessError: If the file cannot be written.
        """
        place = _as_place(path, (".html", ".htm"), "a replay")
        from voxshell.viewer.lanes import Lane
        from voxshell.viewer.replay import save_replay

        return save_replay(place, [Lane(label, self)], title=title, **options)

    def __repr__(self) -> str:
        return (
            f"Recording({len(self.bodies)} bodies, {self.frame_count} frames, {self.duration:.6g} s, "
            f"{len(self.contacts.points)} contacts)"
        )

    def _repr_html_(self) -> str:
        """For notebooks: a table of facts, and the replay where the viewer is installed and the page is small."""
        moving = sum(not body.fixed for body in self.bodies)
        facts = {
            "time": f"{self.duration:.6g} s, {self.frame_count:,} frames, {1e3 * self.time_step:.4g} ms apart",
            "bodies": f"{len(self.bodies):,}, of which {moving:,} move",
            "contacts": f"{len(self.contacts.points):,}, at most {int(self.contacts.counts.max()):,} at a time",
        }
        page = self._make_small_page()
        if isinstance(page, str):
            facts["replay"] = page
            return make_table("Recording", facts)
        return make_table("Recording", facts) + make_frame(page.decode(), 480)

    def _make_small_page(self) -> bytes | str:
        """The replay, UTF-8; or, where there is none to show, what to do instead."""
        numbers = sum(body.vertices.size + body.faces.size for body in self.bodies)
        numbers += 7 * len(self.bodies) * self.frame_count
        if 4 * numbers > _MOST_RAW:  # before the page is made, which would take long
            return "too large to show here: call save_html('replay.html') and open that file"
        try:
            from voxshell.viewer.lanes import Lane
            from voxshell.viewer.replay import make_replay

            page = make_replay([Lane("", self)], title="Replay").encode()
        except MissingExtraError:
            return "needs the viewer: pip install 'voxshell[viewer]'"
        if len(page) > _MOST_SHOWN:
            return (
                f"{len(page) / 1e6:.1f} MB, too large to show here: call save_html('replay.html') and open "
                "that file"
            )
        return page

    def save_video(self, path: str | PathLike[str], **options: Any) -> Path:
        """Writes a video of the bodies and their contacts: an MP4 file (H.264), or an animated GIF.

        Args:
            path: The file to write, ending in .mp4 or .gif; replaced whole or not at all.
            **options: Passed on to :func:`voxshell.viewer.video.save_video`: size in pixels, pictures a second,
                speed, camera and title.

        Returns:
            The path written.

        Raises:
            MissingExtraError: The renderer is not installed: ``pip install 'voxshell[video]'``.
            SettingsError: The path ends otherwise, no file can be written there, or an option is out of range.
            FileAccessError: The file cannot be written.
        """
        place = _as_place(path, (".mp4", ".gif"), "a video")
        from voxshell.viewer.video import save_video

        return save_video(place, self, **options)

    def save_gltf(self, path: str | PathLike[str], *, up: str = "+z") -> Path:
        """Writes the bodies and their motion as binary glTF, which Blender, three.js, Unity and others read.

        Each body is a node with a mesh, a color and an animation with a key for each frame. Contacts are not written.

        Args:
            path: The file to write, ending in .glb; replaced whole or not at all.
            up: The world axis that points up, such as "+z" or "+y". In glTF +Y is up: a node at the root turns the
                scene.

        Returns:
            The path written.

        Raises:
            SettingsError: The path ends otherwise, or no file can be written there.
            RecordingError: ``up`` is no axis.
            FileAccessError: The file cannot be written.

        Example:
            >>> import tempfile
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ball = world.add(vx.Sphere(0.1), name="ball")
            >>> recorder = world.record(every=10)
            >>> world.step(100)
            >>> with tempfile.TemporaryDirectory() as folder:
            ...     recorder.recording().save_gltf(folder + "/fall.glb").name
            'fall.glb'
        """
        place = _as_place(path, (".glb",), "an animation for glTF")
        from voxshell.viewer.gltf import save_gltf

        return save_gltf(place, self, up=up)

    def save_usd(self, path: str | PathLike[str], *, up: str = "+z") -> Path:
        """Writes the bodies and their motion as Universal Scene Description, which Omniverse, Blender and others read.

        Each body is a mesh with a color, and a position and an orientation for each frame. The stage is in meters.
        Contacts are not written.

        Args:
            path: The file to write: .usda is text, .usdc and .usd are binary; replaced whole or not at all.
            up: The world axis that points up, "+z" or "+y".

        Returns:
            The path written.

        Raises:
            MissingExtraError: usd-core is not installed: ``pip install 'voxshell[usd]'``.
            SettingsError: The path ends otherwise, no file can be written there, or ``up`` is another axis.
            FileAccessError: The file cannot be written.
        """
        place = _as_place(path, (".usdc", ".usda", ".usd"), "an animation for USD")
        from voxshell.viewer.usd import save_usd

        return save_usd(place, self, up=up)


def _as_place(path: str | PathLike[str], suffixes: Sequence[str], what: str) -> Path:
    """A file that can be written and is named after what is in it."""
    place = Path(os.fsdecode(as_path(path, "path")))
    check_output_file(place)
    check_suffix(place, suffixes, what)
    return place


def _keep(owner: object, name: str, array: NDArray[Any]) -> None:
    """Stores a read-only array in a frozen dataclass."""
    array.flags.writeable = False
    object.__setattr__(owner, name, array)


def _as_floats(value: ArrayLike, what: str) -> NDArray[np.float64]:
    """A new float64 array of finite numbers, or an error that says how many are not."""
    try:
        array = np.array(value, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise RecordingError(f"{what} must be numbers: {error}") from error
    bad = int(np.sum(~np.isfinite(array)))
    if bad:
        raise RecordingError(f"{what} hold {bad} of {array.size} numbers that are not finite")
    return array


def _as_points(value: ArrayLike, what: str) -> NDArray[np.float64]:
    """A new (n, 3) array; an empty list counts as (0, 3)."""
    array = _as_floats(value, what)
    if array.size == 0:
        return np.zeros((0, 3))
    if array.ndim != 2 or array.shape[1] != 3:
        raise RecordingError(f"{what} must have shape (n, 3), got {array.shape}")
    return array


def _as_integers(value: ArrayLike, what: str) -> NDArray[np.int64]:
    """A new int64 array; floats are refused rather than rounded."""
    array = np.asarray(value)
    if array.size and not np.issubdtype(array.dtype, np.integer):
        raise RecordingError(f"{what} must be integers, got {array.dtype}")
    return np.array(array, dtype=np.int64, order="C")


def _as_poses(value: ArrayLike, what: str) -> NDArray[np.float64]:
    """A new (frames, 4, 4) array of rigid transforms."""
    try:
        poses = _as_floats(read_poses(value, what), what)
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


def _as_color(value: Sequence[int] | None, what: str) -> tuple[int, int, int] | None:
    """Three integers 0 to 255, or None."""
    if value is None:
        return None
    try:
        color = tuple(int(channel) for channel in value)
        same = all(a == b for a, b in zip(color, value, strict=True))
    except (TypeError, ValueError):
        color, same = (), False
    if not same or len(color) != 3 or not all(0 <= channel <= 255 for channel in color):
        raise RecordingError(f"{what} must be three integers from 0 to 255 or None, got {value!r}")
    return color[0], color[1], color[2]
