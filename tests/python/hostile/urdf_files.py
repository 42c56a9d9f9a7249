"""Robots."""

from __future__ import annotations

from collections.abc import Iterator

from .bodies import entity_bomb, nest, outer_entity, stl, triangles
from .case import Case, Content, Wants, of_files

BODY = {"body.stl": stl(triangles() * 0.1)}
SPHERE = '<sphere radius="0.1"/>'


def link(
    name: str = "arm",
    geometry: str = SPHERE,
    mass: object = 1,
    inertia: tuple[object, object, object] = (0.004, 0.004, 0.004),
    products: object = 0,
    origin: str = "",
) -> str:
    x, y, z = inertia
    return (
        f'<link name="{name}"><inertial><origin xyz="0 0 0"/><mass value="{mass}"/>'
        f'<inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="{products}" ixz="0" iyz="0"/></inertial>'
        f"<collision>{origin}<geometry>{geometry}</geometry></collision></link>"
    )


def joint(
    name: str = "pivot",
    kind: str = "revolute",
    parent: str = "base",
    child: str = "arm",
    limits: str = '<limit lower="-1" upper="1" effort="5" velocity="1"/>',
    axis: str = '<axis xyz="0 1 0"/>',
    inside: str = "",
) -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{axis}{limits}{inside}</joint>"
    )


def robot(*parts: str, head: str = "", base: str = '<link name="base"/>') -> str:
    return f'{head}<robot name="robot">{base}{"".join(parts)}</robot>'


def with_link(**link_settings: object) -> str:
    return robot(link(**link_settings), joint())  # type: ignore[arg-type]


def with_joint(**joint_settings: str) -> str:
    return robot(link(), joint(**joint_settings))


def limit(**limits: object) -> str:
    values = {"lower": -1, "upper": 1, "effort": 5, "velocity": 1, **limits}
    attributes = " ".join(f'{name}="{value}"' for name, value in values.items())
    return f"<limit {attributes}/>"


def mesh(file: str, scale: str = "") -> str:
    scaling = f' scale="{scale}"' if scale else ""
    return with_link(geometry=f'<mesh filename="{file}"{scaling}/>')


def chain(length: int) -> str:
    links = [link(f"l{i}") for i in range(length)]
    joints = [joint(f"j{i}", parent=f"l{i}", child=f"l{i + 1}") for i in range(length - 1)]
    return f'<robot name="chain">{"".join(links + joints)}</robot>'


def list_trees() -> Iterator[tuple[str, Content, Wants]]:
    whole = robot(link(), joint())
    yield "empty", "", "refused"
    yield "no XML", "solid", "refused"
    yield "cut", whole[:-40], "refused"
    yield "another document", "<html/>", "refused"
    yield "a robot of nothing", '<robot name="a"/>', "refused"
    yield "no name", whole.replace(' name="robot"', ""), "either"
    yield "a robot in a robot", robot(whole), "either"
    yield "two roots", robot(link(), link("other"), joint()), "refused"
    yield (
        "links in a circle",
        robot(
            link("a"),
            link("b"),
            joint("j", parent="a", child="b"),
            joint("k", parent="b", child="a"),
        ),
        "refused",
    )
    yield (
        "a circle and no root",
        robot(
            link("a"),
            link("b"),
            joint("j", parent="a", child="b"),
            joint("k", parent="b", child="a"),
            base="",
        ),
        "refused",
    )
    yield "a joint from a link to itself", with_joint(parent="arm"), "refused"
    yield (
        "a link with two parents",
        robot(
            link(), link("other"), joint(), joint("j", child="other"), joint("k", parent="other")
        ),
        "refused",
    )
    yield "a missing parent", with_joint(parent="missing"), "refused"
    yield "a missing child", with_joint(child="missing"), "refused"
    yield "the same link twice", robot(link(), link(), joint()), "refused"
    yield "the same joint twice", robot(link(), link("b"), joint(), joint(child="b")), "refused"
    yield "links without names", whole.replace('name="arm"', ""), "refused"
    yield "empty names", whole.replace('"arm"', '""'), "either"
    yield "no parent", whole.replace('<parent link="base"/>', ""), "refused"
    yield "no type of a joint", whole.replace(' type="revolute"', ""), "refused"
    yield "an unknown type of a joint", with_joint(kind="flying"), "refused"
    yield "a floating joint", with_joint(kind="floating"), "either"
    yield "a planar joint", with_joint(kind="planar"), "either"
    yield "a chain of 300 links", chain(300), "either"
    yield "a chain of 2000 links", chain(2000), "either"
    yield "unknown elements", robot(link(), joint(), "<evil><deep/></evil>"), "either"
    yield "an unknown number as attribute", whole.replace("<link ", '<link evil="5" '), "either"
    yield "macros", robot(link(), joint(), '<xacro:include filename="/dev/zero"/>'), "either"
    yield (
        "macros with their name space",
        robot(link(), joint(), '<include xmlns="http://ros.org/wiki/xacro" filename="/dev/zero"/>'),
        "either",
    )
    yield "UTF-16", ('<?xml version="1.0" encoding="UTF-16"?>' + whole).encode("utf-16"), "either"
    yield "a byte order mark", b"\xef\xbb\xbf" + whole.encode(), "either"
    yield "Latin-1", whole.replace("robot", "r\xf6bot").encode("latin-1"), "refused"
    yield "NUL", whole.replace("arm", "a\0m"), "refused"
    yield "an entity bomb", robot(link(), joint(), "&bomb;", head=entity_bomb()), "refused"
    yield (
        "a file of the system as entity",
        robot(link(), joint(), "&bomb;", head=outer_entity("/etc/passwd")),
        "refused",
    )
    yield (
        "a device as entity",
        robot(link(), joint(), "&bomb;", head=outer_entity("/dev/zero")),
        "refused",
    )
    yield "100000 nested elements", robot(link(), joint(), nest("a", 100_000)), "either"
    yield "a name of a megabyte", whole.replace("arm", "a" * 1_000_000), "either"
    yield (
        "10000 collisions of a link",
        whole.replace(
            "</inertial>",
            "</inertial>" + f"<collision><geometry>{SPHERE}</geometry></collision>" * 10_000,
        ),
        "either",
    )


def list_numbers() -> Iterator[tuple[str, Content, Wants]]:
    for value in ("nan", "inf", "words", "", "1e999", "1_0"):
        yield f"limits of {value!r}", with_joint(limits=limit(upper=value)), "refused"
        yield (
            f"an effort of {value!r}",
            with_joint(limits=limit(effort=value)),
            ("either" if value in ("inf", "1e999") else "refused"),
        )
        yield f"a mass of {value!r}", with_link(mass=value), "refused"
        yield f"an inertia of {value!r}", with_link(inertia=(value, 0.004, 0.004)), "refused"
        yield f"a radius of {value!r}", with_link(geometry=f'<sphere radius="{value}"/>'), "refused"
        yield f"an axis of {value!r}", with_joint(axis=f'<axis xyz="0 {value} 0"/>'), "refused"
        yield f"a place of {value!r}", with_joint(inside=f'<origin xyz="0 {value} 0"/>'), "refused"
        yield f"a turn of {value!r}", with_joint(inside=f'<origin rpy="0 {value} 0"/>'), "refused"
    yield "limits the wrong way round", with_joint(limits=limit(lower=1, upper=-1)), "either"
    yield "no limits", with_joint(limits=""), "either"
    yield "limits of 1e300", with_joint(limits=limit(lower=-1e300, upper=1e300)), "either"
    yield "a negative effort", with_joint(limits=limit(effort=-5)), "either"
    yield "a negative velocity", with_joint(limits=limit(velocity=-1)), "either"
    yield "a negative damping", with_joint(inside='<dynamics damping="-1"/>'), "refused"
    yield "a damping of NaN", with_joint(inside='<dynamics damping="nan"/>'), "refused"
    yield "a friction of 1e300", with_joint(inside='<dynamics friction="1e300"/>'), "either"
    yield "an axis of zeros", with_joint(axis='<axis xyz="0 0 0"/>'), "refused"
    yield "an axis of two numbers", with_joint(axis='<axis xyz="0 1"/>'), "refused"
    yield "an axis of 1e-300", with_joint(axis='<axis xyz="0 1e-300 0"/>'), "either"
    yield "an axis of 1e300", with_joint(axis='<axis xyz="0 1e300 0"/>'), "either"
    yield "a place of 1e300", with_joint(inside='<origin xyz="1e300 0 0"/>'), "refused"
    yield "a turn of 1e300", with_joint(inside='<origin rpy="1e300 0 0"/>'), "either"
    yield "a mass of zero", with_link(mass=0), "either"
    yield "a negative mass", with_link(mass=-1), "refused"
    yield "a mass of 1e300", with_link(mass=1e300), "refused"
    yield "a mass of 1e-300", with_link(mass=1e-300), "either"
    yield "a negative inertia", with_link(inertia=(-1, 1, 1)), "either"
    yield "an inertia of zeros", with_link(inertia=(0, 0, 0)), "either"
    yield "an inertia that no body has", with_link(inertia=(1, 1, 100)), "either"
    yield "products of inertia beyond it", with_link(products=5), "either"
    yield "no inertia", robot(link(), joint()).replace("<inertia ", "<evil "), "either"
    yield "a ball of radius 0", with_link(geometry='<sphere radius="0"/>'), "loaded"
    yield "a ball of radius -1", with_link(geometry='<sphere radius="-1"/>'), "refused"
    yield "a ball of radius 1e300", with_link(geometry='<sphere radius="1e300"/>'), "refused"
    yield "a ball of radius 1e-300", with_link(geometry='<sphere radius="1e-300"/>'), "either"
    yield "a ball without a radius", with_link(geometry="<sphere/>"), "refused"
    yield "a box of two numbers", with_link(geometry='<box size="1 1"/>'), "refused"
    yield "a flat box", with_link(geometry='<box size="1 1 0"/>'), "refused"
    yield (
        "a cylinder of no length",
        with_link(geometry='<cylinder radius="1" length="0"/>'),
        "refused",
    )
    yield "an unknown shape", with_link(geometry='<torus radius="1"/>'), "refused"
    yield "no shape", with_link(geometry=""), "either"
    yield "two shapes in one collision", with_link(geometry=SPHERE * 2), "either"
    yield "a joint that mimics itself", with_joint(inside='<mimic joint="pivot"/>'), "refused"
    yield "a joint that mimics a missing one", with_joint(inside='<mimic joint="x"/>'), "refused"
    mimics = [joint(f"j{i}", child=f"l{i}", inside=f'<mimic joint="j{1 - i}"/>') for i in range(2)]
    yield "joints that mimic each other", robot(link("l0"), link("l1"), *mimics), "refused"
    yield (
        "a mimic of NaN",
        robot(
            link(),
            link("b"),
            joint(),
            joint("j", child="b", inside='<mimic joint="pivot" multiplier="nan"/>'),
        ),
        "refused",
    )


def list_meshes() -> Iterator[tuple[str, Content, Wants]]:
    files: dict[str, tuple[str, Wants]] = {
        "a missing file": ("missing.stl", "refused"),
        "no name": ("", "refused"),
        "itself": ("robot.urdf", "refused"),
        "its folder": (".", "refused"),
        "a device": ("/dev/zero", "refused"),
        "a package out of its folder": ("package://../../../../etc/passwd", "refused"),
        "a package of no file": ("package://", "refused"),
        "a missing package": ("package://missing/body.stl", "either"),
        "the network": ("http://127.0.0.1:9/body.stl", "refused"),
        "a file of the system": ("file:///etc/passwd", "refused"),
        "an unknown scheme": ("evil://body.stl", "either"),
        "a name of 5000 letters": ("a" * 5000 + ".stl", "refused"),
        "a damaged mesh": ("damaged.stl", "refused"),
    }
    for name, (file, wants) in files.items():
        yield f"a mesh of {name}", mesh(file), wants
    for scale, wants in (
        ("0 0 0", "refused"),
        ("nan nan nan", "refused"),
        ("1e300 1e300 1e300", "refused"),
        ("1e-300 1e-300 1e-300", "refused"),
        ("-1 1 1", "either"),
        ("1 1", "refused"),
        ("a b c", "refused"),
    ):
        yield f"a mesh of scale {scale}", mesh("body.stl", scale), wants  # type: ignore[misc]
    yield (
        "the same mesh in 1000 links",
        robot(
            *(link(f"l{i}", '<mesh filename="body.stl"/>') for i in range(1000)),
            *(joint(f"j{i}", child=f"l{i}") for i in range(1000)),
        ),
        "either",
    )


def list_cases() -> Iterator[Case]:
    others = {**BODY, "damaged.stl": BODY["body.stl"][:100]}
    for lister in (list_trees, list_numbers, list_meshes):
        for name, content, wants in lister():
            yield of_files("urdf", name, "robot.urdf", content, wants, others)
