"""Many processes that ask an empty cache for the same model at the same time.

In every second round each process is held up at random between its system calls, so that others meet it in
moments that are short otherwise.
"""

from __future__ import annotations

import hashlib
import tempfile
from pathlib import Path

import numpy as np
import trimesh
import voxshell as vx
from voxshell.model import cache as cache_module
from voxshell.model.cache import ModelCache

from soak.task import Check, Outcome, Task, Totals

PROCESSES = 8


def prepare() -> Check:
    import cache_races

    cache_module.WORTH_SECONDS = 0.0
    core = vx.Model.from_mesh(trimesh.creation.box(), resolution=3, padding=0, cache=False)._core
    wanted = hashlib.sha256(core.shell.points.tobytes()).digest()

    def check(case: int) -> Outcome:
        rng = np.random.default_rng([case, 6])
        key = hashlib.sha256(str(case).encode()).hexdigest()
        with tempfile.TemporaryDirectory(prefix="voxshell-soak-") as folder:
            cache = ModelCache(Path(folder, "models"))
            # Some builds end before others have begun to wait.
            builds, answers = cache_races.race(
                cache,
                key,
                core,
                PROCESSES,
                rng.choice((0.0, 0.001, 0.02, 0.1)),
                seed=case if case % 2 else None,
            )
            assert builds == 1, f"{builds} processes built it"
            assert answers == [wanted] * PROCESSES, "not all processes got the same model"
            assert len(cache.entries()) == 1
            assert not cache_races.leftovers(Path(folder, "models"))
        return Outcome(1, {"processes": PROCESSES, "held up": case % 2})

    return check


def describe(totals: Totals) -> str:
    return (
        f"{totals.tallies['processes']:,.0f} processes, {PROCESSES} per round, one build per round; "
        f"{totals.tallies['held up']:,.0f} rounds with random delays between system calls"
    )


TASK = Task(
    promise="If many processes request one model at the same time, exactly one builds it",
    oracle="the number of builds, and a digest of each process's model",
    unit="rounds",
    target=1_000,
    prepare=prepare,
    describe=describe,
)
