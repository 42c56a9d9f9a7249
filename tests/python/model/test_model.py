from __future__ import annotations

import gc
import re

import numpy as np
import pytest
import trimesh
import voxshell as vx


def box(**options: object) -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.box(), **{"resolution": 20, **options})


# ---- building ------------------------------------------------------------------------------------


def test_the_bunny_has_the_points_asked_for(fine_bunny: vx.Model, coarse_bunny: vx.Model):
    assert abs(len(fine_bunny.shell) - 35_596) <= 0.01 * 35_596
    assert abs(len(coarse_bunny.shell) - 799) <= 0.01 * 799
    assert fine_bunny.field.voxel_size == coarse_bunny.field.voxel_size == 0.002
    np.testing.assert_allclose(np.ptp(fine_bunny.bounds, axis=0).max(), 0.2115)


@pytest.mark.parametrize("target", [50, 275, 799, 3_000])
@pytest.mark.parametrize("shape", ["ball", "box", "torus"])
def test_regular_meshes_have_the_points_asked_for(shape: str, target: int):
    # Along their own axes the numbers of their surface voxels leave gaps of more than 1 %.
    mesh = {
        "ball": trimesh.creation.icosphere,
        "box": trimesh.creation.box,
        "torus": lambda: trimesh.creation.torus(1.0, 0.4),
    }[shape]()
    model = vx.Model.from_mesh(mesh, resolution=10, target_points=target)
    assert abs(len(model.shell) - target) <= 0.01 * target
    nearest = trimesh.proximity.closest_point_naive(mesh, model.shell.points[::20])[1]
    assert nearest.max() < 1e-6


def test_settings_reach_the_core():
    assert box(resolution=40).field.voxel_size == pytest.approx(1 / 40)
    assert box(resolution=None, voxel_size=0.1).field.voxel_size == 0.1
    assert box().shell.spacing == box().field.voxel_size
    assert box(point_spacing=0.2).shell.spacing == 0.2
    assert box().tolerance is None
    default = vx.Model.from_mesh(trimesh.creation.box())
    assert default.tolerance == pytest.approx(0.0002)
    assert len(default.shell.edges) > 12
    assert vx.Model.from_mesh(trimesh.creation.box(), tolerance=0.01).tolerance == 0.01
    with pytest.raises(vx.SettingsError, match="either a tolerance or the sizes"):
        vx.Model.from_mesh(trimesh.creation.box(), tolerance=0.01, resolution=10)
    wide = box(padding=1.0).field
    np.testing.assert_allclose(wide.origin, -1.5)
    assert box(padding=0).field.origin == pytest.approx([-0.9] * 3)  # at least a brick


def test_scale_comes_before_all_other_settings():
    model = vx.Model.from_mesh(trimesh.creation.box(), scale=0.001, voxel_size=0.0001)
    np.testing.assert_allclose(model.bounds, [[-0.0005] * 3, [0.0005] * 3])
    assert model.field.voxel_size == 0.0001


def test_the_number_of_threads_does_not_change_the_result():
    mesh = trimesh.creation.torus(1.0, 0.4)
    one, many = (vx.Model.from_mesh(mesh, resolution=30, threads=n) for n in (1, 7))
    points = np.random.default_rng(0).uniform(-1.6, 1.6, (10_000, 3))
    assert one.field.sample(points).tobytes() == many.field.sample(points).tobytes()
    assert one.shell.points.tobytes() == many.shell.points.tobytes()


# ---- what it holds -------------------------------------------------------------------------------


def test_the_mesh_is_that_given_without_repetitions():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    soup = vertices[faces.ravel()], np.arange(12).reshape(4, 3)  # as in an STL file
    for mesh in ((vertices, faces), soup):
        model = vx.Model.from_mesh(mesh, resolution=10)
        got = model.mesh
        assert (got.vertices.dtype, got.faces.dtype) == (np.float64, np.uint32)
        assert got.vertices.shape == (4, 3)
        np.testing.assert_array_equal(got.vertices[got.faces], vertices[faces])
        np.testing.assert_array_equal(model.bounds, [[0, 0, 0], [1, 1, 1]])
    again = vx.Model.from_mesh(model.mesh, resolution=10)
    np.testing.assert_array_equal(again.shell.points, model.shell.points)


def test_mesh_arrays_are_read_only_and_outlive_the_model():
    model = box()
    vertices, faces = model.mesh
    copies = vertices.copy(), faces.copy()
    for array in (vertices, faces):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0
    del model
    gc.collect()
    np.testing.assert_array_equal(vertices, copies[0])
    np.testing.assert_array_equal(faces, copies[1])


def test_the_input_is_copied():
    vertices, faces = np.array(trimesh.creation.box().vertices), trimesh.creation.box().faces
    model = vx.Model.from_mesh((vertices, faces), resolution=10)
    vertices[:] = np.nan
    assert np.isfinite(model.mesh.vertices).all()


def test_a_model_cannot_be_changed_or_made_by_hand():
    model = box()
    for name in ("mesh", "field", "shell", "bounds", "name"):
        with pytest.raises(AttributeError):
            setattr(model, name, None)
    with pytest.raises(vx.InputTypeError, match="from_mesh"):
        vx.Model(trimesh.creation.box())  # pyright: ignore[reportArgumentType]


def test_it_says_what_it_holds(coarse_bunny: vx.Model):
    assert re.fullmatch(
        rf"Model\(69666 triangles, {len(coarse_bunny.shell)} points, field 145 x 145 x 121, "
        r"voxel size 0\.002 m, \d\.\d MB\)",
        repr(coarse_bunny),
    )


def test_it_says_its_tolerance_and_a_mesh_only_how_large_it_is():
    model = vx.Model.from_mesh(trimesh.creation.box(), tolerance=0.002)
    assert ", tolerance 0.002 m, field " in repr(model)
    assert ">2 mm<" in model._repr_html_()
    assert ">none: uniform, with the voxel size of the field<" in box()._repr_html_()
    assert repr(model.mesh) == "Mesh(8 vertices, 12 faces)"


# ---- mass properties -----------------------------------------------------------------------------


def test_mass_properties_of_a_box_are_the_textbook_ones():
    sides = np.array([0.1, 0.2, 0.4])
    mesh = trimesh.creation.box(extents=sides)
    mesh.apply_translation((1.0, 2.0, 3.0))
    model = vx.Model.from_mesh(mesh, resolution=20)
    solid = model.mass_properties(mass=3.0)
    assert solid.mass == 3.0
    np.testing.assert_allclose(solid.center_of_mass, (1.0, 2.0, 3.0), atol=1e-9)
    expected = 3.0 / 12.0 * np.diag((sides**2).sum() - sides**2)
    np.testing.assert_allclose(solid.inertia, expected, atol=1e-12)
    surface = model.mass_properties(mass=3.0, kind="surface")
    assert np.all(np.diag(surface.inertia) > np.diag(expected))


def test_the_bunny_s_surface_has_the_inertia_of_the_thesis(fine_bunny: vx.Model):
    surface = fine_bunny.mass_properties(kind="surface")
    np.testing.assert_allclose(np.diag(surface.inertia), (4.76e-3, 4.44e-3, 6.39e-3), rtol=2e-3)


def test_mass_properties_agree_with_trimesh(bunny_mesh: trimesh.Trimesh, coarse_bunny: vx.Model):
    solid = coarse_bunny.mass_properties()
    expected = bunny_mesh.mass_properties
    np.testing.assert_allclose(solid.center_of_mass, expected.center_mass, atol=1e-9)
    np.testing.assert_allclose(
        solid.inertia, expected.inertia / expected.mass, rtol=1e-6, atol=1e-12
    )


@pytest.mark.parametrize("mass", [0, -1, np.nan, np.inf, "1", None])
def test_a_wrong_mass_is_refused(cube: vx.Model, mass):
    with pytest.raises(vx.SettingsError, match="mass"):
        cube.mass_properties(mass)


@pytest.mark.parametrize("kind", ["hollow", None, 1])
def test_a_wrong_kind_of_mass_is_refused(cube: vx.Model, kind):
    with pytest.raises(vx.SettingsError, match="'solid' or 'surface'"):
        cube.mass_properties(kind=kind)


# ---- wrong settings ------------------------------------------------------------------------------

NOT_LENGTHS = [0, -0.1, np.nan, np.inf, -np.inf, 1e300, "0.1", [0.1], 1j, len, True, np.True_]
NOT_COUNTS = [0, -1, 1.5, 10.0, 2**31, 10**40, np.nan, "10", [10], True, np.True_]


@pytest.mark.parametrize("name", ["voxel_size", "point_spacing"])
@pytest.mark.parametrize("value", NOT_LENGTHS)
def test_a_wrong_length_is_refused_by_name(name: str, value):
    with pytest.raises(vx.SettingsError, match=name):
        vx.Model.from_mesh(trimesh.creation.box(), **{name: value})


@pytest.mark.parametrize("name", ["resolution", "target_points", "threads"])
@pytest.mark.parametrize("value", NOT_COUNTS)
def test_a_wrong_count_is_refused_by_name(name: str, value):
    with pytest.raises(vx.SettingsError, match=name):
        vx.Model.from_mesh(trimesh.creation.box(), **{name: value})


@pytest.mark.parametrize("padding", [-1e-9, -1, np.nan, np.inf, 1e300, "1", [1], True])
def test_a_wrong_padding_is_refused(padding):
    with pytest.raises(vx.SettingsError, match="padding"):
        box(padding=padding)


@pytest.mark.parametrize("scale", [0, -1, np.nan, np.inf, "1", [], True])
def test_a_wrong_scale_is_refused(scale):
    with pytest.raises(vx.SettingsError, match="scale"):
        box(scale=scale)


@pytest.mark.parametrize("name", ["voxel_size", "point_spacing"])
def test_a_length_above_the_mesh_is_refused_as_one_in_another_unit(name: str):
    """A voxel size of 100 for a sphere of 0.2 m built a model of four points."""
    sphere = trimesh.creation.icosphere(radius=0.1)
    words = name.replace("_", " ")
    with pytest.raises(
        vx.MeshError, match=f"longest side of 0.2 m, below the {words} of 100 m: check their units"
    ):
        vx.Model.from_mesh(sphere, **{name: 100})
    # As long as a needle is, where it is thinner.
    needle = trimesh.creation.box(extents=(0.2, 0.001, 0.001))
    assert len(vx.Model.from_mesh(needle, **{name: 0.2}).shell) > 0


def test_contradicting_settings_are_refused():
    with pytest.raises(vx.SettingsError, match="either voxel_size or resolution"):
        box(voxel_size=0.1)
    with pytest.raises(vx.SettingsError, match="either point_spacing or target_points"):
        box(point_spacing=0.1, target_points=100)


def test_a_wrong_progress_is_refused():
    with pytest.raises(vx.InputTypeError, match="callable"):
        box(progress=1)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"voxel_size": 1e-4}, r"use a voxel size of at least .* \(a resolution of at most"),
        ({"resolution": 5_000}, r"use a voxel size of at least .* \(a resolution of at most"),
        ({"resolution": 20, "padding": 1e9}, r"use a padding of at most 1 m$"),
        ({"resolution": 20, "point_spacing": 1e-9}, "use a point spacing of at least"),
        ({"resolution": 20, "target_points": 2**31 - 1}, "limit of 67108864; ask for no more"),
    ],
    ids=str,
)
def test_what_would_not_fit_memory_is_refused_at_once(settings: dict, message: str):
    with pytest.raises(vx.MemoryLimitError, match=message):
        vx.Model.from_mesh(trimesh.creation.box(), **settings)


@pytest.mark.parametrize("settings", [{"voxel_size": 1e-6}, {"resolution": 2**31 - 1}], ids=str)
def test_voxels_too_fine_for_single_precision_are_refused(settings: dict):
    with pytest.raises(vx.MeshError, match="single precision"):
        vx.Model.from_mesh(trimesh.creation.box(), **settings)


@pytest.mark.parametrize("scale", [1e-200, 1e-40, 1e20, 1e200])
def test_sizes_out_of_this_world_are_refused(scale: float):
    with pytest.raises(vx.MeshError):
        box(scale=scale)
