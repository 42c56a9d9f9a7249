from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from voxshell.measuring.units import format_time
from voxshell.model.model import Model
from voxshell_studies.drop import REST_STEPS, run_drop, summarize
from voxshell_studies.report.drop import draw_curves, write_results
from voxshell_studies.scenes.bunny import find_bunny
from voxshell_studies.scenes.drop import METHODS, DropSettings, build_shapes

SETTINGS = DropSettings()
MODELS = tuple(method for method in METHODS if method.is_model)


@pytest.fixture(scope="module")
def shapes():
    return build_shapes(find_bunny(), SETTINGS, MODELS)


@pytest.fixture(scope="module")
def runs(shapes):
    return [run_drop(shapes, method, SETTINGS, 700) for method in MODELS]


def test_points_are_as_many_as_published(shapes):
    assert len(shapes.bodies["vps-fine"].shell) == pytest.approx(35_596, rel=0.01)
    assert len(shapes.bodies["vps-coarse"].shell) == pytest.approx(799, rel=0.01)


def test_grid_is_the_published_one_in_whole_bricks(shapes):
    field = Model.from_mesh(
        shapes.bodies["vps-coarse"].mesh,
        voxel_size=SETTINGS.voxel_size,
        padding=100 * SETTINGS.voxel_size,
        cache=False,
    ).field
    cells = np.array([306, 305, 282])
    np.testing.assert_array_equal(field.shape, 8 * np.ceil(cells / 8) + 1)


def test_surface_inertia_is_as_published(shapes):
    np.testing.assert_allclose(
        np.diag(shapes.mass_properties.inertia), (4.79e-3, 4.46e-3, 6.38e-3), rtol=0.01
    )


def test_bunny_comes_to_rest_with_every_variant(runs):
    for run in runs:
        assert run.speed[-REST_STEPS:].max() < 0.01, run.method.label
        assert run.depth[-REST_STEPS:].max() < SETTINGS.voxel_size, run.method.label
        # The whole mesh, not only the points that collide.
        assert abs(run.lowest[-REST_STEPS:]).max() < SETTINGS.voxel_size, run.method.label
        assert run.contacts[-1] >= 3, run.method.label


def test_fall_is_free_until_the_ground(runs):
    steps = np.arange(1, 61)
    dt = 1.0 / SETTINGS.rate
    expected = SETTINGS.height - 9.81 * dt * dt * steps * (steps + 1) / 2.0
    for run in runs:
        np.testing.assert_allclose(run.lowest[:60], expected, atol=1e-6)
        assert run.contacts[:60].max() == 0


def test_same_motion_on_every_run(shapes, runs):
    again = run_drop(shapes, MODELS[0], SETTINGS, 200)
    np.testing.assert_array_equal(again.lowest, runs[0].lowest[:200])
    np.testing.assert_array_equal(again.depth, runs[0].depth[:200])


def test_summary_is_of_the_steps_it_names(runs):
    summaries = summarize(runs)
    fine = summaries[0]
    assert fine.ratio == 1.0
    assert fine.median == np.median(runs[0].narrow_phase[250:600])
    assert fine.deepest == runs[0].depth.max()
    assert summarize(runs[1:])[0].ratio != summarize(runs[1:])[0].ratio  # no fine run: NaN


def test_results_are_complete_json(tmp_path, shapes, runs):
    path = tmp_path / "results.json"
    short = [replace(run, narrow_phase=run.narrow_phase[:10]) for run in runs]
    write_results(path, "bunny", SETTINGS, shapes, short, summarize(short))
    results = json.loads(path.read_text(), parse_constant=pytest.fail)
    assert results["settings"]["fine_points"] == 35_596
    assert results["environment"]["cpu"]
    assert results["environment"]["bullet"].startswith("3.")
    assert "commit" in results["environment"]
    assert results["mesh"]["triangles"] == len(shapes.mesh.faces)
    row = results["methods"][0]
    assert row["key"] == "vps-fine"
    assert f"{len(shapes.bodies['vps-fine'].shell)} points" in row["shape"]
    assert "voxel size 0.002 m" in row["ground_shape"]
    assert row["world_arguments"] == {}
    assert row["median"] is None  # ten steps have none in full operation
    assert len(row["curves"]["speed"]) == 700
    assert sorted(path.name for path in tmp_path.iterdir()) == ["results.json"]


def test_curves_are_a_picture_with_a_line_a_method(tmp_path, runs):
    path = tmp_path / "curves.png"
    draw_curves(path, "bunny", runs)
    from matplotlib.image import imread

    pixels = imread(path)[..., :3]
    assert pixels.shape[0] > 600
    for color in ((0x0B, 0x6E, 0x4F), (0x43, 0xAA, 0x8B), (0x90, 0xBE, 0x6D)):
        near = np.abs(pixels * 255 - color).max(axis=2) < 12
        assert near.sum() > 200


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.00123, "1.23 ms"),
        (1.5e-6, "1.50 \N{MICRO SIGN}s"),
        (0.25, "250 ms"),
        (np.nan, "-"),
        (9.996e-3, "10.0 ms"),
    ],
)
def test_times_are_short_to_read(seconds, text):
    assert format_time(seconds) == text
