"""Work in a separate process, which may crash or hang without affecting the caller."""

from __future__ import annotations

import faulthandler
import multiprocessing
import os
import signal
import sys
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from voxshell.errors import MissingExtraError

from voxshell_studies.peers.measure import describe
from voxshell_studies.workers import begin_worker, starting_workers

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from multiprocessing.connection import Connection
    from pathlib import Path

_GRACE = 5.0
"""Seconds in which a process must end after its last result."""

_LAST_WORDS = 200
"""Largest number of characters of a log in an explanation."""


@dataclass(frozen=True)
class Ending:
    """The end of work in a process.

    Attributes:
        how: "done"; "missing": a library is not installed; "failed": it raised or its process
            ended; "timed out".
        reason: Why it was not completed.
    """

    how: Literal["done", "missing", "failed", "timed out"]
    reason: str = ""


def run_apart(
    work: Callable[..., Iterator[object]],
    arguments: dict[str, Any],
    receive: Callable[[Any], object],
    *,
    limit: float,
    log: Path,
) -> Ending:
    """Run a generator in a new process, and pass on what it yields at once.

    Args:
        work: A generator function at a module's top level.
        arguments: Its keyword arguments, which can be pickled.
        receive: Called with each result.
        limit: Seconds after which the process is killed.
        log: File for the output of the process and its libraries; the process runs in its folder.
    """
    # Forking would copy the libraries that the parent has loaded.
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(
        target=_run, args=(work, arguments, sender, log.absolute()), daemon=True, name="peer"
    )
    end = time.monotonic() + limit
    try:
        with starting_workers():
            process.start()
        sender.close()
        while (remaining := end - time.monotonic()) > 0.0:
            if not receiver.poll(min(remaining, 1.0)):
                continue
            try:
                message = receiver.recv()
            except EOFError:
                process.join()
                return Ending("failed", _describe_exit(process.exitcode, log))
            if isinstance(message, Ending):
                process.join(_GRACE)
                return message
            receive(message)
        return Ending("timed out", f"killed after {limit:g} s")
    finally:
        # This also applies to work that has reported its end, but hangs in a library's clean-up.
        if process.pid is not None:
            process.kill()
            process.join()
        receiver.close()


def _run(
    work: Callable[..., Iterator[object]],
    arguments: dict[str, Any],
    sender: Connection,
    log: Path,
) -> None:
    begin_worker()
    try:
        # Libraries write to file descriptors, not to Python's streams.
        descriptor = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        os.dup2(descriptor, 1)
        os.dup2(descriptor, 2)
        faulthandler.enable(sys.stderr)
        # Some libraries write files into the current folder.
        os.chdir(log.parent)
        for message in work(**arguments):
            sender.send(message)
        sender.send(Ending("done"))
    except MissingExtraError as error:
        sender.send(Ending("missing", str(error)))
    except Exception as error:
        sender.send(Ending("failed", describe(error)))


def _describe_exit(code: int | None, log: Path) -> str:
    """Return why a process ended without a report."""
    if code is not None and code < 0:
        how = f"crashed with {signal.Signals(-code).name}"
    else:
        how = f"its process ended with code {code}"
    try:
        lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    except OSError:
        lines = []
    # After a crash, faulthandler's first line is the reason, and the rest is the stack.
    words = [line for line in lines if line.startswith("Fatal") or line.startswith("terminate")]
    last = (words or lines[-1:] or [""])[0].strip()[:_LAST_WORDS]
    return f"{how} ({last})" if last else how
