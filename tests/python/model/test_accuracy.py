from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
import voxshell as vx


def test_it_is_a_statistic_of_a_hundred_thousand_places():
    model = vx.Model.from_mesh(trimesh.creation.torus(0.1, 0.03), resolution=40)
    accuracy = model.accuracy
    assert isinstance(accuracy, vx.Accuracy)
    assert accuracy.places >= 100_000
    for errors in (accuracy.distance, accuracy.normal, accuracy.coverage):
        assert isinstance(errors, vx.ErrorStatistic)
        assert 0.0 <= errors.median <= errors.p99 <= errors.max
    assert accuracy.gap <= math.sqrt(3.0) * model.shell.spacing
    assert accuracy == model.accuracy


def test_its_distance_is_what_sampling_the_field_gives():
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=0.1)
    model = vx.Model.from_mesh(mesh, resolution=30)
    places = trimesh.sample.sample_surface(mesh, 20_000, seed=1)[0]
    errors = np.abs(model.field.sample(places))
    assert model.accuracy.distance.p99 == pytest.approx(np.percentile(errors, 99), rel=0.4)


def test_sharp_is_what_has_a_convex_edge():
    assert vx.Model.from_mesh(trimesh.creation.box(), resolution=10).accuracy.is_sharp
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(subdivisions=4), resolution=10)
    assert not ball.accuracy.is_sharp
    assert ball.accuracy.curvature == pytest.approx(1.0, rel=0.25)


def test_its_text_has_lengths_in_millimetres():
    accuracy = vx.Model.from_mesh(trimesh.creation.box(), resolution=10).accuracy
    assert repr(accuracy).startswith("Accuracy(median/99 %/max at 100,000 places: distance ")
    assert repr(accuracy).endswith("sharp)")


def test_model_files_keep_it(tmp_path):
    model = vx.Model.from_mesh(trimesh.creation.box((1.0, 0.5, 0.1)), resolution=20)
    model.save(tmp_path / "box.vxs")
    again = vx.Model.load(tmp_path / "box.vxs")
    assert (again.accuracy, again.thickness) == (model.accuracy, model.thickness)
    assert again.thickness == pytest.approx(0.1)
