"""``voxshell simulate drop``: one body that falls on a ground, by every method."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter
from rich.console import Console
from voxshell.base.outputs import check_output_folder, filling
from voxshell.cli.bodies import require_file
from voxshell.cli.progress import open_progress, tracked
from voxshell.errors import SettingsError
from voxshell.measuring.files import finite

from voxshell_studies.cli.drop_table import explain, make_table

if TYPE_CHECKING:
    from voxshell_studies.drop import DropRun, DropSummary
    from voxshell_studies.scenes.drop import DropSettings, Method

RESULTS, CURVES, PAGE = "results.json", "curves.png", "index.html"

MethodKey = Literal[
    "vps-fine",
    "vps-coarse",
    "vps-fine-plane",
    "gimpact",
    "gimpact-plane",
    "hull",
    "decomposition",
]


def drop(
    mesh: Path | None = None,
    /,
    *,
    out: Path = Path("drop"),
    steps: int = 1000,
    slow_steps: int = 600,
    methods: Annotated[
        list[MethodKey] | None, Parameter(consume_multiple=True, negative="")
    ] = None,
    size: float = 0.2115,
    up: Literal["x", "y", "z"] = "y",
    height: float = 0.5,
    rate: float = 200.0,
    fine_points: int = 35_596,
    coarse_points: int = 799,
    voxel_size: float = 0.002,
    mass: float = 1.0,
    json_only: Annotated[bool, Parameter(name="--json", negative="")] = False,
) -> None:
    """Drop a body on a ground, with voxshell's models and with Bullet's own methods.

    Prints the time of the narrow phase, how deep the bodies sink and how still they rest. Writes into
    OUT: results.json (all figures, settings and versions), curves.png (time and speed over steps) and
    index.html (an offline replay). The files appear once all are complete.

    For example, the bunny, and your own part with two methods:

        voxshell simulate drop --out bunny
        voxshell simulate drop part.stl --up z --size 0.1 --methods vps-fine hull

    Args:
        mesh: A closed mesh: STL, OBJ, PLY, OFF, GLB, glTF, DAE or 3MF; the Stanford bunny by default.
        out: The folder to write into; created if missing.
        steps: Number of steps to simulate.
        slow_steps: Number of steps for GImpact on the block, which takes tens of milliseconds each.
        methods: Methods to run; all by default. Ratios need vps-fine.
        size: Longest side of the body in meters; the mesh is scaled to it.
        up: The mesh's axis that points up.
        height: Height of the body's lowest point above the ground, in meters.
        rate: Steps per second.
        fine_points: Number of points of the fine shell.
        coarse_points: Number of points of the coarse shell.
        voxel_size: Voxel size of the distance fields, in meters.
        mass: Mass of the body in kilograms.
        json_only: Print only JSON: the table.
    """
    if steps < 1 or slow_steps < 1:
        raise SettingsError(f"steps must be at least 1, not {min(steps, slow_steps)}")
    from voxshell_studies.scenes.bunny import find_bunny
    from voxshell_studies.scenes.drop import METHODS, DropSettings

    settings = DropSettings(
        size=size,
        up=up,
        height=height,
        rate=rate,
        fine_points=fine_points,
        coarse_points=coarse_points,
        voxel_size=voxel_size,
        mass=mass,
    )
    wanted = tuple(m for m in METHODS if methods is None or m.key in methods)
    path = find_bunny() if mesh is None else mesh
    require_file(path)
    check_output_folder(out, (RESULTS, CURVES, PAGE))
    runs, summaries = _run(
        path, out, settings, wanted, steps, slow_steps, Console(quiet=json_only, stderr=True)
    )
    if json_only:
        print(json.dumps(finite([asdict(summary) for summary in summaries])))
        return
    console = Console(highlight=False)
    console.print(make_table(runs, summaries))
    console.print(explain(runs, steps))
    for name in (PAGE, CURVES, RESULTS):
        console.print(f"  {out / name}", soft_wrap=True)


def _run(
    path: Path,
    out: Path,
    settings: DropSettings,
    methods: tuple[Method, ...],
    steps: int,
    slow_steps: int,
    console: Console,
) -> tuple[list[DropRun], list[DropSummary]]:
    """Build, simulate and write, with a line of progress for each part."""
    from voxshell_studies.drop import run_drop, summarize
    from voxshell_studies.report.drop import draw_curves, save_page, write_results
    from voxshell_studies.scenes.drop import build_shapes

    title = f"{path.stem} dropped {settings.height:g} m at {settings.rate:g} Hz"
    with open_progress(console) as progress:
        with tracked(progress, "build models") as track:
            shapes = build_shapes(path, settings, methods, track.update)
        runs: list[DropRun] = []
        for method in methods:
            count = min(steps, slow_steps) if method.is_slow else steps
            with tracked(progress, f"drop {method.label}") as track:
                runs.append(run_drop(shapes, method, settings, count, track.advance))
        summaries = summarize(runs)
        with tracked(progress, "write results") as track, filling(out) as folder:
            write_results(folder / RESULTS, str(path), settings, shapes, runs, summaries)
            track.update(CURVES, 0.1)
            draw_curves(folder / CURVES, title, runs)
            track.update(PAGE, 0.3)
            save_page(folder / PAGE, title, runs, summaries)
    return runs, summaries
