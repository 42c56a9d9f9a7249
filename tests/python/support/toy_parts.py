"""Parts of experiments that are quick, slow, wrong or deadly, at the top level so that workers find them."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import numpy as np


def squares(count: int) -> dict:
    return {"numbers": {"n": np.arange(count), "square": np.arange(count) ** 2.0}}


def nap(seconds: float, number: int) -> dict:
    time.sleep(seconds)
    return {"numbers": {"number": np.array([number])}}


def note(folder: str, name: str) -> dict:
    """Leaves a line with its beginning and end."""
    start = time.monotonic()
    time.sleep(0.05)
    with (Path(folder) / name).open("a") as file:
        file.write(f"{start} {time.monotonic()} {os.getpid()}\n")
    return {"done": {"pid": np.array([os.getpid()])}}


def fail() -> dict:
    raise ValueError("the ball is square")


def uneven() -> dict:
    return {"numbers": {"a": np.zeros(2), "b": np.zeros(3)}}


def die_once(folder: str) -> dict:
    """Kills its own process the first time."""
    marker = Path(folder) / "died"
    if not marker.exists():
        marker.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return {"numbers": {"answer": np.array([42])}}


class Deadly:
    """Kills whoever unpickles it."""

    def __reduce__(self):
        return _kill_own_process, ()


def _kill_own_process():
    os.kill(os.getpid(), signal.SIGKILL)


def name_process(item):
    time.sleep(0.05)
    return item, os.getpid()


def make_much(item):
    """More than a pipe holds, so that whoever makes it is mostly about to hand it over."""
    return bytes(30_000_000)


def refuse_zero(item):
    if item == 0:
        raise ValueError("0 is too small")
    return item
