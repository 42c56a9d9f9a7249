"""The files of videos: how many frames a second they have, and the encoder."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.base.user_warnings import warn_user
from voxshell.viewer.palette import FORCE_COLOR
from voxshell.viewer.pins import color_depths

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell.recording import Recording
    from voxshell.viewer.timeline import Timeline

_DEPTH_SHADES = 32
"""Colors of a GIF that contacts have, from a touch to the largest depth."""


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


def open_writer(
    imageio: Any, path: Path, pause: float, samples: Sequence[NDArray[np.uint8]]
) -> Any:
    """Return a writer, a context manager, to which pictures can be appended.

    Args:
        imageio: The library.
        path: The file, with the suffix .mp4 or .gif.
        pause: Seconds between frames.
        samples: Some of the pictures, (h, w, 3), whose colors a GIF gets; MP4 needs none.
    """
    if path.suffix.lower() == ".gif":
        return GifWriter(path, pause, samples)
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


class GifWriter:
    """A GIF whose pictures share 256 colors, among them those of contacts, so that only what moves takes space.

    Colors chosen for each picture alone would flicker, and leave out those of small things.

    Args:
        path: The file.
        pause: Seconds between frames.
        samples: Some of the pictures, (h, w, 3).
    """

    def __init__(self, path: Path, pause: float, samples: Sequence[NDArray[np.uint8]]) -> None:
        self._images = import_module("PIL.Image")  # imageio needs it, too
        self._path, self._milliseconds = path, round(1e3 * pause)
        depths = color_depths(np.linspace(0.0, 1.0, _DEPTH_SHADES)).round().astype(np.uint8)
        needed = np.concatenate([depths, np.array([FORCE_COLOR], np.uint8)])
        found = self._choose_colors(samples, 256 - len(needed))
        self._palette = self._images.new("P", (1, 1))
        self._palette.putpalette([*found, *needed.ravel().tolist()])
        self._frames: list[Any] = []

    def _choose_colors(self, samples: Sequence[NDArray[np.uint8]], count: int) -> list[int]:
        """Return red, green and blue of each color, one after the other."""
        pixels = np.concatenate([each.reshape(-1, 3) for each in samples]).astype(np.int64)
        seen, areas = np.unique(pixels @ (1 << 16, 1 << 8, 1), return_counts=True)
        colors = np.stack([seen >> 16, seen >> 8 & 255, seen & 255], axis=1).astype(np.uint8)
        # Weighted by their areas, most would be those of a bright background.
        image = self._images.fromarray(
            np.repeat(colors, np.ceil(np.sqrt(areas)).astype(int), axis=0)[None]
        )
        return image.quantize(count, kmeans=3).getpalette()[: 3 * count]

    def append_data(self, picture: NDArray[np.uint8]) -> None:
        """Append a picture, (h, w, 3)."""
        plain = self._images.Dither.NONE  # grain would move, and takes space
        frame = self._images.fromarray(picture).quantize(palette=self._palette, dither=plain)
        self._frames.append(frame)

    def __enter__(self) -> GifWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Write the file, unless an exception ends the block."""
        if kind is None:
            first, *rest = self._frames
            first.save(
                self._path,
                format="GIF",
                save_all=True,
                append_images=rest,
                duration=self._milliseconds,
                loop=0,
            )
