"""Progress displays for long work."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.progress import Progress, TaskID, TextColumn

from voxshell.viewer.terminal_progress import make_columns

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.console import Console


def open_progress(console: Console) -> Progress:
    """Return a display of tasks with elapsed time, remaining time and current stage.

    It writes nothing where nobody looks on, such as into a log.
    """
    return Progress(
        *make_columns(),
        TextColumn("[dim]{task.fields[stage]}"),
        console=console,
        disable=not console.is_terminal,
    )


class Track:
    """A line of a progress display."""

    def __init__(self, progress: Progress, task: TaskID) -> None:
        self._progress = progress
        self._task = task

    def update(self, stage: str, fraction: float) -> None:
        """Show the current stage and the completed fraction, 0 to 1."""
        self._progress.update(self._task, completed=fraction, stage=stage)

    def advance(self, fraction: float) -> None:
        """Show the completed fraction, 0 to 1."""
        self._progress.update(self._task, completed=fraction)


@contextmanager
def tracked(progress: Progress, description: str) -> Iterator[Track]:
    """Yield a line that shows completion when the block succeeds."""
    track = Track(progress, progress.add_task(description, total=1.0, stage=""))
    yield track
    track.update("", 1.0)
