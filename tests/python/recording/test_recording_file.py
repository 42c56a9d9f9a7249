from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
import voxshell as vx
from voxshell.recording import BodyTrack, ContactTrack, Recording


def make_recording(seed: int = 1) -> Recording:
    """Two bodies that turn, one of which has a color and comes later, and contacts in some frames."""
    random = np.random.default_rng(seed)
    frames = 7
    poses = [np.stack([vx.pose(p, euler=p) for p in random.normal(size=(frames, 3))]) for _ in "ab"]
    bodies = (
        BodyTrack("a flag ünder\ud800", np.eye(3), [[0, 1, 2]], None, poses[0]),
        BodyTrack(
            "pole", random.normal(size=(4, 3)), [[0, 1, 2], [1, 2, 3]], (1, 2, 255), poses[1], 3
        ),
    )
    normals = random.normal(size=(5, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    contacts = ContactTrack(
        [0, 0, 2, 2, 5, 5, 5, 5],
        random.normal(size=(5, 3)),
        normals,
        random.normal(size=5),
        random.normal(size=(5, 3)),
    )
    return Recording(1.0 / 3.0, bodies, contacts)


def test_a_loaded_recording_is_the_saved_one_in_every_bit(tmp_path: Path):
    recording = make_recording()
    path = tmp_path / "fall.npz"
    assert recording.save(str(path)) == path
    again = Recording.load(path)
    assert again.time_step == recording.time_step
    for a, b in zip(recording.bodies, again.bodies, strict=True):
        assert (a.name, a.color, a.start) == (b.name, b.color, b.start)
        for name in ("vertices", "faces", "poses"):
            assert getattr(a, name).tobytes() == getattr(b, name).tobytes()
    for name in ("offsets", "points", "normals", "depths", "forces"):
        assert (
            getattr(recording.contacts, name).tobytes() == getattr(again.contacts, name).tobytes()
        )
    again.save(tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == path.read_bytes()


def test_a_recording_without_contacts_is_kept(tmp_path: Path):
    bodies = make_recording().bodies
    Recording(0.1, bodies, ContactTrack.empty(7)).save(tmp_path / "a.npz")
    assert Recording.load(tmp_path / "a.npz").contacts.counts.tolist() == [0] * 7


def test_names_that_are_not_unicode_are_shown_with_question_marks(tmp_path: Path):
    recording = make_recording()
    assert "\ud800" in recording.bodies[0].name
    recording.save_html(tmp_path / "a.html", title="\udcff")
    assert "<title>?</title>" in (tmp_path / "a.html").read_text(encoding="utf-8")
    recording.save_gltf(tmp_path / "a.glb")
    assert "a flag ünder?".encode() in (tmp_path / "a.glb").read_bytes()


@pytest.mark.parametrize("name", ["fall", "fall.html", "fall.npy"])
def test_another_suffix_is_refused(tmp_path: Path, name: str):
    with pytest.raises(vx.SettingsError, match=r"ends in \.npz, but"):
        make_recording().save(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_places_that_cannot_be_used_have_typed_errors(tmp_path: Path):
    recording = make_recording()
    with pytest.raises(vx.MissingFileError, match=r"the folder .* does not exist; create it first"):
        recording.save(tmp_path / "no" / "fall.npz")
    with pytest.raises(vx.MissingFileError, match="it does not exist"):
        Recording.load(tmp_path / "fall.npz")
    with pytest.raises(vx.SettingsError, match="it is a folder"):
        Recording.load(tmp_path)
    with pytest.raises(vx.InputTypeError):
        Recording.load(3)  # pyright: ignore[reportArgumentType]


def test_every_damage_is_a_recording_error(tmp_path: Path):
    path, damaged = tmp_path / "fall.npz", tmp_path / "damaged.npz"
    make_recording().save(path)
    whole = path.read_bytes()
    random = np.random.default_rng(2)
    refused = 0
    for trial in range(400):
        content = bytearray(whole)
        if trial % 4 == 0:
            content = content[: random.integers(len(whole))]
        else:
            content[random.integers(len(whole))] ^= 1 << random.integers(8)
        damaged.write_bytes(content)
        try:
            Recording.load(damaged)
        except (vx.RecordingError, vx.MemoryLimitError):
            refused += 1
    assert refused > 250  # bits of names and times in the archive's list do not matter


@pytest.mark.parametrize(
    ("header", "message"),
    [
        (None, "it has no 'header'"),
        (b"[]", "it is not a recording of voxshell"),
        (b'{"format": "voxshell recording", "version": 2}', "it has version 2; this package reads"),
        (b'{"format": "voxshell recording", "version": 1}', "it has no 'bodies'"),
        (b"\xff", "damaged.npz: "),
        (b'{"format": "voxshell recording", "version": 1, "bodies": [3], "time_step": 1}', "npz: "),
        (b"[" * 100_000, "npz: "),
    ],
)
def test_other_archives_are_refused(tmp_path: Path, header: bytes | None, message: str):
    path = tmp_path / "damaged.npz"
    arrays = {} if header is None else {"header": np.frombuffer(header, dtype=np.uint8)}
    np.savez(path, other=np.zeros(3), **arrays)
    with pytest.raises(vx.RecordingError, match=message):
        Recording.load(path)


@pytest.mark.parametrize("content", [b"", b"solid part", b"PK\3\4 cut"])
def test_files_of_other_kinds_are_called_so_and_damaged_ones_are_not(
    tmp_path: Path, content: bytes
):
    path = tmp_path / "other.npz"
    path.write_bytes(content)
    with pytest.raises(vx.RecordingError) as refusal:
        Recording.load(path)
    is_damaged = content.startswith(b"PK")
    assert str(refusal.value).endswith("it is not a recording (.npz)") == (not is_damaged)


def test_pickles_are_not_read(tmp_path: Path):
    np.savez(tmp_path / "a.npz", header=np.array([{}], dtype=object), allow_pickle=True)
    with pytest.raises(vx.RecordingError, match="allow_pickle"):
        Recording.load(tmp_path / "a.npz")


def test_an_archive_that_grows_beyond_the_limit_is_refused_before_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("voxshell.base.array_file._MOST_BYTES", 1_000_000)
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("header.npy", bytes(2_000_000))
    with pytest.raises(
        vx.MemoryLimitError, match=r"0\.002 GB of arrays; at most 0\.001 GB are read"
    ):
        Recording.load(tmp_path / "a.npz")
