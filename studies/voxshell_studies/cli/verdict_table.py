"""The table of an experiment's verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.markup import escape
from voxshell.cli.tables import bare_table

from voxshell_studies.verdict import format_value

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.table import Table

    from voxshell_studies.verdict import Row


def make_table(title: str, rows: Iterable[Row]) -> Table:
    """Return a table of published and measured values with bars and verdicts; long words wrap."""
    table = bare_table(title, expand=True)
    # The remaining width goes to the columns that need it most.
    table.add_column("quantity", ratio=1)
    table.add_column("published", justify="right", max_width=10)
    table.add_column("here", justify="right", no_wrap=True)
    table.add_column("should be", max_width=16)
    table.add_column("verdict", no_wrap=True)
    group = ""
    for row in rows:
        if row.group != group:
            group = row.group
            table.add_section()
            table.add_row(f"[bold]{escape(group)}[/]")
        good = row.reproduced is not False and row.holds is not False
        said = row.reproduced is not None or row.holds is not None
        color = "" if not said else "green" if good else "red"
        words = row.below_heading
        quantity = f"{words}, {row.unit}" if row.unit else words
        verdict = row.verdict.replace(", ", ",\n").replace("for information", "-")
        table.add_row(
            *map(escape, (quantity, format_value(row.published), format_value(row.here), row.bar)),
            f"[{color}]{verdict}[/]" if color else verdict,
        )
    return table
