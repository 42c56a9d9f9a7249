from __future__ import annotations

import numpy as np
from voxshell.recording import BodyTrack, ContactTrack, Recording
from voxshell.viewer.palette import BODY_COLORS, FIXED_COLOR, choose_colors


def make_recording(bodies: list[tuple[bool, tuple[int, int, int] | None]]) -> Recording:
    """Bodies that move or not, with a color or none."""
    tracks = []
    for number, (moves, color) in enumerate(bodies):
        poses = np.tile(np.eye(4), (2, 1, 1))
        poses[1, 0, 3] = 0.1 * moves
        tracks.append(BodyTrack(str(number), np.eye(3), [[0, 1, 2]], color, poses))
    return Recording(0.1, tuple(tracks), ContactTrack.empty(2))


def test_a_body_keeps_the_color_that_it_was_given():
    recording = make_recording([(True, (1, 2, 3)), (False, (0, 0, 0))])
    assert choose_colors(recording) == [(1, 2, 3), (0, 0, 0)]


def test_others_are_colored_in_turn_and_bodies_that_stay_are_gray():
    moving = [(True, None)] * (len(BODY_COLORS) + 1)
    colors = choose_colors(make_recording([(False, None), *moving]))
    assert colors == [FIXED_COLOR, *BODY_COLORS, BODY_COLORS[0]]


def test_a_body_that_stays_does_not_change_the_colors_of_others():
    both = choose_colors(make_recording([(True, None), (False, None), (True, None)]))
    assert both[::2] == choose_colors(make_recording([(True, None), (True, None)]))
