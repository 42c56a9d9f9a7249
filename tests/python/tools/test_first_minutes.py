"""The table of a new user's first steps."""

from __future__ import annotations

import first_minutes


def test_the_table_has_a_column_each_and_the_sums_of_its_steps():
    steps = {"install": 30.4, first_minutes.TEN_LINES: 2.4, "film": 10.0}
    columns = {
        "Python 3.10": steps,
        "Python 3.13": {step: 2.0 * took for step, took in steps.items()},
    }
    assert first_minutes.format_table(columns) == [
        "| step | Python 3.10 | Python 3.13 |",
        "|---|---|---|",
        "| install | 30 s | 61 s |",
        f"| {first_minutes.TEN_LINES} | 2 s | 5 s |",
        "| so far | 33 s | 66 s |",
        "| film | 10 s | 20 s |",
        "| all | 43 s | 86 s |",
    ]
