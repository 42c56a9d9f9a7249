"""Processes that are killed while they write a cache or a model file."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import numpy as np
import trimesh
import voxshell as vx
from voxshell.model import cache as cache_module
from voxshell.model.cache import ModelCache

from soak.task import Check, Outcome, Task, Totals

KILLS = 20  # a case


def prepare() -> Check:
    import cache_races

    cache_module.WORTH_SECONDS = 0.0
    box = trimesh.creation.box()
    cores = [
        vx.Model.from_mesh(box, resolution=resolution, padding=0, cache=False)._core
        for resolution in (3, 4)
    ]

    def check(case: int) -> Outcome:
        rng = np.random.default_rng([case, 5])
        folder = Path(tempfile.mkdtemp(prefix="voxshell-soak-"))
        try:
            if case % 2 == 0:
                whole, left = store(folder, rng)
            else:
                whole, left = save(folder, rng)
        finally:
            shutil.rmtree(folder)
        return Outcome(KILLS, {"whole": whole, "left": left})

    def store(folder: Path, rng: np.random.Generator) -> tuple[int, int]:
        cache = ModelCache(folder)
        for kill in range(KILLS):
            cache_races.kill_while_storing(cache, cores[0], rng.uniform(0.0, 0.02), kill)
        entries = cache.entries()
        for entry in entries:
            vx.Model.load(cache._path(entry))  # raises where it is torn
        return len(entries), len(cache_races.leftovers(folder)) if folder.exists() else 0

    def save(folder: Path, rng: np.random.Generator) -> tuple[int, int]:
        path = folder / "model.vxs"
        wanted = set()
        for core in cores:
            core.save(bytes(path))
            wanted.add(path.read_bytes())
        for _ in range(KILLS):
            cache_races.kill_after(
                rng.uniform(0.0, 0.01), lambda number: cores[number % 2].save(bytes(path))
            )
            assert path.read_bytes() in wanted, "the file is neither the old model nor the new one"
        return 1, len(cache_races.leftovers(folder))

    return check


def describe(totals: Totals) -> str:
    return (
        f"{totals.tallies['whole']:,.0f} files read back complete; killed processes left "
        f"{totals.tallies['left']:,.0f} unfinished files, which are never read"
    )


def doubt(totals: Totals) -> str:
    # A kill that meets no write proves nothing.
    few = totals.count >= 500 and totals.tallies["left"] < 0.02 * totals.count
    return "hardly any kill met a writer at work" if few else ""


TASK = Task(
    promise="A process that is killed while it writes a model leaves no incomplete model",
    oracle="every file is read back",
    unit="kills",
    target=10_000,
    prepare=prepare,
    describe=describe,
    doubt=doubt,
)
