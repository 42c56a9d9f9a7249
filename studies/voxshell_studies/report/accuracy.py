"""Report of the accuracy."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from voxshell_studies import accuracy
from voxshell_studies.accuracy import AccuracySettings
from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.report.figures import FAINT, OURS, OURS_COARSE, open_figure
from voxshell_studies.verdict import Row, at_most

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell_studies.experiment import Results
    from voxshell_studies.part import Columns

TOUCHING_VOLUME = 1e-12
"""Exact overlaps below this are rounding errors, m3."""


def describe(settings: AccuracySettings) -> str:
    """Return the setup as text."""
    return (
        f"Two bunnies of {settings.size * 1e3:g} mm are in {settings.poses} relative poses, from "
        f"{-settings.least_depth * 1e3:g} mm apart to {settings.most_depth * 1e3:g} mm in each other. "
        "The deepest contact of both shells in both fields is compared with a brute-force search on "
        f"voxels and points of {settings.reference_voxel_size * 1e3:g} mm, and with the exact overlap of "
        "the triangles (volume by manifold3d). For a shallow overlap, the sum of the points' areas times "
        "their depths is its volume."
    )


def reduce(settings: AccuracySettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    table = results["depths"]["depths"]
    overlap = table["volume"] > TOUCHING_VOLUME
    rows = []
    for shell in ("fine", "coarse"):
        error = np.abs(table[shell] - table["truth"])
        missed = overlap & (table[shell] == 0.0)
        invented = ~overlap & (table[shell] > 0.0)
        fine = shell == "fine"
        rows += [
            Row(
                f"depth off the truth at most, {shell}",
                None,
                float(error.max()) * 1e3,
                "mm",
                bar=f"<= {settings.voxel_size * 1e3:g} (a voxel)" if fine else "",
                holds=at_most(float(error.max()), settings.voxel_size) if fine else None,
                note=f"median {np.median(error) * 1e3:.3f} mm",
            ),
            Row(
                f"meshes overlap, no contact, {shell}",
                None,
                int(missed.sum()),
                f"of {int(overlap.sum())}",
                note=f"the deepest of these is {table['truth'][missed].max(initial=0.0) * 1e3:.3f} mm in",
            ),
            Row(
                f"meshes apart, contact, {shell}",
                None,
                int(invented.sum()),
                f"of {int((~overlap).sum())}",
                note=f"the deepest of these says {table[shell][invented].max(initial=0.0) * 1e3:.3f} mm",
            ),
            Row(
                f"areas by depths over the exact volume, all poses together, {shell}",
                None,
                float(table[f"{shell}_volume"].sum() / table["volume"].sum()),
                "",
                note=_tell_volumes(table, overlap, shell),
            ),
        ]
    deep_missed = overlap & (table["fine"] == 0.0) & (table["truth"] > settings.voxel_size)
    rows.append(
        Row(
            "overlaps deeper than a voxel that the fine shell misses",
            None,
            int(deep_missed.sum()),
            "",
            bar="0",
            holds=not deep_missed.any(),
        )
    )
    return rows


def _tell_volumes(table: Columns, overlap: NDArray[np.bool_], shell: str) -> str:
    """Return rows on single poses: the ratio in the middle half of them."""
    ratios = table[f"{shell}_volume"][overlap] / table["volume"][overlap]
    low, middle, high = np.percentile(ratios, (25, 50, 75)) if len(ratios) else (np.nan,) * 3
    return f"of single poses {middle:.2g} in the median, half of them {low:.2g} to {high:.2g}"


def draw(settings: AccuracySettings, results: Results, folder: Path) -> list[Picture]:
    """Draw each shell's depth over the true one, and its volume over the exact one."""
    table = results["depths"]["depths"]
    overlap = table["volume"] > TOUCHING_VOLUME
    with open_figure(folder / "depths.png", width=10, height=4.2) as figure:
        axes, volumes = figure.subplots(1, 2)
        most = float(table["truth"].max(initial=1e-3)) * 1e3
        axes.plot([0, most], [0, most], "--", color=FAINT, label="true")
        for shell, color, marker in (("coarse", OURS_COARSE, "s"), ("fine", OURS, "o")):
            points = settings.fine_points if shell == "fine" else settings.coarse_points
            axes.plot(
                table["truth"] * 1e3,
                table[shell] * 1e3,
                marker,
                ms=4,
                color=color,
                label=f"{points:,} points",
            )
            # Overlaps that a shell misses cannot be shown on a logarithmic axis.
            found = overlap & (table[f"{shell}_volume"] > 0.0)
            exact, counted = table["volume"][found] * 1e9, table[f"{shell}_volume"][found] * 1e9
            volumes.plot(exact, counted, marker, ms=4, color=color)
        axes.set(xlabel="true depth, mm", ylabel="deepest contact, mm")
        axes.legend(fontsize=8, frameon=False)
        ends = table["volume"][overlap]
        ends = np.array([ends.min(initial=1e-6), ends.max(initial=1e-9)]) * 1e9
        volumes.plot(ends, ends, "--", color=FAINT)
        volumes.set(
            xscale="log",
            yscale="log",
            xlabel="exact overlap, mm\N{SUPERSCRIPT THREE}",
            ylabel="areas by depths of contacts, mm\N{SUPERSCRIPT THREE}",
        )
    return [
        Picture(
            "depths.png",
            "A dot a pose. Left: deepest contact over the true depth. Right: volume of the contacts "
            "over that of the exact overlap.",
        )
    ]


ACCURACY = Experiment(
    name="accuracy",
    title="Accuracy",
    question="How large is the error of the reported depth, and which overlaps are missed?",
    describe=describe,
    settings=AccuracySettings(),
    quick=replace(AccuracySettings(), poses=12, reference_voxel_size=0.001),
    plan=accuracy.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
