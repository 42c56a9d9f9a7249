"""Rotations as the player represents them: quaternions (w, x, y, z)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def rotations_as_wxyz(rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return unit quaternions, (k, 4), w first, of (k, 3, 3) rotation matrices.

    Example:
        >>> turn = np.array([[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]])
        >>> rotations_as_wxyz(turn).round(4)
        array([[0.7071, 0.    , 0.    , 0.7071]])
    """
    r = np.asarray(rotations, dtype=np.float64)
    diagonal = np.diagonal(r, axis1=1, axis2=2)
    trace = diagonal.sum(axis=1)
    # Four times the squares of w, x, y and z. Dividing by the largest is always accurate.
    squares = np.stack([1.0 + trace, *(1.0 + 2.0 * diagonal.T - trace)], axis=1)
    wx, wy, wz = (r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1])
    xy, xz, yz = (r[:, 0, 1] + r[:, 1, 0], r[:, 0, 2] + r[:, 2, 0], r[:, 1, 2] + r[:, 2, 1])
    w2, x2, y2, z2 = squares.T
    rows = np.stack(
        [
            np.stack([w2, wx, wy, wz], axis=1),
            np.stack([wx, x2, xy, xz], axis=1),
            np.stack([wy, xy, y2, yz], axis=1),
            np.stack([wz, xz, yz, z2], axis=1),
        ],
        axis=1,
    )
    chosen = rows[np.arange(len(r)), np.argmax(squares, axis=1)]
    return chosen / np.linalg.norm(chosen, axis=1, keepdims=True)


def normals_as_wxyz(normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return unit quaternions, (k, 4), w first, of the shortest rotations from z to (k, 3) normals.

    Example:
        >>> normals_as_wxyz(np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])).round(4)
        array([[1.    , 0.    , 0.    , 0.    ],
               [0.7071, 0.    , 0.7071, 0.    ]])
    """
    turns = np.zeros((len(normals), 4))
    turns[:, 0] = 1.0 + normals[:, 2]
    turns[:, 1] = 0.0 - normals[:, 1]  # avoids negative zero
    turns[:, 2] = normals[:, 0]
    # For a normal of -z, any half turn is correct; near it, the sum above has lost precision.
    turns[turns[:, 0] < 1e-6] = (0.0, 1.0, 0.0, 0.0)
    return turns / np.linalg.norm(turns, axis=1, keepdims=True)


def as_steady(turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the same rotations, (k, 4), with signs that keep neighbors within half a turn.

    A quaternion and its negative are the same rotation, but interpolation between them would spin.

    Example:
        >>> as_steady(np.array([[1.0, 0.0, 0.0, 0.0], [-0.8, 0.6, 0.0, 0.0]])).tolist()
        [[1.0, 0.0, 0.0, 0.0], [0.8, -0.6, -0.0, -0.0]]
    """
    apart = np.einsum("ij,ij->i", turns[1:], turns[:-1]) < 0.0
    signs = np.where(np.concatenate([[False], apart]), -1.0, 1.0).cumprod()
    return turns * signs[:, None]
