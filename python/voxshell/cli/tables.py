"""Tables in one style that fit into 80 columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich import box
from rich.markup import escape
from rich.table import Table

if TYPE_CHECKING:
    from collections.abc import Iterable


def new_table(*headings: str, title: str | None = None) -> Table:
    """Return an empty table: words are left-aligned, all other columns right-aligned."""
    table = bare_table(title)
    for index, heading in enumerate(headings):
        table.add_column(heading, justify="right" if index else "left", no_wrap=True)
    return table


def bare_table(title: str | None = None, *, expand: bool = False) -> Table:
    """Return a table without columns; if expanded, it is as wide as the terminal."""
    return Table(
        title=title,
        title_justify="left",
        box=box.SIMPLE_HEAD,
        pad_edge=False,
        padding=(0, 1, 0, 0),
        expand=expand,
    )


def list_facts(facts: Iterable[tuple[str, str]], title: str | None = None) -> Table:
    """Return a table of names and values, one per line."""
    table = Table(
        title=title,
        title_justify="left",
        box=None,
        show_header=False,
        pad_edge=False,
        padding=(0, 2, 0, 0),
    )
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    for name, value in facts:
        table.add_row(escape(name), escape(value))
    return table
