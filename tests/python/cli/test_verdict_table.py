from __future__ import annotations

import io
from dataclasses import replace

from rich.console import Console
from voxshell_studies.cli.verdict_table import make_table
from voxshell_studies.verdict import Row

ROWS = [
    Row("rebound off c2, at most of 50 start heights, c = 0.5, our rule, plane", None, 0.012, "mm"),
    Row("GImpact / VPS fine on the plane", 137, 2850, "", True, ">= 500 at every phase", True),
    Row("maximum penetration, high", 19.2, 20.0, "mm", False, "<= v dt + a voxel", False),
]


def test_words_have_room_in_eighty_columns():
    screen = io.StringIO()
    Console(file=screen, width=80).print(make_table("Table", ROWS))
    lines = screen.getvalue().splitlines()
    assert max(map(len, lines)) <= 80
    # Title, headings, the line below, empty lines, and at most three lines a row.
    assert len(lines) <= 5 + 3 * len(ROWS)
    text = screen.getvalue()
    for words in ("high, mm", "not reproduced,", "falls short", "2850", "0.012"):
        assert words in text


def test_groups_have_headings():
    screen = io.StringIO()
    rows = [replace(row, group=group) for row, group in zip(ROWS, "AAB", strict=True)]
    Console(file=screen, width=80).print(make_table("Table", rows))
    lines = [line.strip() for line in screen.getvalue().splitlines()]
    assert lines.index("A") < lines.index("B")
    assert lines.count("A") == lines.count("B") == 1
