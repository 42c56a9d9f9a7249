"""Files of recordings.

The header holds the time step, and the name, color and first frame of each body. The arrays of body i are
``body<i>_vertices``, ``body<i>_faces`` and ``body<i>_poses``, and those of the contacts ``contacts_points`` and so
on. All of them are checked as those of any recording are.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from voxshell.base.array_file import SUFFIX, FileKind
from voxshell.errors import RecordingError
from voxshell.recording.body_track import BodyTrack
from voxshell.recording.contact_track import ContactTrack

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

Made = TypeVar("Made")

__all__ = ["SUFFIX", "read_recording", "write_recording"]

_KIND = FileKind("recording", 1, RecordingError)
_BODY = ("vertices", "faces", "poses")
_CONTACTS = ("offsets", "points", "normals", "depths", "forces")


def write_recording(
    path: Path, time_step: float, bodies: tuple[BodyTrack, ...], contacts: ContactTrack
) -> None:
    """Write a recording completely or not at all.

    Raises:
        SettingsError: No file can be written there.
        FileAccessError: The system refuses to write it.
    """
    header = {
        "time_step": time_step,
        "bodies": [
            {"name": body.name, "color": body.color, "start": body.start} for body in bodies
        ],
    }
    arrays: dict[str, Any] = {f"contacts_{name}": getattr(contacts, name) for name in _CONTACTS}
    for index, body in enumerate(bodies):
        arrays |= {f"body{index}_{name}": getattr(body, name) for name in _BODY}
    _KIND.write(path, header, arrays)


def read_recording(
    path: Path, make: Callable[[float, tuple[BodyTrack, ...], ContactTrack], Made]
) -> Made:
    """Return what is made of the time step, the bodies and the contacts of a file.

    Args:
        path: The file.
        make: Checks that they fit together: its ValueError, such as RecordingError, means that the file is damaged.

    Raises:
        MissingFileError: The file does not exist.
        FileAccessError: The system refuses to read it.
        SettingsError: It is a folder or a device.
        RecordingError: It is damaged, is not a recording, or has a version that this package does not read.
        MemoryLimitError: Its arrays have more than 4 GiB, or there is no memory for them.
    """
    return _KIND.read(path, lambda header, arrays: make(*_make_parts(header, arrays)))


def _make_parts(
    header: dict[str, Any], arrays: Mapping[str, NDArray[Any]]
) -> tuple[float, tuple[BodyTrack, ...], ContactTrack]:
    bodies = tuple(
        BodyTrack(
            body["name"],
            arrays[f"body{index}_vertices"],
            arrays[f"body{index}_faces"],
            body["color"],
            arrays[f"body{index}_poses"],
            body["start"],
        )
        for index, body in enumerate(header["bodies"])
    )
    contacts = ContactTrack(*(arrays[f"contacts_{name}"] for name in _CONTACTS))
    return float(header["time_step"]), bodies, contacts
