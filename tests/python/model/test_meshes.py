from __future__ import annotations

import os
import signal
import struct
import subprocess
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
import voxshell as vx
from hypothesis import given, settings
from hypothesis import strategies as st
from voxshell.model.meshes import read_mesh

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def build(mesh) -> vx.Model:
    return vx.Model.from_mesh(mesh, resolution=10)


# ---- what is taken -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "mesh",
    [
        (VERTICES, FACES),
        (VERTICES.tolist(), FACES.tolist()),
        [VERTICES.astype(np.float32), FACES.astype(np.uint8)],
        (np.asfortranarray(VERTICES), FACES.astype(float)),
        (VERTICES.astype(int), FACES.astype(np.int16)[:, ::1]),
        trimesh.Trimesh(VERTICES, FACES),
        SimpleNamespace(vertices=VERTICES, faces=FACES),
    ],
    ids=["arrays", "lists", "list", "float faces", "int vertices", "trimesh", "alike"],
)
def test_kinds_of_meshes(mesh):
    model = build(mesh)
    np.testing.assert_array_equal(model.mesh.vertices[model.mesh.faces], VERTICES[FACES])


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "off", "glb"])
def test_kinds_of_files(tmp_path: Path, suffix: str):
    path = tmp_path / f"corner piece.{suffix}"
    trimesh.Trimesh(VERTICES, FACES).export(path)
    for name in (path, str(path)):
        model = build(name)
        assert len(model.mesh.faces) == 4
        np.testing.assert_allclose(model.bounds, [[0, 0, 0], [1, 1, 1]])


def test_the_bodies_of_a_scene_become_one_mesh(tmp_path: Path):
    scene = trimesh.Scene()
    for i in range(2):
        pose = trimesh.transformations.translation_matrix((3.0 * i, 0, 0))
        scene.add_geometry(trimesh.creation.box(), transform=pose)
    scene.export(tmp_path / "scene.glb")
    model = build(tmp_path / "scene.glb")
    assert len(model.mesh.faces) == 24
    np.testing.assert_allclose(model.bounds, [[-0.5] * 3, [3.5, 0.5, 0.5]])


# ---- what is refused -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (None, "not NoneType"),
        (42, "not int"),
        (VERTICES, "not ndarray"),
        ((VERTICES,), "not tuple"),
        ((VERTICES, FACES, FACES), "not tuple"),
        (trimesh.Scene(), r"not Scene; pass scene.to_mesh\(\)"),
        (b"bunny.obj", "not bytes"),
    ],
)
def test_what_is_not_a_mesh_is_refused(mesh, message: str):
    with pytest.raises(vx.InputTypeError, match=message):
        build(mesh)


@pytest.mark.parametrize(
    ("vertices", "message"),
    [
        (
            VERTICES[:, :2],
            r"vertices must be \(n, 3\) numbers, not an array of shape \(4, 2\) and type float64",
        ),
        (VERTICES.ravel(), r"of shape \(12,\)"),
        (VERTICES[None], r"of shape \(1, 4, 3\)"),
        (VERTICES.astype(complex), "complex128"),
        (VERTICES.astype(str), "<U"),
        (VERTICES.astype(object), "object"),
        (VERTICES > 0, "bool"),
        (None, "vertices must be .* not None$"),
        (0.5, "vertices must be .* not 0.5$"),
        ([[0, 0, 0], [1]], "inhomogeneous"),
        (np.where(VERTICES == 1, np.nan, VERTICES), "3 of 4 vertices .*finite .*vertex 1.; remove"),
        (np.where(VERTICES == 1, np.inf, VERTICES), "3 of 4 vertices .*finite .*vertex 1.; remove"),
        (np.zeros((4, 3)), "no triangle with an area above zero, of 4; export it again"),
        (np.empty((0, 3)), "for 0 vertices"),
    ],
)
def test_wrong_vertices_are_refused(vertices, message: str):
    with pytest.raises(vx.MeshError, match=message):
        build((vertices, FACES))


@pytest.mark.parametrize(
    ("faces", "message"),
    [
        (FACES[:, :2], r"faces must be \(m, 3\) integers, not an array of shape \(4, 2\)"),
        (
            np.hstack([FACES, FACES[:, :1]]),
            r"shape \(4, 4\) and type int64; split quadrilaterals into triangles",
        ),
        (FACES.ravel(), r"of shape \(12,\)"),
        (None, "not None$"),
        ([[0, 1, 2], [3]], "inhomogeneous"),
        (FACES.astype(str), "<U"),
        (FACES.astype(complex), "complex"),
        (FACES > 0, "bool"),
        (FACES + 0.5, "fractions or NaN"),
        (np.where(FACES == 3, np.nan, FACES), "fractions or NaN"),
        (np.where(FACES == 3, np.inf, FACES), "3 of 12 face indices .* 4 vertices .*inf in face 1"),
        (FACES - 1, "3 of 12 face indices are out of range for 4 vertices .first: -1 in face 0"),
        (FACES + 1, "3 of 12 face indices .* 4 in face 1, both counted from 0.; remove those"),
        (np.where(FACES == 3, 2**32 + 3, FACES), "4294967299 in face 1"),
        (np.where(FACES == 3, 2**64 - 1, FACES.astype(np.uint64)), "18446744073709551615"),
        (np.where(FACES == 3, 1e300, FACES), "1e[+]300"),
        (np.empty((0, 3), int), "no triangles"),
        ([[0, 0, 0], [1, 1, 2]], "no triangle with an area"),
    ],
)
def test_wrong_faces_are_refused(faces, message: str):
    with pytest.raises(vx.MeshError, match=message):
        build((VERTICES, faces))


@pytest.mark.parametrize(
    ("faces", "message"),
    [
        (FACES[1:], "not watertight: 3 open.*; repair it, or find its inside automatically"),
        (FACES[:, ::-1], "inside out"),
        (np.vstack([FACES[:3], FACES[3:, ::-1]]), "wrongly oriented"),
    ],
    ids=["open", "inside out", "mixed"],
)
def test_a_faulty_surface_is_refused_where_it_must_be_closed(faces: np.ndarray, message: str):
    with pytest.raises(vx.MeshError, match=message):
        vx.Model.from_mesh((VERTICES, faces), resolution=10, sign="closed")


@pytest.mark.parametrize(
    ("faces", "message"),
    [
        (
            FACES[1:],
            r"surface: 3 open edges, the first near .* pass sign='winding' to silence this warning$",
        ),
        (FACES[:, ::-1], "inside out"),
    ],
    ids=["open", "inside out"],
)
def test_a_faulty_surface_is_taken_with_a_warning(faces: np.ndarray, message: str):
    with pytest.warns(vx.MeshWarning, match=message):
        model = vx.Model.from_mesh((VERTICES, faces), resolution=10, open="solid", cache=False)
    assert (model.field.sample(np.mean(VERTICES, axis=0)[None, :]) < 0).all()
    assert (model.field.sample([[3.0, 3.0, 3.0]]) > 0).all()


def test_parts_that_overlap_are_said_to_become_their_union():
    boxes = [trimesh.creation.box().apply_translation((x, x, x)) for x in (0.0, 0.3)]
    for sizes in ({"resolution": 20}, {"resolution": 40}, {}):
        with pytest.warns(vx.MeshWarning) as caught:
            vx.Model.from_mesh(trimesh.util.concatenate(boxes), cache=False, **sizes)
        text = str(caught[0].message)
        assert (
            "surface: overlapping parts (12 triangles wholly or partly inside others), the" in text
        )
        assert (
            "; the model is the union of its parts; repair the mesh, or pass sign='winding' to silence"
            in text
        )
    with warnings.catch_warnings():
        warnings.simplefilter("error", vx.MeshWarning)
        vx.Model.from_mesh(trimesh.util.concatenate(boxes), sign="winding", cache=False)


@pytest.mark.parametrize("sign", ["open", "", None, 1])
def test_a_wrong_sign_is_refused(sign):
    with pytest.raises(vx.SettingsError, match="sign must be"):
        vx.Model.from_mesh((VERTICES, FACES), sign=sign)


@pytest.mark.parametrize("thickness", [0.0, 6.7e-116, 1e-9])
@pytest.mark.filterwarnings("ignore::voxshell.MeshWarning")
def test_a_mesh_that_folds_flat_is_no_wire(thickness):
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, thickness]]
    faces = [[0, 2, 1], [0, 0, 3], [1, 2, 3], [0, 3, 2]]
    with pytest.raises(vx.MeshError, match="encloses no volume"):
        vx.Model.from_mesh((vertices, faces), resolution=3, cache=False)


TETRAHEDRON = trimesh.Trimesh(VERTICES, FACES)
COORDINATES = st.one_of(
    st.floats(-2.0, 2.0),
    st.sampled_from([0.0, -0.0, 1.0, 0.5, 1e-30, 1e30, 1e300, np.nan, np.inf, -np.inf]),
)


@st.composite
def damaged_meshes(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    """Closed meshes with some coordinates and corners replaced."""
    whole = draw(
        st.sampled_from([TETRAHEDRON, trimesh.creation.box(), trimesh.creation.icosphere(1)])
    )
    vertices, faces = np.array(whole.vertices), np.array(whole.faces)
    for _ in range(draw(st.integers(0, 3))):
        vertices[draw(st.integers(0, len(vertices) - 1)), draw(st.integers(0, 2))] = draw(
            COORDINATES
        )
    for _ in range(draw(st.integers(0, 3))):
        corner = draw(st.integers(-1, len(vertices)))
        faces[draw(st.integers(0, len(faces) - 1)), draw(st.integers(0, 2))] = corner
    return vertices, faces


@given(
    mesh=damaged_meshes(),
    resolution=st.integers(2, 12),
    target_points=st.one_of(st.none(), st.integers(1, 300)),
    scale=st.sampled_from([1.0, 1.0, 1e-6, 1e6]),
)
@settings(max_examples=300, deadline=None)
@pytest.mark.filterwarnings("ignore::voxshell.MeshWarning")
def test_any_damage_is_an_error_or_a_sound_model(mesh, resolution, target_points, scale):
    try:
        model = vx.Model.from_mesh(
            mesh, resolution=resolution, target_points=target_points, scale=scale, threads=1
        )
    except vx.VoxshellError:
        return
    shell = model.shell
    assert len(shell) > 0
    assert np.isfinite(shell.points).all()
    low, high = model.bounds
    points = np.random.default_rng(0).uniform(2 * low - high, 2 * high - low, (1000, 3))
    assert np.isfinite(model.field.sample(points)).all()
    area = trimesh.Trimesh(*model.mesh, process=False).area
    sampled = shell.areas.astype(float).sum()
    # What lies inside other parts of the mesh has no points.
    assert 0.0 < sampled <= area * (1.0 + 1e-4)
    if model.field.sign_method == "closed":
        assert sampled == pytest.approx(area, rel=1e-4)
    assert model.mass_properties().mass == 1.0
    found = vx.contacts(model, model, margin=1e-3 * scale)
    assert (
        found.ids.tolist()
        == vx.testing.contacts_flat(model, model, margin=1e-3 * scale).ids.tolist()
    )


def write(path: Path, content: bytes | str) -> Path:
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


BAD_FILES = {
    # 4,294,967,295 triangles are announced, one is there.
    "boast.stl": b"\0" * 80 + struct.pack("<I", 0xFFFFFFFF) + b"\0" * 50,
    "none.stl": b"\0" * 80 + struct.pack("<I", 0),
    "empty.stl": "",
    "empty.obj": "",
    "empty.ply": "",
    "points.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\n",
    "beyond.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
    "words.obj": "v a b c\nf 1 2 3\n",
    "words.off": "OFF\nfour\n",
    "cut.ply": "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n",
    "cut.glb": b"glTF\x02\0\0\0\xff\xff\xff\xff",
    "noise.stl": bytes(range(256)) * 4,
    "noise.ply": bytes(range(256)) * 4,
    "noise.glb": bytes(range(256)) * 4,
    "flat.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n",
    "huge.obj": "v 1e999 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n",
    "mesh.xyz123": "1 2 3\n",
    "mesh": "1 2 3\n",
}


@pytest.mark.filterwarnings("ignore")  # trimesh's own, on its way to failing
@pytest.mark.parametrize("name", BAD_FILES)
def test_bad_files_are_refused_by_name(tmp_path: Path, name: str):
    path = write(tmp_path / name, BAD_FILES[name])
    with pytest.raises(vx.MeshError) as caught:
        build(path)
    assert str(path) in str(caught.value)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "beyond.obj",
            "a face refers to vertex 8, counted from 0, but there are 3; .* export it again",
        ),
        ("words.off", "it is damaged or not in OFF format .*four.*; export it again"),
        ("mesh.xyz123", "suffix .* no supported format .*obj, off, ply, stl.*; convert it"),
        ("mesh", "suffix .* no supported format .*obj, off, ply, stl.*; convert it"),
        ("huge.obj", "1 of 3 vertices"),
        ("none.stl", "no triangles.*; export it again"),
    ],
)
def test_a_bad_file_is_refused_in_words_and_with_what_to_do(
    tmp_path: Path, name: str, message: str
):
    """They were those of trimesh: "IndexError: index 8 is out of bounds for axis 0"."""
    with pytest.raises(vx.MeshError, match=message) as caught:
        build(write(tmp_path / name, BAD_FILES[name]))
    assert "Error" not in str(caught.value)


@pytest.mark.parametrize("name", ["part.vxs", "PART.VXS"])
def test_a_model_is_no_mesh_and_is_sent_to_where_it_is_read(tmp_path: Path, name: str):
    build((VERTICES, FACES)).save(tmp_path / name)
    with pytest.raises(vx.MeshError, match=r"a model already: .*Model.load, or pass the mesh"):
        build(tmp_path / name)


@pytest.mark.parametrize(
    ("name", "error", "message"),
    [("missing.stl", vx.MissingFileError, "does not exist"), (".", vx.MeshError, "is a folder")],
)
def test_what_is_no_file_is_refused_by_name(
    tmp_path: Path, name: str, error: type[vx.VoxshellError], message: str
):
    path = tmp_path / name
    with pytest.raises(error, match=message) as caught:
        build(str(path))
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (PermissionError(13, "Permission denied"), "part.stl: Permission denied"),
        (ImportError("no module named collada"), "its reader is not installed: no module"),
    ],
)
def test_what_is_no_fault_of_the_file_is_not_called_damage(tmp_path, monkeypatch, error, words):
    path = tmp_path / "part.stl"
    trimesh.creation.box().export(path)

    def fail(*_, **__):
        raise error

    monkeypatch.setattr(trimesh, "load", fail)
    with pytest.raises(vx.MeshError, match=words) as raised:
        vx.Model.from_mesh(path, voxel_size=0.1)
    assert "damaged" not in str(raised.value)


def test_an_interrupt_is_not_taken_for_a_fault_of_the_file(tmp_path: Path, monkeypatch):
    path = tmp_path / "part.stl"
    trimesh.Trimesh(VERTICES, FACES).export(path)
    load, handler = trimesh.load, signal.getsignal(signal.SIGINT)

    def load_anyway(*args, **kwargs):
        try:
            signal.raise_signal(signal.SIGINT)
        except BaseException:
            return load(*args, **kwargs)
        pytest.fail("interrupts have to wait until the file is read")

    monkeypatch.setattr(trimesh, "load", load_anyway)
    with pytest.raises(KeyboardInterrupt):
        build(path)
    assert signal.getsignal(signal.SIGINT) is handler


def test_an_address_is_not_fetched():
    with pytest.raises(vx.MissingFileError, match="it is a URL; download it"):
        build("https://example.com/bunny.stl")


class OddPath:
    """What a path object says."""

    def __init__(self, said: object) -> None:
        self.said = said

    def __fspath__(self) -> object:
        return self.said


def test_path_objects_may_be_bytes_and_nothing_odd(tmp_path: Path):
    path = tmp_path / "box.stl"
    trimesh.creation.box().export(path)
    assert len(read_mesh(OddPath(os.fsencode(path))).faces) == 12
    with pytest.raises(vx.MissingFileError, match=r"missing\.stl"):
        read_mesh(OddPath(b"/dev/missing.stl"))
    with pytest.raises(vx.InputTypeError, match=r"mesh must be a path, but .* not int"):
        read_mesh(OddPath(5))


def test_normals_that_cannot_be_read_do_not_matter(tmp_path: Path):
    """trimesh printed its traceback. The program's own handlers still get what it says."""
    path = tmp_path / "box.stl"
    text = trimesh.exchange.stl.export_stl_ascii(trimesh.creation.box())
    path.write_text(text.replace("facet normal", "facet normal x", 1))
    program = (
        "import logging, sys\n"
        "from voxshell.model.meshes import read_mesh\n"
        f"print(len(read_mesh({str(path)!r}).faces), logging.getLogger('trimesh').handlers)\n"
        "logging.basicConfig(format='%(name)s: %(message)s', stream=sys.stdout)\n"
        f"read_mesh({str(path)!r})\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=60
    )
    assert ended.stderr == ""
    assert ended.stdout.startswith("12 []\ntrimesh.util: failed to extract face_normals\n")
