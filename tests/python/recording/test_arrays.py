"""What every array of a recording is held to."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from voxshell.errors import RecordingError
from voxshell.recording.arrays import as_floats, as_integers, as_points, keep


def test_numbers_are_copied():
    floats, integers = np.ones((2, 3)), np.arange(3)
    copies = as_floats(floats, "x"), as_points(floats, "x"), as_integers(integers, "x")
    floats[:], integers[:] = 7.0, 7
    assert all(7 not in copy for copy in copies)


@pytest.mark.parametrize(
    ("read", "value", "message"),
    [
        (as_floats, ["a"], "x must be numbers: "),
        (as_floats, [[1.0], [1.0, 2.0]], "x must be numbers: "),
        (as_floats, [1.0, np.nan, -np.inf], "x hold 2 of 3 numbers that are not finite"),
        (as_points, [1.0, 2.0, 3.0], r"x must have shape \(n, 3\), got \(3,\)"),
        (as_points, [[1.0, 2.0]], r"x must have shape \(n, 3\), got \(1, 2\)"),
        (as_integers, [1.0], "x must be integers, got float64"),
        (as_integers, [True], "x must be integers, got bool"),
    ],
)
def test_other_values_are_refused(read, value, message):
    with pytest.raises(RecordingError, match=message):
        read(value, "x")


def test_nothing_is_no_points_and_no_integers():
    assert as_points([], "x").shape == (0, 3)
    assert as_integers([], "x").dtype == np.int64


def test_what_is_kept_is_read_only():
    owner = SimpleNamespace()
    keep(owner, "numbers", np.zeros(2))
    with pytest.raises(ValueError, match="read-only"):
        owner.numbers[0] = 1.0
