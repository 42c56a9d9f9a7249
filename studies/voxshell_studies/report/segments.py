"""Report of the segmented traverse."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from voxshell.model.shapes import Box
from voxshell.simulation.body_shapes import mesh_of

from voxshell_studies import segments
from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.motion import restore
from voxshell_studies.report.figures import OURS, OURS_COARSE, as_rgb, open_figure
from voxshell_studies.report.paint import thin_out
from voxshell_studies.segments import LEVELS, SegmentsSettings
from voxshell_studies.timing import STAGES
from voxshell_studies.verdict import Row, at_most

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell_studies.experiment import Results

PUBLISHED_TIMES = {
    "coarse": (102.2, 102.1, 104.2, 102.3, 102.8),
    "fine": (1387.9, 1477.5, 1407.4, 1449.6, 1494.3),
}
"""Published times at levels 1 to 5, microseconds (section 5.3)."""

REPRODUCED_FLATNESS = {"coarse": 1.05, "fine": 1.10}
FLATNESS = 1.05
SPEED_UP = 30.0
"""Required speedup over the published times."""


def describe(settings: SegmentsSettings) -> str:
    """Return the setup as text."""
    return (
        f"The bunny falls {settings.height:g} m onto a block of voxels at {settings.rate:g} Hz in "
        f"{settings.orientations} orientations, with {settings.coarse_points} and "
        f"{settings.fine_points:,} points. Its contacts are segmented at levels 1 to 5. Figures are "
        f"means over steps {settings.first_step} to {settings.last_step}. The time of a step is its "
        f"median over {settings.repeats} equal runs, on one core, with nothing else running. Then all "
        f"levels run once more in the poses of level {segments.POSES_OF}. The thesis gives its fine shell "
        "as 35,596 or 34,892 points, and its times as 0.71 ms or as listed here. This experiment uses "
        "the first number of points and compares with the listed times."
    )


def reduce(settings: SegmentsSettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    rows = []
    for shell in ("coarse", "fine"):
        who = "low" if shell == "coarse" else "high"
        means = _means(settings, results, shell, "steps", "narrow_phase") * 1e6
        contacts = _means(settings, results, shell, "steps", "contacts")
        for level, here, published, count in zip(
            *(LEVELS, means, PUBLISHED_TIMES[shell], contacts), strict=True
        ):
            rows.append(
                Row(
                    f"mean time, {who}, L = {level}",
                    published,
                    float(here),
                    "\N{MICRO SIGN}s",
                    bar=f"<= {published / SPEED_UP:.3g} (30x below)",
                    holds=at_most(float(here), published / SPEED_UP),
                    note=f"{published / here:.0f} times as fast as published; {count:.1f} contacts",
                )
            )
        published_flatness = max(PUBLISHED_TIMES[shell]) / min(PUBLISHED_TIMES[shell])
        traverse = "traverse alone, equal poses"
        for name, table, figure in (
            ("whole narrow phase, own falls", "steps", "narrow_phase"),
            ("whole narrow phase, equal poses", "same_poses", "narrow_phase"),
            (traverse, "same_poses", "query"),
        ):
            values = _means(settings, results, shell, table, figure) * 1e6
            flatness = float(values.max() / values.min())
            rows.append(
                Row(
                    f"max/min over L, {who}, {name}",
                    published_flatness,
                    flatness,
                    "",
                    reproduced=at_most(flatness, REPRODUCED_FLATNESS[shell]),
                    bar=f"<= {FLATNESS:g}",
                    holds=at_most(flatness, FLATNESS),
                    note=f"{', '.join(f'{v:.2f}' for v in values)} \N{MICRO SIGN}s; the spread is "
                    f"{np.ptp(values) / min(PUBLISHED_TIMES[shell]):.2%} of the published time"
                    + (
                        f"; {_tell_growth(settings, results, shell, table)}"
                        if name != traverse
                        else ""
                    ),
                )
            )
        filling = _means(settings, results, shell, "same_poses", "manifold") * 1e6
        choosing = _means(settings, results, shell, "same_poses", "reduction") * 1e6
        rows.append(
            Row(
                f"choosing and filling of L = 5 over that of L = 1, {who}, equal poses",
                None,
                float(filling[-1] + choosing[-1] - filling[0] - choosing[0]),
                "\N{MICRO SIGN}s",
                note="what a contact more costs: it is seen because the traverse takes so little",
            )
        )
    return rows


def _tell_growth(settings: SegmentsSettings, results: Results, shell: str, table: str) -> str:
    """Return the ratio of each stage's time at the highest level to that at the lowest."""
    growth = {
        stage: 1e6 * float(means[-1] - means[0])
        for stage in STAGES
        for means in [_means(settings, results, shell, table, stage)]
    }
    return (
        "from L = 1 to 5 "
        + ", ".join(f"{stage} {value:+.2f}" for stage, value in growth.items())
        + " \N{MICRO SIGN}s"
    )


def draw(settings: SegmentsSettings, results: Results, folder: Path) -> list[Picture]:
    """Draw mean times over levels, beside the published ones."""
    with open_figure(folder / "levels.png", width=9, height=4.4) as figure:
        axes = figure.subplots()
        for shell, color in (("coarse", OURS_COARSE), ("fine", OURS)):
            points = settings.coarse_points if shell == "coarse" else settings.fine_points
            axes.plot(
                LEVELS,
                PUBLISHED_TIMES[shell],
                "s--",
                color=color,
                mfc="white",
                label=f"{points:,} points, published",
            )
            for table, style, name in (
                ("steps", "o-", "here"),
                ("same_poses", ".:", "here, equal poses"),
            ):
                means = _means(settings, results, shell, table, "narrow_phase") * 1e6
                axes.plot(LEVELS, means, style, color=color, label=f"{points:,} points, {name}")
        axes.set(
            yscale="log",
            xlabel="level L",
            ylabel="mean time of a step, \N{MICRO SIGN}s",
            xticks=LEVELS,
        )
        axes.legend(fontsize=8, frameon=False, ncols=2)
    _save_replay(settings, results, folder / "replay.html")
    return [
        Picture("levels.png", "Mean narrow-phase time over the level of the segments, published and here."),
        Picture("replay.html", "The upright fine bunny's fall with contacts of levels 1 to 5, side by side."),
    ]  # fmt: skip


def _save_replay(settings: SegmentsSettings, results: Results, path: Path) -> None:
    from voxshell.viewer.lanes import arrange_lanes
    from voxshell.viewer.replay import save_replay

    block = mesh_of(Box(segments.GROUND_HALF_EXTENTS))
    bunny = thin_out(settings.build_mesh(), settings.size / 60)
    tables = results["shown"]
    recordings = {
        f"L = {level}": restore(
            {name: tables[f"{level}_{name}"] for name in ("poses", "contacts")},
            {"ground": (block, None), "bunny": (bunny, as_rgb(OURS))},
            segments.RECORDED_EVERY / settings.rate,
        )
        for level in LEVELS
    }
    save_replay(
        path,
        arrange_lanes(recordings),
        title="Contacts of more segments",
        caption=f"The bunny of {settings.fine_points:,} points falls on a block of voxels at "
        f"{settings.rate:g} Hz: contacts are the deepest point of each segment, and what will touch.",
    )


def _means(
    settings: SegmentsSettings, results: Results, shell: str, table: str, figure: str
) -> NDArray[np.float64]:
    """Return means by level over the steps that count and all orientations."""
    values = []
    for orientation in range(settings.orientations):
        columns = results[f"orientation-{orientation}-{shell}"][table]
        counts = columns["step"] > settings.first_step
        values.append(
            [columns[figure][counts & (columns["level"] == level)].mean() for level in LEVELS]
        )
    return np.mean(values, axis=0)


SEGMENTS = Experiment(
    name="segments",
    title="Segmented traverse",
    question="Does it cost more to report contacts of more segments?",
    describe=describe,
    settings=SegmentsSettings(),
    quick=replace(SegmentsSettings(), orientations=3, repeats=3),
    plan=segments.plan,
    reduce=reduce,
    draw=draw,
)
