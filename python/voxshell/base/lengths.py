"""Lengths for people: in a suitable unit, and no digits that are only rounding."""

from __future__ import annotations

LEAST = 1e-7
"""Errors and depths below this are rounding, meters: of single precision at a meter."""


def metric(length: float) -> str:
    """Return a length, in meters, as a text in the unit with the fewest digits.

    Example:
        >>> [metric(x) for x in (0.00025, 0.003, 0.02, 1.5)]
        ['0.25 mm', '3 mm', '2 cm', '1.5 m']
    """
    for unit, size in (("m", 1.0), ("cm", 0.01), ("mm", 0.001)):
        if length >= 0.9999 * size or (unit == "mm" and length >= 0.00005):
            return f"{length / size:.3g} {unit}"
    return f"{length * 1e6:.3g} µm"


def limit(length: float) -> str:
    """Return in words how large a depth or an error is at most, meters.

    Example:
        >>> [limit(x) for x in (0.0034512, 2e-6, 9.68e-11)]
        ['at most 3.45 mm', 'at most 2 µm', 'below 0.1 µm']
    """
    return f"below {metric(LEAST)}" if length < LEAST else f"at most {metric(length)}"


def in_millimeters(length: float, digits: int = 3) -> str:
    """Return an error or a depth, in meters, as a number of millimeters.

    Args:
        length: Meters.
        digits: Significant ones.

    Example:
        >>> [in_millimeters(x) for x in (0.0025512, 1.5e-7, 2.39e-11, 0.0, -2e-9, -0.001)]
        ['2.55', '0.00015', '<0.0001', '0', '>-0.0001', '-1']
    """
    if 0.0 < abs(length) < LEAST:
        return f"<{1e3 * LEAST:.4f}" if length > 0.0 else f">-{1e3 * LEAST:.4f}"
    number = 1e3 * length
    return f"{number:.{digits}g}" if abs(number) < 10**digits else f"{number:.0f}"
