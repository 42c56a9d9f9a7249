"""Recording of a world's motion and contacts."""

from __future__ import annotations

import mmap
import threading
from collections import Counter
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from voxshell.base.calls import explain_calls
from voxshell.base.near_names import suggest_on_set
from voxshell.errors import InputTypeError, MemoryLimitError
from voxshell.recording import BodyTrack, ContactTrack, Recording
from voxshell.simulation.body_colors import as_body_colors
from voxshell.simulation.body_shapes import mesh_of
from voxshell.simulation.tables import as_contacts, compute_forces

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from os import PathLike
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell import _bullet
    from voxshell.simulation.body import Body


_SPARE, _SPARE_OF_BODY = 4 << 20, 1 << 10
"""Bytes that must be free before a frame is taken: where nanobind finds no memory for a small array,
it ends the process."""


@explain_calls
@suggest_on_set
class Recorder:
    """Poses and contacts of a world, step by step; made by :meth:`voxshell.World.record`.

    It records until :meth:`stop`, until the end of a ``with`` block, or until nothing refers to it
    any more. Bodies that are added meanwhile are in the recording from the next frame on, and
    removed bodies stay at their last pose.

    Example:
        >>> import voxshell as vx
        >>> world = vx.World()
        >>> ball = world.add(vx.Sphere(0.1))
        >>> with world.record() as recorder:
        ...     world.step(10)
        >>> world.step(100)
        >>> recorder.recording().frame_count
        11
    """

    __slots__ = (
        "__weakref__",
        "_bodies",
        "_contacts",
        "_every",
        "_forces",
        "_lock",
        "_poses",
        "_simulation",
        "_steps",
        "_stopped",
        "_time_step",
    )

    def __init__(
        self,
        simulation: _bullet.Simulation,
        time_step: float,
        bodies: Sequence[Body],
        every: int,
    ) -> None:
        # Do not store the world, so that its recorders do not keep it alive.
        self._simulation = simulation
        self._time_step = time_step
        self._bodies = bodies  # of the world, which goes on changing them
        self._every = every
        self._steps = 0
        self._stopped = False
        # The poses of each body from the frame on in which it is there first.
        self._poses: dict[Body, list[NDArray[np.float64]]] = {}
        self._contacts: list[NDArray[np.void]] = []
        self._forces: list[NDArray[np.float64]] = []
        # One thread may step the world while another one reads what is recorded.
        self._lock = threading.Lock()
        self._take_frame()

    def take(self) -> None:
        """Record one step; the world calls this."""
        self._steps += 1
        if self._steps % self._every == 0:
            self._take_frame()

    def stop(self) -> None:
        """Stop recording; what has been recorded stays. Further calls do nothing."""
        self._stopped = True

    @property
    def stopped(self) -> bool:
        """True after :meth:`stop`."""
        return self._stopped

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def recording(self, *, colors: Mapping[Body, tuple[int, int, int]] | None = None) -> Recording:
        """Return what has been recorded so far as plain data.

        Args:
            colors: Red, green and blue, 0 to 255, of bodies, as in :attr:`Robot.colors`; the viewer
                chooses the other colors.

        Raises:
            RecordingError: The world had no body in any frame.
            InputTypeError: ``colors`` does not map bodies to colors.
            SettingsError: A color is not three integers from 0 to 255.
        """
        chosen = as_body_colors(colors)
        with self._lock:
            poses_of = {body: list(known) for body, known in self._poses.items()}
            contacts_of, forces_of = list(self._contacts), list(self._forces)
        bodies_of = Counter(body.name for body in poses_of)
        tracks = []
        for body, known in poses_of.items():
            mesh = mesh_of(body.shape)
            faces = mesh.faces.astype(np.int64)
            name = body.name if bodies_of[body.name] == 1 else f"{body.name} ({body.number})"
            start = len(contacts_of) - len(known)
            poses = np.array([known[0]] * start + known)
            tracks.append(BodyTrack(name, mesh.vertices, faces, chosen.get(body), poses, start))
        contacts = ContactTrack.from_frames(
            [
                (frame["point_b"], frame["normal"], frame["depth"], forces)
                for frame, forces in zip(contacts_of, forces_of, strict=True)
            ]
        )
        return Recording(self._every * self._time_step, tuple(tracks), contacts)

    def save_html(
        self,
        path: str | PathLike[str],
        *,
        colors: Mapping[Body, tuple[int, int, int]] | None = None,
        **options: Any,
    ) -> Path:
        """Write the recording so far as one offline page; see :meth:`Recording.save_html`.

        Args:
            path: The page's path.
            colors: As for :meth:`recording`.
            options: As for :meth:`Recording.save_html`.
        """
        return self.recording(colors=colors).save_html(path, **options)

    def save_video(
        self,
        path: str | PathLike[str],
        *,
        colors: Mapping[Body, tuple[int, int, int]] | None = None,
        **options: Any,
    ) -> Path:
        """Write the recording so far as a video; see :meth:`Recording.save_video`.

        Args:
            path: The file's path.
            colors: As for :meth:`recording`.
            options: As for :meth:`Recording.save_video`.
        """
        return self.recording(colors=colors).save_video(path, **options)

    def save_gltf(
        self,
        path: str | PathLike[str],
        *,
        colors: Mapping[Body, tuple[int, int, int]] | None = None,
        **options: Any,
    ) -> Path:
        """Write the recording so far as binary glTF; see :meth:`Recording.save_gltf`.

        Args:
            path: The file's path.
            colors: As for :meth:`recording`.
            options: As for :meth:`Recording.save_gltf`.
        """
        return self.recording(colors=colors).save_gltf(path, **options)

    def save_usd(
        self,
        path: str | PathLike[str],
        *,
        colors: Mapping[Body, tuple[int, int, int]] | None = None,
        **options: Any,
    ) -> Path:
        """Write the recording so far as Universal Scene Description; see :meth:`Recording.save_usd`.

        Args:
            path: The file's path.
            colors: As for :meth:`recording`.
            options: As for :meth:`Recording.save_usd`.
        """
        return self.recording(colors=colors).save_usd(path, **options)

    def __reduce__(self) -> NoReturn:
        raise InputTypeError(
            "a Recorder cannot be copied or pickled, because it belongs to a world: pass its recording()"
        )

    def __repr__(self) -> str:
        frames, bodies = len(self._contacts), len(self._poses)
        return (
            f"Recorder(frames={frames}, bodies={bodies}, time_step={self._every * self._time_step:.6g} s"
            f"{', stopped' if self.stopped else ''})"
        )

    def _take_frame(self) -> None:
        _check_memory(_SPARE + _SPARE_OF_BODY * len(self._poses))
        # Other threads may add and remove bodies meanwhile.
        present = {body: body.pose for body in tuple(self._bodies) if not body.removed}
        contacts = as_contacts(self._simulation.contacts())
        with self._lock:
            for body in present:
                self._poses.setdefault(body, [])
            for body, known in self._poses.items():
                known.append(present[body] if body in present else known[-1])
            dynamic = [body.number for body in self._poses if body.motion == "dynamic"]
            self._contacts.append(contacts)
            self._forces.append(compute_forces(contacts, dynamic, self._time_step))


def _check_memory(size: int) -> None:
    """Raise MemoryLimitError if the system does not have as many bytes."""
    try:
        mmap.mmap(-1, size).close()
    except OSError as error:
        raise MemoryLimitError("no memory left to record another frame") from error
