"""Outputs of a drop: data, curves and replay."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np
from voxshell.errors import MissingExtraError
from voxshell.measuring.environment import describe_environment
from voxshell.measuring.files import write_figure, write_json
from voxshell.measuring.units import format_time

from voxshell_studies.drop import FULL_OPERATION, REST_STEPS
from voxshell_studies.scenes.drop import BULLET_MARGIN, GROUND_HALF_EXTENTS

if TYPE_CHECKING:
    from pathlib import Path

    from voxshell_studies.drop import DropRun, DropSummary
    from voxshell_studies.scenes.drop import DropSettings, DropShapes

COLORS = {
    "vps-fine": "#0b6e4f",
    "vps-coarse": "#43aa8b",
    "vps-fine-plane": "#90be6d",
    "gimpact": "#d1495b",
    "gimpact-plane": "#f4978e",
    "hull": "#5c6bc0",
    "decomposition": "#e09f3e",
    "hacd": "#8d6e63",
    "coacd": "#7d5ba6",
}
"""A color for each method in all pictures; ours are green."""


def write_results(
    path: Path,
    mesh_name: str,
    settings: DropSettings,
    shapes: DropShapes,
    runs: list[DropRun],
    summaries: list[DropSummary],
) -> None:
    """Write figures, settings, shapes, versions and the values of every step as JSON.

    "world_arguments" are those in which a method's world differs from :class:`voxshell.World`'s
    defaults.
    """
    write_json(
        path,
        {
            "experiment": "drop",
            "mesh": {
                "name": mesh_name,
                "vertices": len(shapes.mesh.vertices),
                "triangles": len(shapes.mesh.faces),
            },
            "settings": asdict(settings)
            | {
                "ground_half_extents": GROUND_HALF_EXTENTS,
                "inertia": shapes.mass_properties.inertia.tolist(),
                "margin_of_bullets_shapes": BULLET_MARGIN,
            },
            "full_operation_steps": FULL_OPERATION,
            "rest_steps": REST_STEPS,
            "environment": describe_environment(),
            "units": "seconds, meters, m/s, rad/s",
            "methods": [
                asdict(run.method)
                | asdict(summary)
                | {
                    "shape": repr(shapes.bodies[run.method.key]),
                    "ground_shape": repr(shapes.grounds[run.method.ground]),
                    "world_arguments": run.method.solver,
                }
                | {
                    "curves": {
                        name: getattr(run, name).tolist()
                        for name in (
                            "narrow_phase",
                            "query",
                            "reduction",
                            "manifold",
                            "contacts",
                            "depth",
                            "speed",
                            "angular_speed",
                            "lowest",
                        )
                    }
                }
                for run, summary in zip(runs, summaries, strict=True)
            ],
        },
    )


def draw_curves(path: Path, title: str, runs: list[DropRun]) -> None:
    """Draw narrow-phase time and speed over steps, as in the thesis (section 5.3), as a PNG.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtraError(
            "the curves need matplotlib: pip install voxshell-studies"
        ) from error

    figure = Figure(figsize=(11, 8.5), dpi=120, layout="constrained")
    time_axes, speed_axes = figure.subplots(2, 1, sharex=True)
    for run in runs:
        steps = np.arange(1, run.steps + 1)
        color = COLORS[run.method.key]
        # Zero cannot be shown on a logarithmic axis.
        time = np.where(run.narrow_phase > 0.0, run.narrow_phase, np.nan)
        speed = np.where(run.speed > 0.0, run.speed, np.nan)
        # Draw ours on top: otherwise curves that vibrate at rest would hide them.
        above = 3 if run.method.is_model else 2
        time_axes.plot(steps, time * 1e6, color=color, lw=1.1, label=run.method.label, zorder=above)
        speed_axes.plot(steps, speed, color=color, lw=1.1, zorder=above)
    time_axes.set_ylabel("narrow phase, \N{MICRO SIGN}s a step")
    speed_axes.set_ylabel("speed of the center of mass, m/s")
    speed_axes.set_xlabel("step")
    for axes in (time_axes, speed_axes):
        axes.set_yscale("log")
        axes.axvspan(*FULL_OPERATION, color="#000000", alpha=0.05, lw=0)
        axes.grid(visible=True, which="major", color="#dddddd", lw=0.6)
        axes.spines[["top", "right"]].set_visible(False)
        axes.margins(x=0.01)
    time_axes.text(
        sum(FULL_OPERATION) / 2,
        0.985,
        f"timed: steps {FULL_OPERATION[0]}-{FULL_OPERATION[1]}",
        transform=time_axes.get_xaxis_transform(),
        ha="center",
        va="top",
        fontsize=8,
        color="#666666",
    )
    figure.suptitle(title, x=0.01, ha="left", fontsize=13)
    figure.legend(loc="outside right center", frameon=False)
    write_figure(path, figure)


def save_page(path: Path, title: str, runs: list[DropRun], summaries: list[DropSummary]) -> None:
    """Write one offline page with all methods side by side.

    Raises:
        MissingExtraError: viser is not installed.
    """
    from dataclasses import replace

    from voxshell.viewer.lanes import arrange_lanes
    from voxshell.viewer.replay import save_replay

    recordings = {}
    for run, summary in zip(runs, summaries, strict=True):
        color = tuple(int(COLORS[run.method.key][i : i + 2], 16) for i in (1, 3, 5))
        bodies = tuple(
            replace(body, color=color) if body.name == "body" else body
            for body in run.recording.bodies
        )
        label = f"{run.method.label}\n{format_time(summary.median)}"
        recordings[label] = replace(run.recording, bodies=bodies)
    save_replay(
        path,
        arrange_lanes(recordings),
        title=title,
        caption="Times: narrow phase of a step, median of the steps timed.",
    )
