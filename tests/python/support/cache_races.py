"""Processes that write models at the same time, are killed while they write, or are held up."""

from __future__ import annotations

import fcntl
import hashlib
import os
import random
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from voxshell import _core
from voxshell.model.cache import ModelCache

CALLS = (
    *("open", "close", "stat", "lstat", "fstat", "scandir", "mkdir", "rmdir", "unlink"),
    *("rename", "replace", "utime"),
)
"""Of `os`, with which Python's part of the cache works on files."""


@contextmanager
def before_each_call(act: Callable[[], object]) -> Iterator[None]:
    """Does something before each call of the system that works on files, also before `flock`."""
    places: list[tuple[Any, str]] = [*((os, name) for name in CALLS), (fcntl, "flock")]
    kept = [getattr(place, name) for place, name in places]

    def acting(call: Callable[..., object]) -> Callable[..., object]:
        def act_and_call(*arguments: object, **options: object) -> object:
            act()
            return call(*arguments, **options)

        return act_and_call

    for (place, name), call in zip(places, kept, strict=True):
        setattr(place, name, acting(call))
    try:
        yield
    finally:
        for (place, name), call in zip(places, kept, strict=True):
            setattr(place, name, call)


def dawdle(seed: int, fraction: float = 0.15, longest: float = 0.01) -> Callable[[], None]:
    """Something that sometimes takes a while, as a process does that the system interrupts.

    Args:
        seed: Of the times.
        fraction: Of the calls that take a while.
        longest: Seconds of one.
    """
    generator = random.Random(seed)

    def wait() -> None:
        if generator.random() < fraction:
            time.sleep(generator.uniform(0.0, longest))

    return wait


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
    cache: ModelCache,
    key: str,
    core: _core.Model,
    processes: int,
    build_seconds: float,
    seed: int | None = None,
) -> tuple[int, list[bytes]]:
    """Processes that ask for one model at the same time.

    Args:
        cache: Where they look for it.
        key: Of the model.
        core: The model.
        processes: How many there are.
        build_seconds: That a build takes.
        seed: Of interruptions between the calls of each process; None for no interruptions.

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
    for number in range(processes):
        reading, writing = os.pipe()
        if os.fork() == 0:
            try:
                time.sleep(max(0.0, start - time.monotonic()))
                wait = (lambda: None) if seed is None else dawdle(processes * seed + number)
                with before_each_call(wait):
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
