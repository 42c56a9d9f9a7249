"""Checks of arguments. Each error states what the public function expects and what it received."""

from __future__ import annotations

import math
import operator
import os
from functools import wraps
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from voxshell.errors import (
    FileAccessError,
    InputTypeError,
    MemoryLimitError,
    SettingsError,
    VoxshellError,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import ArrayLike, NDArray

Conversion = TypeVar("Conversion", bound="Callable[..., Any]")

_MOST_THREADS = 1024
FARTHEST = 1e15
"""Largest length that is accepted, meters: its square still fits single precision."""


_LONGEST_SHOWN = 80
_LONGEST_ROW_SHOWN = 8
_COUNTS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")
_LARGEST_SHOWN = 2**63


def show_value(value: Any) -> str:
    """Return a value for a message as Python writes it: one line, the beginning of a long one.

    Example:
        >>> show_value("part")
        "'part'"
        >>> len(show_value(np.zeros((1000, 3))))
        83
    """
    if isinstance(value, int) and abs(value) > _LARGEST_SHOWN:
        return f"an integer of {value.bit_length()} bits"
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # Python limits the digits of an integer
        return f"a {type(value).__name__} with an integer of too many digits"
    except Exception:  # too deeply nested, or an unfinished object
        return f"a {type(value).__name__} that cannot be shown"
    return text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}..."


def show_apart(*numbers: float) -> list[str]:
    """Return numbers for a message, with six digits or as many more as tell them apart.

    Example:
        >>> show_apart(0.5, 0.1 + 0.2)
        ['0.5', '0.3']
        >>> show_apart(0.3, 0.1 + 0.2)
        ['0.3', '0.30000000000000004']
    """
    for digits in range(6, 16):
        texts = [f"{number:.{digits}g}" for number in numbers]
        if len(set(texts)) == len(set(numbers)):
            return texts
    return [repr(float(number)) for number in numbers]


def show_array(array: NDArray[Any]) -> str:
    """Return an array for a message: a number or a short row itself, else its shape and type.

    Example:
        >>> show_array(np.array(0.1)), show_array(np.array((0, 1)))
        ('0.1', '[0, 1]')
        >>> show_array(np.zeros((1000, 2)))
        'an array of shape (1000, 2) and type float64'
    """
    is_short = array.ndim == 1 and array.size <= _LONGEST_ROW_SHOWN and array.dtype.kind in "fiu"
    if array.ndim == 0 or is_short:
        return show_value(array.tolist())
    return f"an array of shape {describe(array.shape)} and type {array.dtype}"


def within_memory(function: Conversion) -> Conversion:
    """Make what converts an argument raise MemoryLimitError where it does not fit into memory."""

    @wraps(function)
    def convert(value: Any, name: str, *args: Any, **kwargs: Any) -> Any:
        try:
            return function(value, name, *args, **kwargs)
        except MemoryError as error:
            raise MemoryLimitError(f"no memory left for {name}") from error

    return cast("Conversion", convert)


def as_real(value: Any, name: str) -> float:
    """Return a finite number."""
    try:
        # Python converts True to 1, which would be 1 m where a length is expected.
        if isinstance(value, (str, bytes, bytearray, bool, np.bool_)):
            raise TypeError
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise SettingsError(f"{name} must be a number, not {show_value(value)}") from None
    if not math.isfinite(number):
        raise SettingsError(f"{name} must be finite, not {number}")
    return number


def as_positive(value: Any, name: str) -> float:
    """Return a finite number above zero."""
    number = as_real(value, name)
    if not number > 0.0:
        raise SettingsError(f"{name} must be above 0, not {number:g}")
    return number


def as_not_negative(value: Any, name: str) -> float:
    """Return a finite number of at least 0."""
    number = as_real(value, name)
    if number < 0.0:
        raise SettingsError(f"{name} must be at least 0, not {number:g}")
    return number


def as_fraction(value: float, name: str) -> float:
    """Return a number from 0 to 1."""
    fraction = as_real(value, name)
    if not 0.0 <= fraction <= 1.0:
        raise SettingsError(f"{name} must be from 0 to 1, not {fraction:g}")
    return fraction


def as_length(value: Any, name: str) -> float:
    """Return a length above zero, in meters."""
    number = as_positive(value, name)
    if number > FARTHEST:
        raise SettingsError(f"{name} must be at most {FARTHEST:g} m, not {number:g}")
    return number


def as_integer(value: Any, name: str, lowest: int, highest: int) -> int:
    """Return an integer within a range that includes both ends."""
    try:
        if isinstance(value, bool):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        raise SettingsError(f"{name} must be an integer, not {show_value(value)}") from None
    if not lowest <= number <= highest:
        unbounded = highest >= 2**31 - 1 and number < lowest
        allowed = f"at least {lowest}" if unbounded else f"from {lowest} to {highest}"
        raise SettingsError(f"{name} must be {allowed}, not {number}")
    return number


def as_flag(value: Any, name: str) -> bool:
    """Return True or False; other values are refused, because most of them count as true."""
    if not isinstance(value, (bool, np.bool_)):
        raise SettingsError(f"{name} must be True or False, not {show_value(value)}")
    return bool(value)


def as_choice(value: Any, name: str, choices: Iterable[str]) -> str:
    """Return one of some words."""
    words = tuple(choices)
    if not (isinstance(value, str) and value in words):
        known = join_choices(map(repr, words))
        raise SettingsError(f"{name} must be {known}, not {show_value(value)}")
    return value


def join_choices(words: Iterable[str]) -> str:
    """Return words of which one is to be chosen, for a message.

    Example:
        >>> join_choices(["free", "ball", "hinge"]), join_choices(["1"])
        ('free, ball or hinge', '1')
    """
    *others, last = words
    return f"{', '.join(others)} or {last}" if others else last


def as_text(value: Any, name: str) -> str:
    """Return a text."""
    if not isinstance(value, str):
        raise InputTypeError(f"{name} must be a string, not {type(value).__name__}")
    return value


def as_unicode(text: str) -> str:
    """Return a text with question marks for what is not Unicode, as parts of file names may be."""
    return text.encode(errors="replace").decode()


def check_callable(value: Any, name: str) -> None:
    """Refuse what is neither None nor can be called."""
    if value is not None and not callable(value):
        raise InputTypeError(f"{name} must be callable, not {type(value).__name__}")


def is_iterable(value: Any) -> bool:
    """Return whether a loop can run over a value, which arrays of no dimension only seem to allow."""
    try:
        iter(value)
    except TypeError:
        return False
    return True


def is_infinite(value: Any) -> bool:
    """Return whether a value is the number that stands for no limit."""
    return isinstance(value, (float, np.floating)) and bool(value == math.inf)


def as_color(value: Any, name: str) -> tuple[int, int, int]:
    """Return red, green and blue, integers from 0 to 255."""
    try:
        color = tuple(int(channel) for channel in value)
        same = all(a == b for a, b in zip(color, value, strict=True))
    except (TypeError, ValueError, OverflowError):
        color, same = (), False
    if not same or len(color) != 3 or not all(0 <= channel <= 255 for channel in color):
        raise SettingsError(f"{name} must be three integers from 0 to 255, not {show_value(value)}")
    return color[0], color[1], color[2]


def as_threads(value: Any) -> int:
    """Return a number of threads for the core, which takes 0 for None: one thread per CPU core."""
    return 0 if value is None else as_integer(value, "threads", 1, _MOST_THREADS)


@within_memory
def as_floats(
    value: ArrayLike,
    name: str,
    shape: tuple[int | None, ...],
    error: type[VoxshellError] = SettingsError,
    meaning: str = "",
) -> NDArray[np.float64]:
    """Return a contiguous float64 array of a shape.

    Args:
        value: Anything that NumPy makes an array of.
        name: The argument's name in messages.
        shape: The lengths along each axis; None stands for any length.
        error: The error to raise.
        meaning: What follows "numbers" in messages, such as " in meters".
    """
    try:
        array = np.asarray(value)
    except (TypeError, ValueError) as failure:
        wanted = f"{_count(shape)} numbers{meaning}"
        raise error(f"{name} must be {wanted}, not {show_value(value)} ({failure})") from None
    fits = array.ndim == len(shape) and all(
        want is None or want == have for want, have in zip(shape, array.shape, strict=True)
    )
    if array.dtype.kind not in "fiu" or not fits:
        wanted = f"{_count(shape)} numbers{meaning}"
        raise error(f"{name} must be {wanted}, not {show_array(array)}")
    return np.ascontiguousarray(array, dtype=np.float64)


def as_points(value: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return an (n, 3) array. The core checks that its numbers are finite."""
    return as_floats(value, name, (None, 3))


def as_vector(
    value: ArrayLike, name: str, meaning: str = ", such as (0, 0, 1)"
) -> tuple[float, float, float]:
    """Return three finite numbers; ``meaning`` is as for :func:`as_floats`."""
    x, y, z = as_floats(value, name, (3,), meaning=meaning).tolist()
    if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(z)):
        raise SettingsError(f"{name} must be finite, not {(x, y, z)}")
    return x, y, z


def as_path(value: Any, name: str) -> bytes:
    """Return a file name in the encoding of the file system."""
    try:
        path = os.fsencode(value)
    except (TypeError, ValueError):
        raise InputTypeError(f"{name} must be a path, not {type(value).__name__}") from None
    if not path or b"\0" in path:
        raise FileAccessError(f"{name} must name a file, not {show_value(value)}")
    return path


def _count(shape: tuple[int | None, ...]) -> str:
    """Return how many numbers an array of a shape has, in words: "three" or "(n, 3)"."""
    count = shape[0] if len(shape) == 1 else None
    return describe(shape) if count is None or count >= len(_COUNTS) else _COUNTS[count]


def describe(shape: tuple[int | None, ...]) -> str:
    """Return a shape in words, such as "(n, 3)"."""
    sizes = ["n" if size is None else str(size) for size in shape]
    return f"({sizes[0]},)" if len(sizes) == 1 else f"({', '.join(sizes)})"
