from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from voxshell_studies import bunny, convex_parts
from voxshell_studies.bunny import BunnyFallSettings
from voxshell_studies.hull_tables import read_hulls
from voxshell_studies.part import compute_part
from voxshell_studies.report.bunny import BUNNY
from voxshell_studies.scenes.bunny import ORIENTATIONS_WXYZ
from voxshell_studies.scenes.drop import METHODS, decompose


@pytest.fixture(scope="module")
def settings(tmp_path_factory):
    """A cone in the bunny's place: its decomposition and GImpact take a second, not a minute."""
    path = tmp_path_factory.mktemp("mesh") / "cone.stl"
    trimesh.creation.cone(radius=30, height=50).export(path)
    return replace(
        BunnyFallSettings(),
        mesh=str(path),
        size=0.1,
        height=0.1,
        voxel_size=0.005,
        fine_points=1_000,
        coarse_points=200,
        steps=620,
        slow_steps=600,
        orientations=1,
        equal_poses=5,
        repeats=2,
        decomposers=("hacd",),
    )


@pytest.fixture(scope="module")
def results(settings):
    return {part.name: compute_part(part).tables for part in bunny.plan(settings)}


def test_every_method_fell_and_met_the_equal_poses(settings, results):
    tables = results["orientation-0"]
    steps = tables["steps"]
    methods = bunny.methods_of(tables)
    assert {method.key for method in methods} == {
        *(method.key for method in METHODS),
        *bunny.find_decomposers(settings),
    }
    for method in methods:
        mine = steps["method"] == method.key
        assert mine.sum() == (settings.slow_steps if method.is_slow else settings.steps)
        assert steps["contacts"][mine].max() > 0
        again = tables["equal_poses"]["method"] == method.key
        assert again.sum() == settings.equal_poses * settings.repeats
        assert (tables["equal_poses"]["narrow_phase"][again] > 0.0).all()


def test_ratios_are_those_of_the_data(settings, results):
    tables = results["orientation-0"]
    steps = {name: values.copy() for name, values in tables["steps"].items()}
    seconds = {
        "gimpact": 0.02,
        "hull": 1e-6,
        "decomposition": 2e-5,
        "hacd": 1.6e-5,
        "vps-fine": 1e-5,
        "vps-coarse": 4e-6,
    }
    for key, value in seconds.items():
        steps["narrow_phase"][steps["method"] == key] = value
    rows = {
        row.quantity: row
        for row in BUNNY.reduce(settings, {"orientation-0": {**tables, "steps": steps}})
    }
    if bunny.find_decomposers(settings):
        hacd = rows["decomposition by HACD / VPS coarse, own falls"]
        assert hacd.here == pytest.approx(4.0)
        assert hacd.holds
    assert rows["GImpact / VPS fine, own falls"].here == pytest.approx(2000.0)
    assert rows["GImpact / VPS fine, own falls"].holds
    hull = rows["VPS fine / GJK on the hull, own falls"]
    assert hull.here == pytest.approx(10.0)
    assert hull.reproduced
    assert hull.holds is False
    assert rows["decomposition / VPS coarse, own falls"].here == pytest.approx(5.0)
    assert rows["leads of VPS over peers that are lost"].reproduced
    steps["narrow_phase"][steps["method"] == "gimpact"] = 1e-9
    rows = {
        row.quantity: row
        for row in BUNNY.reduce(settings, {"orientation-0": {**tables, "steps": steps}})
    }
    assert rows["leads of VPS over peers that are lost"].reproduced is False


def test_setup_is_held_to_the_published_one(settings, results):
    tables = results["orientation-0"]
    published = {
        **tables,
        "body": {
            "side": np.array([0.2115, 0.2096, 0.1639]),
            "moment": np.array([4.79e-3, 4.46e-3, 6.38e-3]),
        },
        "shells": {
            "method": np.array(["vps-fine", "vps-coarse"]),
            "points": np.array([35_500, 850]),
        },
    }
    like = replace(settings, voxel_size=0.002)
    rows = {
        row.quantity: row
        for row in BUNNY.reduce(like, {"orientation-0": published})
        if row.quantity.startswith("set-up")
    }
    grid = rows["set-up: voxels of a full grid, 100 of them on each side of the bunny"]
    assert grid.here == 306 * 305 * 282
    assert {quantity for quantity, row in rows.items() if not row.reproduced} == {
        "set-up: points of VPS coarse"
    }


def test_stages_of_the_narrow_phase_are_told_apart(settings, results):
    rows = {row.quantity: row.here for row in BUNNY.reduce(settings, results)}
    whole = rows["narrow phase in full operation, median, VPS fine"]
    stages = [
        rows[f"{stage} in full operation, median, VPS fine"]
        for stage in ("query", "reduction", "manifold")
    ]
    assert 0.0 < max(stages) < whole
    assert 64 < rows["picture of the segments: those of level 5, fine shell"] <= 256
    assert rows["video of the drop: frames of the offline replay with contacts, VPS fine"] > 400


def test_decompositions_that_did_not_fall_say_why(settings, results):
    wanted = replace(settings, decomposers=("hacd", "coacd"))
    quantity = "decomposition by CoACD / VPS coarse, own falls"
    for asked, why in ((wanted, "pip install coacd"), (settings, "the full run has it")):
        (row,) = (row for row in BUNNY.reduce(asked, results) if row.quantity == quantity)
        assert np.isnan(row.here)
        assert row.holds is None
        assert why in row.note


def test_split_parts_are_addressed_by_their_library(settings, monkeypatch):
    wanted = replace(settings, decomposers=("coacd",))

    def plan_with(version):
        monkeypatch.setattr(convex_parts.Recipe, "version", version)
        return {part.name: part.address for part in bunny.plan(wanted)}

    without, old, new = (plan_with(version) for version in (None, "1.0", "2.0"))
    assert "split-coacd" not in without
    assert len({plan["orientation-0"] for plan in (without, old, new)}) == 3
    assert old["split-coacd"] != new["split-coacd"]


def test_vhacd_splits_beforehand_as_the_drops_own(settings, results):
    """The timed part finds in the cache what an untimed one on another core has made."""
    mesh = bunny.read_scaled(bunny.find_mesh(settings), settings.size)
    expected = decompose(mesh).hulls
    found = read_hulls(results["orientation-0"]["hulls"], "decomposition")
    assert results["split-vhacd"]["hulls"]["points"].tolist() == [len(h) for h in expected]
    assert len(found) == len(expected)
    for hull, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(hull, other)


def test_pictures_animation_and_replay_are_made(settings, results, tmp_path):
    from PIL import Image

    pictures = BUNNY.draw(settings, results, tmp_path)
    assert all((tmp_path / picture.path).is_file() for picture in pictures)
    with Image.open(tmp_path / "animation.gif") as animation:
        assert animation.n_frames > 50
        first = np.asarray(animation.convert("RGB"), dtype=int)
        animation.seek(40)
        later = np.asarray(animation.convert("RGB"), dtype=int)
    assert (np.abs(first - later).max(axis=2) > 60).sum() > 500  # the bodies fell
    with Image.open(tmp_path / "segments.png") as segments:
        pixels = np.asarray(segments.convert("RGB").quantize(64).convert("RGB"))
    colors = np.unique(pixels.reshape(-1, 3), axis=0)
    assert len(colors) > 20


def test_published_quaternions_are_unit():
    lengths = np.linalg.norm(ORIENTATIONS_WXYZ, axis=1)
    np.testing.assert_allclose(lengths, 1.0, atol=2e-4)
    # The first one puts the mesh's y upwards.
    np.testing.assert_allclose(bunny.orientation_of(0)[:3, 1], [0, 0, 1], atol=1e-6)
