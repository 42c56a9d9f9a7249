"""Processes that work for this one: deaf to interrupts from their first instruction, gone when it is."""

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
"""Ctrl-C, and by what the program ``voxshell`` takes one up again that came amid an import."""


@contextmanager
def starting_workers() -> Iterator[None]:
    """Starts processes in the block that no interrupt reaches before :func:`begin_worker`.

    Ctrl-C goes to all processes of a terminal, also to those that have not yet said that they leave it
    to their parent. The caller's own interrupts come at the block's end, lest it leaves a process half
    started, which would complain.
    """
    late: list[int] = []
    # Python runs handlers in the main thread alone, where alone they can be set.
    here = threading.current_thread() is threading.main_thread()
    handlers = {n: signal.getsignal(n) for n in _INTERRUPTS if here}
    handlers = {number: handler for number, handler in handlers.items() if callable(handler)}
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    try:
        for number in handlers:
            signal.signal(number, lambda number, _: late.append(number))
        # Its own start would let interrupts through again.
        resource_tracker.ensure_running()
        # What a thread blocks, the processes that it starts block too.
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for number, handler in handlers.items():
            signal.signal(number, handler)
        for number in late[:1]:
            signal.raise_signal(number)


def begin_worker() -> None:
    """Leaves interrupts to the parent, and ends this process with it however that ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    parent = multiprocessing.parent_process()

    def follow() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=follow, daemon=True).start()
