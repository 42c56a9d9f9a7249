from __future__ import annotations

import math

import pytest
from voxshell_studies.verdict import Row, at_least, at_most, format_value


def test_nothing_measured_holds_no_bar():
    assert not at_most(math.nan, 1.0)
    assert not at_least(math.nan, 1.0)
    assert not at_most(-math.inf, 1.0)
    assert at_most(1.0, 1.0)


@pytest.mark.parametrize(
    ("reproduced", "holds", "verdict"),
    [
        (True, True, "reproduced, holds"),
        (False, None, "not reproduced"),
        (None, False, "falls short"),
        (None, None, "for information"),
    ],
)
def test_verdict_in_words(reproduced, holds, verdict):
    assert Row("x", None, 1.0, "", reproduced=reproduced, holds=holds).verdict == verdict


@pytest.mark.parametrize(
    ("value", "text"),
    [(35596.0, "35600"), (0.1, "0.1"), (1e-7, "1.00e-07"), (-2.345, "-2.35"), (999.7, "1000")],
)
def test_values_have_three_digits(value, text):
    assert format_value(value) == text
