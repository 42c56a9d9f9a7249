"""Published and measured values, and verdicts on them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True)
class Row:
    """One quantity of an experiment.

    Attributes:
        quantity: The quantity in words.
        published: The thesis' value, a number in ``unit`` or words; None if it has none.
        here: This run's value; NaN if it could not be measured.
        unit: Unit of both, "" for pure numbers.
        reproduced: True if the published behavior occurs here; None if nothing was published.
        bar: The required value, in words; "" if nothing is required.
        holds: True if the value meets it; None if nothing is required.
        note: An explanation of the value or of a shortfall.
        group: Heading of the row's group in long tables; "" for none.
    """

    quantity: str
    published: float | str | None
    here: float
    unit: str
    reproduced: bool | None = None
    bar: str = ""
    holds: bool | None = None
    note: str = ""
    group: str = ""

    @property
    def below_heading(self) -> str:
        """The quantity below its group's heading, without the heading at its start.

        Example:
            >>> Row("first contact, crossed knives", None, 0.1, "mm", group="First contact").below_heading
            'crossed knives'
        """
        return self.quantity.removeprefix(f"{self.group[:1].lower()}{self.group[1:]}, ")

    @property
    def verdict(self) -> str:
        """The verdict in a few words, for tables.

        Example:
            >>> Row("apex", 0.5, 0.5, "m", reproduced=True, bar="<= 1", holds=False).verdict
            'reproduced, falls short'
        """
        said = {True: "reproduced", False: "not reproduced", None: ""}[self.reproduced]
        kept = {True: "holds", False: "falls short", None: ""}[self.holds]
        return ", ".join(word for word in (said, kept) if word) or "for information"


def at_most(value: float, limit: float) -> bool:
    """Return whether a measured value exists and is not above a limit."""
    return math.isfinite(value) and value <= limit


def at_least(value: float, limit: float) -> bool:
    """Return whether a measured value exists and is not below a limit."""
    return math.isfinite(value) and value >= limit


def format_value(value: float | str | None) -> str:
    """Return three significant digits, or the words.

    Example:
        >>> [format_value(v) for v in (0.50512, 1387.94, 3, "roughly", None, float("nan"), float("inf"))]
        ['0.505', '1390', '3', 'roughly', '', '-', 'inf']
    """
    if value is None or isinstance(value, str):
        return value or ""
    if math.isnan(value):
        return "-"
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    if value == 0.0:
        return "0"
    digits = max(2 - math.floor(math.log10(abs(value))), 0)
    rounded = round(value, 2 - math.floor(math.log10(abs(value))))
    text = f"{rounded:.{digits}f}" if abs(rounded) >= 1e-4 else f"{value:.2e}"
    return text.rstrip("0").rstrip(".") if "." in text and "e" not in text else text


def in_mm(length: float | np.floating[Any]) -> str:
    """Return a length in words, in millimeters, with a resolution of a micrometer.

    Example:
        >>> in_mm(0.00125), in_mm(2e-8), in_mm(0.0)
        ('1.25 mm', '< 0.001 mm', '0 mm')
    """
    return "< 0.001 mm" if 0.0 < length < 1e-6 else f"{format_value(float(length) * 1e3)} mm"
