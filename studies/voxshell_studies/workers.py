"""Worker processes: they ignore interrupts from their start, and end with their parent."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_INTERRUPTS = (signal.SIGINT, signal.SIGALRM)
"""Ctrl-C, and the signal with which ``voxshell`` repeats one that came during an import."""


@contextmanager
def starting_workers() -> Iterator[None]:
    """Start processes in the block that no interrupt reaches before :func:`begin_worker`.

    Ctrl-C goes to all processes of a terminal, including those that have not set their handler yet.
    The caller's own interrupts are delayed to the block's end: otherwise a process that has half
    started would print errors.
    """
    late: list[int] = []
    # Python sets and runs signal handlers only in the main thread.
    here = threading.current_thread() is threading.main_thread()
    handlers = {n: signal.getsignal(n) for n in _INTERRUPTS if here}
    handlers = {number: handler for number, handler in handlers.items() if callable(handler)}
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    try:
        for number in handlers:
            signal.signal(number, lambda number, _: late.append(number))
        # Its start would enable interrupts again.
        resource_tracker.ensure_running()
        # Processes inherit the signals that their parent's thread blocks.
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for number, handler in handlers.items():
            signal.signal(number, handler)
        for number in late[:1]:
            signal.raise_signal(number)


def begin_worker() -> None:
    """Leave interrupts to the parent, and end this process when the parent ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    parent = multiprocessing.parent_process()

    def follow() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=follow, daemon=True).start()
