from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from voxshell.errors import (
    InputTypeError,
    MissingExtraError,
    RecordingError,
    SettingsError,
    VoxshellError,
)
from voxshell.recording import BodyTrack, ContactTrack, Recording


def still(frames: int) -> np.ndarray:
    return np.tile(np.eye(4), (frames, 1, 1))


def body(frames: int = 2, name: str = "flag") -> BodyTrack:
    return BodyTrack(name, np.eye(3), [[0, 1, 2]], None, still(frames))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"time_step": 0.0}, "time_step must be positive seconds, got 0.0"),
        ({"time_step": 1e-320}, "time_step must be from 1e-30 to 1e\\+30 s, got 1e-320"),
        ({"time_step": float("nan")}, "got nan"),
        ({"bodies": ()}, "at least one body"),
        ({"bodies": (body(), body())}, r"1 body name\(s\) are not unique: \['flag'\]"),
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


@pytest.mark.parametrize(
    ("method", "name", "message"),
    [
        (
            "save_html",
            "fall.png",
            r"ends in .html or .htm, but 'fall.png' ends in '.png'; try 'fall.html'",
        ),
        ("save_html", "fall", r"'fall' ends without a suffix; try 'fall.html'"),
        ("save_video", "fall.avi", r"a video needs a file name that ends in .mp4 or .gif"),
        (
            "save_gltf",
            "fall.gltf",
            r"ends in .glb, but 'fall.gltf' ends in '.gltf'; try 'fall.glb'",
        ),
        ("save_usd", "fall.usdz", r"ends in .usdc or .usda or .usd, but"),
    ],
)
def test_a_name_that_says_something_else_is_refused(
    tmp_path: Path, method: str, name: str, message: str
):
    recording = Recording(0.005, (body(),), ContactTrack.empty(2))
    with pytest.raises(SettingsError, match=message):
        getattr(recording, method)(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_what_is_printed_has_no_arrays():
    poses = np.tile(np.eye(4), (3, 1, 1))
    body = BodyTrack("flag", np.eye(3), [[0, 1, 2]], None, poses, 1)
    contacts = ContactTrack.from_frames(
        [([], [], []), ([[0, 0, 0]], [[0, 0, 1]], [0.0025]), ([], [], [])]
    )
    recording = Recording(0.005, (body,), contacts)
    assert repr(recording) == "Recording(1 body, 3 frames, 0.01 s, 1 contact)"
    assert repr(body) == "BodyTrack('flag', 3 vertices, 1 face, 3 frames, from frame 1 on, fixed)"
    assert repr(contacts) == "ContactTrack(3 frames, 1 contact, at most 2.5 mm deep)"
    assert repr(contacts.frame(0)) == "ContactTrack(1 frame, 0 contacts)"


@pytest.mark.parametrize(("method", "name"), [("save_html", "a.html"), ("save_video", "a.gif")])
def test_a_wrong_option_is_an_error_of_the_method_that_was_called(
    tmp_path: Path, method: str, name: str
):
    recording = Recording(0.005, (body(),), ContactTrack.empty(2))
    with pytest.raises(InputTypeError) as error:
        getattr(recording, method)(tmp_path / name, tilte="a")
    said = str(error.value)
    assert said.startswith(
        f"Recording.{method}() has no argument 'tilte': did you mean title? Call it as Recording.{method}(path, *, "
    )
    assert "lanes" not in said
    assert list(tmp_path.iterdir()) == []
