"""Peers that work, lack a library, raise, crash or hang, at the top level so that workers find them."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import numpy as np
from voxshell_studies.peers.protocol import load_library

RUNS = "TOY_PEERS_RUNS"
"""Environment variable: a folder in which every preparation leaves a file."""


def set_up(job, variant):
    if folder := os.environ.get(RUNS):
        Path(folder, f"{variant}-{time.monotonic_ns()}").touch()
    match variant:
        case "missing":
            load_library("no_library_of_this_name", "no-such-package")
        case "raising":
            raise ValueError("no mesh of\nthis kind")
    return Toy(job, variant)


class Toy:
    version = "1.2"
    timed = "nothing"

    def __init__(self, job, variant):
        self.settings = {"variant": variant, "spacing": 0.25}
        self._job = job
        self._variant = variant

    def meet(self, case):
        return None if case.other == "plane" else Query(self._variant, case)

    def drop(self, other, rate):
        if self._variant == "hanging":
            time.sleep(600.0)
        return Fall(self._job.drop_pose)


class Query:
    """Of seven contacts, the deepest a millimeter too deep; a question takes two milliseconds."""

    def __init__(self, variant, case):
        self._variant = variant
        self._case = case

    def ask(self, pose):
        if self._case.key == "pair-73.6":
            match self._variant:
                case "crashing":
                    os.kill(os.getpid(), signal.SIGSEGV)
                case "leaving":
                    os._exit(7)
                case "stumbling":
                    raise RuntimeError("too many contacts")
        return 0.002

    def answer(self):
        return 7, self._case.depth + 0.001


class Fall:
    """Stands still where it is put."""

    def __init__(self, pose):
        self._pose = np.array(pose)
        self._pose[2, 3] -= 0.5

    def step(self):
        return self._pose


def count_up(count):
    """For run_apart."""
    yield from range(count)


def leave_a_file():
    """As MuJoCo does with its warnings."""
    Path("LIBRARY_LOG.TXT").touch()
    yield str(Path.cwd())


def print_and_leave():
    print("the disk is full", flush=True)
    os._exit(3)
    yield


def abort():
    yield "before"
    os.abort()


def sleep():
    yield "before"
    time.sleep(600.0)


def finish_and_hang():
    """A library that hangs when the process ends."""
    import atexit

    atexit.register(time.sleep, 600.0)
    yield "all"
