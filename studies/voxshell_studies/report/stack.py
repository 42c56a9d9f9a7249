"""Report of the stack of spheres."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from voxshell.model.meshes import Mesh

from voxshell_studies import stack
from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.motion import read_poses, restore
from voxshell_studies.report.figures import OURS, PEERS, as_rgb, open_figure
from voxshell_studies.report.paint import (
    Camera,
    Canvas,
    Solid,
    make_hue,
    save_row,
    thin_out,
)
from voxshell_studies.report.rules import RULE_NAMES
from voxshell_studies.scenes.bunny import BunnySettings
from voxshell_studies.scenes.stack import BUNNY_PLACES, BUNNY_SHAKE, StackSettings
from voxshell_studies.verdict import Row, at_least

if TYPE_CHECKING:
    from pathlib import Path

    from voxshell_studies.experiment import Results


def describe(settings: StackSettings) -> str:
    """Return the setup as text."""
    return (
        f"{settings.count} spheres of radius {settings.radius:g} m and {settings.mass:g} kg stand on an "
        f"analytic plane, one exactly above the other. Each is rotated at random ({settings.seeds} "
        f"seeds). The rate is {settings.rate:g} Hz, and no body sleeps. A stack has collapsed when its "
        "top has fallen by a radius. The shells have "
        f"{', '.join(f'{n:,}' for n in settings.resolutions)} points; the baseline is Bullet's own "
        f"spheres. A second stack has {len(BUNNY_PLACES)} fine bunnies and runs {settings.bunny_seeds} "
        f"times: they are released {BUNNY_SHAKE * 1e3:g} mm above each other, with random offsets of the "
        "same size, at places where they had rested."
    )


def reduce(settings: StackSettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    rows = []
    for rule in stack.RULES:
        medians = [_median(results, f"{rule}-{points}") for points in settings.resolutions]
        rows += [
            Row(
                f"time to collapse, median, {points:,} points, {RULE_NAMES[rule]}",
                "collapses in the end" if rule == "published" else None,
                median,
                "s",
                reproduced=bool(np.isfinite(_collapses(results, f"{rule}-{points}")).all())
                if rule == "published"
                else None,
                note=_spread(results, f"{rule}-{points}"),
            )
            for points, median in zip(settings.resolutions, medians, strict=True)
        ]
        growth = medians[-1] / medians[0]
        rises = bool(np.all(np.diff(medians) >= 0.0) and growth > 1.0)
        rows.append(
            Row(
                f"growth of that time from {settings.resolutions[0]:,} to "
                f"{settings.resolutions[-1]:,} points, {RULE_NAMES[rule]}",
                "finer stands longer" if rule == "published" else None,
                growth,
                "",
                reproduced=rises and len(medians) >= 3 if rule == "published" else None,
                note="never shorter at the next resolution"
                if rises
                else f"medians {', '.join(f'{m:.3g}' for m in medians)} s do not rise throughout",
            )
        )
    finest = settings.resolutions[-1]
    worst = float(_collapses(results, f"voxshell-{finest}").min())
    stood = min(worst, settings.seconds)
    bunnies = np.minimum(_collapses(results, "bunnies"), settings.seconds)
    rows += [
        Row(
            f"{settings.count} fine spheres stand, worst seed, our rule",
            None,
            stood,
            "s",
            bar=f">= {settings.seconds:g}",
            holds=at_least(stood, settings.seconds),
            note="perfect spheres have no stable stack: what stands rests on facets and friction",
        ),
        Row(
            f"{len(BUNNY_PLACES)} bunnies stand, worst seed, our rule",
            None,
            float(bunnies.min()),
            "s",
            bar=f">= {settings.seconds:g}",
            holds=at_least(float(bunnies.min()), settings.seconds),
            note=f"{int((bunnies >= settings.seconds).sum())} of {len(bunnies)} shaken starts stand",
        ),
        Row(
            "time to collapse, median, Bullet's spheres",
            None,
            _median(results, "bullet"),
            "s",
            note=_spread(results, "bullet"),
        ),
    ]
    return rows


def draw(settings: StackSettings, results: Results, folder: Path) -> list[Picture]:
    """Draw time to collapse over points, height of the top over time, and a replay."""
    with open_figure(folder / "collapse.png", width=11, height=4) as figure:
        left, right = figure.subplots(1, 2)
        for rule, color in (("published", "#43aa8b"), ("voxshell", OURS)):
            times = [_collapses(results, f"{rule}-{n}") for n in settings.resolutions]
            shown = [np.minimum(t, settings.seconds) for t in times]
            for points, each in zip(settings.resolutions, shown, strict=True):
                left.plot(np.full(len(each), points), each, "o", color=color, ms=4, alpha=0.5)
            medians = [float(np.median(each)) for each in shown]
            left.plot(settings.resolutions, medians, color=color, label=RULE_NAMES[rule])
        left.axhline(
            min(_median(results, "bullet"), settings.seconds),
            color=PEERS[1],
            label="Bullet's spheres",
        )
        left.set(
            xscale="log", yscale="log", xlabel="points of a shell", ylabel="time to collapse, s"
        )
        left.legend(fontsize=8, frameon=False)
        shades = np.linspace(0.75, 0.0, len(settings.resolutions))
        for points, shade in zip(settings.resolutions, shades, strict=True):
            curve = results[f"published-{points}"]["heights"]
            first = curve["seed"] == 0
            right.plot(
                curve["step"][first],
                curve["top"][first],
                color=str(shade),
                label=f"{points:,} points",
            )
        bullet = results["bullet"]["heights"]
        first = bullet["seed"] == 0
        right.plot(
            bullet["step"][first], bullet["top"][first], color=PEERS[1], label="Bullet's spheres"
        )
        right.set(xlabel="step", ylabel="height of the top's center, m", xscale="symlog")
        right.legend(fontsize=8, frameon=False)
    _draw_bunnies(results, folder / "bunnies.png")
    _save_replay(settings, results, folder / "replay.html")
    return [
        Picture("collapse.png", "Left: time to collapse over the shells' points, a dot a seed, lines through medians; the highest dots stand to the end. Right: the top's height, published rule, first seed."),
        Picture("bunnies.png", "The five bunnies at the start and four seconds later, or at the end; from two sides."),
        Picture("replay.html", "Coarse and fine stacks, and Bullet's, side by side."),
    ]  # fmt: skip


def _draw_bunnies(results: Results, path: Path) -> None:
    mesh = thin_out(BunnySettings().build_mesh(), 0.002)
    poses = [read_poses(results["bunnies"], f"bunny {n + 1}") for n in range(len(BUNNY_PLACES))]
    pictures = []
    for azimuth in (25.0, 115.0):
        for frame, label in ((0, "start"), (-1, "later")):
            canvas = Canvas(Camera((0.0, 0.0, 0.27), 0.45, (230, 330), azimuth=azimuth))
            canvas.paint_floor((-0.2, -0.2), (0.2, 0.2))
            canvas.paint([Solid(mesh, each[frame], make_hue(n)) for n, each in enumerate(poses)])
            canvas.write(label, 0.5, 0.96)
            pictures.append(canvas.finish())
    save_row(pictures, path)


def _save_replay(settings: StackSettings, results: Results, path: Path) -> None:
    from trimesh.creation import box, icosphere
    from voxshell.viewer.lanes import arrange_lanes
    from voxshell.viewer.replay import save_replay

    sphere = icosphere(subdivisions=3, radius=settings.radius)
    plate = box((4.0, 4.0, 0.02))
    plate.apply_translation((0.0, 0.0, -0.01))
    coarse, fine = settings.resolutions[0], settings.resolutions[-1]
    recordings = {}
    for name, label, color in (
        (f"published-{coarse}", f"{coarse:,} points\npublished rule", "#43aa8b"),
        (f"published-{fine}", f"{fine:,} points\npublished rule", "#43aa8b"),
        (f"voxshell-{fine}", f"{fine:,} points\nour rule", OURS),
        ("bullet", "Bullet's spheres", PEERS[1]),
    ):
        surfaces = {
            f"sphere {n + 1}": (Mesh(sphere.vertices, sphere.faces), as_rgb(color))
            for n in range(settings.count)
        }
        ground = {"ground": (Mesh(plate.vertices, plate.faces), None)}
        recordings[label] = restore(results[name], ground | surfaces, 4.0 / settings.rate)
    save_replay(
        path, arrange_lanes(recordings), title="Stacks of spheres", caption=describe(settings)
    )


def _collapses(results: Results, name: str) -> np.ndarray:
    return results[name]["runs"]["collapse"]


def _median(results: Results, name: str) -> float:
    return float(np.median(_collapses(results, name)))


def _spread(results: Results, name: str) -> str:
    times = _collapses(results, name)
    return f"{times.min():.3g} to {times.max():.3g} s over {len(times)} seeds"


STACK = Experiment(
    name="stack",
    title="Stack of spheres",
    question="How long does a stack of spheres stand, and do finer shells help?",
    describe=describe,
    settings=StackSettings(),
    quick=replace(StackSettings(), seeds=10, seconds=20.0, bunny_seeds=1),
    plan=stack.plan,
    reduce=reduce,
    draw=draw,
)
