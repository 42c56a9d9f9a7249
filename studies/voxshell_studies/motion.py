"""Recordings as tables, which are stored with a part's data and replayed later."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from voxshell.recording import BodyTrack, ContactTrack, Recording

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray
    from voxshell.model.meshes import Mesh

    from voxshell_studies.part import Tables

Surface: TypeAlias = "tuple[Mesh, tuple[int, int, int] | None]"
"""Triangles in the body's frame, and their color."""

_ENTRIES = [f"{row}{column}" for row in "xyz" for column in "xyzt"]
"""Names of the upper three rows of world_from_body."""


def tabulate(recording: Recording) -> Tables:
    """Return poses and contacts of every frame as tables, without surfaces.

    Returns:
        "poses": body, frame, and the entries of world_from_body: "xy" is row x, column y, "xt" the
        place along x. "contacts": frame, place, normal, depth. Meters, world frame.
    """
    frames = recording.frame_count
    rows = np.concatenate([body.poses[:, :3, :].reshape(frames, 12) for body in recording.bodies])
    names = np.repeat([body.name for body in recording.bodies], frames)
    contacts = recording.contacts
    return {
        "poses": {
            "body": names,
            "frame": np.tile(np.arange(frames), len(recording.bodies)),
            **{entry: rows[:, i] for i, entry in enumerate(_ENTRIES)},
        },
        "contacts": {
            "frame": np.repeat(np.arange(frames), contacts.counts),
            **{axis: contacts.points[:, i] for i, axis in enumerate("xyz")},
            **{f"normal_{axis}": contacts.normals[:, i] for i, axis in enumerate("xyz")},
            "depth": contacts.depths,
        },
    }


def read_poses(tables: Tables, body: str) -> NDArray[np.float64]:
    """Return the body's poses, (frames, 4, 4) world_from_body."""
    table = tables["poses"]
    mine = table["body"] == body
    poses = np.tile(np.eye(4), (int(mine.sum()), 1, 1))
    poses[:, :3, :] = np.stack([table[entry][mine] for entry in _ENTRIES], axis=1).reshape(-1, 3, 4)
    return poses


def restore(tables: Tables, surfaces: Mapping[str, Surface], time_step: float) -> Recording:
    """Return the recording that :func:`tabulate` stored, for the bodies with a surface.

    Args:
        tables: The part's tables.
        surfaces: Surfaces by the body's name.
        time_step: Seconds between frames.
    """
    bodies = tuple(
        BodyTrack(name, mesh.vertices, mesh.faces.astype(np.int64), color, read_poses(tables, name))
        for name, (mesh, color) in surfaces.items()
    )
    contacts = tables["contacts"]
    counts = np.bincount(contacts["frame"], minlength=bodies[0].frame_count)
    return Recording(
        time_step,
        bodies,
        ContactTrack(
            np.concatenate([[0], np.cumsum(counts)]),
            np.stack([contacts[axis] for axis in "xyz"], axis=1),
            np.stack([contacts[f"normal_{axis}"] for axis in "xyz"], axis=1),
            contacts["depth"],
        ),
    )
