"""HTML summaries that notebooks display for voxshell's objects."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

_CELL = "text-align: left; padding: 0.15em 1.2em 0.15em 0; vertical-align: top"


def make_table(title: str, facts: Mapping[str, str]) -> str:
    """Return a table of facts as self-contained HTML.

    Args:
        title: Plain text.
        facts: Names and values, plain text, in the order of display.

    Example:
        >>> print(make_table("Ball", {"radius": "0.1 m"}))
        <table ...><tr><th ...>Ball</th></tr><tr><td ...>radius</td><td ...>0.1 m</td></tr></table>
    """
    rows = "".join(
        f'<tr><td style="{_CELL}">{html.escape(name)}</td>'
        f'<td style="{_CELL}">{html.escape(value)}</td></tr>'
        for name, value in facts.items()
    )
    heading = f'<tr><th colspan="2" style="{_CELL}">{html.escape(title)}</th></tr>'
    return f'<table style="border-collapse: collapse">{heading}{rows}</table>'


def make_frame(page: str, height: int) -> str:
    """Return an iframe that can neither read nor change the page around it.

    Args:
        page: A complete HTML page.
        height: Pixels.
    """
    return (
        f'<iframe sandbox="allow-scripts" srcdoc="{html.escape(page)}" style="width: 100%; '
        f'height: {height}px; border: 1px solid #d5dbe2; border-radius: 6px"></iframe>'
    )
