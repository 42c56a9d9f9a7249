"""Report of bunnies in a bin."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from voxshell.model.meshes import Mesh

from voxshell_studies import pour
from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.motion import read_poses, restore
from voxshell_studies.report.figures import (
    OURS,
    OURS_COARSE,
    OURS_PLANE,
    PEERS,
    as_rgb,
    open_figure,
)
from voxshell_studies.report.paint import Camera, Canvas, Solid, save_picture
from voxshell_studies.scenes.pour import METHODS, PourSettings
from voxshell_studies.scenes.solids import simplify
from voxshell_studies.verdict import Row

if TYPE_CHECKING:
    from pathlib import Path

    from voxshell_studies.experiment import Results

LABELS = {"voxshell": "VPS", "decomposition": "8 hulls each", "gimpact": "GImpact"}
COLORS = {"voxshell": OURS, "decomposition": PEERS[2]}
LAST = 0.1
"""Fraction of the run, at its end, that counts as rest."""

DRAWN_ERROR = 0.004
"""Size of the triangles in pictures, as a fraction of the body's size."""


def describe(settings: PourSettings) -> str:
    """Return the setup as text."""
    inside = " x ".join(f"{1e2 * side:g}" for side in settings.bin_size)
    return (
        f"{settings.count} bodies of {settings.size * 1e3:g} mm, with {len(settings.build_model().shell.points):,} "
        f"points each and voxels of {settings.voxel_size * 1e3:g} mm, fall into a bin of {inside} cm, "
        f"which is also a model, at {settings.rate:g} Hz for {settings.seconds:g} s. The baselines fall "
        "into a bin of five of Bullet's boxes. V-HACD's hulls fall on their own. GImpact takes seconds "
        f"per step, so it runs {settings.slow_steps} steps in the heap that the models made; all methods "
        "are timed in that heap. The experiment uses one core."
    )


def reduce(settings: PourSettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    tables = results["pour"]
    ends = tables["ends"]
    rows = []
    for method in pour.POURED:
        lost = int(ends["lost"][ends["method"] == method].sum())
        ours = method == "voxshell"
        steps = tables[method]
        late = slice(-max(round(LAST * len(steps["speed"])), 1), None)
        rows += [
            Row(
                f"left the bin or lost, {LABELS[method]}",
                None,
                lost,
                f"of {settings.count}",
                bar="0" if ours else "",
                holds=lost == 0 if ours else None,
            ),
            Row(
                f"median speed in the heap, {LABELS[method]}",
                None,
                float(np.median(steps["speed"][late])) * 1e3,
                "mm/s",
                note=f"fastest {steps['fastest'][late].max() * 1e3:.0f} mm/s; median turning "
                f"{np.median(steps['angular_speed'][late]):.3f} rad/s",
            ),
            Row(
                f"deepest contact in the heap, {LABELS[method]}",
                None,
                float(steps["depth"][late].max()) * 1e3,
                "mm",
                note=f"{steps['contacts'][late].mean():.0f} contacts",
            ),
            Row(
                f"median time of a step while pouring, {LABELS[method]}",
                None,
                float(np.median(steps["step_seconds"])) * 1e3,
                "ms",
                note=f"99 % below {np.quantile(steps['step_seconds'], 0.99) * 1e3:.0f} ms",
            ),
        ]
    times = {method: _heap_time(results, method) for method in METHODS}
    for method in METHODS:
        rows.append(
            Row(
                f"median time of a step in the same heap, {LABELS[method]}",
                None,
                times[method] * 1e3,
                "ms",
                note=f"{times[method] / times['voxshell']:.3g} times ours",
            )
        )
    return rows


def _heap_time(results: Results, method: str) -> float:
    heap = results["pour"]["heap"]
    return float(np.median(heap["step"][heap["method"] == method]))


def draw(settings: PourSettings, results: Results, folder: Path) -> list[Picture]:
    """Draw step time and motion over time, the heap, and a replay."""
    tables = results["pour"]
    with open_figure(folder / "steps.png", width=11, height=3.8) as figure:
        panels = figure.subplots(1, 2)
        for method in pour.POURED:
            steps = tables[method]
            time = np.arange(1, len(steps["speed"]) + 1) / settings.rate
            look = {"color": COLORS[method], "lw": 1.2, "label": LABELS[method]}
            panels[0].plot(time, steps["step_seconds"] * 1e3, **look)
            panels[1].plot(time, np.maximum(steps["speed"] * 1e3, 1e-2), **look)
        panels[0].set(xlabel="s", ylabel="time of a step, ms", yscale="log")
        panels[1].set(xlabel="s", ylabel="median speed, mm/s", yscale="log")
        panels[1].legend(fontsize=8, frameon=False)
    mesh = simplify(settings.build_model().mesh, DRAWN_ERROR * settings.size)
    _draw_heap(settings, results, mesh, folder / "heap.png")
    _save_replay(settings, results, mesh, folder / "replay.html")
    return [
        Picture("heap.png", "The heap at the end, its bodies as models, the bin's near walls left out."),
        Picture("steps.png", "Time of a step, and how calm the heap becomes."),
        Picture("replay.html", "Models poured into a model."),
    ]  # fmt: skip


def _shades(count: int) -> list[tuple[int, int, int]]:
    """Return colors that distinguish neighbors."""
    palette = [as_rgb(color) for color in (OURS, *PEERS, OURS_COARSE, OURS_PLANE)]
    return [palette[number % len(palette)] for number in range(count)]


def _draw_heap(settings: PourSettings, results: Results, mesh: Mesh, path: Path) -> None:
    camera = Camera(
        (0.0, 0.0, 0.4 * settings.bin_size[2]),
        1.9 * settings.bin_size[0],
        (760, 620),
        elevation=40.0,
    )
    canvas = Canvas(camera)
    container = settings.build_bin()
    middles = container.vertices[container.faces].mean(axis=1)
    toward = camera.axes[2] * (1.0, 1.0, 0.0)
    behind = (np.abs(middles[:, 2]) < 1e-6) | (middles @ toward <= 0.0)
    walls = Mesh(container.vertices, container.faces[behind])
    canvas.paint([Solid(walls, np.eye(4), (200, 205, 212))])
    last = [read_poses(results["pour"], f"body {n + 1}")[-1] for n in range(settings.count)]
    canvas.paint(
        [
            Solid(mesh, pose, color)
            for pose, color in zip(last, _shades(settings.count), strict=True)
        ]
    )
    save_picture(canvas.finish(), path)


def _save_replay(settings: PourSettings, results: Results, mesh: Mesh, path: Path) -> None:
    from voxshell.viewer.lanes import arrange_lanes
    from voxshell.viewer.replay import save_replay

    surfaces = {"body 0": (settings.build_bin(), (170, 176, 186))} | {
        f"body {n + 1}": (mesh, color) for n, color in enumerate(_shades(settings.count))
    }
    every = max(round(pour.RECORDED_EVERY * settings.rate), 1) / settings.rate
    recording = restore(results["pour"], surfaces, every)
    save_replay(
        path,
        arrange_lanes({"VPS": recording}),
        title="Bunnies in a bin",
        caption=describe(settings),
        max_contacts=100,
    )


POUR = Experiment(
    name="pour",
    title="Bunnies in a bin",
    question="Do many concave bodies stay in a concave bin, and what does a step take?",
    describe=describe,
    settings=PourSettings(),
    quick=replace(PourSettings(), count=12, seconds=1.5, bin_size=(0.45, 0.45, 0.3), slow_steps=1),
    plan=pour.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
