from __future__ import annotations

import math
import re
import warnings

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


def test_its_text_has_lengths_in_millimeters():
    accuracy = vx.Model.from_mesh(trimesh.creation.box(), resolution=10).accuracy
    assert repr(accuracy).startswith("Accuracy(median/99 %/max at 100,000 places: distance ")
    assert repr(accuracy).endswith("sharp)")


def test_what_print_shows_says_which_number_is_which():
    box = vx.Model.from_mesh(trimesh.creation.box(), resolution=10).accuracy
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), resolution=10).accuracy
    for accuracy in (box, ball):
        lines = str(accuracy).splitlines()
        assert [line.split()[0].rstrip(":,") for line in lines] == [
            "Errors", "distance", "normal", "coverage", "gap",
        ]  # fmt: skip
        for line, unit in zip(lines[1:4], ("mm", "degrees", "mm"), strict=True):
            assert "median " in line
            assert f" {unit}" in line.split("largest ")[1]
    assert "at edges, where normals jump" in str(box)
    assert "at edges" not in str(ball)


def test_model_files_keep_it(tmp_path):
    model = vx.Model.from_mesh(trimesh.creation.box((1.0, 0.5, 0.1)), resolution=20)
    model.save(tmp_path / "box.vxs")
    again = vx.Model.load(tmp_path / "box.vxs")
    assert (again.accuracy, again.thickness) == (model.accuracy, model.thickness)
    assert again.thickness == pytest.approx(0.1)


def ball_with_a_hole(radius: float = 0.03, subdivisions: int = 4) -> trimesh.Trimesh:
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    nearest = np.argsort(np.linalg.norm(mesh.triangles_center - mesh.triangles_center[7], axis=1))
    mesh.update_faces(np.isin(np.arange(len(mesh.faces)), nearest[65:]))
    return mesh


def build_and_hear(
    mesh: trimesh.Trimesh, tolerance: float | None = None
) -> tuple[vx.Model, list[str]]:
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        model = vx.Model.from_mesh(mesh, tolerance=tolerance, cache=False)
    return model, [str(one.message) for one in heard if one.category is vx.AccuracyWarning]


def test_a_warning_of_the_largest_error_alone_does_not_name_the_others():
    model, said = build_and_hear(ball_with_a_hole(0.05), 1e-4)
    accuracy = model.accuracy
    reached = max(accuracy.distance.p99, accuracy.coverage.p99)
    assert reached <= model.tolerance < accuracy.distance.max / 4, "the case has changed"
    (text,) = said
    assert f"the largest error is {1e3 * accuracy.distance.max:.3g} mm, and at most 4 tol" in text
    assert "99 %" not in text


def test_a_warning_of_most_of_the_surface_names_its_errors():
    model, said = build_and_hear(ball_with_a_hole(), 5e-6)
    (text,) = said
    assert (
        f"on 99 % of its surface the field's error is at most {1e3 * model.accuracy.distance.p99:.3g} mm"
        in text
    )


@pytest.mark.parametrize("tolerance", [None, 1e-5])
@pytest.mark.parametrize("radius", [0.03, 0.05])
def test_the_advised_tolerance_is_larger_and_ends_the_warning(tolerance, radius):
    mesh = ball_with_a_hole(radius)
    model, said = build_and_hear(mesh, tolerance)
    assert len(said) == 1
    found = re.search(r"pass a larger tolerance, such as tolerance=(\S+), or voxel_size=", said[0])
    assert found is not None, said
    assert float(found[1]) > model.tolerance
    assert build_and_hear(mesh, float(found[1]))[1] == []


def test_the_advised_voxel_size_ends_the_warning():
    _, said = build_and_hear(ball_with_a_hole())
    found = re.search(r"voxel_size=(\S+) for a uniform model$", said[0])
    assert found is not None, said
    with warnings.catch_warnings():
        warnings.simplefilter("error", vx.AccuracyWarning)
        vx.Model.from_mesh(ball_with_a_hole(), voxel_size=float(found[1]), sign="winding")
