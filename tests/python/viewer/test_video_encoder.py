"""Frames a second of videos, and colors of GIFs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from recorded_fall import turn_and_fall
from voxshell.viewer.pins import DEPTH_COLORS
from voxshell.viewer.timeline import plan_timeline
from voxshell.viewer.video_encoder import GifWriter, as_pause, warn_of_rate


@pytest.mark.parametrize(
    ("name", "pause", "kept"),
    [("a.mp4", 0.0123, 0.0123), ("a.gif", 0.0123, 0.02), ("A.GIF", 0.034, 0.03)],
)
def test_gifs_count_in_hundredths_of_a_second_and_have_50_frames_at_most(
    name: str, pause: float, kept: float
):
    assert as_pause(pause, Path(name)) == pytest.approx(kept)


@pytest.mark.parametrize(
    ("name", "rate", "wanted", "message"),
    [
        ("a.mp4", 30.0, 40.0, "30 frames per second instead of 40: it shows one in 2 of the 60 that"),
        ("a.gif", 20.0, 30.0, "playback; GIFs count in hundredths of a second; pass a frames_per_sec"),
        ("a.mp4", 30.0, 30.0, ""),
        ("a.mp4", 29.9, 30.0, ""),
    ],
)  # fmt: skip
def test_fewer_frames_than_asked_for_are_warned_of(
    name: str, rate: float, wanted: float, message: str
):
    recording = turn_and_fall()
    timeline = plan_timeline([recording], frames_per_second=30.0)
    if not message:
        warn_of_rate(Path(name), recording, timeline, rate, wanted)
        return
    with pytest.warns(UserWarning, match=message):
        warn_of_rate(Path(name), recording, timeline, rate, wanted)


def test_a_gif_keeps_the_colors_of_small_contacts_and_stores_only_what_moves(tmp_path: Path):
    # A bright scene with more colors than a GIF has, and on it a contact of a few pixels that moves.
    across, down = np.meshgrid(np.linspace(0, 60, 320), np.linspace(0, 60, 200))
    scene = np.stack([250 - across, 240 - down, 245 - 0.5 * (across + down)], axis=2)
    touch, deep = np.array(DEPTH_COLORS[0]), np.array(DEPTH_COLORS[-1])
    pictures = []
    for frame in range(20):
        picture = scene.round().astype(np.uint8)
        picture[100:104, 10 * frame : 10 * frame + 4] = touch
        picture[150:154, 10 * frame : 10 * frame + 4] = deep
        pictures.append(picture)
    path = tmp_path / "a.gif"
    with GifWriter(path, 0.1, pictures[:1]) as writer:
        for picture in pictures:
            writer.append_data(picture)
    with Image.open(path) as film:
        assert film.n_frames == 20
        assert film.info["duration"] == 100
        for frame in range(20):
            film.seek(frame)
            shown = np.asarray(film.convert("RGB"), dtype=int)
            assert np.abs(shown[101, 10 * frame + 1] - touch).max() <= 4
            assert np.abs(shown[151, 10 * frame + 1] - deep).max() <= 4
            assert np.abs(shown - pictures[frame]).max() <= 12
        first = len(pictures[0].tobytes()) // 3
    assert path.stat().st_size < 2 * first


def test_a_gif_whose_drawing_fails_is_not_written(tmp_path: Path):
    path = tmp_path / "a.gif"

    def draw() -> None:
        picture = np.zeros((8, 8, 3), np.uint8)
        with GifWriter(path, 0.1, [picture]) as writer:
            writer.append_data(picture)
            raise KeyError

    with pytest.raises(KeyError):
        draw()
    assert not path.exists()
