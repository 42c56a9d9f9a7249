"""Arrows for the normal forces of contacts, as long as the forces are large."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.viewer.pins import as_light
from voxshell.viewer.quaternions import normals_as_wxyz
from voxshell.viewer.shading import split_creases

if TYPE_CHECKING:
    from collections.abc import Sequence

    import viser
    from numpy.typing import NDArray

    from voxshell.recording import Recording

LONGEST_ARROW, ARROW_SHAFT = 0.6, 0.008
"""Length of the longest arrow of a recording, and radius of all shafts, in diameters of a typical body."""

_SHAFT, _HEAD, _HEAD_LENGTH, _SIDES = 0.02, 0.06, 0.18, 12
"""Radii, and length of the head, of an arrow of length 1."""
_STOUT = 2.0
"""Ratio of width to length up to which short arrows are stouter than that, so that they stay visible."""
_LEAST_FRACTION = 2.5e-4
"""Of the force of the longest arrow: smaller forces have none."""
_FULL_FORCE_QUANTILE = 0.98
"""The blow of one landing should not shorten all other arrows."""


def full_force(recordings: Sequence[Recording]) -> float:
    """The force, newtons, of the longest arrow: about the largest of all; 0 without forces.

    Rounded up to 1, 2 or 5 times a power of ten, because it is written in the legend.
    """
    sizes = np.concatenate([np.linalg.norm(one.contacts.forces, axis=1) for one in recordings])
    sizes = sizes[sizes > 0.0]
    if len(sizes) == 0:
        return 0.0
    large = float(np.quantile(sizes, _FULL_FORCE_QUANTILE))
    power = 10.0 ** math.floor(math.log10(large))
    return power * next(
        step for step in (1.0, 2.0, 5.0, 10.0) if step * power >= large * (1 - 1e-9)
    )


def find_arrows(
    points: NDArray[np.float64],
    forces: NDArray[np.float64],
    *,
    strongest: float,
    longest: float,
    limit: int,
) -> NDArray[np.float64]:
    """The arrows of one frame, (k, 2, 3): each from its contact in the direction of its force.

    Args:
        points: (n, 3) of the contacts.
        forces: (n, 3) newtons.
        strongest: Newtons above which arrows no longer grow.
        longest: Their length then, in the unit of ``points``.
        limit: Arrows at most, those of the largest forces.
    """
    sizes = np.linalg.norm(forces, axis=1)
    chosen = np.argsort(-sizes, kind="stable")[:limit]
    chosen = np.sort(chosen[sizes[chosen] > _LEAST_FRACTION * strongest])
    lengths = np.minimum(sizes[chosen] / max(strongest, 1e-300), 1.0) * longest
    directions = forces[chosen] / np.maximum(sizes[chosen], 1e-300)[:, None]
    return np.stack([points[chosen], points[chosen] + lengths[:, None] * directions], axis=1)


def make_arrow() -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The surface of an arrow of length 1 along z: vertices (n, 3) and faces (m, 3)."""
    profile = ((0.0, 0.0), (_SHAFT, 0.0), (_SHAFT, 1 - _HEAD_LENGTH), (_HEAD, 1 - _HEAD_LENGTH))
    from trimesh.creation import revolve

    mesh = revolve((*profile, (0.0, 1.0)), sections=_SIDES)
    return np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64)


def mesh_arrows(
    arrows: NDArray[np.float64], *, body_size: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """One surface of all arrows, vertices (n, 3) and faces (m, 3); see :func:`place_arrows`."""
    vertices, faces = make_arrow()
    positions, turns, scales = place_arrows(arrows, body_size=body_size)
    scaled = vertices * scales[:, None]
    w, axis = turns[:, :1, None], turns[:, None, 1:]
    # A rotation by a quaternion, without its matrix.
    twice = 2.0 * np.cross(axis, scaled)
    placed = scaled + w * twice + np.cross(axis, twice) + positions[:, None]
    shifts = len(vertices) * np.arange(len(arrows))[:, None, None]
    return placed.reshape(-1, 3), (faces + shifts).reshape(-1, 3)


def place_arrows(
    arrows: NDArray[np.float64], *, body_size: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """How to place the arrow of :func:`make_arrow` as each of some arrows.

    Short arrows are small in all directions, head included. Long ones have one width.

    Args:
        arrows: (k, 2, 3): start and tip of each.
        body_size: Diameter of a typical body, in the same unit.

    Returns:
        Positions (k, 3), quaternions (k, 4), w first, and scales along x, y and z, (k, 3).
    """
    ways = arrows[:, 1] - arrows[:, 0]
    lengths = np.linalg.norm(ways, axis=1)
    turns = normals_as_wxyz(ways / np.maximum(lengths, 1e-300)[:, None])
    widths = np.minimum(_STOUT * lengths, ARROW_SHAFT / _SHAFT * body_size)
    return arrows[:, 0], turns, np.stack([widths, widths, lengths], axis=1)


def add_arrows(
    scene: viser.SceneApi,
    name: str,
    placed: Sequence[NDArray[np.float32]],
    color: tuple[int, int, int],
    *,
    visible: bool = True,
) -> Any:
    """Add a node of arrows of one color.

    Args:
        scene: Of the page.
        name: Of the node.
        placed: Positions (k, 3), quaternions (k, 4) and scales (k, 3), as of :func:`place_arrows`.
        color: Red, green and blue, 0 to 255.
        visible: Whether it is shown at once.
    """
    positions, turns, scales = placed
    vertices, faces = split_creases(*make_arrow())
    return scene.add_batched_meshes_simple(
        name,
        vertices.astype(np.float32),
        faces.astype(np.uint32),
        turns,
        positions,
        batched_scales=scales,
        batched_colors=as_light(np.array([color], np.float64))[0],
        lod="off",
        cast_shadow=False,
        receive_shadow=False,
        visible=visible,
    )
