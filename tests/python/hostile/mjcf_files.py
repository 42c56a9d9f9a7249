"""MJCF models."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from pathlib import Path

from .bodies import entity_bomb, nest, outer_entity, stl, triangles
from .case import Case, Content, Wants, of_files

BODY = {"body.stl": stl(triangles() * 0.1), "damaged.stl": stl(triangles())[:100]}
BALL = '<geom size="0.1"/>'


def model(*parts: str, inside: str = BALL, head: str = "", joint: str = "<freejoint/>") -> str:
    body = f'<body name="arm">{joint}{inside}</body>'
    return f'{head}<mujoco model="m">{"".join(parts)}<worldbody>{body}</worldbody></mujoco>'


def mesh(asset: str, geom: str = "") -> str:
    return model(
        f'<asset><mesh name="a" {asset}/></asset>', inside=f'<geom type="mesh" mesh="a" {geom}/>'
    )


def rows_of(count: int) -> str:
    return "".join(f'<body pos="{i} 0 0"><joint/>{BALL}</body>' for i in range(count))


def list_trees() -> Iterator[tuple[str, Content, Wants]]:
    whole = model()
    yield "empty", "", "refused"
    yield "no XML", "solid", "refused"
    yield "cut", whole[:-40], "refused"
    yield "another document", "<html/>", "refused"
    yield "a robot of ROS", '<robot name="a"><link name="b"/></robot>', "refused"
    yield "no worldbody", "<mujoco/>", "refused"
    yield "nothing in the world", "<mujoco><worldbody/></mujoco>", "loaded"
    yield "the same body twice", model(inside=BALL + '<body name="arm"/>'), "refused"
    yield "a body called world", whole.replace('"arm"', '"world"'), "refused"
    yield (
        "a body called as a plane",
        whole.replace(
            "<worldbody>", '<worldbody><geom name="arm" type="plane" size="1 1 1"/>'
        ).replace('"arm">', '"world/arm">'),
        "refused",
    )
    yield "the same joint twice", model(joint='<joint name="a"/><joint name="a"/>'), "refused"
    yield "two free joints", model(joint="<freejoint/><freejoint/>"), "refused"
    yield (
        "a free joint in a body",
        model(inside=BALL + f"<body><freejoint/>{BALL}</body>"),
        "refused",
    )
    yield "a plane that moves", model(inside='<geom type="plane" size="1 1 1"/>'), "refused"
    yield "a moving body of nothing", model(inside=""), "either"
    yield "an unknown element", whole.replace("<geom", "<geomm"), "refused"
    yield "an unknown attribute", whole.replace("size=", "sise="), "refused"
    yield "a name of a million letters", whole.replace("size=", "size" * 250_000 + "="), "refused"
    yield "a shell of no shape", model(inside='<geom size="0.1" shellinertia="x"/>'), "refused"
    yield (
        "pairs of all and nothing",
        model('<contact><pair geom1="a" geom2="a"/><pair geom1="" geom2="b"/></contact>'),
        "loaded",
    )
    yield "an unknown joint", model(joint='<joint type="screw"/>'), "refused"
    yield "1000 joints of a body", model(joint="<joint/>" * 1000), "either"
    yield (
        "3000 bodies",
        f"<mujoco><worldbody>{f'<body><freejoint/>{BALL}</body>' * 3000}</worldbody></mujoco>",
        "refused",
    )
    yield "900 bodies", f"<mujoco><worldbody>{rows_of(900)}</worldbody></mujoco>", "loaded"
    yield (
        "90 bodies in each other",
        model(inside=BALL + "<body><joint/>" * 90 + BALL + "</body>" * 90),
        "either",
    )
    yield "a million elements", model("<custom>" + "<a/>" * 1_000_000 + "</custom>"), "refused"
    yield "100000 nested elements", model(nest("a", 100_000)), "refused"
    yield "100000 nested bodies", model(inside=nest("body", 100_000)), "refused"
    yield "5000 nested frames", model(inside=nest("frame", 5_000)), "refused"
    yield (
        "5000 nested defaults",
        model("<default class='main'>" + nest("default", 5_000) + "</default>"),
        "refused",
    )
    yield "a name of a megabyte", whole.replace("arm", "a" * 1_000_000), "either"
    yield "an entity bomb", model("&bomb;", head=entity_bomb()), "refused"
    yield (
        "a file of the system as entity",
        model("&bomb;", head=outer_entity("/etc/passwd")),
        "refused",
    )
    yield "a device as entity", model("&bomb;", head=outer_entity("/dev/zero")), "refused"
    yield "UTF-16", ('<?xml version="1.0" encoding="UTF-16"?>' + whole).encode("utf-16"), "loaded"
    yield "NUL", whole.replace("arm", "a\0m"), "refused"
    yield "an unknown class", model(inside='<geom size="0.1" class="none"/>'), "refused"
    yield "an unknown childclass", whole.replace('"arm"', '"arm" childclass="none"'), "refused"
    yield "a class without a name", model("<default><default/></default>"), "refused"
    yield "global coordinates", model('<compiler coordinate="global"/>'), "refused"
    yield "unknown axes of euler angles", model('<compiler eulerseq="xyw"/>'), "refused"
    yield "two axes of euler angles", model('<compiler eulerseq="xy"/>'), "refused"
    yield "an unknown unit of angles", model('<compiler angle="turn"/>'), "refused"
    yield "a total mass of 1e300", model('<compiler settotalmass="1e300"/>'), "refused"
    yield "a total mass of 1e-300", model('<compiler settotalmass="1e-300"/>'), "either"
    yield "a total mass of nothing", model('<compiler settotalmass="5"/>', inside=""), "either"
    yield (
        "pairs of no bodies",
        model('<contact><exclude body1="x" body2="y"/><pair geom1="x" geom2="y"/></contact>'),
        "loaded",
    )
    yield "a pair of one", model('<contact><exclude body1="x"/></contact>'), "refused"
    yield (
        "soft bodies",
        model(inside=BALL + '<composite type="cable"/><flexcomp name="a"/>'),
        "loaded",
    )
    yield (
        "a replica",
        model(inside=BALL + '<replicate count="1000000000"><geom size="1"/></replicate>'),
        "refused",
    )


def list_numbers() -> Iterator[tuple[str, Content, Wants]]:
    for value in ("nan", "inf", "words", "", "1e999", "1_0", "1" * 400, "0x10"):
        short = value[:20]
        yield f"a size of {short!r}", model(inside=f'<geom size="{value}"/>'), "refused"
        yield (
            f"a place of {short!r}",
            model(inside=f'<geom size="1" pos="0 {value} 0"/>'),
            "refused",
        )
        yield f"a mass of {short!r}", model(inside=f'<geom size="1" mass="{value}"/>'), "refused"
        yield (
            f"a density of {short!r}",
            model(inside=f'<geom size="1" density="{value}"/>'),
            "refused",
        )
        yield (
            f"an angle of {short!r}",
            model(inside=f'<geom size="1" euler="0 {value} 0"/>'),
            "refused",
        )
        yield f"a range of {short!r}", model(joint=f'<joint range="0 {value}"/>'), "refused"
        yield f"an axis of {short!r}", model(joint=f'<joint axis="0 {value} 0"/>'), "refused"
        yield (
            f"a contype of {short!r}",
            model(inside=f'<geom size="1" contype="{value}"/>'),
            "refused",
        )
        yield (
            f"an inertia of {short!r}",
            model(inside=f'<inertial mass="1" diaginertia="1 1 {value}"/>'),
            "refused",
        )
        yield f"a gravity of {short!r}", model(f'<option gravity="0 0 {value}"/>'), "refused"
    for value in ("0", "-1", "1e300", "1e-300"):
        wants: Wants = "either" if value == "1e-300" else "refused"
        yield f"a ball of {value}", model(inside=f'<geom size="{value}"/>'), wants
        yield (
            f"a box of {value}",
            model(inside=f'<geom type="box" size="1 1 {value}"/>'),
            "either" if value == "1e300" else wants,
        )
        yield (
            f"an ellipsoid of {value}",
            model(inside=f'<geom type="ellipsoid" size="1 1 {value}"/>'),
            wants,
        )
    for rotation in ("quat='0 0 0 0'", "axisangle='0 0 0 1'", "zaxis='0 0 0'", "xyaxes='1 0 0 1 0 0'",
                     "quat='1e300 0 0 1e-300'", "zaxis='1e-300 0 0'", "euler='1e300 0 0'"):  # fmt: skip
        yield f"a rotation of {rotation}", model(inside=f"<geom size='1' {rotation}/>"), "either"
    yield "an axis of zeros", model(joint='<joint axis="0 0 0"/>'), "refused"
    yield "an axis of 1e300", model(joint='<joint axis="0 1e300 0"/>'), "loaded"
    yield (
        "a range the wrong way round",
        model(joint='<joint limited="true" range="1 -1"/>'),
        "refused",
    )
    yield "a range of 1e300", model(joint='<joint range="-1e300 1e300"/>'), "either"
    yield "a reference of 1e300", model(joint='<joint ref="1e300"/>'), "either"
    yield (
        "a reference out of the world",
        model(joint='<joint type="slide" ref="1e300" range="0 1"/>'),
        "refused",
    )
    yield "a negative damping", model(joint='<joint damping="-1"/>'), "refused"
    yield (
        "ends at the same place",
        model(inside='<geom type="capsule" size="1" fromto="0 0 0 0 0 0"/>'),
        "refused",
    )
    yield (
        "ends of 1e300",
        model(inside='<geom type="capsule" size="1" fromto="0 0 0 0 0 1e300"/>'),
        "refused",
    )
    yield "a negative mass", model(inside='<geom size="1" mass="-1"/>'), "refused"
    yield "a mass of 1e300", model(inside='<geom size="1" mass="1e300"/>'), "refused"
    yield "a negative inertia", model(inside='<inertial mass="1" diaginertia="-1 1 1"/>'), "either"
    yield "no mass of an inertial", model(inside='<inertial diaginertia="1 1 1"/>'), "refused"
    yield (
        "five numbers of an inertia",
        model(inside='<inertial mass="1" fullinertia="1 1 1 0 0"/>'),
        "refused",
    )
    yield "a friction of -1", model(inside='<geom size="1" friction="-1"/>'), "refused"
    yield "a contype of a half", model(inside='<geom size="1" contype="0.5"/>'), "refused"
    yield "an unknown shape", model(inside='<geom type="torus" size="1"/>'), "refused"
    yield "no size", model(inside='<geom type="box"/>'), "refused"
    yield "10000 geoms of a body", model(inside='<geom size="0.1"/>' * 10_000), "either"


def list_meshes() -> Iterator[tuple[str, Content, Wants]]:
    files: dict[str, Wants] = {
        "missing.stl": "refused",
        "": "refused",
        "model.xml": "refused",
        ".": "refused",
        "/dev/zero": "refused",
        "../../../../../../etc/passwd": "refused",
        "http://127.0.0.1:9/body.stl": "refused",
        "a" * 5000 + ".stl": "refused",
        "damaged.stl": "refused",
        "damaged.msh": "refused",
        "huge.msh": "refused",
        "body.stl": "loaded",
    }
    for file, wants in files.items():
        yield f"a mesh of {file[:40]!r}", mesh(f'file="{file}"'), wants
    for scale in ("0 0 0", "nan 1 1", "1e300 1 1", "1 1"):
        yield f"a scale of {scale}", mesh(f'file="body.stl" scale="{scale}"'), "refused"
    yield "a mirrored mesh", mesh('file="body.stl" scale="-1 1 1"'), "loaded"
    yield "a mesh that is turned by nothing", mesh('file="body.stl" refquat="0 0 0 0"'), "refused"
    yield "a geom of no mesh", model(inside='<geom type="mesh" mesh="none"/>'), "refused"
    yield "a mesh without a file", mesh(""), "refused"
    tetrahedron = 'vertex="0 0 0 1 0 0 0 1 0 0 0 1"'
    yield "vertices", mesh(tetrahedron), "loaded"
    yield "three vertices", mesh('vertex="0 0 0 1 0 0 0 1 0"'), "refused"
    yield "eleven numbers of vertices", mesh('vertex="0 0 0 1 0 0 0 1 0 0 0"'), "refused"
    yield "vertices in a plane", mesh('vertex="0 0 0 1 0 0 0 1 0 1 1 0"'), "refused"
    yield "faces of no vertices", mesh(tetrahedron + ' face="0 1 9 0 2 1"'), "refused"
    yield "faces of halves", mesh(tetrahedron + ' face="0 1 0.5 0 2 1"'), "refused"
    yield (
        "a box around a mesh of no volume",
        mesh('vertex="0 0 0 1 0 0 0 1 0 0 0 1" face="0 1 2"', 'type="box"').replace(
            'type="mesh" ', ""
        ),
        "either",
    )
    yield (
        "the same mesh 1000 times",
        mesh('file="body.stl"').replace(
            "<geom", "<geom/>" * 0 + '<geom type="mesh" mesh="a"/>' * 1000 + "<geom"
        ),
        "either",
    )


def list_includes() -> Iterator[tuple[str, Content, Wants]]:
    for file in ("model.xml", "./model.xml", "ring.xml", "missing.xml", "", ".", "/dev/zero", "/etc/passwd",
                 "../../../../etc/passwd", "body.stl", "a" * 5000):  # fmt: skip
        yield f"an include of {file[:40]!r}", model(f'<include file="{file}"/>'), "refused"
    yield "an include without a file", model("<include/>"), "refused"
    yield "an include of an include", model('<include file="part.xml"/>'), "loaded"
    yield "includes that double", model('<include file="double0.xml"/>'), "refused"
    yield "1000 includes", model('<include file="part.xml"/>' * 1000), "refused"
    yield "99 includes of much", model('<include file="much.xml"/>' * 99), "refused"
    for file in ("model.xml", "missing.xml", "body.stl"):
        asset = f'<asset><model name="x" file="{file}"/></asset>'
        yield (
            f"{file} attached",
            model(asset, inside=BALL + '<attach model="x" prefix="p"/>'),
            "refused",
        )
    asset = '<asset><model name="x" file="model.xml"/></asset>'
    yield (
        "a model that attaches itself in frames",
        model(
            asset, inside=BALL + "<frame>" * 90 + '<attach model="x" prefix="p"/>' + "</frame>" * 90
        ),
        "refused",
    )
    yield "no model attached", model(inside=BALL + '<attach model="x"/>'), "refused"
    yield (
        "a body of no name attached",
        model(asset, inside=BALL + '<attach model="x" body="y"/>'),
        "refused",
    )


OTHERS: dict[str, Content] = {
    **BODY,
    "damaged.msh": struct.pack("<4i", 4, 0, 0, 4) + b"\0" * 60,
    "huge.msh": struct.pack("<4i", 2**31 - 1, 0, 0, 2**31 - 1),
    "ring.xml": '<mujoco><include file="ring2.xml"/></mujoco>',
    "ring2.xml": '<mujoco><include file="ring.xml"/></mujoco>',
    "part.xml": '<mujocoinclude><include file="inner.xml"/></mujocoinclude>',
    "inner.xml": "<mujocoinclude><asset/></mujocoinclude>",
    "much.xml": f"<mujocoinclude><custom>{'<a/>' * 100_000}</custom></mujocoinclude>",
    **{
        f"double{i}.xml": f'<mujocoinclude>{f"""<include file="double{i + 1}.xml"/>""" * 2}</mujocoinclude>'
        for i in range(30)
    },
    "double30.xml": "<mujocoinclude/>",
}


def with_pipe(tag: str) -> Case:
    """A pipe that a model names."""
    content = model(
        '<include file="pipe"/>'
        if tag == "include"
        else '<asset><mesh name="a" file="pipe.stl"/></asset>',
        inside='<geom type="mesh" mesh="a"/>',
    )

    def write(folder: Path) -> None:
        (folder / "model.xml").write_text(content)
        for name in ("pipe", "pipe.stl"):
            os.mkfifo(folder / name)

    return Case(f"a pipe as {tag}", "mjcf", "model.xml", write, "refused")


def list_cases() -> Iterator[Case]:
    for lister in (list_trees, list_numbers, list_meshes, list_includes):
        for name, content, wants in lister():
            yield of_files("mjcf", name, "model.xml", content, wants, OTHERS)
    yield with_pipe("include")
    yield with_pipe("mesh")
