from __future__ import annotations

import numpy as np
import pytest
from voxshell.errors import RecordingError
from voxshell.recording import BodyTrack

TRIANGLE = np.eye(3)
FACES = np.array([[0, 1, 2]])


def still(frames: int) -> np.ndarray:
    return np.tile(np.eye(4), (frames, 1, 1))


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


def test_a_body_that_comes_later_has_the_pose_with_which_it_comes_before():
    poses = still(4)
    poses[:, 0, 3] = [5.0, 6.0, 1.0, 1.0]
    track = BodyTrack("flag", TRIANGLE, FACES, None, poses, 2)
    assert track.poses[:, 0, 3].tolist() == [1.0] * 4
    assert track.fixed
    assert BodyTrack("flag", TRIANGLE, FACES, None, poses).start == 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"start": -1}, "body 'flag': start must be from 0 to 1, not -1"),
        ({"start": 2}, "body 'flag': start must be from 0 to 1, not 2"),
        ({"start": 0.5}, "body 'flag': start must be an integer"),
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
