"""Quantities for people: three digits in a suitable unit."""

from __future__ import annotations

import math

_MICRO = "\N{MICRO SIGN}"
_TIMES = ((60.0, "min"), (1.0, "s"), (1e-3, "ms"), (1e-6, f"{_MICRO}s"))
_LENGTHS = ((1.0, "m"), (1e-3, "mm"), (1e-6, f"{_MICRO}m"))
_SIZES = ((1e9, "GB"), (1e6, "MB"), (1e3, "kB"), (1.0, "B"))


def format_time(seconds: float) -> str:
    """Return a duration as text.

    Example:
        >>> [format_time(t) for t in (1.234e-5, 0.0456, 9.996e-3, 90.0, float("nan"))]
        ['12.3 µs', '45.6 ms', '10.0 ms', '1.50 min', '-']
    """
    return _format(seconds, _TIMES)


def format_length(meters: float) -> str:
    """Return a length, which may be negative, as text.

    Example:
        >>> [format_length(x) for x in (0.2115, -0.00123, 4.5e-6, 12.0, 1e-20)]
        ['212 mm', '-1.23 mm', '4.50 µm', '12.0 m', '0 m']
    """
    return _format(meters, _LENGTHS)


def format_size(count: float) -> str:
    """Return a number of bytes as text.

    Example:
        >>> [format_size(n) for n in (512, 81_920, 9_996_000)]
        ['512 B', '81.9 kB', '10.0 MB']
    """
    return _format(count, _SIZES)


def _format(value: float, units: tuple[tuple[float, str], ...]) -> str:
    if not math.isfinite(value):
        return "-"
    if abs(value) < 0.005 * units[-1][0]:
        return f"0 {next(name for size, name in units if size == 1.0)}"
    # Round before choosing the unit and the digits: 9.996 has one digit more than 10.0.
    rounded = float(f"{value:.3g}")
    size, name = next((unit for unit in units if abs(rounded) >= unit[0]), units[-1])
    number = float(f"{value / size:.3g}")
    digits = (
        0 if abs(number) >= 100 or size == 1.0 == units[-1][0] else 1 if abs(number) >= 10 else 2
    )
    return f"{number:.{digits}f} {name}"
