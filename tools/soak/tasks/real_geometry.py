"""Contacts of real parts against the meshes themselves."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from soak.task import CORE, Check, Outcome, Task, Totals, UnavailableError

BUNNY = Path("/usr/share/glmark2/models/bunny.obj")
POSES = 10  # a case


def prepare() -> Check:
    import real_geometry

    if not BUNNY.is_file():
        raise UnavailableError(f"{BUNNY} is missing; install the package glmark2-data")

    @cache
    def court(name: str) -> real_geometry.Court:
        return real_geometry.Court(real_geometry.make_pair(name, BUNNY))

    def check(case: int) -> Outcome:
        names = real_geometry.NAMES
        judge = court(names[case % len(names)])
        rng = np.random.default_rng([case, 2])
        first = case // len(names) * POSES
        verdicts = [judge.judge(index, rng) for index in range(first, first + POSES)]
        return Outcome(
            POSES,
            {
                "in contact": sum(verdict.in_contact for verdict in verdicts),
                "clear": sum(verdict.clear for verdict in verdicts),
                "judged": sum(2 * verdict.judged for verdict in verdicts),
                "proven": sum(verdict.proven for verdict in verdicts),
            },
        )

    return check


def describe(totals: Totals) -> str:
    in_contact, clear = (totals.tallies[name] / totals.count for name in ("in contact", "clear"))
    return (
        f"{in_contact:.0%} in contact, {clear:.0%} proven clear; contact proven for "
        f"{totals.tallies['proven']:,.0f} shells"
    )


def doubt(totals: Totals) -> str:
    if totals.count < 500:
        return ""
    in_contact, clear = (totals.tallies[name] / totals.count for name in ("in contact", "clear"))
    proven = totals.fraction("proven", "judged")
    enough = 0.3 <= in_contact <= 0.8 and clear >= 0.15 and proven >= 0.15
    return "" if enough else f"too few poses prove anything: {describe(totals)}"


TASK = Task(
    promise="Overlap beyond the stated bound is a contact, and clearance beyond it is not",
    oracle="coal and manifold3d on the meshes",
    unit="poses",
    target=100_000,
    prepare=prepare,
    sources=(*CORE, "tests/python/support/real_geometry.py"),
    describe=describe,
    doubt=doubt,
)
