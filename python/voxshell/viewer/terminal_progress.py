"""Progress of long work on the terminal of a program that did not ask for it with a callback."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rich.progress import ProgressColumn


@contextmanager
def on_terminal(description: str) -> Iterator[Callable[[str, float], object]]:
    """Yield a progress callback that draws a bar on stderr, which is removed when the block ends.

    Where stderr is no terminal, such as in a log or a notebook, it writes nothing.

    Args:
        description: What is being done, in a few words.

    Yields:
        A function of the name of the stage and its completed fraction, 0 to 1.
    """
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import Progress

    console = Console(stderr=True)
    with Progress(
        *make_columns(),
        console=console,
        disable=not console.is_terminal,
        transient=True,
    ) as display:
        task = display.add_task(escape(description), total=1.0)
        yield lambda _, fraction: display.update(task, completed=fraction)


def make_columns() -> list[ProgressColumn]:
    """Return the columns of a task: its description, a bar, the percentage, elapsed and remaining time."""
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    return [
        TextColumn("{task.description}"),
        BarColumn(bar_width=16),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("[dim]left"),
        TimeRemainingColumn(),
    ]
