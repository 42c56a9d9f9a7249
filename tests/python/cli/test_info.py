from __future__ import annotations

import re
import warnings
from dataclasses import asdict

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.cli import advice
from voxshell.model.meshes import read_mesh


def test_model_file_is_told_about(voxshell, cone_model_path):
    model = vx.Model.load(cone_model_path)
    told = voxshell("info", cone_model_path, "--json").json
    assert told["kind"] == "model"
    assert told["points"] == len(model.shell)
    assert told["field_bytes"] == model.field.nbytes
    np.testing.assert_allclose(told["center_of_mass"], model.mass_properties().center_of_mass)
    ended = voxshell("info", cone_model_path)
    assert f"{len(model.shell):,} points" in ended.out
    assert max(map(len, ended.out.splitlines())) <= 80


def test_mesh_is_measured(voxshell, cone_path):
    cone = trimesh.load_mesh(cone_path)
    told = voxshell("info", cone_path, "--json").json
    assert told["kind"] == "mesh"
    assert told["closed"] is True
    assert told["volume"] == pytest.approx(cone.volume, rel=1e-6)
    assert told["area"] == pytest.approx(cone.area, rel=1e-6)
    ended = voxshell("info", cone_path)
    assert "--scale 0.001" in ended.out  # 60 m would be a large cone
    assert "--scale" not in voxshell("info", cone_path, "--scale", "0.001").out


THIN_PARTS = {
    "box": trimesh.creation.box((0.06, 0.04, 0.002)),
    "foil": trimesh.creation.box((0.06, 0.04, 0.0001)),
    "hall": trimesh.creation.box((30.0, 10.0, 8.0)),
    "bench": trimesh.creation.box((3.0, 1.0, 1.0)),
    "sheet": trimesh.creation.cylinder(0.01, 0.03)
    .slice_plane((0, 0, 0), (0, 0, 1))
    .slice_plane((0, 0, 0.01), (0, 0, -1)),
}


@pytest.mark.parametrize("part", THIN_PARTS)
def test_the_thinnest_wall_and_the_default_tolerance_are_those_of_a_build(voxshell, tmp_path, part):
    path = tmp_path / "part.ply"
    THIN_PARTS[part].export(path)
    told = voxshell("info", path, "--json").json
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = vx.Model.from_mesh(path, cache=False)
    assert told["thickness"] == pytest.approx(model.thickness, rel=1e-6)
    assert told["default_tolerance"] == pytest.approx(model.tolerance, rel=1e-6)
    text = voxshell("info", path).out
    assert re.search(r"^thinnest wall +\d", text, re.M)
    assert re.search(r"^default tolerance +\d", text, re.M)


def test_open_mesh_is_told_to_be_open(voxshell, tmp_path):
    box = trimesh.creation.box()
    trimesh.Trimesh(box.vertices, box.faces[:-1]).export(tmp_path / "open.ply")
    told = voxshell("info", tmp_path / "open.ply", "--json").json
    assert told["closed"] is False
    assert "3 open" in told["warnings"][0]


WORDS = ("field error", "shell coverage", "normal error", "proven bounds")

# Within these factors of what is measured when the models are really built.
FACTORS = {
    "field_bytes": 1.6,
    "points": 1.1,
    "error": 2.0,
    "build_seconds": 4.0,
    "contacts_seconds": 4.0,
    "collide_seconds": 4.0,
}


def count(answer):
    """The contacts in an answer, or one for a plain yes or no."""
    return 1 if isinstance(answer, bool) else len(answer)


@pytest.mark.parametrize(
    "mesh",
    [
        trimesh.creation.torus(0.1, 0.03, major_sections=64, minor_sections=32),
        trimesh.creation.cone(radius=0.03, height=0.05, sections=64),
    ],
    ids=["torus", "cone"],
)
def test_estimates_are_near_what_is_built(mesh, monkeypatch):
    """With a clock that shows the work done, as other programs may delay a real one."""
    build = advice._build

    def build_by_work(*args):
        model, _ = build(*args)
        return model, 1e-9 * model.field.nbytes + 1e-7 * len(model.shell)

    monkeypatch.setattr(advice, "_build", build_by_work)
    monkeypatch.setattr(advice, "_time", lambda ask, poses: 1e-9 * sum(map(count, map(ask, poses))))
    arrays = read_mesh(mesh)
    guessed = advice.estimate(arrays, lambda *_: None, (200,), (25, 50, 100))
    built = advice.measure(arrays, lambda *_: None, (100, 200))
    [guess], real = guessed, built[-1]
    assert not guess.measured
    assert real.measured
    assert guess.size == pytest.approx(real.size)
    for name, factor in FACTORS.items():
        # Distances of a flat face are exact but for rounding.
        least = 1e-6 * float(np.ptp(arrays.vertices)) if name == "error" else 0.0
        one, other = (max(asdict(each)[name], least) for each in (guess, real))
        assert 1.0 / factor <= one / other <= factor, (name, one, other)


@pytest.mark.parametrize("name", ["bunny", "box"])
def test_estimates_of_accuracy_are_what_a_build_measures(name, bunny_mesh):
    mesh = bunny_mesh if name == "bunny" else trimesh.creation.box((1.0, 0.7, 0.4))
    mesh = mesh.copy()
    mesh.apply_transform(trimesh.transformations.rotation_matrix(0.4, (1, 2, 3)))
    arrays = read_mesh(mesh)
    known, guess = advice.estimate(arrays, lambda *_: None, (50, 100), (25, 50))
    assert (known.measured, guess.measured) == (True, False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        coarse, fine = (vx.Model.from_mesh(arrays, resolution=n, cache=False) for n in (50, 100))
    assert known.error == coarse.accuracy.distance.p99
    assert known.coverage == coarse.accuracy.coverage.p99
    assert known.field_bound == coarse.field.interpolation_error
    assert 1.0 / 1.5 <= guess.error / fine.accuracy.distance.p99 <= 1.5
    assert 1.0 / 1.5 <= guess.coverage / fine.accuracy.coverage.p99 <= 1.5
    assert guess.field_bound == pytest.approx(fine.field.interpolation_error, rel=0.01)


def test_build_and_info_tell_the_tolerance(voxshell, cone_path, tmp_path):
    for options, told, value in (
        (("--tolerance", "0.0002"), "200 µm", 0.0002),
        (("--resolution", "30"), "none: the model is uniform", None),
    ):
        file = tmp_path / "cone.vxs"
        built = voxshell("build", cone_path, "-o", file, "--scale", "0.001", *options)
        for said in (built.out, voxshell("info", file).out):
            assert re.search(rf"^tolerance +{told} *$", said, re.M)
        assert voxshell("info", file, "--json").json["tolerance"] == pytest.approx(value)


def test_one_wording_of_accuracy_in_build_and_info(voxshell, cone_path, tmp_path):
    file = tmp_path / "cone.vxs"
    arguments = ("build", cone_path, "-o", file, "--scale", "0.001", "--resolution", "30")
    built, told = voxshell(*arguments), voxshell("info", file)
    lines = [line for line in built.out.splitlines() if line.startswith(WORDS)]
    assert len(lines) == len(WORDS)
    assert [line for line in told.out.splitlines() if line.startswith(WORDS)] == lines
    from_build = voxshell(*arguments, "--json").json["accuracy"]
    assert voxshell("info", file, "--json").json["accuracy"] == from_build
    model = vx.Model.load(file)
    assert from_build["measured"]["distance"]["p99"] == model.accuracy.distance.p99
    assert from_build["proved"]["field"] == model.field.interpolation_error


def test_advice_is_the_finest_that_is_cheap_enough():
    def make(resolution, **costs):
        cheap = dict.fromkeys(("field_bytes", "points", "error", "coverage"), 1.0)
        cheap |= dict.fromkeys(("field_bound", "shell_bound"), 1.0)
        cheap |= dict.fromkeys(("build_seconds", "contacts_seconds", "collide_seconds"), 1e-6)
        return advice.Estimate(resolution, 1.0 / resolution, False, **(cheap | costs))

    dear = {"build_seconds": 31.0}, {"field_bytes": 1.1e8}, {"contacts_seconds": 2.1e-4}
    for costs in dear:
        assert advice.recommend([make(50), make(100), make(200, **costs)]).resolution == 100
    assert advice.recommend([make(50, **dear[0]), make(100, **dear[0])]).resolution == 50


def test_advice_is_printed_and_can_be_followed(voxshell, cone_path, tmp_path, monkeypatch):
    monkeypatch.setattr(advice, "MEASURED", (10, 20))
    monkeypatch.setattr(advice.estimate, "__defaults__", ((20, 40), (10, 20)))
    ended = voxshell("info", cone_path, "--scale", "0.001", "--advise")
    assert ended.code == 0, ended.err
    commands = [line for line in ended.out.splitlines() if line.startswith("  voxshell build")]
    assert max(len(line) for line in ended.out.splitlines() if line not in commands) <= 80
    monkeypatch.chdir(tmp_path)
    default, larger, uniform = (command.split()[1:] for command in commands)
    assert "--tolerance" in larger
    assert ended.out.index("default tolerance, 30.0 µm") < ended.out.index(" ".join(uniform))
    for command, expected in ((default, 3e-5), (larger, 6e-5)):
        assert voxshell(*command).code == 0
        tolerance = vx.Model.load(tmp_path / "cone.vxs").tolerance
        assert tolerance == pytest.approx(expected, rel=0.01)
    assert voxshell(*uniform).code == 0
    told = voxshell("info", cone_path, "--scale", "0.001", "--advise", "--json").json["advice"]
    assert [each["measured"] for each in told["estimates"]] == [True, False]
    size = vx.Model.load(tmp_path / "cone.vxs").field.voxel_size
    assert told["recommended"] == {"tolerance": pytest.approx(3e-5)}
    assert told["recommended_uniform"]["voxel_size"] == pytest.approx(size, rel=1e-3)


def test_a_long_mesh_is_doubted_in_json_too(voxshell, tmp_path):
    path = tmp_path / "part.stl"
    trimesh.creation.box((80, 60, 20)).export(path)
    assert "80 m long" in voxshell("info", path, "--json").json["hint"]
    assert "hint" not in voxshell("info", path, "--json", "--scale", 1).json
