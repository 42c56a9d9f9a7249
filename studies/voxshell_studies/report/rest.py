"""Report of rest."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.report.figures import FAINT, OURS, OURS_COARSE, PEERS, open_figure
from voxshell_studies.rest import study
from voxshell_studies.rest.study import RestSettings
from voxshell_studies.verdict import Row, at_most

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell_studies.experiment import Results
    from voxshell_studies.part import Tables

MOST_TURNING = 0.002
"""rad/s."""

ROLLING = 0.1
"""Larger than the vibration of any body here that rests on its contacts, rad/s."""

MOST_DRIFT = 1e-4
"""Largest accepted drift in ten seconds, meters."""

ROLLER_NAMES = {
    "fine": "VPS fine",
    "coarse": "VPS coarse",
    "hull": "Bullet's hull of 42 vertices",
    "whole-hull": "Bullet's hull of all vertices",
    "mujoco": "MuJoCo's hull of all vertices",
}
ROLLER_COLORS = {
    "fine": OURS,
    "coarse": OURS_COARSE,
    "hull": PEERS[1],
    "whole-hull": PEERS[0],
    "mujoco": PEERS[2],
}

GROUND_NAMES = {"voxels": "block of voxels", "plane": "analytic plane"}


def describe(settings: RestSettings) -> str:
    """Return the setup as text."""
    return (
        f"The bunny is released {settings.height * 1e2:g} cm above the ground in {settings.orientations} "
        f"orientations, at {settings.rate:g} Hz, with the fine and the coarse shell and every contact "
        "rule, on a block of voxels and on an analytic plane. Its angular speed is the largest of the "
        f"last {study.WINDOW_SECONDS:g} s before {settings.settle_seconds:g} s after touch-down. Its "
        f"drift is the largest displacement in the next {settings.drift_seconds:g} s. No body sleeps in "
        "these runs; a second set of runs with sleeping on shows whether the bunny falls asleep. "
        "Bullet's own hull of the bunny, with 42 vertices, does the same for comparison. Other engines "
        "show whether contacts cause a body to roll after that time: the hull of all of the bunny's "
        "vertices runs on the plane in Bullet and in MuJoCo, at "
        f"{', '.join(f'{r:g}' for r in settings.roll_rates)} Hz. A body lies still from the time when it "
        f"turns slower than {MOST_TURNING:g} rad/s until the end. None of these bodies has rolling "
        "friction, which brings real bodies to rest. Therefore all models run once more with "
        f"{_name_friction(settings)} on bunny and ground, and the same spinning friction"
        + (f", and in {settings.others} other orientations." if settings.others > 0 else ".")
    )


def reduce(settings: RestSettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    rows = []
    others = _tell_others(settings, results)
    for held, beside in study.HULLS.items():
        hull = results[study.name_rest("plane", beside, "auto", held=held)]["runs"]
        hull_name = "Bullet's hull" if not held else "Bullet's whole hull"
        for ground, shell, mode in product(study.GROUNDS, study.SHELLS, study.MODES):
            runs = results[study.name_rest(ground, shell, mode, held=held)]["runs"]
            who = f"{shell}, {mode}, {GROUND_NAMES[ground]}"
            if held:
                who += f", {_name_friction(settings)}"
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
                    f"({hull_name}: {int((hull['angular_speed'] < MOST_TURNING).sum())}"
                    f"{'' if held else '; ' + others}); "
                    f"at the end worst {runs['end_angular_speed'].max():.2g} "
                    f"({hull['end_angular_speed'].max():.2g})",
                ),
                Row(
                    f"drift over the next {settings.drift_seconds:g} s, worst, {who}",
                    None,
                    float(drift.max()) * 1e3,
                    "mm",
                    bar=f"< {MOST_DRIFT * 1e3:g}",
                    holds=at_most(float(drift.max()), MOST_DRIFT),
                    note=f"{int((drift < MOST_DRIFT).sum())} of {count} orientations below "
                    f"({hull_name}: {int((hull['drift'] < MOST_DRIFT).sum())})",
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
    return rows + _rows_of_others(settings, results) + _rows_of_rolling(settings, results)


def _rows_of_others(settings: RestSettings, results: Results) -> list[Row]:
    """Return rows on orientations for which the rolling friction was not chosen."""
    rows = []
    for ground, shell in product(study.GROUNDS, study.SHELLS) if settings.others > 0 else ():
        missed, count = [], 0
        for mode in study.MODES:
            runs = results[study.name_rest(ground, shell, mode, held=True, others=True)]["runs"]
            calm = (runs["angular_speed"] < MOST_TURNING) & (runs["drift"] < MOST_DRIFT)
            count += len(calm)
            missed += [
                f"{mode} at {runs['angular_speed'][i]:.2g} rad/s, drift {runs['drift'][i] * 1e3:.2g} mm"
                for i in np.flatnonzero(~(calm & (runs["asleep"] > 0)))
            ]
        rows.append(
            Row(
                f"rest in {settings.others} other orientations, {shell}, all modes, "
                f"{GROUND_NAMES[ground]}, {_name_friction(settings)}",
                None,
                count - len(missed),
                f"of {count}",
                note="; ".join(missed),
            )
        )
    return rows


def _name_friction(settings: RestSettings) -> str:
    return f"{settings.rolling_friction * 1e3:g} mm of rolling friction"


def _tell_others(settings: RestSettings, results: Results) -> str:
    """Count the orientations in which the hull of all vertices rests, at the finest rate."""
    rate = max(settings.roll_rates)
    still = {
        roller: count_below(settings, results[name], MOST_TURNING)
        for roller in ("whole-hull", "mujoco")
        if (name := f"roll-{roller}-{rate:g}") in results
    }
    names = {"whole-hull": "Bullet's", "mujoco": "MuJoCo's"}
    return f"whole hull at {rate:g} Hz: " + ", ".join(
        f"{names[each]} {count}" for each, count in still.items()
    )


def _rows_of_rolling(settings: RestSettings, results: Results) -> list[Row]:
    rows = []
    for roller, rate in product(study.ROLLERS, settings.roll_rates):
        name = f"roll-{roller}-{rate:g}"
        count, here, note = (
            settings.orientations,
            float("nan"),
            "pip install voxshell-studies[peers]",
        )
        if name in results:
            stills = np.sort(find_stills(results[name]))
            here = count_below(settings, results[name], MOST_TURNING)
            rolling = count - count_below(settings, results[name], ROLLING)
            note = f"{rolling} roll at {ROLLING:g} rad/s or more; still to the end: " + ", ".join(
                f"{words} {_format_seconds(settings, stills[math.ceil(fraction * count) - 1])}"
                for fraction, words in ((0.5, "half"), (0.9, "nine of ten"), (1.0, "all"))
            )
        rows.append(
            Row(
                f"below {MOST_TURNING:g} rad/s after {settings.settle_seconds:g} s, "
                f"{ROLLER_NAMES[roller]}, {rate:g} Hz, analytic plane",
                None,
                here,
                f"of {count}",
                note=note,
            )
        )
    return rows


def count_below(settings: RestSettings, tables: Tables, limit: float) -> int:
    """Count orientations that stay below a limit, rad/s, before ``settle_seconds``."""
    table = tables["turning"]
    late = table["time"] > settings.settle_seconds - study.WINDOW_SECONDS
    window = late & (table["time"] <= settings.settle_seconds)
    turning = table["orientation"][window & (table["angular_speed"] >= limit)]
    return settings.orientations - len(np.unique(turning))


def find_stills(tables: Tables) -> NDArray[np.float64]:
    """Return when each orientation comes to rest, (orientations,), seconds after touch-down.

    Infinite if it rotates to the end.
    """
    table = tables["turning"]
    stills = []
    for orientation in np.unique(table["orientation"]):
        mine = table["orientation"] == orientation
        times, turns = table["time"][mine], table["angular_speed"][mine] >= MOST_TURNING
        if turns[-1]:
            stills.append(np.inf)
        else:
            # The time of a frame is its end, from which the next one counts.
            stills.append(times[np.flatnonzero(turns)[-1]] if turns.any() else 0.0)
    return np.array(stills)


def _format_seconds(settings: RestSettings, seconds: float) -> str:
    if np.isfinite(seconds):
        return f"from {seconds:.1f} s on"
    return f"not within {settings.settle_seconds + settings.drift_seconds:g} s"


def draw(settings: RestSettings, results: Results, folder: Path) -> list[Picture]:
    """Draw angular speed and drift of every orientation, and the number at rest over time."""
    _draw_rolling(settings, results, folder / "rolling.png")
    with open_figure(folder / "rest.png", width=9, height=7.2) as figure:
        turning, drift = figure.subplots(2, 1, sharex=True)
        colors = {"fine": OURS, "coarse": OURS_COARSE, "hull": PEERS[1], "whole-hull": PEERS[0]}
        cases = list(product(study.GROUNDS, study.SHELLS, study.MODES))
        labels = [f"{shell}\n{mode}\n{ground}" for ground, shell, mode in cases]
        for held, hull in study.HULLS.items():
            for place, case in enumerate([*cases, ("plane", hull, "auto")]):
                runs = results[study.name_rest(*case, held=held)]["runs"]
                at = place + (0.2 if held else -0.2)
                look = {"marker": "o", "mfc": "none"} if held else {"marker": "o"}
                for axes, key, scale in ((turning, "angular_speed", 1.0), (drift, "drift", 1e3)):
                    values = np.maximum(runs[key] * scale, 1e-6)
                    axes.plot(
                        np.full(len(values), at), values, ls="", ms=4, alpha=0.6,
                        color=colors[case[1]], **look,
                    )  # fmt: skip
                end = max(runs["end_angular_speed"].max(), 1e-6)
                turning.plot(at, end, "_", color="black", ms=9)
        for axes, bar, label in (
            (turning, MOST_TURNING, f"angular speed after {settings.settle_seconds:g} s, rad/s"),
            (drift, MOST_DRIFT * 1e3, f"drift in {settings.drift_seconds:g} s, mm"),
        ):
            axes.axhline(bar, color=FAINT, ls="--", lw=1)
            axes.set(yscale="log", ylabel=label)
            axes.set_xticks(range(len(cases) + 1), [*labels, "Bullet's\nhulls\nplane"], fontsize=7)
    return [
        Picture(
            "rest.png",
            "A dot an orientation, hollow: with rolling friction; dashed: the bar; black: the worst angular "
            "speed at the very end. Bullet's hulls: of 42 vertices, and of all with rolling friction.",
        ),
        Picture(
            "rolling.png",
            "In how many orientations the bunny lies still, and does so to the end, over the time since "
            "touch-down, on the plane; the hulls are other contacts than ours. Dashed: the bar.",
        ),
    ]


def _draw_rolling(settings: RestSettings, results: Results, path: Path) -> None:
    with open_figure(path, width=11, height=4) as figure:
        panels = figure.subplots(1, len(settings.roll_rates), sharey=True, squeeze=False)[0]
        for axes, rate in zip(panels, settings.roll_rates, strict=True):
            for roller, label in ROLLER_NAMES.items():
                if (name := f"roll-{roller}-{rate:g}") not in results:
                    continue
                stills = np.sort(find_stills(results[name]))
                stills = stills[np.isfinite(stills)]
                end = settings.settle_seconds + settings.drift_seconds
                axes.step(
                    [0.0, *stills, end],
                    [*range(len(stills) + 1), len(stills)],
                    where="post",
                    color=ROLLER_COLORS[roller],
                    label=label,
                )
            axes.axvline(settings.settle_seconds, color=FAINT, ls="--", lw=1)
            axes.set_title(f"{rate:g} Hz", fontsize=10)
            axes.yaxis.get_major_locator().set_params(integer=True)
            axes.set(xlabel="time since touch-down, s", ylim=(0, settings.orientations + 0.5))
        panels[0].set_ylabel(f"lie still, of {settings.orientations}")
        lines, labels = panels[0].get_legend_handles_labels()
        figure.legend(lines, labels, loc="outside upper center", ncols=3, fontsize=8, frameon=False)


REST = Experiment(
    name="rest",
    title="Rest",
    question="Does the bunny come to rest, stay where it is, and fall asleep?",
    describe=describe,
    settings=RestSettings(),
    quick=replace(RestSettings(), orientations=4, others=4, roll_rates=(200.0, 1000.0)),
    plan=study.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
