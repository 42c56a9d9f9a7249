"""Contacts as exports show them: which balls and arrows a frame has."""

from __future__ import annotations

import numpy as np
import pytest
from recorded_fall import FRAMES, turn_and_fall
from voxshell.recording import ContactTrack, Recording
from voxshell.viewer.marks import MarkedContacts


def test_balls_lie_at_contacts_and_arrows_begin_there_and_grow_with_forces():
    recording = turn_and_fall()
    marked = MarkedContacts(recording, up="+z", limit=10)
    assert marked.deepest == pytest.approx(0.002)
    assert marked.strongest == pytest.approx(2.0)
    first, last = marked.frame(0), marked.frame(FRAMES - 1)
    assert first.points.tolist() == [[0.0, 0.0, 0.0]]
    assert (first.fractions[0], last.fractions[0]) == pytest.approx((0.5, 1.0))
    lengths = [np.linalg.norm(each.arrows[0, 1] - each.arrows[0, 0]) for each in (first, last)]
    assert lengths[1] == pytest.approx(2.0 * lengths[0])
    assert (last.arrows[0, 0] == last.points[0]).all()


def test_of_many_contacts_an_even_sample_is_shown_and_without_forces_no_arrow():
    count = 1000
    line = np.zeros((count, 3))
    line[:, 0] = np.arange(count)
    bodies = turn_and_fall().bodies
    contacts = [(line, np.tile((0.0, 0.0, 1.0), (count, 1)), np.zeros(count))] * FRAMES
    recording = Recording(0.1, bodies, ContactTrack.from_frames(contacts))
    marks = MarkedContacts(recording, up="+z", limit=5).frame(0)
    assert marks.points[:, 0].tolist() == [0.0, 250.0, 500.0, 749.0, 999.0]
    assert marks.fractions.tolist() == [0.0] * 5
    assert len(marks.arrows) == 0
