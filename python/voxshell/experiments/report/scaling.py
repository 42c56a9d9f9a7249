"""What the scaling says."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from voxshell.experiments import scaling
from voxshell.experiments.experiment import Experiment, Picture
from voxshell.experiments.report.figures import FAINT, OURS, open_figure
from voxshell.experiments.scaling import ScalingSettings
from voxshell.experiments.verdict import Row, format_value

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell.experiments.experiment import Results


def describe(settings: ScalingSettings) -> str:
    """The set-up in words."""
    return (
        f"The bunny {settings.depth * 1e3:g} mm deep in a block of voxels, moved to and fro by "
        f"{settings.shift * 1e3:g} mm, {settings.steps} steps in {settings.orientations} orientations: "
        f"the narrow phase with {settings.points[0]:,} to {settings.points[-1]:,} points, and with "
        f"voxels of {settings.voxel_sizes[0] * 1e3:g} to {settings.voxel_sizes[-1] * 1e3:g} mm. "
        "Medians; one core, nothing else running."
    )


def reduce(settings: ScalingSettings, results: Results) -> list[Row]:
    """The verdicts."""
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
    return rows


def draw(settings: ScalingSettings, results: Results, folder: Path) -> list[Picture]:
    """Time over points and over the voxel size."""
    del settings
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
    return [Picture("scaling.png", "Narrow-phase time over points and over the voxel size; grey: orientations.")]  # fmt: skip


def _by(results: Results, name: str, key: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Values of a column, ascending, and the median seconds of each."""
    table = results[name]["times"]
    values = np.unique(table[key])
    return values, np.array([np.median(table["seconds"][table[key] == v]) for v in values])


SCALING = Experiment(
    name="scaling",
    title="Scaling",
    question="How does the time grow with points and voxels?",
    describe=describe,
    settings=ScalingSettings(),
    quick=replace(
        ScalingSettings(),
        orientations=2,
        points=(1_000, 10_000, 100_000),
        voxel_sizes=(0.004, 0.002),
        steps=100,
    ),
    plan=scaling.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
