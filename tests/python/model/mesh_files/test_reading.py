"""Files that ask for far more than they hold: refused at once, by name, before a library reads them."""

from __future__ import annotations

import base64
import io
import json
import os
import subprocess
import sys
import time
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.model.mesh_files.reading import KINDS
from voxshell.model.meshes import read_mesh

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "<f4")
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], "<u4")
CORNERS = 20_000


def make_gltf(nodes: list[Any], roots: list[int] | None = None, **changes: Any) -> bytes:
    whole = VERTICES.tobytes() + FACES.tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(whole).decode()
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0] if roots is None else roots}],
        "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"uri": uri, "byteLength": len(whole)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 48},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 12, "type": "SCALAR"},
        ],
    }
    return json.dumps(tree | changes).encode()


MESH = (
    '<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>'
    '<vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles>'
    '<triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>'
    '<triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles></mesh>'
)


def make_3mf(objects: str, items: str, junk: int = 0) -> bytes:
    text = (
        '<?xml version="1.0"?><model unit="millimeter" '
        'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>'
        f'<object id="1" type="model">{MESH}</object>{objects}</resources>'
        f"<build>{items}</build></model>"
    )
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", text)
        with archive.open("Metadata/thumbnail.png", "w") as member:
            for _ in range(junk):
                member.write(bytes(1_000_000))
    return file.getvalue()


def make_component(number: int, times: int) -> str:
    inner = f'<component objectid="{number - 1}"/>' * times
    return f'<object id="{number}" type="model"><components>{inner}</components></object>'


def make_dae(nodes: str, faces: str = "", entity: str = "") -> bytes:
    places = " ".join(str(float(x)) for x in VERTICES.ravel())
    faces = faces or "<triangles count='4'>{input}<p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles>"
    faces = faces.replace("{input}", "<input semantic='VERTEX' source='#v' offset='0'/>")
    return f"""<?xml version="1.0"?>{entity}
        <COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
        <asset><unit meter="1"/></asset><library_geometries><geometry id="g"><mesh>
        <source id="s"><float_array id="a" count="12">{places}</float_array><technique_common>
        <accessor source="#a" count="4" stride="3"><param name="X" type="float"/>
        <param name="Y" type="float"/><param name="Z" type="float"/></accessor>
        </technique_common></source><vertices id="v"><input semantic="POSITION" source="#s"/>
        </vertices>{faces}</mesh></geometry></library_geometries>
        <library_nodes>{nodes}</library_nodes><library_visual_scenes><visual_scene id="scene">
        <node id="root"><instance_node url="#n0"/></node></visual_scene></library_visual_scenes>
        <scene><instance_visual_scene url="#scene"/></scene></COLLADA>""".encode()


def make_dae_nodes(levels: int, times: int) -> str:
    leaf = f"<node id='n{levels}'><instance_geometry url='#g'/></node>"
    inner = [f"<instance_node url='#n{i + 1}'/>" * times for i in range(levels)]
    return leaf + "".join(f"<node id='n{i}'>{inner[i]}</node>" for i in range(levels - 1, -1, -1))


def make_binary_ply(corners: int) -> bytes:
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {corners}\nproperty float x\n"
        "property float y\nproperty float z\nelement face 1\n"
        "property list int int vertex_indices\nend_header\n"
    )
    turns = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    ring = np.column_stack([np.cos(turns), np.sin(turns), 0 * turns]).astype("<f4")
    face = np.array([corners, *range(corners)], "<i4")
    return header.encode() + ring.tobytes() + face.tobytes()


def make_ring(form: str, corners: int = CORNERS) -> bytes:
    turns = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    ring = [f"{np.cos(turn):.6f} {np.sin(turn):.6f} 0" for turn in turns]
    first = 1 if form == "obj" else 0
    face = " ".join(map(str, range(first, corners + first)))
    if form == "obj":
        return "".join([*(f"v {each}\n" for each in ring), f"f {face}\n"]).encode()
    lines = "\n".join([*ring, f"{corners} {face}"]) + "\n"
    if form == "off":
        return f"OFF\n{corners} 1 0\n{lines}".encode()
    return (
        f"ply\nformat ascii 1.0\nelement vertex {corners}\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list int int vertex_indices\nend_header\n"
        f"{lines}"
    ).encode()


CHAIN = [{"children": [i + 1], "mesh": 0, "translation": [2, 0, 0]} for i in range(4999)]
SPARSE = {
    "componentType": 5126,
    "count": 4_000_000_000,
    "type": "VEC3",
    "sparse": {"count": 1, "indices": {"bufferView": 0, "componentType": 5125}, "values": {}},
}
ACCESSORS = json.loads(make_gltf([]))["accessors"]
VIEW = {"buffer": 0, "byteOffset": 0, "byteLength": 96}
LAUGHS = '<!DOCTYPE c [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'

HOSTILE: dict[str, tuple[str, Callable[[], bytes], str]] = {
    "face of many corners, OBJ": (
        "a.obj",
        lambda: make_ring("obj"),
        "20000 corners; at most 1000",
    ),
    "face over many lines": (
        "a.obj",
        lambda: make_ring("obj").replace(b" 1000 ", b" 1000 \\\n"),
        "20000 corners",
    ),
    "face of many corners, OFF": ("a.off", lambda: make_ring("off"), "20000 corners.*triangulate"),
    "face of many corners, PLY": ("a.ply", lambda: make_ring("ply"), "20000 corners.*triangulate"),
    "face of many corners, binary PLY": (
        "a.ply",
        lambda: make_binary_ply(CORNERS),
        "20000 corners.*triangulate",
    ),
    "face of many corners, COLLADA": (
        "a.dae",
        lambda: make_dae(
            make_dae_nodes(0, 0),
            "<polylist count='1'>{input}<vcount>20000</vcount>"
            f"<p>{'0 1 2 3 ' * (CORNERS // 4)}</p></polylist>",
        ),
        "20000 corners.*triangulate",
    ),
    "polygon of many corners, COLLADA": (
        "a.dae",
        lambda: make_dae(
            make_dae_nodes(0, 0),
            "<polygons count='1'>{input}" + f"<p>{'0 1 2 3 ' * (CORNERS // 4)}</p></polygons>",
        ),
        "20000 corners.*triangulate",
    ),
    "nodes in each other": (
        "a.gltf",
        lambda: make_gltf([*CHAIN, {"mesh": 0}]),
        "nested too deeply, .* levels; apply their transforms",
    ),
    "nodes in a circle": (
        "a.gltf",
        lambda: make_gltf([{"children": [1]}, {"children": [0], "mesh": 0}]),
        "contain themselves",
    ),
    "many nodes": (
        "a.gltf",
        lambda: make_gltf([{"mesh": 0}] * 50_000, [*range(50_000)]),
        "places more than 20000 parts.*merge",
    ),
    "an accessor without data": (
        "a.gltf",
        lambda: make_gltf([{"mesh": 0}], accessors=[*ACCESSORS, SPARSE]),
        "expands to 48 GB, more than 100 times as much",
    ),
    "views of the same bytes": (
        "a.gltf",
        lambda: make_gltf(
            [{"mesh": 0}],
            buffers=[{"byteLength": 96, "uri": "data:;base64," + "A" * 400_000}],
            bufferViews=[{"buffer": 0, "byteLength": 299_999}] * 3000,
        ),
        "expands to 900 MB",
    ),
    "JSON in JSON": ("a.gltf", lambda: b"[" * 100_000 + b"]" * 100_000, "it is damaged"),
    "objects in each other": (
        "a.3mf",
        lambda: make_3mf(
            "".join(make_component(i, 1) for i in range(2, 1000)), '<item objectid="999"/>'
        ),
        "nested too deeply",
    ),
    "objects ten times in each other": (
        "a.3mf",
        lambda: make_3mf(
            "".join(make_component(i, 10) for i in range(2, 30)), '<item objectid="29"/>'
        ),
        "places more than 3500 parts",
    ),
    "an archive of zeros": (
        "a.3mf",
        lambda: make_3mf("", '<item objectid="1"/>', junk=500),
        "expands to 500 MB, more than 100 times as much; it is damaged, or made",
    ),
    "nodes ten times in each other": (
        "a.dae",
        lambda: make_dae(make_dae_nodes(20, 10)),
        "places more than 12000 parts",
    ),
    "elements in each other": (
        "a.dae",
        lambda: make_dae("<node>" * 5000 + "</node>" * 5000),
        "nested more than 200 deep",
    ),
    "entities": ("a.dae", lambda: make_dae("", entity=LAUGHS), "declares XML entities"),
}


@pytest.mark.parametrize("what", HOSTILE)
def test_a_small_file_that_asks_for_much_is_refused_at_once(tmp_path: Path, what: str):
    """Some took minutes, or all memory."""
    name, make, message = HOSTILE[what]
    path = tmp_path / name
    path.write_bytes(make())
    assert path.stat().st_size < 2_000_000
    start = time.perf_counter()
    with pytest.raises(vx.MeshError, match=message) as caught:
        vx.Model.from_mesh(path, cache=False)
    assert time.perf_counter() - start < 2.0
    assert str(path) in str(caught.value)


def test_a_file_of_holes_is_refused_at_once(tmp_path: Path):
    path = tmp_path / "holes.stl"
    with path.open("wb") as file:
        file.truncate(3_000_000_000)
    with pytest.raises(vx.MeshError, match=r"expands to 3 GB, more than 100 times|3 GB"):
        read_mesh(path)


def test_a_file_that_is_too_large_is_refused_at_once(tmp_path: Path):
    path = tmp_path / "large.stl"
    with path.open("wb") as file:
        file.truncate(5_000_000_000)
    with pytest.raises(vx.MeshError, match="it has 5 GB; at most 4 GB are read; simplify"):
        read_mesh(path)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.obj", b"mtllib pipe\nusemtl a\n", None),
        ("a.ply", b"ply\nformat ascii 1.0\ncomment TextureFile pipe\n", None),
        (
            "a.gltf",
            make_gltf([{"mesh": 0}], buffers=[{"uri": "pipe", "byteLength": 96}]),
            "refers to 'pipe', .*a pipe or a device; copy",
        ),
        ("pipe.stl", None, "it is a pipe or a device; copy the mesh to a regular file"),
    ],
)
def test_a_pipe_keeps_no_reader_waiting(
    tmp_path: Path, name: str, content: bytes | None, message: str | None
):
    """An `mtllib` that named a pipe waited until something was written into it."""
    os.mkfifo(tmp_path / "pipe")
    if content is None:
        os.mkfifo(tmp_path / name)
    elif name.endswith(".gltf"):
        (tmp_path / name).write_bytes(content)
    else:
        trimesh.Trimesh(VERTICES, FACES).export(
            tmp_path / name, **({"encoding": "ascii"} if name.endswith("ply") else {})
        )
        whole = (tmp_path / name).read_bytes()
        (tmp_path / name).write_bytes(content + whole.removeprefix(b"ply\nformat ascii 1.0\n"))
    program = (
        "import sys, voxshell as vx\nfrom voxshell.model.meshes import read_mesh\n"
        "try: print(len(read_mesh(sys.argv[1]).faces))\nexcept vx.MeshError as error: print(error)"
    )
    command = [sys.executable, "-c", program, str(tmp_path / name)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=20)
    if message is None:
        assert run.stdout.strip() == "4"
    else:
        with pytest.raises(vx.MeshError, match=message):
            raise vx.MeshError(run.stdout)


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_of_file_is_read(tmp_path: Path, kind: str):
    path = tmp_path / f"part.{kind}"
    if kind == "dae":
        path.write_bytes(make_dae(make_dae_nodes(1, 3)))
        assert len(read_mesh(path).faces) == 12
        return
    if kind == "3mf":
        path.write_bytes(make_3mf(make_component(2, 3), '<item objectid="2"/>' * 2))
        assert len(read_mesh(path).faces) == 24
        return
    if kind == "gltf":
        path.write_bytes(make_gltf([{"children": [1, 2, 3]}, *[{"mesh": 0}] * 3]))
        assert len(read_mesh(path).faces) == 12
        return
    trimesh.Trimesh(VERTICES, FACES).export(path)
    mesh = read_mesh(path)
    assert mesh.vertices[mesh.faces].tolist() == VERTICES[FACES].tolist()


def test_a_gltf_file_reads_its_buffers_from_its_folder(tmp_path: Path):
    for name, content in trimesh.Trimesh(VERTICES, FACES).scene().export(file_type="gltf").items():
        (tmp_path / name).write_bytes(content)
    assert len(read_mesh(tmp_path / "model.gltf").faces) == 4


def test_many_materials_are_read_in_time_that_grows_as_their_number(tmp_path: Path):
    """Each became a mesh of its own, for which all vertices were gone through."""
    ball = trimesh.creation.icosphere(5)
    lines = [f"v {x} {y} {z}" for x, y, z in ball.vertices]
    for number, (a, b, c) in enumerate(ball.faces[::2] + 1):
        lines += [f"usemtl {number}", f"f {a} {b} {c}"]
    path = tmp_path / "painted.obj"
    path.write_text("\n".join(lines))
    start = time.perf_counter()
    assert len(read_mesh(path).faces) == len(ball.faces) // 2
    assert time.perf_counter() - start < 2.0


@pytest.mark.parametrize("header", [b"solid", b"SOLID part 1"])
def test_many_solids_are_read_in_time_that_grows_as_their_number(tmp_path: Path, header: bytes):
    """20,000 took 45 s."""
    path = tmp_path / "solids.stl"
    facet = (
        b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
        b"endfacet\n"
    )
    path.write_bytes((header + b"\n" + facet + b"end" + header + b"\n") * 20_000)
    start = time.perf_counter()
    assert len(read_mesh(path).faces) == 20_000
    assert time.perf_counter() - start < 2.0


def test_a_binary_file_that_begins_like_a_text_is_read(tmp_path: Path):
    path = tmp_path / "part.stl"
    whole = trimesh.Trimesh(VERTICES, FACES).export(file_type="stl")
    path.write_bytes(b"solid part".ljust(80) + whole[80:])
    assert len(read_mesh(path).faces) == 4


def test_memory_that_runs_out_is_a_typed_error(tmp_path: Path, monkeypatch):
    path = tmp_path / "part.stl"
    trimesh.creation.box().export(path)

    def fail(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr(trimesh, "load", fail)
    with pytest.raises(vx.MemoryLimitError, match=r"part.stl: out of memory"):
        read_mesh(path)


# ---- units -----------------------------------------------------------------------------------------


def state_unit(unit: str) -> bytes:
    """A 3MF file with another unit, or with none."""
    made = zipfile.ZipFile(io.BytesIO(make_3mf("", '<item objectid="1"/>')))
    text = made.read("3D/3dmodel.model").decode().replace('unit="millimeter" ', unit)
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("3D/3dmodel.model", text)
    return file.getvalue()


@pytest.mark.parametrize(
    ("name", "content", "meters"),
    [
        ("mm.3mf", state_unit('unit="millimeter" '), 0.001),
        ("none.3mf", state_unit(""), 0.001),
        ("inch.3mf", state_unit('unit="inch" '), 0.0254),
        ("meter.3mf", state_unit('unit="meter" '), 1.0),
        ("meter.dae", make_dae("<node id='n0'><instance_geometry url='#g'/></node>"), 1.0),
        (
            "inch.dae",
            make_dae("<node id='n0'><instance_geometry url='#g'/></node>").replace(
                b'meter="1"', b'name="inch" meter="0.0254"'
            ),
            0.0254,
        ),
        ("meter.gltf", make_gltf([{"mesh": 0}]), 1.0),
    ],
)
def test_a_file_that_states_its_unit_is_read_in_meters(
    tmp_path: Path, name: str, content: bytes, meters: float
):
    path = tmp_path / name
    path.write_bytes(content)
    side = np.ptp(read_mesh(path).vertices, axis=0)
    np.testing.assert_allclose(side, meters, rtol=1e-6)
    given = np.ptp(read_mesh(path, 0.5).vertices, axis=0)
    np.testing.assert_allclose(given, 0.5, rtol=1e-6, err_msg="a scale replaces the unit")


@pytest.mark.parametrize(
    ("units", "meters"),
    [(None, 1.0), ("meters", 1.0), ("millimeters", 0.001), ("in", 0.0254), ("0.01 * meters", 0.01)],
)
def test_a_trimesh_that_states_its_unit_is_read_in_meters(units: str | None, meters: float):
    box = trimesh.creation.box((1, 1, 1))
    if units is not None:
        box.units = units
    assert np.ptp(read_mesh(box).vertices, axis=0).tolist() == [meters] * 3
    assert np.ptp(read_mesh(box, 0.5).vertices, axis=0).tolist() == [0.5] * 3


def test_a_trimesh_in_no_length_is_refused():
    box = trimesh.creation.box((1, 1, 1))
    box.units = "furlongs of cheese"
    with pytest.raises(vx.MeshError, match=r"mesh\.units is 'furlongs of cheese'"):
        vx.Model.from_mesh(box)


@pytest.mark.parametrize("meter", ["0", "-1", "nan", "inf"])
def test_a_unit_that_is_no_length_is_refused(tmp_path: Path, meter: str):
    path = tmp_path / "part.dae"
    content = make_dae("<node id='n0'><instance_geometry url='#g'/></node>")
    path.write_bytes(content.replace(b'meter="1"', f'meter="{meter}"'.encode()))
    with pytest.raises(
        vx.MeshError, match=r"part\.dae: its unit is .* meters, which is not a valid length"
    ):
        read_mesh(path)


def test_an_unknown_unit_is_refused(tmp_path: Path):
    path = tmp_path / "part.3mf"
    path.write_bytes(state_unit('unit="furlong" '))
    with pytest.raises(vx.MeshError, match=r"part\.3mf: its unit is 'furlong', but 3MF has only"):
        read_mesh(path)


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "off"])
def test_a_long_file_without_a_unit_is_doubted(tmp_path: Path, suffix: str):
    path = tmp_path / f"part.{suffix}"
    trimesh.creation.box((80, 60, 20)).export(path)
    with pytest.warns(vx.MeshWarning, match=f"80 m long, and {suffix.upper()} files state no unit"):
        model = vx.Model.from_mesh(path, resolution=20)
    assert np.ptp(model.bounds, axis=0)[0] == 80.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        vx.Model.from_mesh(path, resolution=20, scale=1)
        small = vx.Model.from_mesh(path, resolution=20, scale=0.001)
        vx.Model.from_mesh(trimesh.load(path), resolution=20)  # whoever made it knows
    np.testing.assert_allclose(np.ptp(small.bounds, axis=0), (0.08, 0.06, 0.02), rtol=1e-6)


def test_a_model_that_is_too_large_in_a_wrong_unit_is_refused_with_the_reason(tmp_path: Path):
    path = tmp_path / "part.stl"
    trimesh.creation.box((80, 60, 20)).export(path)
    with pytest.raises(vx.MeshError, match=r"reaches 40 m.*80 m long.*scale=0\.001"):
        vx.Model.from_mesh(path, voxel_size=0.001)
