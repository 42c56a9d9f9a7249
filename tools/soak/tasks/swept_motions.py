"""Sweeps against queries at fractions before the one that they name, over the pairs of tree_poses."""

from __future__ import annotations

import fast_paths
import numpy as np
import voxshell as vx

from soak.task import CORE, Check, Outcome, Task, Totals
from soak.tasks import tree_poses

POSES = 30  # a case: twenty motions, from a far pose to one that touches and to one that is deep
LOOKS = 100  # before each fraction, half of them just before


def motions_of(pair: fast_paths.Pair, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """b_from_a where motions begin and end: some of them stop before they touch, some go through."""
    poses = fast_paths.far_touching_or_deep(pair, POSES, rng)
    starts = np.repeat(poses[0::3], 2, axis=0)
    toward = np.stack([poses[1::3], poses[2::3]], axis=1).reshape(-1, 4, 4)
    ends = [
        vx.interpolate_pose(start, end, rng.uniform(0.2, 2.0))
        for start, end in zip(starts, toward, strict=True)
    ]
    return starts, np.array(ends)


def prepare() -> Check:
    names = list(tree_poses.PAIRS)

    def check(case: int) -> Outcome:
        pair = tree_poses.asker(names[case % len(names)]).pair
        rng = np.random.default_rng([case, 5])
        starts, ends = motions_of(pair, rng)
        found = vx.sweep_batch(pair.a, pair.b, starts, a_ends=ends, threads=1)
        for i, fraction in enumerate(found.fractions):
            left = np.concatenate([rng.random(LOOKS // 2), 10.0 ** rng.uniform(-7, 0, LOOKS // 2)])
            before = vx.interpolate_pose(starts[i], ends[i], fraction * (1.0 - left))
            if fraction > 0.0 and vx.collide_batch(pair.a, pair.b, before, threads=1).any():
                raise AssertionError(f"motion {i} touches before its fraction {fraction}")
        return Outcome(
            len(starts),
            {
                "touching": float((found.touches & (found.fractions > 0.0)).sum()),
                "free": float((~found.touches).sum()),
                "looks": float(LOOKS * (found.fractions > 0.0).sum()),
            },
        )

    return check


def describe(totals: Totals) -> str:
    touching, free = (totals.tallies[name] / totals.count for name in ("touching", "free"))
    return (
        f"{touching:.0%} touch during the motion, {free:.0%} do not; "
        f"{totals.tallies['looks']:,.0f} checks"
    )


def doubt(totals: Totals) -> str:
    if totals.count < 1000:
        return ""
    touching, free = (totals.tallies[name] / totals.count for name in ("touching", "free"))
    enough = touching >= 0.3 and free >= 0.1
    return "" if enough else f"too few motions of either kind: {describe(totals)}"


TASK = Task(
    promise="No two bodies touch before the time of impact that a sweep returns",
    oracle="queries at a hundred earlier fractions of the motion",
    unit="motions",
    target=100_000,
    prepare=prepare,
    sources=(*CORE, "tests/python/support/fast_paths.py", "tests/python/support/parts.py"),
    describe=describe,
    doubt=doubt,
)
