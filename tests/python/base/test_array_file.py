"""Files of arrays: what is written is read, and everything else is an error of the kind's type."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import voxshell as vx
from voxshell.base.array_file import FileKind

KIND = FileKind("tally", 2, vx.RecordingError)


def keep(header: dict[str, Any], arrays: Any) -> Any:
    return header, dict(arrays)


def test_what_is_written_is_read(tmp_path: Path):
    path = tmp_path / "a.npz"
    counts = np.arange(6, dtype=np.float64).reshape(2, 3)
    KIND.write(path, {"names": ["x", "ÿ"]}, {"counts": counts, "none": np.zeros((0, 4))})
    header, arrays = KIND.read(path, keep)
    assert header == {"format": "voxshell tally", "version": 2, "names": ["x", "ÿ"]}
    np.testing.assert_array_equal(arrays["counts"], counts)
    assert arrays["none"].shape == (0, 4)
    KIND.write(
        tmp_path / "b.npz", {"names": ["x", "ÿ"]}, {"counts": counts, "none": arrays["none"]}
    )
    assert (tmp_path / "b.npz").read_bytes() == path.read_bytes()


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (FileKind("recording", 2, vx.RecordingError), "it is not a tally of voxshell"),
        (FileKind("tally", 3, vx.RecordingError), "it has version 3; this package reads version 2"),
    ],
)
def test_other_kinds_and_versions_are_refused(tmp_path: Path, other: FileKind, message: str):
    other.write(tmp_path / "a.npz", {}, {})
    with pytest.raises(vx.RecordingError, match=f"cannot read the tally .*a.npz: {message}"):
        KIND.read(tmp_path / "a.npz", keep)


def test_what_is_missing_is_named(tmp_path: Path):
    KIND.write(tmp_path / "a.npz", {}, {})
    with pytest.raises(vx.RecordingError, match="it has no 'counts'"):
        KIND.read(tmp_path / "a.npz", lambda header, arrays: arrays["counts"])


def test_members_that_are_not_arrays_are_refused(tmp_path: Path):
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("header", b"{}")
    with pytest.raises(vx.RecordingError, match="its 'header' is not an array"):
        KIND.read(tmp_path / "a.npz", keep)


def test_files_that_are_not_archives_are_refused(tmp_path: Path):
    (tmp_path / "a.npz").write_bytes(b"solid part")
    with pytest.raises(vx.RecordingError, match=r"it is not a tally \(\.npz\)"):
        KIND.read(tmp_path / "a.npz", keep)
