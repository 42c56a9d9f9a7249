from __future__ import annotations

import re

import numpy as np
import pytest
from voxshell.recording import BodyTrack, ContactTrack, Recording
from voxshell.viewer.lanes import Lane
from voxshell.viewer.time_plots import draw_time_plots
from voxshell.viewer.timeline import plan_timeline

FRAMES = 101


def record(depths: dict[int, list[float]]) -> Recording:
    """A body that stays, with contacts of these depths at some frames, 1/60 s apart."""
    frames = []
    for frame in range(FRAMES):
        here = depths.get(frame, [])
        frames.append((np.zeros((len(here), 3)), np.tile([0.0, 0.0, 1.0], (len(here), 1)), here))
    flag = BodyTrack("flag", np.eye(3), [[0, 1, 2]], None, np.tile(np.eye(4), (FRAMES, 1, 1)))
    return Recording(1 / 60, (flag,), ContactTrack.from_frames(frames))


def draw(*recordings: Recording, labels: tuple[str, ...] = ("", "")) -> str:
    lanes = [Lane(label, r) for label, r in zip(labels, recordings, strict=False)]
    return draw_time_plots(lanes, plan_timeline(recordings))


def read_lines(page: str) -> list[np.ndarray]:
    """(k, 2) places along the plot and up it, 0 to 1, of each line."""
    lines = re.findall(r'points="([^"]*)"', page)
    read = [np.array([p.split(",") for p in line.split()], dtype=float) for line in lines]
    return [np.column_stack([xy[:, 0] / 240.0, (39.5 - xy[:, 1]) / 39.0]) for xy in read]


def test_lines_tell_how_many_contacts_and_how_deep_when():
    page = draw(record({25: [0.001, 0.003], 50: [0.004], 75: [-0.001] * 4}))
    counts, depths = read_lines(page)
    for line, wanted in ((counts, {25: 0.5, 50: 0.25, 75: 1.0}), (depths, {25: 0.75, 50: 1.0})):
        assert (line[0, 0], line[-1, 0]) == (0.0, 1.0)
        found = {round(100 * x): y for x, y in line if y > 0.01}
        assert found == pytest.approx(wanted, abs=0.01)
    assert "contacts, at most 4" in page
    assert "deepest, at most 4 mm" in page
    assert 'data-seconds="1.66667"' in page


def test_each_lane_has_a_line_of_its_color_and_a_name():
    page = draw(record({3: [0.001]}), record({5: [0.002]}), labels=("a < b\nmore", "c"))
    assert len(read_lines(page)) == 4
    names = re.findall(r'<span style="color: (#\w+)">([^<]*)</span>', page)
    assert [name for _, name in names] == ["a &lt; b", "c"]
    assert [color for color, _ in names] == re.findall(r'stroke="(#\w+)"', page)[:2]


def test_depths_that_are_rounding_are_a_line_at_the_foot_and_have_no_digits():
    recording = record({25: [9.68e-11], 50: [4e-11]})
    page = draw_time_plots([Lane("", recording)], plan_timeline([recording]), full=12e-6)
    assert read_lines(page)[1][:, 1].max() < 0.01
    assert "deepest, below 0.1 µm" in page


def test_without_contacts_there_is_nothing_to_plot():
    assert draw(record({})) == ""
