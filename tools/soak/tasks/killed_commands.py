"""Commands that are killed at a random moment, and run again."""

from __future__ import annotations

import shutil
import tempfile
import time
from pathlib import Path

import numpy as np

from soak.task import Check, Outcome, Task, Totals


def prepare() -> Check:
    import killed_commands

    commands = killed_commands.list_commands(Path(tempfile.mkdtemp(prefix="voxshell-soak-")))
    seconds: dict[str, float] = {}

    def check(case: int) -> Outcome:
        rng = np.random.default_rng([case, 12])
        name = list(commands)[case % len(commands)]
        folder = Path(tempfile.mkdtemp(prefix="voxshell-soak-"))
        command = commands[name](folder)
        try:
            if name not in seconds:
                began = time.monotonic()
                killed_commands.run(command, folder)
                seconds[name] = time.monotonic() - began
                shutil.rmtree(folder)
                folder.mkdir()
            number = killed_commands.SIGNALS[rng.integers(3)]
            after = rng.uniform(0.0, seconds[name])
            lived = killed_commands.kill(command, folder, after, number)
            killed_commands.run(command, folder)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        return Outcome(int(lived), {name: int(lived)})

    return check


def describe(totals: Totals) -> str:
    return ", ".join(f"{name} {count:,.0f}" for name, count in sorted(totals.tallies.items()))


TASK = Task(
    promise="A killed command succeeds when it is rerun, and the rerun removes unfinished files",
    oracle="the exit code of the second run, and the names in its folder and cache",
    unit="kills",
    target=200,
    prepare=prepare,
    describe=describe,
)
