"""The output files of a scene's simulation: all of them or none."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.base.outputs import filling
from voxshell.errors import MissingExtraError
from voxshell.measuring.environment import describe_environment
from voxshell.measuring.files import write_csv, write_figure, write_json, write_parquet
from voxshell.scenes.scene_run import make_recording, tabulate_contacts, tabulate_poses

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell.recording import Recording
    from voxshell.scenes.scene_file import Scene
    from voxshell.scenes.scene_run import SceneRun
    from voxshell.scenes.scene_settings import OutputSettings
    from voxshell.simulation.world import World

PAGE, PLOT, RESULTS = "index.html", "plot.png", "results.json"
EXPORT = "recording"
"""Name of exports without suffix."""


def check_extras(scene: Scene) -> None:
    """Check before the simulation that all libraries for the outputs are installed.

    Raises:
        MissingExtraError: An output needs a library that is not installed.
    """
    from importlib.util import find_spec

    outputs = scene.outputs
    needed = (
        (outputs.replay, "viser", "viewer"),
        (outputs.plot, "matplotlib", "report"),
        ("parquet" in (outputs.poses, outputs.contacts), "pyarrow", "report"),
        *((is_video(outputs), name, "video") for name in ("pyvista", "imageio", "imageio_ffmpeg")),
        (bool({"usda", "usdc"} & set(outputs.exports)), "pxr", "usd"),
    )
    missing = [
        (library, extra)
        for wanted, library, extra in needed
        if wanted and find_spec(library) is None
    ]
    if missing:
        libraries = ", ".join(library for library, _ in missing)
        extras = ",".join(dict.fromkeys(extra for _, extra in missing))
        raise MissingExtraError(
            f"the outputs of {scene.path} need {libraries}: pip install 'voxshell[{extras}]'"
        )


def is_video(outputs: OutputSettings) -> bool:
    """Return whether the outputs include a video."""
    return bool({"mp4", "gif"} & set(outputs.exports))


def list_files(scene: Scene) -> list[str]:
    """Return the names of the files that the scene requests."""
    outputs = scene.outputs
    tables = {"poses": outputs.poses, "contacts": outputs.contacts}
    return [
        RESULTS,
        *(f"{name}.{form}" for name, form in tables.items() if form != "none"),
        *([PLOT] if outputs.plot else []),
        *([PAGE] if outputs.replay else []),
        *(f"{EXPORT}.{form}" for form in dict.fromkeys(outputs.exports)),
    ]


def write_outputs(
    out: Path,
    scene: Scene,
    world: World,
    run: SceneRun,
    progress: Callable[[str, float], object],
) -> list[Path]:
    """Write the files that the scene requests; they appear together, once all are complete.

    Returns:
        Their paths.

    Raises:
        FileAccessError: A file cannot be written; then none is.
    """
    with filling(out) as folder:
        _write_all(folder, scene, world, run, progress)
    return [out / name for name in sorted(list_files(scene))]


def summarize(run: SceneRun) -> list[dict[str, Any]]:
    """Return each body's final position, speed, and depths of contacts, ready for JSON."""
    rows = []
    for index, name in enumerate(run.names):
        depths = [
            frame["depth"][(frame["body_a"] == index) | (frame["body_b"] == index)]
            for frame in run.contacts
        ]
        deepest = max((float(each.max()) for each in depths if len(each)), default=0.0)
        rows.append(
            {
                "body": name,
                "position": run.poses[-1, index, :3, 3].tolist(),
                "speed": float(np.linalg.norm(run.linear_velocities[-1, index])),
                "angular_speed": float(np.linalg.norm(run.angular_velocities[-1, index])),
                "contacts": len(depths[-1]),
                "deepest": max(deepest, 0.0),
            }
        )
    return rows


def describe_results(scene: Scene, world: World, run: SceneRun) -> dict[str, Any]:
    """Return settings, final states of bodies, times of steps and versions, ready for JSON."""
    narrow = run.timings["narrow_phase"]
    return {
        "scene": str(scene.path),
        "title": scene.title,
        "settings": {
            "scene": asdict(scene.world),
            "outputs": asdict(scene.outputs),
            "meshes": {name: asdict(each) for name, each in scene.meshes.items()},
            "bodies": {name: asdict(each) for name, each in scene.bodies.items()},
            "joints": {name: asdict(each) for name, each in scene.joints.items()},
        },
        "steps": scene.world.steps,
        "bodies": summarize(run),
        "joints": [
            {"joint": joint.name, "position": joint.position, "velocity": joint.velocity}
            for joint in world.joints
            if scene.joints[joint.name].has_axis
        ],
        "narrow_phase_seconds": {
            "median": float(np.median(narrow)),
            "p99": float(np.percentile(narrow, 99)),
        },
        "step_seconds": {
            "median": float(np.median(run.timings["step"])),
            "p99": float(np.percentile(run.timings["step"], 99)),
        },
        "units": "seconds, meters, radians, m/s, rad/s",
        "environment": describe_environment(),
    }


def _write_all(
    folder: Path,
    scene: Scene,
    world: World,
    run: SceneRun,
    progress: Callable[[str, float], object],
) -> None:
    outputs = scene.outputs
    progress(RESULTS, 0.0)
    write_json(folder / RESULTS, describe_results(scene, world, run))
    for name, form, tabulate in (
        ("poses", outputs.poses, tabulate_poses),
        ("contacts", outputs.contacts, tabulate_contacts),
    ):
        if form != "none":
            progress(f"{name}.{form}", 0.1)
            _write_table(folder / f"{name}.{form}", tabulate(run))
    if outputs.plot:
        progress(PLOT, 0.3)
        _draw(folder / PLOT, scene, run)
    if not outputs.replay and not outputs.exports:
        return
    recording = make_recording(scene, world, run)
    if outputs.replay:
        progress(PAGE, 0.5)
        recording.save_html(folder / PAGE, title=scene.title)
    forms = list(dict.fromkeys(outputs.exports))
    for number, form in enumerate(forms):
        name = f"{EXPORT}.{form}"

        def advance(_: str, fraction: float, name: str = name, number: int = number) -> None:
            progress(name, 0.7 + 0.3 * (number + fraction) / len(forms))

        advance("", 0.0)
        _export(recording, folder / name, scene.title, advance)


def _export(
    recording: Recording, path: Path, title: str, progress: Callable[[str, float], object]
) -> None:
    match path.suffix:
        case ".mp4" | ".gif":
            recording.save_video(path, title=title, progress=progress)
        case ".glb":
            recording.save_gltf(path)
        case _:
            recording.save_usd(path)


def _write_table(path: Path, columns: Mapping[str, NDArray[np.generic]]) -> None:
    if path.suffix == ".csv":
        write_csv(
            path, columns, zip(*(column.tolist() for column in columns.values()), strict=True)
        )
    else:
        write_parquet(path, columns)


def _draw(path: Path, scene: Scene, run: SceneRun) -> None:
    """Plot heights, speeds and numbers of contacts of the moving bodies over time."""
    from matplotlib.figure import Figure

    up = -np.array(scene.world.gravity)
    length = float(np.linalg.norm(up))
    up = up / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    figure = Figure(figsize=(9, 8), dpi=120, layout="constrained")
    heights, speeds, counts = figure.subplots(3, 1, sharex=True)
    for index, (name, body) in enumerate(scene.bodies.items()):
        if body.kilograms == 0.0:
            continue
        color = None if body.color is None else np.array(body.color) / 255.0
        line = {"label": name, "lw": 1.2, "color": color}
        heights.plot(run.times, run.poses[:, index, :3, 3] @ up, **line)
        speeds.plot(run.times, np.linalg.norm(run.linear_velocities[:, index], axis=1), **line)
    counts.plot(run.times, [len(frame) for frame in run.contacts], lw=1.2, color="#555555")
    heights.set_ylabel("height of the origin, m")
    speeds.set_ylabel("speed, m/s")
    counts.set_ylabel("contact points")
    counts.set_xlabel("time, s")
    for axes in (heights, speeds, counts):
        axes.grid(visible=True, color="#dddddd", lw=0.6)
        axes.spines[["top", "right"]].set_visible(False)
        axes.margins(x=0.01)
    if heights.lines:
        heights.legend(loc="upper right", frameon=False)
    figure.suptitle(scene.title, x=0.01, ha="left", fontsize=13)
    write_figure(path, figure)
