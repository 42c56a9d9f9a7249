from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from voxshell.errors import MissingExtraError, RecordingError, VoxshellError
from voxshell.recording import BodyTrack, ContactTrack, Recording

TRIANGLE = np.eye(3)
FACES = np.array([[0, 1, 2]])


def still(frames: int) -> np.ndarray:
    return np.tile(np.eye(4), (frames, 1, 1))


def body(frames: int = 2, name: str = "flag") -> BodyTrack:
    return BodyTrack(name, TRIANGLE, FACES, None, still(frames))


def test_arrays_are_read_only_copies():
    vertices, poses = TRIANGLE.copy(), still(2)
    track = BodyTrack("flag", vertices, FACES, None, poses)
    vertices[0, 0] = 7.0
    poses[0, 0, 3] = 7.0
    assert track.vertices[0, 0] == 1.0
    assert track.poses[0, 0, 3] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        track.poses[0, 0, 3] = 1.0


def test_a_body_is_fixed_only_if_no_pose_differs():
    poses = still(3)
    assert BodyTrack("flag", TRIANGLE, FACES, None, poses).fixed
    poses[2, 0, 3] = 1e-9
    assert not BodyTrack("flag", TRIANGLE, FACES, None, poses).fixed


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"name": " "}, "needs a name"),
        ({"vertices": np.zeros((3, 2))}, r"shape \(n, 3\), got \(3, 2\)"),
        ({"vertices": np.full((3, 3), np.nan)}, "9 of 9 numbers that are not finite"),
        ({"vertices": "mesh"}, "vertices must be numbers"),
        ({"vertices": np.zeros((0, 3))}, "nothing to show, 0 vertices"),
        ({"faces": [[0, 1, 3]]}, "vertices 0 to 3, but there are 3"),
        ({"faces": [[-1, 1, 2]]}, "vertices -1 to 2"),
        ({"faces": [[0.0, 1.0, 2.0]]}, "must be integers, got float64"),
        ({"faces": [[0, 1, 2, 0]]}, r"shape \(m, 3\), got \(1, 4\)"),
        ({"color": (1, 2)}, "three integers"),
        ({"color": (0.2, 0.4, 0.6)}, "three integers"),
        ({"color": (1, 2, 256)}, "from 0 to 255"),
        ({"poses": np.eye(4)}, r"shape \(frames, 4, 4\), got \(4, 4\)"),
        ({"poses": np.zeros((0, 4, 4))}, r"got \(0, 4, 4\)"),
        ({"poses": 2.0 * still(2)}, "2 of 2 are not, first frame 0: rotation off by 3"),
        ({"poses": still(2) * np.diag([-1, 1, 1, 1])}, "determinant -1"),
    ],
)
def test_a_bad_body_is_refused(change, message):
    good = {"name": "flag", "vertices": TRIANGLE, "faces": FACES, "color": None, "poses": still(2)}
    BodyTrack(**good)
    with pytest.raises(RecordingError, match=message):
        BodyTrack(**(good | change))


def test_a_transposed_pose_is_refused():
    poses = still(4)
    poses[3, 3, :3] = (0.0, 0.0, 0.1)
    with pytest.raises(RecordingError, match=r"first frame 3: .*last row \[0.0, 0.0, 0.1, 1.0\]"):
        BodyTrack("flag", TRIANGLE, FACES, None, poses)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"offsets": [0, 3]}, "offsets must run from 0 to 2, got 0 to 3"),
        ({"offsets": [1, 2]}, "got 1 to 2"),
        ({"offsets": [0, 2, 1, 2]}, "fall from 2 to 1 at frame 1"),
        ({"offsets": [0]}, r"shape \(frames \+ 1,\), got \(1,\)"),
        ({"offsets": [0.0, 2.0]}, "must be integers"),
        ({"points": np.zeros((3, 3))}, "3 points, 2 normals and 2 depths"),
        ({"depths": [0.0]}, "2 normals and 1 depths"),
        ({"depths": [0.0, np.inf]}, "1 of 2 numbers"),
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
    with pytest.raises(RecordingError, match="frame 1 has 0 points, 0 normals and 1 depths"):
        ContactTrack.from_frames([([], [], []), ([], [], [0.1])])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"time_step": 0.0}, "time_step must be positive seconds, got 0.0"),
        ({"time_step": float("nan")}, "got nan"),
        ({"bodies": ()}, "at least one body"),
        ({"bodies": (body(), body())}, r"1 body name\(s\) used more than once: \['flag'\]"),
        ({"bodies": (body(), body(3, "pole"))}, "'pole' has 3 frames, body 'flag' has 2"),
        ({"contacts": ContactTrack.empty(5)}, "contacts have 5 frames, the bodies have 2"),
    ],
)
def test_a_bad_recording_is_refused(change, message):
    good = {"time_step": 0.005, "bodies": (body(),), "contacts": ContactTrack.empty(2)}
    Recording(**good)
    with pytest.raises(RecordingError, match=message):
        Recording(**(good | change))


def test_errors_belong_to_the_family_and_to_python():
    assert issubclass(RecordingError, VoxshellError)
    assert issubclass(RecordingError, ValueError)
    assert issubclass(MissingExtraError, ImportError)


def test_recordings_do_not_load_the_viewer():
    code = "import sys, voxshell.recording; print('viser' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_a_missing_viewer_is_told_of(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    recording = Recording(0.005, (body(),), ContactTrack.empty(2))
    with pytest.raises(MissingExtraError, match=r"pip install 'voxshell\[viewer\]'"):
        recording.save_html(tmp_path / "replay.html")
    assert list(tmp_path.iterdir()) == []
