"""Report of the scaling."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from voxshell_studies import scaling
from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.report.figures import FAINT, OURS, OURS_COARSE, PEERS, open_figure
from voxshell_studies.scaling import ScalingSettings, name_crowd
from voxshell_studies.verdict import Row, format_value

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell_studies.crowd import Engine
    from voxshell_studies.experiment import Results
    from voxshell_studies.part import Tables


ENGINE_NAMES: dict[Engine, str] = {
    "default": "models at default settings",
    "uniform": "models of voxels of 2 mm",
    "hulls": "eight hulls in Bullet",
    "mujoco": "eight hulls in MuJoCo",
}


def describe(settings: ScalingSettings) -> str:
    """Return the setup as text."""
    return (
        f"The bunny is {settings.depth * 1e3:g} mm deep in a block of voxels and moves back and forth by "
        f"{settings.shift * 1e3:g} mm, for {settings.steps} steps in {settings.orientations} "
        f"orientations. The narrow phase is timed with {settings.points[0]:,} to "
        f"{settings.points[-1]:,} points, and with voxels of {settings.voxel_sizes[0] * 1e3:g} to "
        f"{settings.voxel_sizes[-1] * 1e3:g} mm. Figures are medians on one core, with nothing else "
        f"running. In addition, {settings.bodies[0]:,} to {settings.bodies[-1]:,} bunnies of 0.1 m are "
        f"poured for {settings.poured:g} s into a bin whose floor grows with their number. Whole steps "
        "of the resulting heap are timed at 200 Hz: with models at default settings, with models of "
        "voxels of 2 mm and the shell of fewest points, with eight hulls each in Bullet, and with the "
        "same hulls in MuJoCo, where it is installed. No body sleeps."
    )


def reduce(settings: ScalingSettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    rows = []
    points, seconds = _by(results, "points", "points")
    exponent = float(np.polyfit(np.log(points), np.log(seconds), 1)[0])
    rows.append(
        Row(
            "growth of time with points, exponent",
            None,
            exponent,
            "",
            note=f"a flat loop has 1; from {points[0]:,.0f} to {points[-1]:,.0f} points the time "
            f"grows {seconds[-1] / seconds[0]:.1f} times",
        )
    )
    for count, each in zip(points, seconds, strict=True):
        rows.append(Row(f"median time, {count:,.0f} points", None, each * 1e6, "\N{MICRO SIGN}s"))
    table = results["voxels"]["times"]
    sizes, seconds = _by(results, "voxels", "voxel_size")
    for size, each in zip(sizes[::-1], seconds[::-1], strict=True):
        mine = table["voxel_size"] == size
        rows.append(
            Row(
                f"median time, voxels of {size * 1e3:g} mm, {settings.fine_points:,} points",
                None,
                float(each) * 1e6,
                "\N{MICRO SIGN}s",
                note=f"built in {format_value(float(table['build_seconds'][mine][0]))} s, field "
                f"{table['field_bytes'][mine][0] / 1e6:.1f} MB",
            )
        )
    return rows + _reduce_bodies(settings, results)


def _reduce_bodies(settings: ScalingSettings, results: Results) -> list[Row]:
    rows = []
    for engine, name in ENGINE_NAMES.items():
        counts, steps = _heaps(settings, results, engine)
        for count in counts:
            tables = results[name_crowd(engine, count)]
            rows.append(_describe_heap(engine, count, tables))
        if len(counts) > 1:
            exponent = float(np.polyfit(np.log(counts), np.log(steps), 1)[0])
            rows.append(
                Row(
                    f"heaps, {name}: growth of step time with bodies, exponent",
                    None,
                    exponent,
                    "",
                    group="Heaps",
                )
            )
    for ours in ("default", "uniform"):
        for other in ("hulls", "mujoco"):
            counts, steps = _heaps(settings, results, other)
            if not counts:
                continue
            mine = results[name_crowd(ours, counts[-1])]["heap"]["step"]
            rows.append(
                Row(
                    f"heaps, {counts[-1]:,} bodies: {ENGINE_NAMES[other]} over {ENGINE_NAMES[ours]}",
                    None,
                    steps[-1] / float(np.median(mine)),
                    "",
                    note="of the times of a step; above 1, ours is faster",
                    group="Heaps",
                )
            )
    return rows


def _describe_heap(engine: Engine, count: int, tables: Tables) -> Row:
    heap, pouring, end = tables["heap"]["step"], tables["pouring"]["step"], tables["end"]
    notes = [f"99 % {np.percentile(heap, 99) * 1e3:.3g} ms"]
    if engine != "mujoco":
        notes.append(f"narrow phase {np.median(tables['heap']['narrow_phase']) * 1e3:.3g} ms")
    if "all_cores" in tables:
        notes.append(f"on all cores {np.median(tables['all_cores']['step']) * 1e3:.3g} ms")
    poured = np.percentile(pouring, (50, 99)) * 1e3
    notes += [
        f"while poured {poured[0]:.3g} ms, 99 % {poured[1]:.3g} ms",
        f"{end['contacts'][0]:,.0f} contacts",
        f"median speed {end['speed'][0] * 1e3:.2g} mm/s",
        f"bodies {end['height'][0] * 1e3:.3g} mm high in the mean",
        f"{end['megabytes'][0]:.3g} MB more than before",
    ]
    if end["lost"][0] > 0:
        notes.append(f"{end['lost'][0]:.0f} lost")
    return Row(
        f"heaps, {ENGINE_NAMES[engine]}: step with {count:,} bodies, median",
        None,
        float(np.median(heap)) * 1e3,
        "ms",
        note="; ".join(notes),
        group="Heaps",
    )


def _heaps(
    settings: ScalingSettings, results: Results, engine: Engine
) -> tuple[list[int], list[float]]:
    """Return the numbers of bodies that an engine was timed with, and its median steps, seconds."""
    counts = [count for count in settings.bodies if name_crowd(engine, count) in results]
    steps = [results[name_crowd(engine, count)]["heap"]["step"] for count in counts]
    return counts, [float(np.median(step)) for step in steps]


def draw(settings: ScalingSettings, results: Results, folder: Path) -> list[Picture]:
    """Draw time over points, over the voxel size, and over bodies."""
    from matplotlib.ticker import LogLocator

    with open_figure(folder / "scaling.png", width=9, height=3.8) as figure:
        left, right = figure.subplots(1, 2, sharey=True)
        for axes, name, key, scale in (
            (left, "points", "points", 1.0),
            (right, "voxels", "voxel_size", 1e3),
        ):
            table = results[name]["times"]
            axes.plot(table[key] * scale, table["seconds"] * 1e6, ".", color=FAINT)
            sizes, seconds = _by(results, name, key)
            axes.plot(sizes * scale, seconds * 1e6, "o-", color=OURS)
            axes.set(xscale="log", yscale="log")
            axes.minorticks_off()
            axes.set_xticks(sizes * scale, [f"{size * scale:,g}" for size in sizes])
        left.set(xlabel="points of the shell", ylabel="narrow phase, \N{MICRO SIGN}s")
        left.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        left.yaxis.set_major_formatter("{x:g}")
        right.set_xlabel("voxel size, mm")
    with open_figure(folder / "bodies.png", width=7, height=4.2) as figure:
        axes = figure.subplots()
        colors = dict(zip(ENGINE_NAMES, (OURS, OURS_COARSE, *PEERS[:2]), strict=True))
        for engine, name in ENGINE_NAMES.items():
            counts, steps = _heaps(settings, results, engine)
            if counts:
                axes.plot(counts, np.array(steps) * 1e3, "o-", color=colors[engine], label=name)
        axes.set(xscale="log", yscale="log", xlabel="bodies in the heap", ylabel="step, ms")
        axes.minorticks_off()
        axes.set_xticks(settings.bodies, [f"{count:,}" for count in settings.bodies])
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter("{x:g}")
        axes.axhline(5.0, color=FAINT, lw=0.8)
        axes.annotate("real time", (settings.bodies[0], 5.0), va="bottom", color=FAINT)
        axes.legend(frameon=False)
    return [
        Picture("scaling.png", "Narrow-phase time over points and over the voxel size; gray: orientations."),
        Picture("bodies.png", "Time of a step of heaps of bunnies at 200 Hz, one core."),
    ]  # fmt: skip


def _by(results: Results, name: str, key: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the values of a column, ascending, and the median seconds of each."""
    table = results[name]["times"]
    values = np.unique(table[key])
    return values, np.array([np.median(table["seconds"][table[key] == v]) for v in values])


SCALING = Experiment(
    name="scaling",
    title="Scaling",
    question="How does the time grow with points, voxels and bodies?",
    describe=describe,
    settings=ScalingSettings(),
    quick=replace(
        ScalingSettings(),
        orientations=2,
        points=(1_000, 10_000, 100_000),
        voxel_sizes=(0.004, 0.002),
        steps=100,
        bodies=(10, 30),
        poured=1.0,
    ),
    plan=scaling.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
