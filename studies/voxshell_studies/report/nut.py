"""Report of the nut on its bolt."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell_studies import nut
from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.motion import read_poses, restore
from voxshell_studies.report.figures import OURS, OURS_PLANE, as_rgb, open_figure
from voxshell_studies.report.paint import Camera, Canvas, Solid, save_picture
from voxshell_studies.scenes.bolt import BoltSettings
from voxshell_studies.verdict import Row, at_least, at_most

if TYPE_CHECKING:
    from pathlib import Path

    from voxshell_studies.experiment import Results

SETTLED = 0.3
"""Fraction of the run after which the nut must not move."""

MOST_CREEP = 1e-4
"""Meters."""

LEAST_CLEARANCE = 0.9
"""Accepted fraction of the ideal value: models round the edges that threads have."""

HEAD_ROOM = 0.001
"""Height above the bolt's head from which only the thread supports the nut, meters."""

LABELS = {
    "voxshell": "VPS",
    "gimpact": "GImpact",
    "decomposition": "8 hulls each",
    "hull": "convex hulls",
}


def describe(settings: BoltSettings) -> str:
    """Return the setup as text."""
    return (
        f"A nut of size M{settings.radius * 2e3:g} has a clearance of {settings.clearance * 1e3:g} mm "
        f"along the radius and {settings.compute_clearance() * 1e3:.2f} mm across the flanks. It is "
        f"released {nut.START_TURNS:g} turns up the thread of an upright bolt, at {settings.rate:g} Hz "
        f"for {settings.seconds:g} s. With friction it must hold. Without friction it may turn down "
        "along its thread, but must not slip through it. Both are meshes made with manifold3d, with "
        f"{settings.segments} edges per turn and {settings.sections} cuts per pitch, and voxels of "
        f"{settings.voxel_size * 1e3:g} mm."
    )


def reduce(settings: BoltSettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    rows = []
    # Flanks are inclined by 45 degrees: the axial play equals the radial play, twice.
    play = settings.clearance + settings.voxel_size
    for mode in nut.MODES:
        held = results[f"hold-{mode}"]["steps"]
        late = held["height"][int(SETTLED * len(held["height"])) :]
        creep = float(np.ptp(late))
        turned = results[f"turn-{mode}"]["steps"]
        # Down to the head, where the nut stops.
        free = turned["height"] > HEAD_ROOM - nut.START_TURNS * settings.pitch
        off = float(np.abs(turned["height"] - settings.pitch * turned["turns"])[free].max())
        rows += [
            Row(
                f"creep of the nut at rest, friction {settings.friction:g}, {mode}",
                None,
                creep * 1e3,
                "mm",
                bar=f"<= {MOST_CREEP * 1e3:g}",
                holds=at_most(creep, MOST_CREEP),
                note=f"deepest contact {held['depth'].max() * 1e3:.3f} mm",
            ),
            Row(
                f"off its thread at most, no friction, {mode}",
                None,
                off * 1e3,
                "mm",
                bar=f"<= {play * 1e3:g} (clearance + a voxel)",
                holds=at_most(off, play),
                note=f"turned {-turned['turns'][-1]:.2f} times and came down "
                f"{-turned['height'][-1] * 1e3:.2f} mm; deepest contact "
                f"{turned['depth'].max() * 1e3:.3f} mm",
            ),
        ]
    table = results["fit"]["methods"]
    gap = float(results["fit"]["gap"]["distance"][0])
    meant = settings.compute_clearance()
    rows.append(
        Row(
            "distance of the threads in the middle of their play",
            None,
            gap * 1e3,
            "mm",
            bar=f">= {LEAST_CLEARANCE * meant * 1e3:.3g} ({LEAST_CLEARANCE * 100:g} % of what is meant)",
            holds=at_least(gap, LEAST_CLEARANCE * meant),
            note=f"{meant * 1e3:.3f} mm are meant",
        )
    )
    for method, contacts, depth in zip(
        *(table[name] for name in ("method", "contacts", "depth")), strict=True
    ):
        ours = method == "voxshell"
        rows.append(
            Row(
                f"overlap reported where the threads are {gap * 1e3:.2f} mm apart, {LABELS[str(method)]}",
                None,
                float(depth) * 1e3,
                "mm",
                bar="0" if ours else "",
                holds=bool(depth == 0.0) if ours else None,
                note=f"{int(contacts)} contacts",
            )
        )
    return rows


def draw(settings: BoltSettings, results: Results, folder: Path) -> list[Picture]:
    """Draw height over turns, a picture of start and end, and a replay."""
    with open_figure(folder / "thread.png", width=8, height=3.8) as figure:
        axes = figure.subplots()
        for mode, color in zip(nut.MODES, (OURS, OURS_PLANE), strict=True):
            steps = results[f"turn-{mode}"]["steps"]
            axes.plot(
                -steps["turns"], -steps["height"] * 1e3, color=color, label=f"{mode}, no friction"
            )
        most = max(0.2, *(float(-results[f"turn-{m}"]["steps"]["turns"].min()) for m in nut.MODES))
        axes.plot(
            [0, most], [0, most * settings.pitch * 1e3], "--", color="#999999", label="the thread"
        )
        axes.set(xlabel="turns", ylabel="distance down, mm")
        axes.legend(fontsize=8, frameon=False)
    _draw_places(settings, results, folder / "places.png")
    _save_replay(settings, results, folder / "replay.html")
    return [
        Picture("thread.png", "The nut's distance down over its turns without friction; dashed: the pitch."),
        Picture("places.png", "At the start, and at the end: with friction, and without (regular contacts)."),
        Picture("replay.html", "The nut with and without friction."),
    ]  # fmt: skip


def _draw_places(settings: BoltSettings, results: Results, path: Path) -> None:
    from PIL import Image

    bolt, nut_model = settings.build_bolt(), settings.build_nut()
    cases: list[tuple[str, Any]] = [
        ("start", settings.compute_fit(nut.START_TURNS)),
        ("held", read_poses(results["hold-regular"], "nut")[-1]),
        ("turned", read_poses(results["turn-regular"], "nut")[-1]),
    ]
    pictures = []
    for label, pose in cases:
        camera = Camera((0.0, 0.0, 0.4 * settings.length), 1.5 * settings.length, (300, 320))
        canvas = Canvas(camera)
        canvas.paint(
            [
                Solid(bolt.mesh, np.eye(4), (170, 176, 186)),
                Solid(nut_model.mesh, pose, as_rgb(OURS)),
            ]
        )
        canvas.write(label, 0.5, 0.96)
        pictures.append(canvas.finish())
    row = Image.new("RGB", (900, 320), "white")
    for number, picture in enumerate(pictures):
        row.paste(picture, (300 * number, 0))
    save_picture(row, path)


def _save_replay(settings: BoltSettings, results: Results, path: Path) -> None:
    from voxshell.viewer.lanes import arrange_lanes
    from voxshell.viewer.replay import save_replay

    surfaces = {
        "bolt": (settings.build_bolt().mesh, (170, 176, 186)),
        "nut": (settings.build_nut().mesh, as_rgb(OURS)),
    }
    every = max(round(nut.RECORDED_EVERY * settings.rate), 1) / settings.rate
    recordings = {
        label: restore(results[name], surfaces, every)
        for name, label in (("hold-regular", "friction"), ("turn-regular", "no friction"))
    }
    save_replay(path, arrange_lanes(recordings), title="Nut and bolt", caption=describe(settings))


NUT = Experiment(
    name="nut",
    title="Nut on its bolt",
    question="Do threads hold and guide, where a convex decomposition closes them?",
    describe=describe,
    settings=BoltSettings(seconds=5.0),
    quick=replace(BoltSettings(), seconds=1.0),
    plan=nut.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
