"""The table of an experiment's verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich import box
from rich.markup import escape
from rich.table import Table

from voxshell.experiments.verdict import format_value

if TYPE_CHECKING:
    from collections.abc import Iterable

    from voxshell.experiments.verdict import Row


def make_table(title: str, rows: Iterable[Row]) -> Table:
    """Published beside here, with the bar and the verdict; long words wrap."""
    table = Table(
        *("quantity", "unit"),
        title=title,
        title_justify="left",
        box=box.SIMPLE_HEAD,
        pad_edge=False,
    )
    for heading in ("published", "here"):
        table.add_column(heading, justify="right")
    table.add_column("ours should be")
    table.add_column("verdict")
    for row in rows:
        good = row.reproduced is not False and row.holds is not False
        said = row.reproduced is not None or row.holds is not None
        color = "" if not said else "green" if good else "red"
        table.add_row(
            *map(escape, (row.quantity, row.unit, format_value(row.published))),
            *map(escape, (format_value(row.here), row.bar)),
            f"[{color}]{row.verdict}[/]" if color else row.verdict,
        )
    return table
