"""Where the bodies of an inspector begin, and from where they are seen."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from voxshell.model.shapes import Plane
from voxshell.simulation.body_shapes import mesh_of
from voxshell.viewer.stage import VIEW_ASPECT, Camera, place_camera

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.model.meshes import Mesh
    from voxshell.query.pairs import Collidable

_PLANE_DRAWN = 1.5
"""Side of the plate that represents a plane, in diagonals of the model."""

_BESIDE = 0.8
"""Room for the controls at the right side, in widths of what is seen: enough for a window of 760 pixels."""

_LIVE_ASPECT = 4.0 / 3.0
"""Narrowest window, width over height, in which the page with controls shows everything at first."""


class Partner(NamedTuple):
    """The second body at the beginning; lengths in meters.

    Args:
        mesh: What is drawn, in the frame of the body.
        pose: ``model_from_other``, (4, 4).
        grip: (3,) place of the handle, in the frame of the body.
        low: (3,) of the box around both bodies, in the frame of the model.
        high: (3,) of that box.
    """

    mesh: Mesh
    pose: NDArray[np.float64]
    grip: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


def place_partner(
    other: Collidable, bounds: NDArray[np.float64], pose: NDArray[np.float64] | None
) -> Partner:
    """Return the second body, beside the model unless it has a pose.

    Args:
        other: The body.
        bounds: (2, 3) low and high of the model, meters.
        pose: ``model_from_other``, (4, 4), or None.
    """
    mesh = mesh_of(other)  # pyright: ignore[reportArgumentType]: every shape that there is
    low, high = bounds
    start = np.eye(4) if pose is None else pose
    if isinstance(other, Plane):
        # The plate has the size of the scene: the whole plane would hide it.
        middle = mesh.vertices.mean(axis=0)
        side = _PLANE_DRAWN * float(np.linalg.norm(high - low))
        surface = other.offset * other.normal
        factor = side / np.ptp(mesh.vertices, axis=0).max()
        mesh = mesh._replace(vertices=surface + factor * (mesh.vertices - middle))
        # In the direction of a corner, the model and the controls leave space.
        corner = mesh.vertices[np.argmax(mesh.vertices @ (-1.0, -1.0, 1.0))]
        grip = surface + 0.6 * (corner - surface)
        seen = np.stack([low, high, start[:3, :3] @ grip + start[:3, 3]])
    else:
        if pose is None:
            start[0, 3] = high[0] - mesh.vertices[:, 0].min()
        grip = 0.5 * (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0))
        seen = np.stack([low, high, *(mesh.vertices @ start[:3, :3].T + start[:3, 3])])
    return Partner(mesh, start, grip, seen.min(axis=0), seen.max(axis=0))


def find_view(low: NDArray[np.float64], high: NDArray[np.float64], *, has_controls: bool) -> Camera:
    """Return the first view of a box, display units: beside the controls, if there are any."""
    if has_controls:
        high = high + np.array([_BESIDE * (high - low)[0], 0.0, 0.0])
    # The exported page moves the camera back in a narrower window.
    aspect = _LIVE_ASPECT if has_controls else VIEW_ASPECT
    return place_camera([(low, high)], rows=1, up="+z", aspect=aspect)
