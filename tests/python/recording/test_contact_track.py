from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from voxshell.errors import RecordingError
from voxshell.recording import ContactTrack


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"offsets": [0, 3]}, "offsets must run from 0 to 2, got 0 to 3"),
        ({"offsets": [1, 2]}, "got 1 to 2"),
        ({"offsets": [0, 2, 1, 2]}, "decrease from 2 to 1 at frame 1"),
        ({"offsets": [0]}, r"shape \(frames \+ 1,\), got \(1,\)"),
        ({"offsets": [0.0, 2.0]}, "must be integers"),
        ({"points": np.zeros((3, 3))}, "3 points, 2 normals, 2 depths and 3 forces"),
        ({"forces": np.zeros((1, 3))}, "2 depths and 1 forces"),
        ({"depths": [0.0]}, "2 normals, 1 depths and 2 forces"),
        ({"depths": [0.0, np.inf]}, "1 of 2 numbers"),
        (
            {"forces": [[1e308, 1e308, 0.0], [0.0, 0.0, 1.0]]},
            r"forces hold 2 of 6 numbers beyond 1e\+30",
        ),
        ({"normals": [[0, 0, 1], [0, 0, 2]]}, r"normal 1 has length 2 .*\(1 such"),
    ],
)
def test_bad_contacts_are_refused(change, message):
    good = {
        "offsets": [0, 2],
        "points": np.zeros((2, 3)),
        "normals": [[0, 0, 1], [1, 0, 0]],
        "depths": [0.001, -0.001],
    }
    ContactTrack(**good)
    with pytest.raises(RecordingError, match=message):
        ContactTrack(**(good | change))


@given(st.lists(st.integers(0, 5), min_size=1, max_size=8))
def test_frames_come_back_as_they_were_given(counts):
    rng = np.random.default_rng(sum(counts))
    frames = [
        (rng.normal(size=(n, 3)), np.tile([0.0, 1.0, 0.0], (n, 1)), rng.normal(size=n))
        for n in counts
    ]
    track = ContactTrack.from_frames(frames)
    assert track.counts.tolist() == counts
    for index, (points, normals, depths) in enumerate(frames):
        one = track.frame(index)
        assert one.frame_count == 1
        np.testing.assert_array_equal(one.points, points)
        np.testing.assert_array_equal(one.normals, normals)
        np.testing.assert_array_equal(one.depths, depths)


def test_frames_of_contacts_that_are_not_there():
    with pytest.raises(IndexError, match="frame 2 of 2"):
        ContactTrack.empty(2).frame(2)
    with pytest.raises(RecordingError, match="at least one frame"):
        ContactTrack.from_frames([])
    with pytest.raises(
        RecordingError, match="frame 1 has 0 points, 0 normals, 1 depths and 0 forces"
    ):
        ContactTrack.from_frames([([], [], []), ([], [], [0.1])])


def test_forces_are_kept_by_frame_and_zero_where_none_are_given():
    force = [[0.0, 0.0, 2.0]]
    one = ([[0, 0, 0]], [[0, 0, 1]], [0.001])
    track = ContactTrack.from_frames([one, (*one, force)])
    np.testing.assert_array_equal(track.forces, [[0.0, 0.0, 0.0], *force])
    np.testing.assert_array_equal(track.frame(1).forces, force)
    assert ContactTrack.empty(2).forces.shape == (0, 3)
