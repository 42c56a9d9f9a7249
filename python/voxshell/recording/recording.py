"""Recordings: the motion of all bodies and the contacts of a simulation, step by step.

A recording is plain data in numpy arrays. Its methods that save or show it import the viewer, which
is optional, only when they are called.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from voxshell.base.arguments import as_flag, as_path, as_text
from voxshell.base.calls import check_options, explain_calls
from voxshell.base.notebook import make_frame, make_table
from voxshell.base.outputs import check_output_file, check_suffix
from voxshell.errors import MissingExtraError, RecordingError
from voxshell.recording.arrays import LARGEST
from voxshell.recording.body_track import BodyTrack
from voxshell.recording.contact_track import ContactTrack
from voxshell.recording.recording_file import SUFFIX, read_recording, write_recording

_MOST_SHOWN = 8_000_000
"""Largest replay in a notebook, bytes: the notebook stores it in its file."""
_MOST_RAW = 40_000_000
"""Largest uncompressed numbers of such a replay, bytes."""


@explain_calls
@dataclass(frozen=True, eq=False)
class Recording:
    """The motion of bodies and their contacts, at equal time steps.

    Args:
        time_step: Seconds between frames.
        bodies: At least one; all with the same number of frames and with unique names.
        contacts: As many frames as the bodies.

    Raises:
        RecordingError: The time step is not positive, numbers of frames differ, or names repeat.

    Example:
        >>> import numpy as np
        >>> from voxshell.recording import BodyTrack, ContactTrack, Recording
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
        if not 1.0 / LARGEST <= time_step <= LARGEST:
            raise RecordingError(
                f"time_step must be from {1.0 / LARGEST:g} to {LARGEST:g} s, got {time_step!r}"
            )
        bodies = tuple(self.bodies)
        if not bodies:
            raise RecordingError("a recording needs at least one body, got none")
        names = [body.name for body in bodies]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise RecordingError(f"{len(twice)} body name(s) are not unique: {twice}")
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

    def save(self, path: str | PathLike[str]) -> Path:
        """Write the recording to a file, which :meth:`load` reads; equal recordings give equal bytes.

        Args:
            path: The file, with the suffix .npz; written completely or not at all.

        Returns:
            The path of the file.

        Raises:
            SettingsError: The suffix is another one, or the path is a folder, a device or a pipe.
            FileAccessError: The file cannot be written, or its folder does not exist.
            InputTypeError: ``path`` is not a path.

        Example:
            >>> import tempfile
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ball = world.add(vx.Sphere(0.1), name="ball")
            >>> recorder = world.record(every=10)
            >>> world.step(100)
            >>> with tempfile.TemporaryDirectory() as folder:
            ...     path = recorder.recording().save(folder + "/fall.npz")
            ...     vx.Recording.load(path)
            Recording(1 body, 11 frames, 0.5 s, 0 contacts)
        """
        place = _as_place(path, (SUFFIX,), "a recording")
        write_recording(place, self.time_step, self.bodies, self.contacts)
        return place

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Recording:
        """Read a recording that :meth:`save` wrote.

        Args:
            path: The file's path.

        Returns:
            The recording, equal to the saved one in every bit.

        Raises:
            MissingFileError: The file does not exist.
            FileAccessError: The file cannot be read.
            RecordingError: It is damaged, is not a recording, or has another version.
            MemoryLimitError: Its arrays have more than 4 GiB, or there is no memory for them.
            SettingsError: It is a folder or a device.
            InputTypeError: ``path`` is not a path.

        Example:
            >>> import voxshell as vx
            >>> vx.Recording.load("pyproject.toml")
            Traceback (most recent call last):
            voxshell.errors.RecordingError: cannot read the recording pyproject.toml: it is not a recording (.npz)
        """
        return read_recording(Path(os.fsdecode(as_path(path, "path"))), cls)

    def save_html(
        self, path: str | PathLike[str], *, title: str = "Replay", label: str = "", **options: Any
    ) -> Path:
        """Write one offline page that replays the recording in a browser.

        Args:
            path: The file, with the suffix .html; written completely or not at all.
            title: Heading of the page.
            label: Caption below the bodies.
            **options: Passed to :func:`voxshell.viewer.replay.save_replay`, which can also show
                several recordings side by side.

        Returns:
            The path of the file.

        Raises:
            MissingExtraError: The viewer is not installed.
            InputTypeError: ``title`` or ``label`` is not a string, or there is no such option.
            SettingsError: The suffix is not .html, the path is a folder, a device or a pipe, or an
                option is invalid.
            FileAccessError: The file cannot be written, or its folder does not exist.
        """
        place = _as_place(path, (".html", ".htm"), "a replay")
        as_text(title, "title")
        as_text(label, "label")
        from voxshell.viewer.lanes import Lane
        from voxshell.viewer.replay import save_replay

        check_options("Recording.save_html", options, save_replay, ("title", "label"))
        return save_replay(place, [Lane(label, self)], title=title, **options)

    def __repr__(self) -> str:
        bodies, frames, contacts = len(self.bodies), self.frame_count, len(self.contacts.points)
        return (
            f"Recording({bodies} {'body' if bodies == 1 else 'bodies'}, "
            f"{frames} frame{'' if frames == 1 else 's'}, {self.duration:.6g} s, "
            f"{contacts} contact{'' if contacts == 1 else 's'})"
        )

    def _repr_html_(self) -> str:
        """Return a table of facts for notebooks, and the replay if it can be shown and is small."""
        moving = sum(not body.fixed for body in self.bodies)
        facts = {
            "time": f"{self.duration:.6g} s, {self.frame_count:,} frames, {1e3 * self.time_step:.4g} ms apart",
            "bodies": f"{len(self.bodies):,}, moving: {moving:,}",
            "contacts": f"{len(self.contacts.points):,}, at most {int(self.contacts.counts.max()):,} at a time",
        }
        page = self._make_small_page()
        if isinstance(page, str):
            facts["replay"] = page
            return make_table("Recording", facts)
        return make_table("Recording", facts) + make_frame(page.decode(), 480)

    def _make_small_page(self) -> bytes | str:
        """Return the replay, UTF-8; or a text with a remedy if there is none to show."""
        numbers = sum(body.vertices.size + body.faces.size for body in self.bodies)
        numbers += 7 * len(self.bodies) * self.frame_count
        if 4 * numbers > _MOST_RAW:  # check before making the page, which would take long
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
        """Write a video of the bodies and their contacts: an MP4 file (H.264), or an animated GIF.

        Args:
            path: The file, with the suffix .mp4 or .gif; written completely or not at all.
            **options: Passed to :func:`voxshell.viewer.video.save_video`: ``size`` in pixels,
                ``frames_per_second``, ``speed``, ``up``, ``title`` and ``progress``.

        Returns:
            The path of the file.

        Raises:
            MissingExtraError: The renderer is not installed: ``pip install 'voxshell[video]'``.
            SettingsError: The suffix is another one, no file can be written there, or an option is
                out of range.
            FileAccessError: The file cannot be written.
        """
        place = _as_place(path, (".mp4", ".gif"), "a video")
        from voxshell.viewer.video import save_video

        check_options("Recording.save_video", options, save_video, ())
        return save_video(place, self, **options)

    def save_gltf(
        self, path: str | PathLike[str], *, up: str = "+z", contacts: bool = True
    ) -> Path:
        """Write the bodies and their motion as binary glTF for Blender, three.js, Unity and others.

        Each body becomes a node with a mesh, a color and an animation with a key for each frame.
        Contacts are balls in four colors of depth, and arrows along the normal forces on the moving
        body, at most 100 of each in a frame.

        Args:
            path: The file, with the suffix .glb; written completely or not at all.
            up: The world axis that points up, such as "+z" or "+y". In glTF, +Y points up: the root
                node rotates the scene.
            contacts: Add contacts and forces.

        Returns:
            The path of the file.

        Raises:
            SettingsError: The suffix is another one, ``up`` is not an axis, or no file can be
                written there.
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
        as_flag(contacts, "contacts")
        from voxshell.viewer.gltf import save_gltf

        return save_gltf(place, self, up=up, contacts=contacts)

    def save_usd(self, path: str | PathLike[str], *, up: str = "+z", contacts: bool = True) -> Path:
        """Write the bodies and their motion as Universal Scene Description (USD).

        Each body becomes a mesh with a color, and a position and an orientation for each frame. The
        stage is in meters. Contacts are points, colored by depth, and their normal forces on the
        moving body are lines.

        Args:
            path: The file: .usda is text, .usdc and .usd are binary; written completely or not at
                all.
            up: The world axis that points up, "+z" or "+y".
            contacts: Add contacts and forces.

        Returns:
            The path of the file.

        Raises:
            MissingExtraError: usd-core is not installed: ``pip install 'voxshell[usd]'``.
            SettingsError: The suffix is another one, no file can be written there, or ``up`` is
                another axis.
            FileAccessError: The file cannot be written.
        """
        place = _as_place(path, (".usdc", ".usda", ".usd"), "an animation for USD")
        as_flag(contacts, "contacts")
        from voxshell.viewer.usd import save_usd

        return save_usd(place, self, up=up, contacts=contacts)


def _as_place(path: str | PathLike[str], suffixes: Sequence[str], what: str) -> Path:
    """Return a path that can be written and has a matching suffix."""
    place = Path(os.fsdecode(as_path(path, "path")))
    check_output_file(place)
    check_suffix(place, suffixes, what)
    return place
