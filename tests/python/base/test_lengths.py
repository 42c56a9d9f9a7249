"""Lengths in words."""

from __future__ import annotations

import pytest
from voxshell.base.lengths import in_millimeters, limit, metric


@pytest.mark.parametrize(
    ("length", "text"),
    [(9.68e-11, "below 0.1 µm"), (1e-7, "at most 0.1 µm"), (0.00345, "at most 3.45 mm")],
)
def test_a_depth_that_is_rounding_has_no_digits(length: float, text: str):
    assert limit(length) == text


@pytest.mark.parametrize(
    ("length", "digits", "text"),
    [
        (7.947e-10, 4, "<0.0001"),
        (-7.947e-10, 4, ">-0.0001"),
        (0.0022384, 4, "2.238"),
        (1e-7, 3, "0.0001"),
        (0.0, 3, "0"),
        (12.3456, 3, "12346"),
    ],
)
def test_millimeters_have_the_digits_that_are_asked_for(length: float, digits: int, text: str):
    assert in_millimeters(length, digits) == text


def test_the_unit_is_that_with_the_fewest_digits():
    assert [metric(x) for x in (12e-6, 0.05, 0.0)] == ["12 µm", "5 cm", "0 µm"]
