"""Ctrl-C while a command runs: it stops the command, which cleans up, at any place."""

from __future__ import annotations

import signal
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import FrameType

_LOOK_AGAIN = 0.02  # seconds
_IMPORT_CODE = "<frozen importlib._bootstrap>"


@contextmanager
def raising_interrupts() -> Iterator[None]:
    """Make Ctrl-C raise ``KeyboardInterrupt`` in the block, unless it is ignored.

    During an import, the exception is delayed until the import ends. Libraries would take an
    exception there for a missing module and continue without it, or abort.
    """
    handler = signal.getsignal(signal.SIGINT)
    if not callable(handler):
        yield
        return
    signal.signal(signal.SIGINT, _interrupt)
    alarm_handler = signal.signal(signal.SIGALRM, _interrupt)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, alarm_handler)
        signal.signal(signal.SIGINT, handler)


def _interrupt(_number: int, frame: FrameType | None) -> None:
    while frame is not None:
        if frame.f_code.co_filename == _IMPORT_CODE:
            signal.setitimer(signal.ITIMER_REAL, _LOOK_AGAIN)
            return
        frame = frame.f_back
    raise KeyboardInterrupt
