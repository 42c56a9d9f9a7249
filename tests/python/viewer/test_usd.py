"""Recordings as Universal Scene Description, read back by its own library.

That library is not among the packages that ``./dev`` installs. Tests that need it are skipped without it; install it
with ``pip install usd-core``.
"""

from __future__ import annotations

import importlib
import resource
from pathlib import Path
from unittest.mock import MagicMock

import numpy as np
import pytest
import voxshell as vx
from recorded_fall import FRAMES, TIME_STEP, come_later, turn_and_fall


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usd"])
def test_usd_reads_what_was_recorded(tmp_path: Path, suffix: str):
    pytest.importorskip("pxr", reason="needs usd-core")
    usd, geometry = (importlib.import_module(f"pxr.{name}") for name in ("Usd", "UsdGeom"))
    recording = turn_and_fall()
    stage = usd.Stage.Open(str(recording.save_usd(tmp_path / f"fall{suffix}")))
    assert geometry.GetStageUpAxis(stage) == "Z"
    assert geometry.GetStageMetersPerUnit(stage) == 1.0
    assert stage.GetTimeCodesPerSecond() == pytest.approx(1.0 / TIME_STEP)
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0.0, FRAMES - 1.0)
    meshes = [prim for prim in stage.Traverse() if prim.IsA(geometry.Mesh)]
    assert len(meshes) == 3
    for prim, body in zip(meshes, recording.bodies, strict=True):
        mesh = geometry.Mesh(prim)
        assert np.array(mesh.GetPointsAttr().Get()) == pytest.approx(body.vertices, abs=1e-6)
        assert len(mesh.GetFaceVertexCountsAttr().Get()) == len(body.faces)
        for frame in (0, 20, FRAMES - 1):
            # USD's matrices are for rows of points.
            matrix = np.array(mesh.ComputeLocalToWorldTransform(frame)).T
            assert matrix == pytest.approx(body.poses[frame], abs=1e-6)
    assert (suffix == ".usda") == (tmp_path / f"fall{suffix}").read_bytes().startswith(b"#usda")


def test_usd_reads_contacts_and_forces_of_each_frame(tmp_path: Path):
    pytest.importorskip("pxr", reason="needs usd-core")
    usd, geometry = (importlib.import_module(f"pxr.{name}") for name in ("Usd", "UsdGeom"))
    recording = turn_and_fall()
    path = tmp_path / "fall.usdc"
    stage = usd.Stage.Open(str(recording.save_usd(path)))
    balls = geometry.Points(stage.GetPrimAtPath("/recording/contacts"))
    lines = geometry.BasisCurves(stage.GetPrimAtPath("/recording/forces"))
    for frame in (0, 20, FRAMES - 1):
        point = recording.contacts.frame(frame).points
        assert np.array(balls.GetPointsAttr().Get(frame)) == pytest.approx(point, abs=1e-6)
        start, tip = np.array(lines.GetPointsAttr().Get(frame))
        assert start == pytest.approx(point[0], abs=1e-6)
        assert tip[2] - start[2] == pytest.approx(0.1039 * (1 + frame / (FRAMES - 1)), rel=0.01)
    first, last = (balls.GetDisplayColorAttr().Get(frame)[0] for frame in (0, FRAMES - 1))
    assert sum(last) < sum(first), "deeper contacts are darker"
    bare = usd.Stage.Open(str(recording.save_usd(tmp_path / "bare.usdc", contacts=False)))
    assert not bare.GetPrimAtPath("/recording/contacts")


def test_usd_knows_two_axes(tmp_path: Path):
    with pytest.raises(vx.SettingsError, match=r"up must be '\+z' or '\+y' in USD, not '\+x'"):
        turn_and_fall().save_usd(tmp_path / "fall.usda", up="+x")


def test_without_usd_core_an_error_says_what_to_install(tmp_path: Path, monkeypatch):
    find = importlib.import_module

    def fail(asked: str):
        if asked == "pxr.Gf":
            raise ImportError(f"No module named {asked!r}")
        return find("json") if asked.startswith("pxr") else find(asked)

    monkeypatch.setattr("voxshell.viewer.usd.import_module", fail)
    with pytest.raises(vx.MissingExtraError, match=r"pip install 'voxshell\[usd\]'"):
        turn_and_fall().save_usd(tmp_path / "fall.usda")
    assert list(tmp_path.iterdir()) == []


def test_a_body_that_comes_later_is_invisible_before(tmp_path: Path):
    pytest.importorskip("pxr", reason="needs usd-core")
    usd, geometry = (importlib.import_module(f"pxr.{name}") for name in ("Usd", "UsdGeom"))
    stage = usd.Stage.Open(str(come_later(20).save_usd(tmp_path / "late.usdc")))
    ball, ground = (prim for prim in stage.Traverse() if prim.IsA(geometry.Mesh))
    for frame, wanted in ((0, "invisible"), (19, "invisible"), (20, "inherited")):
        assert geometry.Imageable(ball).ComputeVisibility(frame) == wanted
        assert geometry.Imageable(ground).ComputeVisibility(frame) == "inherited"


def test_what_usd_collects_becomes_one_error(tmp_path: Path, monkeypatch):
    usd = MagicMock()
    usd.Tf.ErrorException = type("ErrorException", (RuntimeError,), {})
    once = "Error in 'Write' at line 78 in file asset.cpp : 'Error occurred writing file: No space left'"
    usd.Usd.Stage.CreateInMemory().Export.side_effect = usd.Tf.ErrorException(once, once)
    monkeypatch.setattr("voxshell.viewer.usd._import_usd", lambda: usd)
    old = tmp_path / "fall.usdc"
    old.write_bytes(b"old")
    with pytest.raises(
        vx.FileAccessError, match=r"^cannot write .*fall\.usdc: .* writing file: No space left$"
    ):
        turn_and_fall().save_usd(old)
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [
        ("fall.usdc", b"old")
    ]


@pytest.mark.parametrize("suffix", [".usda", ".usdc"])
def test_usd_has_no_room_for_a_file(tmp_path: Path, suffix: str):
    pytest.importorskip("pxr", reason="needs usd-core")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))
    try:
        with pytest.raises(
            vx.FileAccessError, match=rf"^cannot write .*fall\{suffix}: .*too large$"
        ):
            turn_and_fall().save_usd(tmp_path / f"fall{suffix}")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert list(tmp_path.iterdir()) == []
