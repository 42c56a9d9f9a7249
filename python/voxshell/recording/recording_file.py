"""Files of recordings: numpy's .npz, with a header in JSON and the arrays as they are.

The header holds the format's version, the time step, and the name, color and first frame of each body. The arrays of
body i are ``body<i>_vertices``, ``body<i>_faces`` and ``body<i>_poses``, and those of the contacts ``contacts_points``
and so on. All of them are read without pickles, and checked as those of any recording are.
"""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.base.input_files import read_small_file
from voxshell.base.outputs import write_bytes
from voxshell.errors import MemoryLimitError, RecordingError
from voxshell.recording.body_track import BodyTrack
from voxshell.recording.contact_track import ContactTrack

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

SUFFIX = ".npz"
_FORMAT, _VERSION = "voxshell recording", 1
_ARCHIVE = b"PK"
"""First bytes of any file that :meth:`Recording.save` wrote."""

_MOST_BYTES = 4 << 30
"""Largest file, and largest sum of its arrays, that is read."""

_BODY = ("vertices", "faces", "poses")
_CONTACTS = ("offsets", "points", "normals", "depths", "forces")

_DAMAGED = (
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    KeyError,
    NotImplementedError,  # a compression that zipfile does not have
    RuntimeError,  # an encrypted file
    TypeError,
    ValueError,
    OSError,
)


def write_recording(
    path: Path, time_step: float, bodies: tuple[BodyTrack, ...], contacts: ContactTrack
) -> None:
    """Write a recording completely or not at all.

    Raises:
        SettingsError: No file can be written there.
        FileAccessError: The system refuses to write it.
    """
    header = {
        "format": _FORMAT,
        "version": _VERSION,
        "time_step": time_step,
        "bodies": [
            {"name": body.name, "color": body.color, "start": body.start} for body in bodies
        ],
    }
    arrays: dict[str, Any] = {
        "header": np.frombuffer(json.dumps(header).encode(), dtype=np.uint8),
        **{f"contacts_{name}": getattr(contacts, name) for name in _CONTACTS},
    }
    for index, body in enumerate(bodies):
        arrays |= {f"body{index}_{name}": getattr(body, name) for name in _BODY}
    content = io.BytesIO()
    np.savez_compressed(content, **arrays)
    write_bytes(path, content.getbuffer())


def read_recording(path: Path) -> tuple[float, tuple[BodyTrack, ...], ContactTrack]:
    """Return the time step, the bodies and the contacts of a file.

    Raises:
        MissingFileError: The file does not exist.
        FileAccessError: The system refuses to read it.
        SettingsError: It is a folder or a device.
        RecordingError: It is damaged, is not a recording, or has a version that this package does not read.
        MemoryLimitError: Its arrays have more than 4 GiB, or there is no memory for them.
    """
    content = read_small_file(path, _MOST_BYTES, "recording")
    try:
        arrays = _read_arrays(content, path)
        header = json.loads(arrays["header"].tobytes())
        if not isinstance(header, dict) or header.get("format") != _FORMAT:
            raise RecordingError("it is not a recording of voxshell")
        if header.get("version") != _VERSION:
            raise RecordingError(
                f"it has version {header.get('version')!r}; this package reads version {_VERSION}"
            )
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
    except MemoryError as error:
        raise MemoryLimitError(f"no memory left for the recording {path}") from error
    except MemoryLimitError:
        raise
    except _DAMAGED as error:
        raise RecordingError(
            f"cannot read the recording {path}: {_explain(error, content)}"
        ) from error


def _explain(error: Exception, content: bytes) -> str:
    """Return what is wrong with the content of a file."""
    if isinstance(error, zipfile.BadZipFile) and not content.startswith(_ARCHIVE):
        return f"it is not a recording ({SUFFIX})"
    return f"it has no {error}" if isinstance(error, KeyError) else str(error)


def _read_arrays(content: bytes, path: Path) -> Mapping[str, NDArray[Any]]:
    """Return all arrays of a file, whose sizes are checked first."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        size = sum(member.file_size for member in archive.infolist())
    if size > _MOST_BYTES:
        raise MemoryLimitError(
            f"{path} holds {size / 1e9:.3g} GB of arrays; at most {_MOST_BYTES / 1e9:.3g} GB are read"
        )
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        return {name: arrays[name] for name in arrays.files}
