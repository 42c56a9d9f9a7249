"""Cases that aim at how the readers work: what they check before a library reads, and how."""

from __future__ import annotations

import json
import struct
import sys
from collections.abc import Iterator
from pathlib import Path

from .bodies import (
    BUFFER,
    FACES,
    change,
    dae,
    glb,
    gltf,
    mesh_3mf,
    model_3mf,
    obj,
    object_3mf,
    off,
    pack_3mf,
    ply,
    ply_data,
    ply_text,
    stl,
    stl_text,
    triangles,
    zipped,
)
from .case import Case, Content, Wants, of_files
from .model_files import sound
from .scene_files import SCENE
from .text_meshes import FAN
from .urdf_files import BODY, joint, limit, link, mesh, robot, with_joint, with_link

sys.path.append(str(Path(__file__).resolve().parents[1] / "support"))

from hostile_files import hostile_files, sealed

__all__ = ["list_cases", "sealed"]

EACH = 7
"""Of the model files of `hostile_files`, which `test_model_file.py` opens one and all."""

MANY = " ".join(str(i + 1) for i in range(1001))


def list_texts() -> Iterator[tuple[str, str, Content, Wants]]:
    """Rules about lines, words and corners."""
    long_face = obj(FAN, []) + "f "
    yield "OBJ, 1001 corners after blanks", "a.obj", obj(FAN, []) + f" \t f {MANY}\n", "refused"
    yield (
        "OBJ, 1001 corners on continued lines",
        "a.obj",
        (long_face + MANY.replace(" ", " \\\n") + "\n"),
        "refused",
    )
    yield (
        "OBJ, 1001 corners on lines continued by CRLF",
        "a.obj",
        (long_face + MANY.replace(" ", " \\\r\n") + "\r\n"),
        "refused",
    )
    yield (
        "OBJ, 1001 corners and carriage returns alone",
        "a.obj",
        ((long_face + MANY + "\n").replace("\n", "\r")),
        "refused",
    )
    yield (
        "OBJ, vertex 0 as texture alone",
        "a.obj",
        obj().replace("f 1 3 2", "f 1/0 3/0 2/0"),
        ("either"),
    )
    yield "OBJ, vertex +0", "a.obj", obj().replace("f 1 3 2", "f 1 3 +0"), "refused"
    yield "OBJ, vertex 00/1", "a.obj", obj().replace("f 1 3 2", "f 1 3 00/1"), "refused"
    yield "OBJ, form feeds for line feeds", "a.obj", obj().replace("\n", "\f"), "refused"
    rows = off(FAN, [range(1001)])
    yield "OFF, 1001 corners after form feeds", "a.off", rows.replace("\n", "\f"), "refused"
    yield (
        "OFF, 1001 corners after line separators",
        "a.off",
        rows.replace("\n", "\u2028"),
        "refused",
    )
    yield "OFF, words before its name", "a.off", off(head="not OFF"), "refused"
    yield "OFF, its name twice", "a.off", off(head="OFF\nOFF"), "refused"
    yield "OFF, a comment after each row", "a.off", off().replace("\n", " # a\n"), "loaded"
    yield "OFF, three counts and more", "a.off", off(counts="4 4 0 9 9 9"), "either"
    yield "OFF, blank lines between its rows", "a.off", off().replace("\n", "\n \n"), "loaded"
    yield "OFF, signs before its indices", "a.off", off().replace("3 0 2 1", "3 +0 +2 +1"), "either"
    yield (
        "PLY, 1001 corners",
        "a.ply",
        (
            ply_text(vertices=1001, faces=1).partition("end_header\n")[0]
            + "end_header\n"
            + "".join(f"{x} {y} {z}\n" for x, y, z in FAN)
            + "1001 "
            + " ".join(map(str, range(1001)))
        ),
        "refused",
    )
    yield (
        "PLY, blank lines between its rows",
        "a.ply",
        ply_text().replace("0.0\n", "0.0\n\n"),
        ("refused"),
    )
    yield "PLY, end_header in a comment", "a.ply", ply_text(before="comment end_header\n"), "either"
    yield (
        "PLY, a list before its indices",
        "a.ply",
        ply_text(listed="property list uchar float uv\nproperty list uchar int vertex_indices\n"),
        "refused",
    )
    yield "PLY, a header that is all of it", "a.ply", ply_text().partition("0.0 0.0")[0], "refused"
    mixed = b"".join(
        struct.pack("<B", len(face)) + struct.pack(f"<{len(face)}i", *face)
        for face in [*FACES[:2], (0, 1, 2, 3)]
    )
    yield (
        "binary PLY, faces of three and of four",
        "a.ply",
        (ply(faces=3, data=ply_data(faces=[]) + mixed)),
        "refused",
    )
    yield (
        "binary PLY, three and four corners of the same length in all",
        "a.ply",
        (
            ply(
                faces=2,
                data=ply_data(faces=[])
                + struct.pack("<B4i", 4, 0, 1, 2, 3)
                + struct.pack("<B4i", 3, 0, 2, 1, 0),
            )
        ),
        "refused",
    )
    yield (
        "binary PLY, a count of 64 bits",
        "a.ply",
        ply(listed="property list uint64 int vertex_indices\n"),
        "refused",
    )
    yield (
        "binary PLY, a list of doubles among the corners",
        "a.ply",
        ply(
            point="property list uchar double w\nproperty float x\nproperty float y\nproperty float z\n"
        ),
        "refused",
    )
    yield (
        "STL text, loops that end twice",
        "a.stl",
        stl_text().replace("endloop", "endloop endloop", 1),
        "refused",
    )
    yield "STL text, a solid called endloop", "a.stl", stl_text(name="endloop"), "either"
    yield (
        "STL text, 5000 solids",
        "a.stl",
        lambda: (stl_text(triangles()[:1]) * 5000).encode(),
        ("either"),
    )
    yield (
        "STL text as long as a binary file",
        "a.stl",
        (b"solid a".ljust(80) + struct.pack("<I", 1) + b"facet".ljust(50)),
        "either",
    )
    yield (
        "a binary STL file with text behind it",
        "a.stl",
        stl(triangles()) + stl_text().encode(),
        ("either"),
    )


def list_scenes() -> Iterator[tuple[str, str, Content, Wants]]:
    """Rules about archives, elements and nodes."""
    path = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
    other = (
        f'<components><component p:path="/3D/b.model" objectid="1" xmlns:p="{path}"/></components>'
    )
    yield (
        "3MF, parts of a second model",
        "a.3mf",
        zipped({"3D/3dmodel.model": model_3mf(object_3mf(1, other)), "3D/b.model": model_3mf()}),
        "either",
    )
    yield (
        "3MF, two models that hold each other",
        "a.3mf",
        zipped(
            {
                "3D/3dmodel.model": model_3mf(object_3mf(1, other)),
                "3D/b.model": model_3mf(object_3mf(1, other.replace("/3D/b.", "/3D/3dmodel."))),
            }
        ),
        "refused",
    )
    yield "3MF, its model in capitals", "a.3mf", zipped({"3D/3DMODEL.MODEL": model_3mf()}), "either"
    yield "3MF, an archive in the archive", "a.3mf", pack_3mf(pack_3mf(model_3mf())), "refused"
    yield (
        "3MF, 10000 empty files",
        "a.3mf",
        lambda: zipped({**{f"a{i}": b"" for i in range(10_000)}, "3D/3dmodel.model": model_3mf()}),
        "either",
    )
    yield (
        "3MF, a mesh in a mesh",
        "a.3mf",
        pack_3mf(
            model_3mf(
                object_3mf(inside=mesh_3mf().replace("<vertices>", mesh_3mf() + "<vertices>"))
            )
        ),
        "either",
    )
    yield (
        "3MF, an object in an object",
        "a.3mf",
        pack_3mf(model_3mf(object_3mf(inside=object_3mf(2) + mesh_3mf()))),
        "either",
    )
    many = dae(indices=range(1001)).replace("<triangles", "<polygons").replace("</tri", "</poly")
    yield "COLLADA, a polygon of 1001 corners", "a.dae", many.replace("angles>", "gons>"), "refused"
    yield (
        "COLLADA, an index parted by a comment",
        "a.dae",
        dae(indices=[*range(3), "<!-- -->", *([0] * 8), "1<!-- -->2345678901"]),
        "refused",
    )
    yield (
        "COLLADA, an offset of a word",
        "a.dae",
        dae().replace('offset="0"', 'offset="a"'),
        "refused",
    )
    yield (
        "COLLADA, an offset of 10**9",
        "a.dae",
        dae().replace('offset="0"', 'offset="999999999"'),
        ("refused"),
    )
    yield (
        "COLLADA, a negative offset",
        "a.dae",
        dae().replace('offset="0"', 'offset="-1"'),
        "refused",
    )
    yield (
        "COLLADA, no numbers in a matrix",
        "a.dae",
        dae(nodes='<node><matrix/><instance_geometry url="#g"/></node>'),
        "refused",
    )
    yield (
        "COLLADA, its name space twice",
        "a.dae",
        dae().replace("<scene>", '<scene xmlns="http://example.org/">'),
        "refused",
    )
    yield (
        "glTF, an escaped path out of its folder",
        "a.gltf",
        json.dumps(change(gltf(), "buffers.0.uri", "%2e%2e/%2e%2e/etc/passwd")),
        "refused",
    )
    yield (
        "glTF, an image that is a device",
        "a.glb",
        glb(change(gltf(), "images", [{"uri": "/dev/zero"}])),
        "loaded",
    )
    yield (
        "glTF, more primitives than are placed",
        "a.glb",
        glb(
            change(
                gltf(),
                "meshes",
                [*gltf()["meshes"], {"primitives": gltf()["meshes"][0]["primitives"] * 9}],
            )
        ),
        "either",
    )
    yield (
        "glTF, a node of two meshes' children",
        "a.glb",
        glb(change(gltf(), "nodes", [{"mesh": 0, "children": [1, 2]}, {"mesh": 0}, {"mesh": 0}])),
        "either",
    )
    for key in ("asset", "scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers"):
        for value in (None, 5, "a", [None], [[]]):
            yield f"glTF, {key} of {value!r}", "a.glb", glb(change(gltf(), key, value)), "either"


def list_robots() -> Iterator[tuple[str, Content, Wants]]:
    """Numbers, and what fails when bodies have been added already."""
    yield "a place of two numbers", with_joint(inside='<origin xyz="0 0"/>'), "refused"
    yield "a turn of four numbers", with_joint(inside='<origin rpy="0 0 0 1"/>'), "refused"
    yield "a place without numbers", with_joint(inside="<origin/>"), "loaded"
    yield "numbers parted by commas", with_joint(inside='<origin xyz="0,0,0"/>'), "loaded"
    yield (
        "numbers parted by line feeds",
        with_joint(inside='<origin xyz="0&#10;0&#10;0"/>'),
        "loaded",
    )
    yield "limits of nothing", with_joint(limits="<limit/>"), "either"
    yield (
        "an infinite effort and velocity",
        with_joint(limits=limit(effort="inf", velocity="inf")),
        "loaded",
    )
    yield "a mimic of no joint", with_joint(inside="<mimic/>"), "refused"
    yield (
        "a mimic of 1000 others",
        robot(
            *(link(f"l{i}") for i in range(300)),
            *(
                joint(
                    f"j{i}", child=f"l{i}", inside=f'<mimic joint="j{i + 1}"/>' if i < 299 else ""
                )
                for i in range(300)
            ),
        ),
        "either",
    )
    yield "no ixx", with_link().replace('ixx="0.004" ', ""), "refused"
    yield "a scale of one number", mesh("body.stl", "2"), "loaded"
    yield "a box of one number", with_link(geometry='<box size="1"/>'), "refused"
    yield (
        "a last link that is far away",
        robot(
            link(), link("b"), joint(), joint("j", child="b", inside='<origin xyz="1e300 0 0"/>')
        ),
        "refused",
    )
    yield (
        "a last joint of an axis that is none",
        robot(link(), link("b"), joint(), joint("j", child="b", axis='<axis xyz="1e-320 0 0"/>')),
        "either",
    )
    yield (
        "a last link of a huge mass",
        robot(link(), link("b", mass="1e200"), joint(), joint("j", child="b")),
        "refused",
    )
    yield "1001 links", robot(*(link(f"l{i}") for i in range(1000))), "refused"


def list_toml() -> Iterator[tuple[str, Content, Wants]]:
    """Patterns that take long where they hardly fit."""
    yield "a bare key of 450000 letters", "a" * 450_000 + " = 1\n", "refused"
    yield "a value of 450000 letters", "a = " + "a" * 450_000 + "\n", "refused"
    yield "450000 dots", "a" + "." * 450_000 + " = 1\n", "refused"
    yield "450000 quotes", 'a = "' + '"' * 450_000 + "\n", "refused"
    yield "a text without its end, of backslashes", 'a = "' + "\\" * 450_000 + "\n", "refused"
    yield "100000 tables", "".join(f"[a{i}]\n" for i in range(100_000)), "refused"
    yield "50000 tables", "".join(f"[a{i}]\n" for i in range(50_000)), "refused"
    yield "247000 numbers", "a = [" + "1," * 247_000 + "]\n", "refused"
    many = "".join(f'[bodies.b{i}]\nshape = "plane"\n' for i in range(15_000))
    yield "a wrong key after 15000 tables", many + "[bodies.c]\nevil = 1\n", "refused"
    yield "100 brackets in each other", "a = " + "[" * 100 + "]" * 100, "refused"
    yield (
        "a wrong key after 3000 tables",
        SCENE
        + "".join(f'[bodies.b{i}]\nshape = "plane"\n' for i in range(3000))
        + "[bodies.c]\nevil = 1\n",
        "refused",
    )


def list_cases() -> Iterator[Case]:
    for name, file, content, wants in (*list_texts(), *list_scenes()):
        yield of_files("mesh", name, file, content, wants, {"body.bin": BUFFER})
    for name, content, wants in list_robots():
        yield of_files("urdf", name, "robot.urdf", content, wants, BODY)
    for name, content, wants in list_toml():
        yield of_files("scene", name, "scene.toml", content, wants)
    for number, (name, content) in enumerate(hostile_files(sound())):
        if number % EACH == 0:
            yield of_files("model", f"it {name}", "body.vxs", content, "refused")
