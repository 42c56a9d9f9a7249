"""Frames a second of videos."""

from __future__ import annotations

from pathlib import Path

import pytest
from recorded_fall import turn_and_fall
from voxshell.viewer.timeline import plan_timeline
from voxshell.viewer.video_encoder import as_pause, warn_of_rate


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
