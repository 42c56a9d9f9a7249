"""Report of low rates."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from voxshell.model.meshes import Mesh

from voxshell_studies import rates
from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.motion import restore
from voxshell_studies.rates import RatesSettings
from voxshell_studies.report.figures import FAINT, OURS, OURS_COARSE, as_rgb, open_figure
from voxshell_studies.report.paint import thin_out
from voxshell_studies.report.rules import RULE_NAMES
from voxshell_studies.verdict import Row, at_most

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell_studies.experiment import Results
    from voxshell_studies.part import Columns

PUBLISHED_LOWEST = {1: 30.0, 4: 10.0, 5: 10.0}
"""Approximate lowest steps per second at which a level holds (section 5.3)."""

GROUNDS = {"plane": "half-space", "slab": "slab of 5 cm"}
LOW_RATE = 5.0
DEPTHS = {"deepest after the first contact": "later_depth", "deepest at rest": "rest_depth"}
HELD_TO = ("level 4", "level 5", "regular", "auto")
"""Modes with bars: fewer contacts cannot carry a body at any rate."""


def describe(settings: RatesSettings) -> str:
    """Return the setup as text."""
    return (
        f"The bunny with {settings.fine_points:,} points falls {settings.height:g} m in "
        f"{settings.orientations} orientations. Each run takes {settings.seconds:g} s and at least "
        f"{rates.LEAST_STEPS} steps at each rate from {settings.rates[0]:g} to {settings.rates[-1]:g} "
        "Hz, on a half-space and on a slab of "
        f"{2e2 * rates.SLAB_HALF_EXTENTS[2]:g} cm. The ground carries the bunny if its center of mass is "
        "above the surface and above the ground at the end. The published rule makes contacts of the "
        "points that penetrate: the deepest of each segment of a level. Our rule adds points that will "
        "touch within the step. Then the bunny is thrown at "
        f"{' and '.join(f'{v:g}' for v in settings.throw_speeds)} m/s, at {settings.throw_rate:g} Hz."
    )


def is_carried(runs: Columns, ground: str) -> NDArray[np.bool_]:
    """Return whether the center of mass is above the surface at the end, and not beside the slab."""
    over = np.isfinite(runs["middle"]) & (runs["middle"] > 0.0)
    if ground == "slab":
        over &= runs["sideways"] < rates.SLAB_HALF_EXTENTS[0]
    return over


def reduce(settings: RatesSettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    return [
        *_rows_as_published(results),
        *_rows_of_ours(settings, results),
        *_rows_of_throws(settings, results),
    ]


def _rows_as_published(results: Results) -> list[Row]:
    lowest = {
        level: _find_lowest(results, "published", "plane", f"level {level}")
        for level in rates.LEVELS
    }
    rows = [
        Row(
            f"lowest rate that holds, L = {level}, published rule, half-space",
            PUBLISHED_LOWEST.get(level),
            lowest[level],
            "Hz",
            reproduced=_is_reproduced(level, lowest),
            note=("reproduced when it is below that of L = 1" if level >= 4 else "")
            + ("reproduced within a factor of two" if level == 1 else ""),
        )
        for level in rates.LEVELS
    ]
    depths = [
        _rest_depth(results, "published", "plane", f"level {level}", max(lowest[1], 30.0))
        for level in rates.LEVELS
    ]
    rows.append(
        Row(
            "penetration at rest of L = 5, as part of that of L = 1, at the lowest rate of L = 1",
            "less at higher L",
            depths[-1] / depths[0],
            "",
            reproduced=at_most(depths[-1] / depths[0], 1.0),
            note=f"medians of levels 1 to 5: {', '.join(f'{1e3 * d:.1f}' for d in depths)} mm",
        )
    )
    return rows


def _is_reproduced(level: int, lowest: dict[int, float]) -> bool | None:
    if level == 1:
        return PUBLISHED_LOWEST[1] / 2.0 <= lowest[1] <= PUBLISHED_LOWEST[1] * 2.0
    return lowest[level] < lowest[1] if level in PUBLISHED_LOWEST else None


def _rows_of_ours(settings: RatesSettings, results: Results) -> list[Row]:
    rows = []
    for ground, where in GROUNDS.items():
        for mode in rates.MODES:
            held_to = mode in HELD_TO
            lowest = _find_lowest(results, "voxshell", ground, mode)
            runs = results[f"fall-voxshell-{ground}-{mode}"]["runs"]
            fast = runs["rate"] >= LOW_RATE
            tail = f"{mode}, our rule, {where}"
            rows.append(
                Row(
                    f"lowest rate that holds, {tail}",
                    None,
                    lowest,
                    "Hz",
                    bar=f"<= {LOW_RATE:g}" if held_to else "",
                    holds=at_most(lowest, LOW_RATE) if held_to else None,
                )
            )
            if held_to:
                rows += [
                    Row(
                        f"{what}, {settings.rates[0]:g} to {LOW_RATE:g} Hz, {tail}",
                        None,
                        float(runs[key][fast].max()) * 1e3,
                        "mm",
                        bar=f"<= {settings.voxel_size * 1e3:g} (a voxel)",
                        holds=at_most(float(runs[key][fast].max()), settings.voxel_size),
                        note=_tell_depths(runs, key, settings.voxel_size),
                    )
                    for what, key in DEPTHS.items()
                ]
    return rows


def _rows_of_throws(settings: RatesSettings, results: Results) -> list[Row]:
    rows = []
    for ground, where in GROUNDS.items():
        for mode in rates.THROWN_MODES:
            runs = results[f"throw-{ground}-{mode}"]["runs"]
            for speed in settings.throw_speeds:
                mine = runs["speed"] == speed
                case = {name: values[mine] for name, values in runs.items()}
                through = _fell_through(case, ground)
                rows.append(
                    Row(
                        f"went through when thrown at {speed:g} m/s, {settings.throw_rate:g} Hz, "
                        f"{mode}, {where}",
                        None,
                        float(through.sum()),
                        f"of {len(through)}",
                        bar="0",
                        holds=not through.any(),
                        note=f"deepest {1e3 * float(case['deepest'][~through].max(initial=0.0)):.1f} mm",
                    )
                )
    return rows


def draw(settings: RatesSettings, results: Results, folder: Path) -> list[Picture]:
    """Draw depth at rest over rates, and the lowest rate of each level."""
    shades = ("#c7e9c0", "#8fd08f", "#4fae72", "#238b57", "#00522e", "#5c6bc0", "#c2410c")
    with open_figure(folder / "rates.png", width=12, height=7.5) as figure:
        panels = figure.subplots(2, 2, sharex=True, sharey=True)
        for line, rule in zip(panels, rates.RULES, strict=True):
            for axes, ground in zip(line, GROUNDS, strict=True):
                for mode, color in zip(rates.MODES, shades, strict=True):
                    if mode not in rates.modes_of(rule):
                        continue
                    runs = results[f"fall-{rule}-{ground}-{mode}"]["runs"]
                    depths = [
                        float(np.median(runs["rest_depth"][runs["rate"] == rate])) * 1e3
                        for rate in settings.rates
                    ]
                    axes.plot(
                        settings.rates,
                        np.clip(depths, 0.05, 1e4),
                        color=color,
                        marker=".",
                        label=mode,
                    )
                axes.axhline(settings.voxel_size * 1e3, color=FAINT, ls="--", lw=1)
                axes.set(xscale="log", yscale="log", title=f"{RULE_NAMES[rule]}, {GROUNDS[ground]}")
        for axes in panels[1]:
            axes.set_xlabel("rate, Hz")
        for axes in panels[:, 0]:
            axes.set_ylabel("depth at rest, median, mm")
        panels[1, 0].legend(fontsize=8, frameon=False)
    with open_figure(folder / "lowest.png", width=9, height=3.6) as figure:
        axes = figure.subplots()
        names = rates.MODES
        pairs = list(product(rates.RULES, rates.GROUNDS))
        for index, (rule, ground) in enumerate(pairs):
            shown = rates.modes_of(rule)
            lowest = [_find_lowest(results, rule, ground, mode) for mode in shown]
            places = np.arange(len(shown)) + 0.2 * (index - 1.5)
            color = ("#9aa5b1", "#cbd2d9", "#0b6e4f", "#90be6d")[index]
            axes.plot(
                places,
                np.minimum(lowest, 2 * settings.rates[0]),
                "o",
                color=color,
                label=f"{RULE_NAMES[rule]}, {GROUNDS[ground]}",
            )
        axes.set_xticks(range(len(names)), names)
        axes.set(yscale="log", ylabel="lowest rate that holds, Hz")
        axes.legend(fontsize=8, frameon=False)
    _save_replay(settings, results, folder / "replay.html")
    return [
        Picture("rates.png", "Depth of the lowest vertex at rest over the rate, medians over orientations; dashed: a voxel. Above 100 mm the body has fallen through, or over the slab's edge."),
        Picture("lowest.png", "The lowest rate down to which every orientation is carried (twice the highest rate: at none)."),
        Picture("replay.html", "The upright bunny's fall on the half-space at low rates, published rule and ours."),
    ]  # fmt: skip


def _save_replay(settings: RatesSettings, results: Results, path: Path) -> None:
    from trimesh.creation import box
    from voxshell.viewer.lanes import arrange_lanes
    from voxshell.viewer.replay import save_replay

    plate = box((0.5, 0.5, 0.004))
    plate.apply_translation((0.0, 0.0, -0.002))
    flat = Mesh(plate.vertices, plate.faces)
    bunny = thin_out(settings.build_mesh(), settings.size / 60)
    recordings = {}
    for number, (rule, mode, rate) in enumerate(rates.SHOWN):
        color = as_rgb(OURS if rule == "voxshell" else OURS_COARSE)
        recordings[f"{RULE_NAMES[rule]}\n{mode}, {rate:g} Hz"] = restore(
            {name: results["shown"][f"{number}_{name}"] for name in ("poses", "contacts")},
            {"ground": (flat, None), "bunny": (bunny, color)},
            1.0 / rate,
        )
    save_replay(
        path,
        arrange_lanes(recordings),
        title="Low rates",
        caption="The bunny falls on a half-space. The published rule makes contacts of points that "
        "penetrate; ours adds those that will touch within the step.",
    )


def _find_lowest(results: Results, rule: str, ground: str, mode: str) -> float:
    runs = results[f"fall-{rule}-{ground}-{mode}"]["runs"]
    return rates.find_lowest_rate(runs["rate"], is_carried(runs, ground))


def _rest_depth(results: Results, rule: str, ground: str, mode: str, rate: float) -> float:
    runs = results[f"fall-{rule}-{ground}-{mode}"]["runs"]
    nearest = runs["rate"][np.argmin(np.abs(runs["rate"] - rate))]
    return float(np.median(runs["rest_depth"][runs["rate"] == nearest]))


def _tell_depths(runs: Columns, key: str, limit: float) -> str:
    fast = runs["rate"] >= LOW_RATE
    deep = runs["rate"][fast & (runs[key] > limit)]
    return (
        f"median {1e3 * float(np.median(runs[key][fast])):.2f} mm"
        + (
            f"; in the first contact's step {1e3 * float(runs['deepest'][fast].max()):.1f} mm"
            if key == "later_depth"
            else ""
        )
        + (
            f"; {len(deep)} of {int(fast.sum())} runs above the bar, at {deep.max():g} Hz and less; "
            f"down to the next rate {1e3 * _deepest_above(runs, key, deep.max()):.2f} mm"
            if len(deep)
            else ""
        )
    )


def _deepest_above(runs: Columns, key: str, rate: float) -> float:
    """Return the largest depth at rates above a given one, meters."""
    return float(runs[key][runs["rate"] > rate].max(initial=0.0))


def _fell_through(runs: Columns, ground: str) -> NDArray[np.bool_]:
    """Return whether the body ends below the ground; one that bounced over the slab's edge did not."""
    beside = runs["sideways"] >= rates.SLAB_HALF_EXTENTS[0] if ground == "slab" else False
    return ~(runs["middle"] > 0.0) & ~np.asarray(beside)


RATES = Experiment(
    name="rates",
    title="Low rates",
    question="At which step rates does the ground carry the bunny, and how deep does it sink?",
    describe=describe,
    settings=RatesSettings(),
    quick=replace(
        RatesSettings(),
        orientations=3,
        rates=(200, 50, 30, 20, 15, 10, 5, 2, 1),
        seconds=3.0,
    ),
    plan=rates.plan,
    reduce=reduce,
    draw=draw,
)
