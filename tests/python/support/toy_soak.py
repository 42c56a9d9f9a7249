"""Tasks that are sound, wrong, deadly, hanging or not to be had, for the tests of tools/soak."""

from __future__ import annotations

import fcntl
import os
import signal
import time

from soak.task import Check, Outcome, Task, UnavailableError


def sound() -> Check:
    return lambda case: Outcome(2, {"sum": case}, {"largest": case})


def wrong() -> Check:
    def check(case: int) -> Outcome:
        assert case != 3, "case three is wrong"
        return Outcome()

    return check


def deadly() -> Check:
    def check(case: int) -> Outcome:
        if case == 1:
            os.kill(os.getpid(), signal.SIGSEGV)
        return Outcome()

    return check


def hanging() -> Check:
    def check(case: int) -> Outcome:
        time.sleep(60.0 if case == 0 else 0.0)
        return Outcome()

    return check


def exclusive() -> Check:
    """Fails where two processes run its cases at the same time."""

    def check(case: int) -> Outcome:
        with open(__file__) as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            time.sleep(0.3)
        return Outcome()

    return check


def broken() -> Check:
    raise ValueError("no such file")


def missing() -> Check:
    raise UnavailableError("no such tool")


TASKS = {
    prepare.__name__: Task(
        promise=f"{prepare.__name__} holds",
        oracle="none",
        unit="cases",
        target=10,
        prepare=prepare,
        describe=lambda totals: f"{totals.count:.0f} cases",
        patience=2.0,
    )
    for prepare in (sound, wrong, deadly, hanging, exclusive, broken, missing)
}
