"""The files of videos: how many frames a second they have, and the encoder."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from voxshell.base.user_warnings import warn_user

if TYPE_CHECKING:
    from pathlib import Path

    from voxshell.recording import Recording
    from voxshell.viewer.timeline import Timeline


def as_pause(pause: float, path: Path) -> float:
    """Return seconds between frames that the file can state."""
    if path.suffix.lower() != ".gif":
        return pause
    # Browsers slow down GIFs with less than 20 ms per frame.
    return 0.01 * max(round(100.0 * pause), 2)


def warn_of_rate(
    path: Path, recording: Recording, timeline: Timeline, rate: float, wanted: float
) -> None:
    """Warn if a video has clearly fewer frames per second than were asked for."""
    if len(timeline.times) < 2 or rate > 0.99 * wanted:
        return
    played = timeline.speed / recording.time_step
    shown = "all" if timeline.stride == 1 else f"one in {timeline.stride}"
    gif = "GIFs count in hundredths of a second; " if path.suffix.lower() == ".gif" else ""
    warn_user(
        f"the video has {rate:.4g} frames per second instead of {wanted:.4g}: it shows {shown} of the "
        f"{played:.4g} that the recording has in a second of playback; {gif}pass a frames_per_second that "
        "divides this number, or record more often",
        UserWarning,
    )


def open_writer(imageio: Any, path: Path, pause: float) -> Any:
    """Return a writer to which pictures can be appended.

    Args:
        imageio: The library.
        path: The file, with the suffix .mp4 or .gif.
        pause: Seconds between frames.
    """
    if path.suffix.lower() == ".gif":
        milliseconds = round(1e3 * pause)
        return imageio.get_writer(path, format="GIF", mode="I", duration=milliseconds, loop=0)
    return imageio.get_writer(
        path,
        format="FFMPEG",
        mode="I",
        fps=1.0 / pause,
        codec="libx264",
        pixelformat="yuv420p",
        quality=8,
        macro_block_size=2,
        ffmpeg_log_level="error",
    )
