"""Report of the pair of gears."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from voxshell_studies import gears
from voxshell_studies.convex_parts import RECIPES
from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.gears import GearsSettings
from voxshell_studies.hull_tables import read_hulls
from voxshell_studies.motion import read_poses, restore
from voxshell_studies.report.figures import OURS, PEERS, as_rgb, open_figure
from voxshell_studies.report.paint import Camera, Canvas, Solid, make_hue, save_row
from voxshell_studies.verdict import Row, at_most

if TYPE_CHECKING:
    from pathlib import Path

    from voxshell.model.meshes import Mesh

    from voxshell_studies.experiment import Results
    from voxshell_studies.part import Tables

RATIO_ERROR = 0.01
"""Largest accepted error of the ratio of turns."""

LABELS = {
    "voxshell": "VPS",
    "gimpact": "GImpact",
    **{key: recipe.label for key, recipe in RECIPES.items()},
}
COLORS = dict(zip(LABELS, (OURS, *PEERS, "#8d6e63"), strict=True))


def describe(settings: GearsSettings) -> str:
    """Return the setup as text."""
    return (
        f"A gear of {settings.teeth[0]} involute teeth drives one of {settings.teeth[1]}. The module is "
        f"{settings.module * 1e3:g} mm, each tooth is {settings.backlash * 1e3:g} mm thinner than half a "
        f"pitch, and friction is {settings.friction:g}. The axles are ideal hinges, so that only teeth "
        f"collide. A motor of at most {settings.torque:g} N m turns the first gear at {settings.speed:g} "
        f"turns per second against {settings.load:g} N m on the other axle, for {settings.seconds:g} s "
        f"at {settings.rate:g} Hz. The same gears run as models with voxels of "
        f"{settings.voxel_size * 1e3:g} mm, as Bullet's GImpact with a margin of "
        f"{settings.margin * 1e3:g} mm, and as convex parts without a margin. The true overlap is that "
        "of the models in the poses of each method."
    )


def reduce(settings: GearsSettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    rows = []
    for method in settings.methods:
        tables = results[method]
        label = LABELS[method]
        if len(tables["steps"]["driven"]) == 0:
            rows.append(
                Row(
                    f"turns of the driven gear for one of the other, {label}",
                    None,
                    float("nan"),
                    "",
                    note=RECIPES[method].advice,
                )
            )
            continue
        ours = method == "voxshell"
        ratio, said = _measure_ratio(settings, tables)
        off = abs(ratio / settings.ratio - 1.0)
        parts = [len(read_hulls(tables["hulls"], name)) for name in gears.NAMES]
        made_of = f"; {parts[0]} and {parts[1]} convex parts" if parts[0] else ""
        overlap = float(tables["frames"]["overlap"].max())
        rows += [
            Row(
                f"turns of the driven gear for one of the other, {label}",
                None,
                ratio,
                "",
                bar=f"{settings.ratio:g} within {RATIO_ERROR * 100:g} %" if ours else "",
                holds=at_most(off, RATIO_ERROR) if ours else None,
                note=said + made_of,
            ),
            Row(
                f"deepest true overlap of the teeth, {label}",
                None,
                max(overlap, 0.0) * 1e3,
                "mm",
                bar=f"<= {settings.voxel_size * 1e3:g} (a voxel)" if ours else "",
                holds=at_most(overlap, settings.voxel_size) if ours else None,
                note=f"deepest contact reported {tables['steps']['depth'].max() * 1e3:.3f} mm; "
                f"{tables['steps']['contacts'].mean():.1f} contacts a step",
            ),
        ]
    return rows


def _measure_ratio(settings: GearsSettings, tables: Tables) -> tuple[float, str]:
    """Return the driven gear's turn when the other has made one, or NaN; and an explanation."""
    driven, other = tables["steps"]["driven"], -tables["steps"]["other"]
    done = np.flatnonzero(other >= 1.0)
    if len(done) == 0:
        return float("nan"), (
            f"no full turn: the driven gear turned {driven[-1]:.2f} times, the other {other[-1]:.2f}"
        )
    lag = 360.0 * (other - driven / settings.ratio)[: done[0] + 1]
    ratio = float(driven[done[0]] / other[done[0]])
    return ratio, f"the other gear is {lag.min():+.2f} to {lag.max():+.2f} degrees ahead"


def draw(settings: GearsSettings, results: Results, folder: Path) -> list[Picture]:
    """Draw turn over turns, each method's gears, and a replay."""
    ran = [method for method in settings.methods if len(results[method]["steps"]["driven"])]
    with open_figure(folder / "turns.png", width=9.5, height=3.8) as figure:
        whole, near = figure.subplots(1, 2)
        for method in ran:
            steps = results[method]["steps"]
            lag = 360.0 * (-steps["other"] - steps["driven"] / settings.ratio)
            style = {"color": COLORS[method], "label": LABELS[method], "lw": 1.2}
            whole.plot(steps["driven"], -steps["other"], **style)
            near.plot(steps["driven"], lag, **style)
        end = settings.seconds * settings.speed
        whole.plot([0, end], [0, end / settings.ratio], "--", color="#999999", label="the teeth")
        whole.set(xlabel="turns of the driven gear", ylabel="turns of the other", xlim=(-0.2, end))
        whole.set_ylim(-0.1, 1.1 * end / settings.ratio)
        near.set(
            xlabel="turns of the driven gear", ylabel="other gear ahead, degrees", ylim=(-2, 2)
        )
        near.set_xlim(-0.2, end)
        whole.legend(fontsize=8, frameon=False)
    _draw_gears(settings, results, ran, folder / "gears.png")
    _save_replay(settings, results, ran, folder / "replay.html")
    return [
        Picture("turns.png", "Turns of the other gear over those of the driven one, and how far it is ahead; dashed: the ratio of the teeth."),
        Picture("gears.png", "The gears as each method has them, a color a convex part, at the end of its run."),
        Picture("replay.html", "The gears of every method, with their contacts."),
    ]  # fmt: skip


def _surfaces(settings: GearsSettings, tables: Tables) -> list[list[Mesh]]:
    """Return the meshes of each gear's parts, or its own."""
    from voxshell.simulation.comparison_shapes import ConvexHull

    return [
        [ConvexHull(points).mesh for points in read_hulls(tables["hulls"], name)] or [model.mesh]
        for name, model in zip(gears.NAMES, settings.build_models(), strict=True)
    ]


def _draw_gears(settings: GearsSettings, results: Results, ran: list[str], path: Path) -> None:
    pictures = []
    width = settings.module * (sum(settings.teeth) + 6)
    middle = (0.5 * settings.module * settings.teeth[1], 0.0, 0.5 * settings.width)
    for method in ran:
        tables = results[method]
        solids = []
        for body, meshes in enumerate(_surfaces(settings, tables)):
            pose = read_poses(tables, gears.NAMES[body])[-1]
            whole = ((170, 176, 186), as_rgb(COLORS[method]))[body]
            solids += [
                Solid(mesh, pose, make_hue(i) if len(meshes) > 1 else whole, edges=len(meshes) > 1)
                for i, mesh in enumerate(meshes)
            ]
        canvas = Canvas(Camera(middle, width, (320, 270), azimuth=0.0, elevation=60.0))
        canvas.paint(solids)
        canvas.write(LABELS[method], 0.5, 0.95)
        pictures.append(canvas.finish())
    save_row(pictures, path, columns=3)


def _save_replay(settings: GearsSettings, results: Results, ran: list[str], path: Path) -> None:
    from voxshell.simulation.comparison_shapes import ConvexDecomposition
    from voxshell.viewer.lanes import arrange_lanes
    from voxshell.viewer.replay import save_replay

    recordings = {}
    for method in ran:
        colors = ((170, 176, 186), as_rgb(COLORS[method]))
        surfaces = {}
        for body, (name, model) in enumerate(
            zip(gears.NAMES, settings.build_models(), strict=True)
        ):
            hulls = read_hulls(results[method]["hulls"], name)
            mesh = ConvexDecomposition(hulls).mesh if hulls else model.mesh
            surfaces[name] = (mesh, colors[body])
        time_step = settings.recorded_every / settings.rate
        recordings[LABELS[method]] = restore(results[method], surfaces, time_step)
    save_replay(path, arrange_lanes(recordings), title="Gears", caption=describe(settings))


GEARS = Experiment(
    name="gears",
    title="Gears in mesh",
    question="Do teeth transmit a rotation at their ratio, where convex parts fill the gaps between them?",
    describe=describe,
    settings=GearsSettings(),
    quick=replace(GearsSettings(), methods=("voxshell", "gimpact", "vhacd")),
    plan=gears.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
