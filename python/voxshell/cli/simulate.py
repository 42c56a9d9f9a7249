"""``voxshell simulate``: simulation of scenes."""

from __future__ import annotations

import json
import sys
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import App, Parameter
from rich.console import Console
from rich.markup import escape

from voxshell.base.outputs import check_output_folder
from voxshell.cli.progress import open_progress, tracked
from voxshell.cli.tables import new_table
from voxshell.measuring.files import finite
from voxshell.measuring.units import format_length, format_time

if TYPE_CHECKING:
    from collections.abc import Iterator

    from voxshell.simulation.world import World

_STILL = 1e-9
"""Speed below which motion is only rounding, m/s."""

simulate = App(name="simulate", usage="Usage: voxshell simulate --out PATH [OPTIONS] FILE")


@simulate.default
def scene(
    file: Path,
    /,
    *,
    out: Path,
    export: Annotated[
        tuple[Literal["mp4", "gif", "glb", "usda", "usdc"], ...],
        Parameter(consume_multiple=True, negative=""),
    ] = (),
    watch: Annotated[bool, Parameter(negative="")] = False,
    json_only: Annotated[bool, Parameter(name="--json", negative="")] = False,
) -> None:
    """Simulate a scene file: bodies of meshes and shapes that fall, slide and collide.

    Writes the outputs that the scene file requests to the folder OUT: index.html (an offline
    replay), poses and contacts (Parquet or CSV), plot.png, and results.json (settings, final states,
    times). The files appear once all are complete.

    A short scene:

        [scene]
        duration = 2.0
        [meshes.part]
        file = "part.stl"
        scale = 0.001
        tolerance = 0.0002
        [bodies.ground]
        shape = "plane"
        [bodies.part]
        mesh = "part"
        mass = 0.2
        position = [0, 0, 0.3]

    Run it with:

        voxshell simulate scene.toml --out result

    With a video, a file for Blender, and a page on which to watch and drag the bodies meanwhile:

        voxshell simulate scene.toml --out result --export mp4 glb --watch

    Args:
        file: The scene in TOML; the page on scene files in the documentation shows every key.
        out: The folder to write into; created if missing.
        export: Also write the motion as recording.mp4 or recording.gif (videos), recording.glb
            (glTF: Blender, three.js, Unity) or recording.usda or recording.usdc (Universal Scene
            Description).
        watch: Print the address of a page that shows the simulation, and wait until you press Resume
            on it. If you drag bodies there, the results change.
        json_only: Print only the content of results.json.
    """
    from voxshell.cli.scene_report import check_extras, describe_results, list_files, write_outputs
    from voxshell.scenes.scene_file import read_scene
    from voxshell.scenes.scene_run import run_scene
    from voxshell.scenes.scene_world import build_world
    from voxshell.viewer.server import import_viser

    read = read_scene(file)
    outputs = replace(read.outputs, exports=(*read.outputs.exports, *export))
    read = replace(read, outputs=outputs)
    check_extras(read)
    if watch:
        import_viser()  # fail before models are built, which may take long
    check_output_folder(out, list_files(read))
    with open_progress(Console(quiet=json_only, stderr=True)) as progress:
        with tracked(progress, "build") as track:
            world = build_world(read, track.update)
        with (
            _watching(world, read.title if watch else None),
            tracked(progress, "simulate") as track,
        ):
            run = run_scene(read, world, track.advance)
        with tracked(progress, "write") as track:
            paths = write_outputs(out, read, world, run, track.update)
    results = describe_results(read, world, run)
    if json_only:
        print(json.dumps(finite(results)))
        return
    console = Console(highlight=False)
    table = new_table("body", "ends at, m", "speed", "contacts", "deepest")
    for row in results["bodies"]:
        table.add_row(
            escape(row["body"]),
            " ".join(f"{round(x, 6) + 0.0:.4g}" for x in row["position"]),
            f"{row['speed'] if row['speed'] >= _STILL else 0.0:.3g} m/s",
            str(row["contacts"]),
            format_length(row["deepest"]),
        )
    console.print(table)
    for row in results["joints"]:
        console.print(
            f"joint {row['joint']}: at {round(row['position'], 6):.4g}, moving at {round(row['velocity'], 6):.3g}",
            markup=False,
        )
    times = results["narrow_phase_seconds"]
    console.print(
        f"{results['steps']} steps; narrow phase {format_time(times['median'])} a step, "
        f"p99 {format_time(times['p99'])}"
    )
    for path in paths:
        console.print(f"  {path}", soft_wrap=True)


@contextmanager
def _watching(world: World, title: str | None) -> Iterator[None]:
    """Show a paused world in the browser during the block; without a title, show nothing."""
    if title is None:
        yield
        return
    with world.view(title=title, speed=1.0, paused=True) as view:
        print(f"{view.address}  (press Resume there; Ctrl-C ends it)", file=sys.stderr, flush=True)
        yield
