from __future__ import annotations

import math

import pytest
from voxshell.measuring.units import format_length, format_size, format_time


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0 s"),
        (1e-6, "1.00 µs"),
        (9.996e-4, "1.00 ms"),  # rounded before the unit is chosen
        (59.96, "1.00 min"),
        (59.94, "59.9 s"),
        (3600.0, "60.0 min"),
        (-0.5, "-500 ms"),
        (math.inf, "-"),
        (math.nan, "-"),
    ],
)
def test_times(seconds: float, text: str):
    assert format_time(seconds) == text


@pytest.mark.parametrize(
    ("meters", "text"),
    [(1.0, "1.00 m"), (0.9996, "1.00 m"), (1234.0, "1230 m"), (-1e-5, "-10.0 µm"), (4e-9, "0 m")],
)
def test_lengths(meters: float, text: str):
    assert format_length(meters) == text


@pytest.mark.parametrize(
    ("count", "text"), [(0, "0 B"), (999, "999 B"), (999.9, "1.00 kB"), (2.5e9, "2.50 GB")]
)
def test_sizes(count: float, text: str):
    assert format_size(count) == text
