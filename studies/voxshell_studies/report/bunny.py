"""Report of the falling bunny: verdicts, published curves and pictures, animation, replay."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from voxshell.base.outputs import make_folder
from voxshell.model.model import Model
from voxshell.simulation.comparison_shapes import ConvexDecomposition

from voxshell_studies import bunny
from voxshell_studies.bunny import BunnyFallSettings
from voxshell_studies.convex_parts import CONCAVITY, RECIPES
from voxshell_studies.drop import FULL_OPERATION, REST_STEPS
from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.hull_tables import read_hulls
from voxshell_studies.motion import read_poses
from voxshell_studies.report.drop import COLORS, draw_curves, save_page
from voxshell_studies.report.figures import as_rgb
from voxshell_studies.report.paint import (
    Camera,
    Canvas,
    Solid,
    join_row,
    make_hue,
    save_picture,
    save_row,
    thin_out,
)
from voxshell_studies.scenes.drop import GROUND_HALF_EXTENTS, METHODS
from voxshell_studies.timing import STAGES
from voxshell_studies.verdict import Row, at_least, at_most, format_value

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray
    from voxshell.model.meshes import Mesh

    from voxshell_studies.drop import DropRun
    from voxshell_studies.experiment import Results
    from voxshell_studies.part import Tables
    from voxshell_studies.scenes.drop import Method

PUBLISHED_FINE, PUBLISHED_COARSE = 0.71e-3, 0.102e-3
"""Seconds (section 5.3); it also names 1.39-1.49 ms for the fine shell, in the segments' table."""

PUBLISHED_GRID, PUBLISHED_PADDING = (306, 305, 282), 100
"""Voxels, and those of them on each side of the body."""

PUBLISHED_POINTS = {"vps-fine": 35_596, "vps-coarse": 799}
PUBLISHED_MOMENTS = (4.79, 4.46, 6.38)
"""Of 1 kg of the surface, g m2."""

SETUP_TOLERANCE = 0.01
"""By which the set-up may be off the published one, as a part of it."""

PUBLISHED_HULL_VERTICES, PUBLISHED_HULLS = 42, 8

FRAME_STEPS = (50, 175, 200, 300)
SHOWN = ("vps-fine", "vps-coarse", "gimpact", "hull", "decomposition")
"""Methods in the animation."""

LEVELS_SHOWN = (2, 3, 4, 5)
ANIMATION_STEPS, ANIMATION_EVERY = 400, 4
SEEN = 2e-4
"""Of a pose's entries: smaller changes are well below a pixel of the animation."""


def describe(settings: BunnyFallSettings) -> str:
    """Return the setup as text."""
    first, last = FULL_OPERATION
    return (
        f"The bunny of {settings.size * 1e3:g} mm and {settings.mass:g} kg falls {settings.height:g} m "
        f"onto a block at {settings.rate:g} Hz, with voxels of {settings.voxel_size * 1e3:g} mm and "
        f"shells of {settings.fine_points:,} and {settings.coarse_points} points. The baselines run in "
        "the same process with the same mass and start: Bullet's GImpact on the full mesh, GJK on the "
        "hull of 42 directions, and convex decompositions. These are V-HACD's and HACD's 8 hulls of at "
        "most 100 vertices, and CoACD's with its own settings and a concavity of "
        f"{CONCAVITY:g}. HACD is the one of Bullet's extras, with the settings of its demo, on the mesh "
        f"simplified to within {1e3 * RECIPES['hacd'].tolerance * settings.size:.1f} mm. Each method has "
        "Bullet's own settings (GImpact with two friction directions) and the least margin that keeps "
        f"all of them on the block. Full operation means steps {first} to {last}. Figures are medians "
        f"over {settings.orientations} orientations; then every method runs in {settings.equal_poses} "
        "equal poses of the fine fall. The process is pinned to one core, and nothing else runs."
    )


def reduce(settings: BunnyFallSettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    falls = {name: results[name] for name in results if name.startswith("orientation")}
    methods = bunny.methods_of(falls["orientation-0"])
    own = {method.key: _median_time(falls, "steps", method.key) for method in methods}
    equal = {method.key: _median_time(falls, "equal_poses", method.key) for method in methods}
    why = _explain_fine(falls)
    return [
        *_rows_of_setup(settings, falls["orientation-0"]),
        *_rows_of_ratios(own, "own falls", why),
        *_rows_of_decomposers(settings, falls["orientation-0"], own, "own falls"),
        *_rows_of_ratios(equal, "equal poses", why),
        *_rows_of_decomposers(settings, falls["orientation-0"], equal, "equal poses"),
        _row_of_order(own),
        *_rows_of_pictures(falls["orientation-0"]),
        *_rows_of_times(falls, methods, own),
        *_rows_of_rest(falls, methods),
    ]


def _rows_of_setup(settings: BunnyFallSettings, tables: Tables) -> list[Row]:
    """Return rows that compare the reconstructed set-up with the published one."""
    sides, moments = tables["body"]["side"], tables["body"]["moment"] / settings.mass
    grid = np.ceil(sides / settings.voxel_size).astype(int) + 2 * PUBLISHED_PADDING
    shells = dict(zip(*(tables["shells"][name].tolist() for name in ("method", "points")), strict=True))  # fmt: skip
    cases = [
        (
            f"set-up: voxels of a full grid, {PUBLISHED_PADDING} of them on each side of the bunny",
            float(np.prod(PUBLISHED_GRID)),
            float(np.prod(grid)),
            "",
            f"{' x '.join(map(str, grid))}, published {' x '.join(map(str, PUBLISHED_GRID))}",
        ),
        *(
            (f"set-up: points of {label}", float(PUBLISHED_POINTS[key]), shells[key], "", f"{shells[key]:,}, published {PUBLISHED_POINTS[key]:,}{more}")
            for key, label, more in (
                ("vps-fine", "VPS fine", "; the section also says 34,892"),
                ("vps-coarse", "VPS coarse", ""),
            )
        ),
        *(
            (f"set-up: moment of inertia about {axis}, of the surface", published, here * 1e3, "g m2", "")
            for axis, published, here in zip("xyz", PUBLISHED_MOMENTS, moments.tolist(), strict=True)
        ),
    ]  # fmt: skip
    return [
        Row(
            *(quantity, published, here, unit),
            reproduced=at_most(abs(here / published - 1.0), SETUP_TOLERANCE),
            note=note,
        )
        for quantity, published, here, unit, note in cases
    ]


def _explain_fine(results: Results) -> str:
    """Return the stages of the fine shell's time, and what the hull saves."""
    stages = ", ".join(
        f"{stage} {format_value(1e6 * float(np.median(_samples(results, 'steps', 'vps-fine', stage))))}"
        for stage in STAGES
    )
    fine, hull = (
        _samples(results, "steps", key, "contacts").mean() for key in ("vps-fine", "hull")
    )
    return (
        f"in its own fall VPS takes {stages} \N{MICRO SIGN}s for {fine:.1f} contacts, "
        f"the hull has {hull:.1f}"
    )


def _rows_of_ratios(times: dict[str, float], where: str, why: str) -> list[Row]:
    fine, plane = times["vps-fine"], times["vps-fine-plane"]
    gimpact, hull, parts = times["gimpact"], times["hull"], times["decomposition"]
    coarse = times["vps-coarse"]
    return [
        Row(
            f"GImpact / VPS fine, {where}",
            137.0,
            gimpact / fine,
            "times",
            reproduced=at_least(gimpact / fine, 137.0),
            bar=">= 137",
            holds=at_least(gimpact / fine, 137.0),
        ),
        Row(
            f"GImpact / VPS fine on the analytic plane, {where}",
            None,
            gimpact / plane,
            "times",
            bar=">= 500",
            holds=at_least(gimpact / plane, 500.0),
            note=f"with GImpact on Bullet's plane, too: {times['gimpact-plane'] / plane:.1f}",
        ),
        Row(
            f"VPS fine / GJK on the hull, {where}",
            339.0,
            fine / hull,
            "times",
            reproduced=at_most(fine / hull, 339.0),
            bar="<= 2",
            holds=at_most(fine / hull, 2.0),
            note=f"{(fine - hull) * 1e6:.1f} \N{MICRO SIGN}s apart; on the analytic plane "
            f"{plane / hull:.2g} times; {why}",
        ),
        Row(
            f"decomposition / VPS coarse, {where}",
            1 / 1.3,
            parts / coarse,
            "times",
            reproduced=at_least(parts / coarse, 1 / 1.3),
            bar=">= 3",
            holds=at_least(parts / coarse, 3.0),
            note="published: the decomposition is 1.3 times as fast",
        ),
    ]


def _rows_of_decomposers(
    settings: BunnyFallSettings, tables: Tables, times: dict[str, float], where: str
) -> list[Row]:
    """Return rows on convex parts by other libraries, or why they are missing."""
    rows, hulls = [], tables["hulls"]
    seconds = dict(zip(*(tables["split"][name].tolist() for name in ("method", "seconds")), strict=True))  # fmt: skip
    for method in bunny.DECOMPOSERS:
        quantity = f"decomposition by {method.label} / VPS coarse, {where}"
        if method.key not in times:
            why = "left out by the settings" + (
                "; the full run has it" if method.key == "coacd" else ""
            )
            if method.key in settings.decomposers:
                why = RECIPES[method.key].advice
            rows.append(Row(quantity, None, float("nan"), "times", note=why))
            continue
        ratio = times[method.key] / times["vps-coarse"]
        published = method.thesis_ratio is not None
        rows.append(
            Row(
                quantity,
                1 / 1.3 if published else None,
                ratio,
                "times",
                reproduced=at_least(ratio, 1 / 1.3) if published else None,
                bar=">= 3",
                holds=at_least(ratio, 3.0),
                note=f"{len(read_hulls(hulls, method.key))} hulls, split in "
                f"{format_value(seconds[method.key])} s",
            )
        )
    return rows


def _row_of_order(times: dict[str, float]) -> Row:
    """Return a row on whether VPS leads wherever it led, and no longer lags elsewhere."""
    known = (method for method in (*METHODS, *bunny.DECOMPOSERS) if method.key in times)
    published = {m.key: m.thesis_ratio for m in known if m.thesis_ratio is not None}
    peers = [key for key in published if not key.startswith("vps")]
    lost = [
        f"{ours} behind {peer}"
        for ours in ("vps-fine", "vps-coarse")
        for peer in peers
        if published[ours] < published[peer] and not times[ours] < times[peer]
    ]
    order = sorted(published, key=lambda key: times[key])
    return Row(
        "leads of VPS over peers that are lost",
        0,
        len(lost),
        "",
        reproduced=not lost,
        note="fastest first: " + ", ".join(order) + ("; lost: " + ", ".join(lost) if lost else ""),
    )


def _rows_of_pictures(tables: Tables) -> list[Row]:
    """Return measurements of the pictures that correspond to the published ones."""
    hull = len(read_hulls(tables["hulls"], "hull")[0])
    parts = read_hulls(tables["hulls"], "decomposition")
    poses = read_poses({"poses": tables["vps-fine_poses"]}, "body")
    heights = [float(poses[step][2, 3]) for step in FRAME_STEPS]
    levels = dict(zip(*(tables["segments"][name].tolist() for name in ("level", "segments")), strict=True))  # fmt: skip
    shown = len(np.unique(tables["vps-fine_contacts"]["frame"]))
    return [
        Row(
            "picture of the convex hull: vertices",
            PUBLISHED_HULL_VERTICES,
            hull,
            "",
            reproduced=hull <= PUBLISHED_HULL_VERTICES,
            note="at most one for each direction of btShapeHull",
        ),
        Row(
            "picture of the decomposition: convex parts",
            PUBLISHED_HULLS,
            len(parts),
            "",
            reproduced=len(parts) <= PUBLISHED_HULLS,
            note=f"of at most {max(len(points) for points in parts)} vertices",
        ),
        Row(
            "picture of the segments: those of level 5, fine shell",
            "in colors",
            levels[max(levels)],
            "",
            reproduced=all(levels[level] < levels[level + 1] for level in bunny.LEVELS[:-1]),
            note="levels 1 to 5: " + ", ".join(f"{count:,}" for count in levels.values()),
        ),
        Row(
            f"frames of the drop, steps {', '.join(map(str, FRAME_STEPS))}: distance down after the first",
            "falls, then lies",
            1e3 * (heights[0] - heights[-1]),
            "mm",
            reproduced=heights[0] > max(heights[1:]),
            note="origin at " + ", ".join(format_value(1e3 * height) for height in heights) + " mm",
        ),
        Row(
            "video of the drop: frames of the offline replay with contacts, VPS fine",
            "a video",
            shown,
            f"of {len(poses)}",
            reproduced=shown > 0,
            bar="> 0",
            holds=shown > 0,
            note="replay.html has all methods side by side; animation.gif is the video",
        ),
    ]


def _rows_of_times(results: Results, methods: Sequence[Method], own: dict[str, float]) -> list[Row]:
    published = {"vps-fine": PUBLISHED_FINE, "vps-coarse": PUBLISHED_COARSE}
    rows = []
    for method in methods:
        samples = _samples(results, "steps", method.key)
        p99 = float(np.percentile(samples, 99)) if len(samples) else float("nan")
        rows.append(
            Row(
                f"narrow phase in full operation, median, {method.label}",
                published[method.key] * 1e6 if method.key in published else None,
                own[method.key] * 1e6,
                "\N{MICRO SIGN}s",
                note=f"p99 {format_value(p99 * 1e6)} \N{MICRO SIGN}s, {len(samples)} steps with contact"
                + ("; machines differ: ratios alone compare" if method.key in published else "")
                + (
                    "; the segments' table says 1.39 to 1.49 ms" if method.key == "vps-fine" else ""
                ),
            )
        )
        if method.is_model:
            rows += [
                Row(
                    f"{stage} in full operation, median, {method.label}",
                    None,
                    float(np.median(_samples(results, "steps", method.key, stage))) * 1e6,
                    "\N{MICRO SIGN}s",
                )
                for stage in STAGES
            ]
    return rows


def _rows_of_rest(results: Results, methods: Sequence[Method]) -> list[Row]:
    rows = []
    for method in methods:
        speeds, depths = [], []
        for tables in results.values():
            steps = tables["steps"]
            mine = steps["method"] == method.key
            speeds.append(steps["speed"][mine][-REST_STEPS:].max())
            depths.append(-steps["lowest"][mine][-REST_STEPS:].min())
        rows.append(
            Row(
                f"speed at rest, largest of the last {REST_STEPS} steps, {method.label}",
                None,
                float(np.max(speeds)) * 1e3,
                "mm/s",
                note=f"lowest vertex {-1e3 * np.max(depths):+.2f} mm over the ground",
            )
        )
    return rows


def draw(settings: BunnyFallSettings, results: Results, folder: Path) -> list[Picture]:
    """Draw curves, frames, hulls, segments, an animation and a replay."""
    make_folder(folder)
    tables = results["orientation-0"]
    mesh = bunny.read_scaled(bunny.find_mesh(settings), settings.size)
    runs = _read_runs(settings, tables, thin_out(mesh, settings.size / 60))
    draw_curves(folder / "curves.png", f"The falling bunny at {settings.rate:g} Hz", runs)
    _draw_frames(settings, tables, mesh, folder / "frames.png")
    _draw_hulls(tables, mesh, folder / "hulls.png")
    _draw_segments(settings, mesh, folder / "segments.png")
    _animate(settings, tables, thin_out(mesh, settings.size / 30), folder / "animation.gif")
    save_page(folder / "replay.html", "The falling bunny", runs, _summaries(runs))
    return [
        Picture("curves.png", "Time of the narrow phase and speed over steps, as published (logarithmic axes); gray: full operation."),
        Picture("animation.gif", "The drop, a quarter of real time: VPS fine and coarse, GImpact, convex hull, convex decomposition."),
        Picture("frames.png", f"The fine bunny at steps {', '.join(map(str, FRAME_STEPS))}."),
        Picture("hulls.png", "The mesh, its convex hull of 42 directions, and its convex decompositions, a color a hull."),
        Picture("segments.png", f"Segments of the fine shell at levels {', '.join(map(str, LEVELS_SHOWN))}, a color each."),
        Picture("replay.html", "All methods side by side, with their contacts."),
    ]  # fmt: skip


def _read_runs(settings: BunnyFallSettings, tables: Any, mesh: Mesh) -> list[DropRun]:
    from trimesh.creation import box
    from voxshell.model.meshes import Mesh as Triangles

    block = box(2.0 * np.array(GROUND_HALF_EXTENTS))
    ground = Triangles(block.vertices, block.faces)
    plate = box((0.6, 0.6, 0.01))
    plate.apply_translation((0.0, 0.0, -0.005))
    flat = Triangles(plate.vertices, plate.faces)
    runs = []
    for method in bunny.methods_of(tables):
        surfaces = {
            "ground": (flat if method.ground == "plane" else ground, None),
            "body": (_find_surface(tables, method.key) or mesh, None),
        }
        runs.append(bunny.read_run(tables, method, surfaces, 1.0 / settings.rate))
    return runs


def _summaries(runs: list[DropRun]) -> Any:
    from voxshell_studies.drop import summarize

    return summarize(runs)


def _find_surface(tables: Any, key: str) -> Mesh | None:
    """Return the triangles of hull or decomposition; None for the other methods."""
    hulls = read_hulls(tables["hulls"], key)
    return ConvexDecomposition(hulls).mesh if hulls else None


def _draw_frames(settings: BunnyFallSettings, tables: Any, mesh: Mesh, path: Path) -> None:
    motion = {name: tables[f"vps-fine_{name}"] for name in ("poses", "contacts")}
    poses = read_poses(motion, "body")
    color = as_rgb(COLORS["vps-fine"])
    pictures = []
    for step in FRAME_STEPS:
        camera = Camera((0.0, 0.0, 0.5 * settings.height), 1.05 * settings.height, (330, 430))
        canvas = Canvas(camera)
        canvas.paint_floor((-0.14, -0.14), (0.14, 0.14))
        canvas.paint([Solid(mesh, poses[step], color)])
        canvas.write(f"step {step}", 0.5, 0.96)
        pictures.append(canvas.finish())
    save_row(pictures, path)


def _draw_hulls(tables: Any, mesh: Mesh, path: Path) -> None:
    upright = bunny.orientation_of(0)
    middle = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2.0
    target = tuple((upright[:3, :3] @ middle).tolist())
    pictures = []
    present = bunny.methods_of(tables)
    hull = _find_surface(tables, "hull")
    assert hull is not None
    decompositions = {"V-HACD": "decomposition"} | {
        method.label: method.key for method in bunny.DECOMPOSERS if method in present
    }
    drawn = [
        ("mesh", [Solid(mesh, upright, (200, 195, 185))]),
        ("convex hull", [Solid(hull, upright, as_rgb(COLORS["hull"]), edges=True)]),
    ]
    for label, key in decompositions.items():
        parts = [ConvexDecomposition([part]).mesh for part in read_hulls(tables["hulls"], key)]
        solids = [Solid(part, upright, make_hue(i), edges=True) for i, part in enumerate(parts)]
        drawn.append((f"{label}, {len(parts)} hulls", solids))
    for label, solids in drawn:
        canvas = Canvas(Camera(target, 0.27, (330, 330)))
        canvas.paint(solids)
        canvas.write(label, 0.5, 0.96)
        pictures.append(canvas.finish())
    save_row(pictures, path, columns=3 if len(pictures) > 4 else None)


def _draw_segments(settings: BunnyFallSettings, mesh: Mesh, path: Path) -> None:
    model = Model.from_mesh(
        mesh, voxel_size=settings.voxel_size, target_points=settings.fine_points
    )
    shell = model.shell
    rotation = bunny.orientation_of(0)[:3, :3]
    points = shell.points.astype(np.float64) @ rotation.T
    normals = shell.normals.astype(np.float64) @ rotation.T
    target = tuple(((points.min(axis=0) + points.max(axis=0)) / 2.0).tolist())
    pictures = []
    for level in LEVELS_SHOWN:
        segments = shell.tree.segments(level)
        canvas = Canvas(Camera(target, 0.27, (330, 380)))
        colors = np.array([make_hue(i) for i in range(int(segments.max()) + 1)], dtype=float)
        canvas.paint_points(points, normals, colors[segments], 0.8 * shell.spacing)
        canvas.write(f"L = {level}: {len(set(segments.tolist()))} segments", 0.5, 0.96)
        pictures.append(canvas.finish())
    save_row(pictures, path)


def _animate(settings: BunnyFallSettings, tables: Any, mesh: Mesh, path: Path) -> None:
    labels = {method.key: method.label for method in METHODS}
    poses = {key: read_poses({"poses": tables[f"{key}_poses"]}, "body") for key in SHOWN}
    surfaces = {key: _find_surface(tables, key) or mesh for key in SHOWN}
    camera = Camera((0.0, 0.0, 0.65 * settings.height), settings.height, (190, 310))
    frames = []
    last: dict[str, tuple[NDArray[np.float64], Any]] = {}
    for step in range(0, min(ANIMATION_STEPS, settings.slow_steps) + 1, ANIMATION_EVERY):
        pictures = []
        for key in SHOWN:
            pose = poses[key][step]
            # Bodies at rest need no new picture.
            if key not in last or np.abs(pose - last[key][0]).max() > SEEN:
                canvas = Canvas(camera)
                canvas.paint_floor((-0.11, -0.11), (0.11, 0.11))
                canvas.paint([Solid(surfaces[key], pose, as_rgb(COLORS[key]))])
                canvas.write(labels[key], 0.5, 0.95)
                last[key] = (pose, canvas.finish())
            pictures.append(last[key][1])
        frames.append(join_row(pictures))
    milliseconds = round(4 * 1000 * ANIMATION_EVERY / settings.rate)
    save_picture(
        frames[0],
        path,
        save_all=True,
        append_images=frames[1:],
        duration=milliseconds,
        loop=0,
        optimize=True,
    )


def _samples(
    results: Results, table: str, key: str, figure: str = "narrow_phase"
) -> NDArray[np.float64]:
    """Return seconds of the steps that count, of all orientations.

    Only steps with contact are full operation: a body that has left the block needs no narrow
    phase.
    """
    first, last = FULL_OPERATION
    values = []
    for tables in results.values():
        columns = tables[table]
        mine = columns["method"] == key
        if table == "steps":
            mine &= (
                (columns["step"] > first) & (columns["step"] <= last) & (columns["contacts"] > 0)
            )
        values.append(columns[figure][mine])
    return np.concatenate(values)


def _median_time(results: Results, table: str, key: str) -> float:
    samples = _samples(results, table, key)
    return float(np.median(samples)) if len(samples) else float("nan")


BUNNY = Experiment(
    name="bunny",
    title="Falling bunny",
    question="How long does the narrow phase of a mesh on a ground take, compared with Bullet's own methods?",
    describe=describe,
    settings=BunnyFallSettings(),
    quick=replace(
        BunnyFallSettings(),
        slow_steps=600,
        orientations=1,
        equal_poses=20,
        repeats=2,
        decomposers=("hacd",),
    ),
    plan=bunny.plan,
    reduce=reduce,
    draw=draw,
)
