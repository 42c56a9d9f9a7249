"""Processes that write models at the same time, or are killed while they write."""

from __future__ import annotations

import hashlib
import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

from voxshell import _core
from voxshell.model.cache import ModelCache


def kill_after(seconds: float, work: Callable[[int], object]) -> None:
    """A child that repeats `work`, with numbers from 1, until it is killed."""
    child = os.fork()
    if child == 0:
        try:
            number = 0
            while True:
                number += 1
                work(number)
        finally:
            os._exit(1)
    time.sleep(seconds)
    os.kill(child, signal.SIGKILL)
    status = os.waitpid(child, 0)[1]
    assert os.WIFSIGNALED(status), "the writer failed before it was killed"


def kill_while_storing(
    cache: ModelCache, core: _core.Model, seconds: float, series: int = 0
) -> None:
    """Kills a process that stores one model after the other."""
    kill_after(seconds, lambda number: cache.fetch(f"{series:032x}{number:032x}", lambda: core))


def race(
    cache: ModelCache, key: str, core: _core.Model, processes: int, build_seconds: float
) -> tuple[int, list[bytes]]:
    """Processes that ask for one model at the same time.

    Returns:
        How many of them built it, and a digest of what each one got.
    """
    log_reading, log_writing = os.pipe()

    def build() -> _core.Model:
        os.write(log_writing, b"b")
        time.sleep(build_seconds)
        return core

    start = time.monotonic() + 0.05
    answers: list[int] = []
    for _ in range(processes):
        reading, writing = os.pipe()
        if os.fork() == 0:
            try:
                time.sleep(max(0.0, start - time.monotonic()))
                points = cache.fetch(key, build).shell.points
                os.write(writing, hashlib.sha256(points.tobytes()).digest())
            finally:
                os._exit(0)
        os.close(writing)
        answers.append(reading)
    found = [os.read(reading, 100) for reading in answers]
    for reading in answers:
        os.close(reading)
        os.wait()
    os.close(log_writing)
    builds = len(os.read(log_reading, 1000))
    os.close(log_reading)
    return builds, found


def leftovers(folder: Path) -> list[str]:
    """Names of files that are no models."""
    return [name for name in os.listdir(folder) if not name.endswith(".vxs")]
