"""Poses in arguments and files."""

from __future__ import annotations

import csv
import io
import re
from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.arguments import show_value
from voxshell.base.input_files import read_needed_file
from voxshell.base.pose_forms import as_rigid_pose
from voxshell.errors import PoseError, SettingsError

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import ArrayLike, NDArray

FORMS = "3 numbers (x y z), 7 (x y z, then a quaternion x y z w) or 16 (a 4x4 matrix, row by row)"
"""The numbers that a pose consists of."""

_WHAT = "file of poses"

_SEPARATOR = re.compile(r"[\s;]+")
"""What may separate numbers in files that are not CSV."""

_MOST_BYTES = 500_000_000
"""Largest file of poses, bytes: four million matrices of text."""


def make_pose(numbers: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return the (4, 4) matrix of a pose that is given as :data:`FORMS`.

    Args:
        numbers: Meters; the length of the quaternion must be 1 to 0.001, and is corrected.
        name: The argument's name, for error messages.

    Raises:
        PoseError: There are too few or too many numbers, they are not finite, or the quaternion has
            another length.

    Example:
        >>> make_pose([0.1, 0, 0, 0, 0, 1, 0], "pose")[:2].round(6) + 0.0
        array([[-1. ,  0. ,  0. ,  0.1],
               [ 0. , -1. ,  0. ,  0. ]])
    """
    values = np.asarray(numbers, dtype=np.float64)
    if len(values) not in (3, 7, 16):
        raise PoseError(f"{name} must be {FORMS}, not {len(values)}")
    return as_rigid_pose(values.reshape(4, 4) if len(values) == 16 else values, name)


def read_poses(path: Path) -> NDArray[np.float64]:
    """Read poses from a file, (n, 4, 4).

    Args:
        path: A ``.npy`` file with an array (n, 4, 4) or rows of :data:`FORMS`; or a ``.csv`` file
            with such rows. Its first line is a heading if none of its words is a number.

    Raises:
        MissingFileError: The file does not exist.
        SettingsError: The file cannot be read or has another format; the message gives line and
            column.
        PoseError: A row is not a pose.
    """
    rows = _read_array(path) if path.suffix.lower() == ".npy" else _read_table(path)
    if not rows:
        raise SettingsError(f"{path} holds no poses")
    return np.array([make_pose(numbers, where) for where, numbers in rows])


def _read_array(path: Path) -> list[tuple[str, ArrayLike]]:
    data = read_needed_file(path, _MOST_BYTES, _WHAT)
    try:
        array = np.load(io.BytesIO(data), allow_pickle=False)
    except MemoryError:
        raise SettingsError(f"{path} is not a NumPy array: it is larger than its file") from None
    except Exception as error:  # damaged headers raise any type
        why = str(error).partition("\n")[0] or type(error).__name__
        raise SettingsError(f"{path} is not a NumPy array: {why}") from None
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiu" or array.ndim < 2:
        raise SettingsError(f"{path} must hold an array of numbers, (n, 4, 4) or rows of {FORMS}")
    if array.size == 0:
        return []
    rows = array.reshape(len(array), -1)
    return [(f"{path}: pose {index}", row) for index, row in enumerate(rows)]


def _read_table(path: Path) -> list[tuple[str, ArrayLike]]:
    data = read_needed_file(path, _MOST_BYTES, _WHAT)
    try:
        text = data.decode("utf-8-sig")
        lines = list(csv.reader(io.StringIO(text, newline=""), skipinitialspace=True))
    except (UnicodeDecodeError, csv.Error) as error:
        raise SettingsError(f"{path} is not a CSV file: {error}") from None
    rows: list[tuple[str, ArrayLike]] = []
    for number, words in enumerate(lines, start=1):
        wrong = next((index for index, word in enumerate(words) if not _is_number(word)), None)
        if wrong is None:
            if words:
                rows.append((f"{path}:{number}", [*map(float, words)]))
        elif number > 1 or any(
            _is_number(each) for word in words for each in _SEPARATOR.split(word)
        ):
            crowded = len(_SEPARATOR.split(words[wrong].strip())) > 1
            raise SettingsError(
                f"{path}:{number}: not all entries are numbers: column {wrong + 1} is "
                f"{show_value(words[wrong])}{'; separate numbers with commas' if crowded else ''}"
            )
    return rows


def _is_number(word: str) -> bool:
    """Return whether a word is a number; Python would also take underscores."""
    try:
        float(word)
    except ValueError:
        return False
    return "_" not in word
