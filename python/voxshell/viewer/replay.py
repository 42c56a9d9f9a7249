"""Replays: offline pages that play recordings side by side.

The page is viser's player with the scene inside. It opens from a file, needs no network, and has a
bar to play, pause and scrub.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from voxshell.errors import RecordingError, SettingsError
from voxshell.viewer.actors import Script, add_lane
from voxshell.viewer.arrows import full_force
from voxshell.viewer.lanes import Lane, view_axes
from voxshell.viewer.lighting import add_lights
from voxshell.viewer.page import add_heading, write_whole
from voxshell.viewer.pins import full_depth
from voxshell.viewer.server import silent_server
from voxshell.viewer.stage import find_ground_height, place_camera, plan_stage
from voxshell.viewer.time_plots import draw_time_plots
from voxshell.viewer.timeline import Timeline, plan_timeline


def save_replay(
    path: str | os.PathLike[str],
    lanes: Sequence[Lane],
    *,
    title: str,
    caption: str = "",
    up: str = "+z",
    frames_per_second: float = 60.0,
    speed: float = 1.0,
    max_contacts: int = 400,
    hold: float = 1.0,
) -> Path:
    """Write one offline page that plays recordings side by side.

    Bodies without a color get one. Level fixed boxes under everything that moves are grounds: they
    are drawn as thin plates with a grid, cut to the stage. If there is none, a plate with a grid is
    drawn below everything. Contacts are balls, colored by depth, with an arrow for the normal force
    on the moving body. If a recording has no forces, they are pins with a stem along the normal. If
    a shown frame has no contacts, it shows those of a skipped frame before it. The number below a
    lane counts all contacts of the shown frame. Plots show that number and the largest depth over
    time.

    Args:
        path: The file, usually with the suffix .html; written completely or not at all.
        lanes: The recordings; see :func:`voxshell.viewer.lanes.arrange_lanes`. Their time steps may
            differ: each shows its latest frame.
        title: Heading of the page.
        caption: A sentence below the heading.
        up: The world axis that points up, such as "+z" or "+y".
        frames_per_second: Largest number of frames per second of playback; every n-th frame of the
            recording is shown.
        speed: Simulated seconds per second of playback; 1 is real time, 0.25 slow motion. The play
            bar can change it.
        max_contacts: Largest number of pins in a lane at a time; from more contacts, an even sample
            is drawn.
        hold: Seconds to show the last frame before the replay starts again; the clock stands.

    Returns:
        The path of the file.

    Raises:
        MissingExtraError: viser is not installed.
        RecordingError: There is no lane.
        SettingsError: An option is invalid, or no file can be written there, for example because
            it is a folder or a pipe.
        FileAccessError: The system refuses to write it.
    """
    page = make_replay(
        lanes,
        title=title,
        caption=caption,
        up=up,
        frames_per_second=frames_per_second,
        speed=speed,
        max_contacts=max_contacts,
        hold=hold,
    )
    return write_whole(Path(path), page)


def make_replay(
    lanes: Sequence[Lane],
    *,
    title: str,
    caption: str = "",
    up: str = "+z",
    frames_per_second: float = 60.0,
    speed: float = 1.0,
    max_contacts: int = 400,
    hold: float = 1.0,
) -> str:
    """Return the page that :func:`save_replay` writes, HTML; with the same arguments and errors."""
    lanes = tuple(lanes)
    if not lanes:
        raise RecordingError("nothing to show: no lanes")
    if max_contacts < 0:
        raise SettingsError(f"max_contacts must be at least 0, got {max_contacts}")
    if not (np.isfinite(hold) and hold >= 0.0):
        raise SettingsError(f"hold must be seconds, at least 0, got {hold!r}")
    recordings = [lane.recording for lane in lanes]
    stage = plan_stage(lanes, up=up)
    boxes = [
        ((stage.low + lane.offset) * stage.scale, (stage.high + lane.offset) * stage.scale)
        for lane in lanes
    ]
    script = Script(
        stage=stage,
        camera=place_camera(boxes, rows=stage.rows, up=up),
        timeline=plan_timeline(recordings, frames_per_second=frames_per_second, speed=speed),
        up=up,
        lane_count=len(lanes),
        deepest=full_depth(recordings, stage.body_size),
        strongest=full_force(recordings),
        counted=any(len(recording.contacts.points) for recording in recordings),
        max_contacts=max_contacts,
    )
    return add_heading(
        _record(lanes, script, hold),
        title=title,
        caption=caption,
        rate=_describe_rate(script.timeline, lanes),
        deepest=script.deepest if script.counted else None,
        strongest=script.strongest,
        grid=stage.cell,
        plots=draw_time_plots(lanes, script.timeline, full=script.deepest),
        ground=find_ground_height(recordings, stage, up=up) * stage.scale,
        seconds=float(script.timeline.pauses.sum()),
    )


def _record(lanes: Sequence[Lane], script: Script, hold: float) -> str:
    """Return the player's page with the scene and all its changes, HTML."""
    with silent_server() as server:
        server.scene.world_axes.visible = False
        server.scene.set_up_direction(script.up)  # pyright: ignore[reportArgumentType]
        camera = server.initial_camera
        camera.position, camera.look_at = script.camera.position, script.camera.target
        add_lights(server.scene, up=script.up)
        camera.up, camera.fov = view_axes(script.up)[2], script.camera.field_of_view
        actors = [
            actor
            for number, lane in enumerate(lanes)
            for actor in add_lane(server.scene, lane, number, script)
        ]
        for actor in actors:
            actor.show(0)
        serializer = server.get_scene_serializer()
        for instant, pause in enumerate(script.timeline.pauses.tolist(), start=1):
            serializer.insert_sleep(pause)
            for actor in actors:
                actor.show(instant)
        serializer.insert_sleep(hold)
        return serializer.as_html()


def _describe_rate(timeline: Timeline, lanes: Sequence[Lane]) -> str:
    """Return the speed of the replay in words."""
    if timeline.speed == 1.0:
        pace = "Plays in real time"
    elif timeline.speed < 1.0:
        pace = f"Plays {1.0 / timeline.speed:.3g} times slower than real time"
    else:
        pace = f"Plays {timeline.speed:.3g} times faster than real time"
    # How many steps the simulation made between two frames, a recording does not say.
    rates = sorted({round(1.0 / lane.recording.time_step, 6) for lane in lanes})
    frames = f"{rates[0]:.6g}" if len(rates) == 1 else f"{rates[0]:.6g} to {rates[-1]:.6g}"
    if timeline.stride == 1:
        shown = "all frames"
    elif len(rates) == 1:
        shown = f"one frame in {timeline.stride}"
    else:
        shown = f"{rates[-1] / timeline.stride * timeline.speed:.3g} pictures per second"
    text = (
        f"{pace}: {round(timeline.times[-1], 2):g} s, recorded at {frames} frames per second. "
        f"It shows {shown}."
    )
    return text if timeline.speed == 1.0 else f"{text} The bar counts seconds of playing."
