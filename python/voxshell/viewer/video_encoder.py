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
_UNCHANGED = 255
"""Color of pixels of a GIF that remain as in the last picture: the last one. All others are seen."""
_LONGEST_PAUSE = 2**16 - 1
"""Hundredths of a second that a GIF can state."""


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
    """A GIF whose pictures share 255 colors, among them those of contacts, so that only what moves takes space.

    Colors chosen for each picture alone would flicker, and leave out those of small things. Each picture
    is written when the next one is known. Pillow would keep all of them in memory until the last one.

    Args:
        path: The file.
        pause: Seconds between frames.
        samples: Some of the pictures, (h, w, 3).
    """

    def __init__(self, path: Path, pause: float, samples: Sequence[NDArray[np.uint8]]) -> None:
        self._images = import_module("PIL.Image")  # imageio needs it, too
        self._blocks = import_module("PIL.GifImagePlugin")
        self._path, self._pause = path, round(1e2 * pause)
        depths = color_depths(np.linspace(0.0, 1.0, _DEPTH_SHADES)).round().astype(np.uint8)
        needed = np.concatenate([depths, np.array([FORCE_COLOR], np.uint8)])
        found = self._choose_colors(samples, _UNCHANGED - len(needed))
        self._colors = [*found, *needed.ravel().tolist()]
        self._palette = self._images.new("P", (1, 1))
        self._palette.putpalette(self._colors)
        self._shown: NDArray[np.uint8] | None = None
        self._waiting: tuple[NDArray[np.uint8], tuple[int, int], int] | None = None

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
        colors = np.asarray(frame)
        change = self._find_change(colors)
        if self._waiting is not None:
            waiting, corner, pause = self._waiting
            if change is None and pause + self._pause <= _LONGEST_PAUSE:
                self._waiting = waiting, corner, pause + self._pause
                return
            self._write_waiting()
        part, corner = change or (np.full((1, 1), _UNCHANGED, np.uint8), (0, 0))
        self._waiting = part, corner, self._pause
        self._shown = colors

    def _find_change(
        self, colors: NDArray[np.uint8]
    ) -> tuple[NDArray[np.uint8], tuple[int, int]] | None:
        """Return the part that differs from the last picture, and its left and top; None if nothing does."""
        if self._shown is None:
            return colors, (0, 0)
        differs = colors != self._shown
        rows, columns = np.flatnonzero(differs.any(axis=1)), np.flatnonzero(differs.any(axis=0))
        if not len(rows):
            return None
        part = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
        changed = np.where(differs[part], colors[part], np.uint8(_UNCHANGED))
        return changed, (int(columns[0]), int(rows[0]))

    def _write_waiting(self) -> None:
        """Write the part of a picture that waits until it is known how long it is shown."""
        assert self._waiting is not None
        part, corner, pause = self._waiting
        if self._file.tell() == 0:
            self._file.write(_make_gif_head(part.shape[1], part.shape[0], self._colors))
        image = self._images.fromarray(part)
        for block in self._blocks.getdata(
            image, corner, duration=10 * pause, transparency=_UNCHANGED
        ):
            self._file.write(block)

    def __enter__(self) -> GifWriter:
        self._file = self._path.open("wb")
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Complete the file, or remove it if an exception ends the block."""
        with self._file:
            if kind is None:
                self._write_waiting()
                self._file.write(b";")
        if kind is not None:
            self._path.unlink()


def _make_gif_head(width: int, height: int, colors: Sequence[int]) -> bytes:
    """Return what a GIF of at most 256 colors, red, green and blue of each, begins with if it plays without end."""
    size = width.to_bytes(2, "little") + height.to_bytes(2, "little")
    table = bytes(colors).ljust(3 * 256, b"\0")
    endless = b"!\xff\x0bNETSCAPE2.0\x03\x01\0\0\0"
    return b"GIF89a" + size + b"\xf7\0\0" + table + endless
