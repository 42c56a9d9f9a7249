"""What rest says."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from voxshell.experiments import rest
from voxshell.experiments.experiment import Experiment, Picture
from voxshell.experiments.report.figures import FAINT, OURS, OURS_COARSE, PEERS, open_figure
from voxshell.experiments.rest import RestSettings
from voxshell.experiments.verdict import Row, at_most

if TYPE_CHECKING:
    from pathlib import Path

    from voxshell.experiments.experiment import Results

MOST_TURNING = 0.002
"""rad/s."""

MOST_DRIFT = 1e-4
"""Metres in ten seconds."""

GROUND_NAMES = {"voxels": "block of voxels", "plane": "analytic plane"}


def describe(settings: RestSettings) -> str:
    """The set-up in words."""
    return (
        f"The bunny is let go {settings.height * 1e2:g} cm over the ground in {settings.orientations} "
        f"orientations, at {settings.rate:g} Hz, with the fine and the coarse shell, each way to make "
        "contacts, on a block of voxels and on an analytic plane. Its angular speed is the largest of "
        f"the last {rest.WINDOW_SECONDS:g} s before {settings.settle_seconds:g} s after touch-down, "
        f"its drift the farthest from there in the next {settings.drift_seconds:g} s, nothing sleeps. "
        "Once more with sleeping on: does it fall asleep? Bullet's own hull of the bunny does the "
        "same for comparison: a body that still rolls after that time is not a fault of contacts."
    )


def reduce(settings: RestSettings, results: Results) -> list[Row]:
    """The verdicts."""
    rows = []
    hull = results["plane-hull-auto"]["runs"]
    for ground in rest.GROUNDS:
        for shell in rest.SHELLS:
            for mode in rest.MODES:
                runs = results[f"{ground}-{shell}-{mode}"]["runs"]
                who = f"{shell}, {mode}, {GROUND_NAMES[ground]}"
                turning, drift = runs["angular_speed"], runs["drift"]
                asleep, count = int(runs["asleep"].sum()), len(turning)
                rows += [
                    Row(
                        f"angular speed after {settings.settle_seconds:g} s, worst, {who}",
                        None,
                        float(turning.max()),
                        "rad/s",
                        bar=f"< {MOST_TURNING:g}",
                        holds=at_most(float(turning.max()), MOST_TURNING),
                        note=f"{int((turning < MOST_TURNING).sum())} of {count} orientations below "
                        f"(Bullet's hull: {int((hull['angular_speed'] < MOST_TURNING).sum())}); "
                        f"at the end worst {runs['end_angular_speed'].max():.2g} (Bullet's hull: "
                        f"{hull['end_angular_speed'].max():.2g})",
                    ),
                    Row(
                        f"drift over the next {settings.drift_seconds:g} s, worst, {who}",
                        None,
                        float(drift.max()) * 1e3,
                        "mm",
                        bar=f"< {MOST_DRIFT * 1e3:g}",
                        holds=at_most(float(drift.max()), MOST_DRIFT),
                        note=f"{int((drift < MOST_DRIFT).sum())} of {count} orientations below "
                        f"(Bullet's hull: {int((hull['drift'] < MOST_DRIFT).sum())})",
                    ),
                    Row(
                        f"fall asleep, {who}",
                        None,
                        asleep,
                        f"of {count}",
                        bar="all",
                        holds=asleep == count,
                    ),
                ]
    return rows


def draw(settings: RestSettings, results: Results, folder: Path) -> list[Picture]:
    """Angular speed and drift of every orientation."""
    with open_figure(folder / "rest.png", width=9, height=7.2) as figure:
        turning, drift = figure.subplots(2, 1, sharex=True)
        cases = [
            *((f"{g}-{s}-{m}", s, f"{s}\n{m}\n{g}") for g in rest.GROUNDS for s in rest.SHELLS for m in rest.MODES),
            ("plane-hull-auto", "hull", "Bullet's\nhull\nplane"),
        ]  # fmt: skip
        colors = {"fine": OURS, "coarse": OURS_COARSE, "hull": PEERS[1]}
        for place, (name, shell, _) in enumerate(cases):
            runs = results[name]["runs"]
            for axes, key, scale in ((turning, "angular_speed", 1.0), (drift, "drift", 1e3)):
                values = np.maximum(runs[key] * scale, 1e-6)
                axes.plot(
                    np.full(len(values), place), values, "o", ms=4, alpha=0.6, color=colors[shell]
                )
            turning.plot(
                place + 0.25, max(runs["end_angular_speed"].max(), 1e-6), "_", color="black", ms=9
            )
        for axes, bar, label in (
            (turning, MOST_TURNING, f"angular speed after {settings.settle_seconds:g} s, rad/s"),
            (drift, MOST_DRIFT * 1e3, f"drift in {settings.drift_seconds:g} s, mm"),
        ):
            axes.axhline(bar, color=FAINT, ls="--", lw=1)
            axes.set(yscale="log", ylabel=label)
            axes.set_xticks(range(len(cases)), [label for *_, label in cases], fontsize=7)
    return [
        Picture(
            "rest.png",
            "A dot an orientation; dashed: the bar; black: the worst angular speed at the very end.",
        )
    ]


REST = Experiment(
    name="rest",
    title="Rest",
    question="Does the bunny come to rest, stay where it is, and fall asleep?",
    describe=describe,
    settings=RestSettings(),
    quick=replace(RestSettings(), orientations=4),
    plan=rest.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
