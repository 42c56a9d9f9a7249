"""3MF and COLLADA."""

from __future__ import annotations

from collections.abc import Iterator

from .bodies import (
    CORNERS,
    FACES,
    dae,
    entity_bomb,
    mesh_3mf,
    model_3mf,
    nest,
    object_3mf,
    outer_entity,
    pack_3mf,
    zip_of_zeros,
    zipped,
)
from .case import Case, Content, Wants, of_files

MODEL = "3D/3dmodel.model"


def with_mesh(corners: object = CORNERS, faces: object = FACES) -> bytes:
    return pack_3mf(model_3mf(object_3mf(inside=mesh_3mf(corners, faces))))


def parts(*numbers: object) -> str:
    rows = "".join(f'<component objectid="{number}"/>' for number in numbers)
    return f"<components>{rows}</components>"


def doubled(levels: int) -> bytes:
    """Each object holds the one before twice: 2**levels bodies."""
    objects = [object_3mf()]
    objects += [object_3mf(i + 2, parts(i + 1, i + 1)) for i in range(levels)]
    return pack_3mf(model_3mf("".join(objects), f'<item objectid="{levels + 1}"/>'))


def with_transform(transform: str) -> bytes:
    return pack_3mf(model_3mf(build=f'<item objectid="1" transform="{transform}"/>'))


def with_entity(kind: str) -> bytes:
    text = model_3mf().replace("<resources>", '<metadata name="a">&bomb;</metadata><resources>')
    return pack_3mf(text.replace("?>", "?>" + kind, 1))


def list_3mf() -> Iterator[tuple[str, Content, Wants]]:
    whole = pack_3mf(model_3mf())
    yield "empty", b"", "refused"
    yield "no archive", model_3mf(), "refused"
    yield "cut in half", whole[: len(whole) // 2], "refused"
    yield "cut in its directory", whole[:-30], "refused"
    yield "cut before its last byte", whole[:-1], "refused"
    yield "an archive of nothing", zipped({}), "refused"
    yield "no model", zipped({"readme.txt": "nothing"}), "refused"
    yield "a model of noise", pack_3mf(bytes(range(256))), "refused"
    yield "an empty model", pack_3mf(""), "refused"
    yield "a model cut", pack_3mf(model_3mf()[:-100]), "refused"
    yield "a bomb of 300 megabytes", lambda: zip_of_zeros(MODEL, 300 << 20), "refused"
    yield (
        "a bomb of blanks in the model",
        lambda: zip_of_zeros(MODEL, 64 << 20, model_3mf()[:-8].encode()),
        "refused",
    )
    yield (
        "a wrong checksum",
        zipped({MODEL: model_3mf()}, stored=True).replace(b'x="1.0"', b'x="2.0"', 1),
        "refused",
    )
    yield "a path out of the archive", zipped({"../../3dmodel.model": model_3mf()}), "refused"
    yield "a model called secret", whole.replace(b"\0\0\x08\0", b"\1\0\x08\0"), "either"
    yield "no items", pack_3mf(model_3mf(build="")), "either"
    yield "no objects", pack_3mf(model_3mf("")), "refused"
    yield "an item of no object", pack_3mf(model_3mf(build="<item/>")), "refused"
    yield (
        "an item of a missing object",
        pack_3mf(model_3mf(build='<item objectid="9"/>')),
        "refused",
    )
    yield "an object of itself", pack_3mf(model_3mf(object_3mf(1, parts(1)))), "refused"
    yield (
        "objects in a circle",
        pack_3mf(model_3mf(object_3mf(1, parts(2)) + object_3mf(2, parts(1)))),
        "refused",
    )
    yield "a part of a missing object", pack_3mf(model_3mf(object_3mf(1, parts(9)))), "refused"
    yield "20 levels of two", doubled(20), "refused"
    yield "60 levels of two", doubled(60), "refused"
    yield (
        "a chain of 3000 objects",
        pack_3mf(
            model_3mf(
                object_3mf() + "".join(object_3mf(i + 2, parts(i + 1)) for i in range(3000)),
                '<item objectid="3001"/>',
            )
        ),
        "either",
    )
    yield "20000 items", pack_3mf(model_3mf(build='<item objectid="1"/>' * 20_000)), "refused"
    yield "the same number twice", pack_3mf(model_3mf(object_3mf() + object_3mf())), "either"
    yield "a word as number", pack_3mf(model_3mf(object_3mf("one"))), "refused"
    yield "an unknown unit", pack_3mf(model_3mf(unit="parsec")), "either"
    yield "no unit", pack_3mf(model_3mf(unit=None)), "loaded"
    yield "another name space", pack_3mf(model_3mf(space="http://example.org/")), "either"
    yield "NaN", with_mesh([*CORNERS[:3], ("NaN", 0, 1)]), "refused"
    yield "infinity", with_mesh([*CORNERS[:3], ("INF", 0, 1)]), "refused"
    yield "an exponent of 999", with_mesh([*CORNERS[:3], ("1e999", 0, 1)]), "refused"
    yield "a corner of words", with_mesh([*CORNERS[:3], ("zero", 0, 1)]), "refused"
    yield "underscores in numbers", with_mesh([*CORNERS[:3], ("0", 0, "1_0")]), "refused"
    yield "no corners", with_mesh([]), "refused"
    yield "no triangles", with_mesh(faces=[]), "refused"
    yield "a negative index", with_mesh(faces=[*FACES[:3], (0, 3, -2)]), "refused"
    yield "an index beyond the corners", with_mesh(faces=[*FACES[:3], (0, 3, 4)]), "refused"
    yield "index 2**64 + 2", with_mesh(faces=[*FACES[:3], (0, 3, 2**64 + 2)]), "refused"
    yield "a fraction as index", with_mesh(faces=[*FACES[:3], (0, 3, 2.5)]), "refused"
    yield "no third index", pack_3mf(model_3mf().replace(' v3="2"/></tri', "/></tri")), "refused"
    yield "no x", pack_3mf(model_3mf().replace('x="1.0" ', "")), "refused"
    yield "a transform of 11 numbers", with_transform("1 0 0 0 1 0 0 0 1 0 0"), "refused"
    yield "a transform of NaN", with_transform("nan 0 0 0 1 0 0 0 1 0 0 0"), "refused"
    yield "a transform of zeros", with_transform(" ".join("0" * 12)), "refused"
    yield "a transform of words", with_transform("a b c d e f g h i j k l"), "refused"
    yield "a transform of 1e300", with_transform("1e300 0 0 0 1e300 0 0 0 1e300 0 0 0"), "refused"
    yield "an entity bomb", with_entity(entity_bomb()), "refused"
    yield (
        "a file of the system as entity",
        with_entity(outer_entity("file:///etc/passwd")),
        "refused",
    )
    yield "a device as entity", with_entity(outer_entity("file:///dev/zero")), "refused"
    yield "the network as entity", with_entity(outer_entity("http://127.0.0.1:9/a")), "refused"
    yield "100000 nested elements", pack_3mf(model_3mf(nest("a", 100_000))), "refused"
    yield "UTF-16", pack_3mf(model_3mf(head="").encode("utf-16")), "either"
    yield "UTF-16 called UTF-8", pack_3mf(model_3mf().encode("utf-16-le")), "refused"
    yield "an unknown encoding", pack_3mf(model_3mf().replace("UTF-8", "EBCDIC-9")), "refused"
    yield (
        "a million attributes of nothing",
        lambda: pack_3mf(
            model_3mf("<a " + " ".join(f'b{i}=""' for i in range(100_000)) + "/>" + object_3mf())
        ),
        "either",
    )


def with_dae_entity(kind: str) -> str:
    return dae(head=f'<?xml version="1.0"?>{kind}').replace("<created>", "<created>&bomb;")


def list_dae() -> Iterator[tuple[str, Content, Wants]]:
    whole = dae()
    yield "empty", "", "refused"
    yield "no XML", "solid", "refused"
    yield "cut", whole[:-60], "refused"
    yield "another document", "<html><body/></html>", "refused"
    yield (
        "nothing in it",
        '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"/>',
        "refused",
    )
    yield "no scene", dae(nodes=""), "refused"
    yield "a missing scene", dae(scene="#missing"), "refused"
    yield "a missing body", dae(nodes='<node><instance_geometry url="#x"/></node>'), "refused"
    yield (
        "a body of the network",
        dae(nodes='<node><instance_geometry url="http://127.0.0.1:9/a#g"/></node>'),
        "refused",
    )
    yield (
        "a node of itself",
        dae(nodes='<node id="n"><instance_node url="#n"/><instance_geometry url="#g"/></node>'),
        "refused",
    )
    yield (
        "nodes in a circle",
        dae(
            library='<library_nodes><node id="a"><instance_node url="#b"/></node>'
            '<node id="b"><instance_node url="#a"/></node></library_nodes>',
            nodes='<node><instance_node url="#a"/><instance_geometry url="#g"/></node>',
        ),
        "refused",
    )
    yield (
        "20 levels of two",
        dae(
            library='<library_nodes><node id="n0"><instance_geometry url="#g"/></node>'
            + "".join(
                f'<node id="n{i + 1}">' + f'<instance_node url="#n{i}"/>' * 2 + "</node>"
                for i in range(20)
            )
            + "</library_nodes>",
            nodes='<node><instance_node url="#n20"/></node>',
        ),
        "refused",
    )
    yield "20000 nodes", dae(nodes='<node><instance_geometry url="#g"/></node>' * 20_000), "refused"
    yield (
        "5000 nested nodes",
        dae(nodes=nest("node", 5000, '<instance_geometry url="#g"/>')),
        "either",
    )
    yield "a count of numbers that is wrong", dae(count=99), "either"
    yield "a count of -1", dae(count=-1), "either"
    yield "numbers cut", dae(numbers=range(11)), "refused"
    yield "a corner of words", dae(numbers=["a"] * 12), "refused"
    yield "NaN", dae(numbers=["NaN", *[0.0] * 11]), "refused"
    yield "infinity", dae(numbers=["1e999", *[0.0] * 11]), "refused"
    yield "underscores in numbers", dae(numbers=["1_0", *range(11)]), "refused"
    yield "a stride of 0", dae(stride=0), "either"
    yield "a stride of -3", dae(stride=-3), "either"
    yield "a stride of 10**9", dae(stride=10**9), "either"
    yield (
        "an index beyond the corners",
        dae(indices=[0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 4]),
        "refused",
    )
    yield "a negative index", dae(indices=[0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, -1]), "refused"
    yield "index 2**31", dae(indices=[0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2**31]), "refused"
    yield "index 2**40", dae(indices=[0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2**40]), "refused"
    yield "eleven indices", dae(indices=[0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3]), "refused"
    yield "indices of words", dae(indices=["a"] * 12), "refused"
    yield "no indices", dae(indices=[]), "refused"
    yield "a count of faces that is wrong", dae(faces=10**9), "either"
    yield "corners from nowhere", dae(source="#nowhere"), "refused"
    yield "corners from themselves", dae(source="#v"), "refused"
    yield "a unit of 0", dae(unit='<unit meter="0"/>'), "either"
    yield "a unit of NaN", dae(unit='<unit meter="nan"/>'), "either"
    yield "a unit of -1", dae(unit='<unit meter="-1"/>'), "either"
    yield "a unit of 1e300", dae(unit='<unit meter="1e300"/>'), "either"
    yield "a unit of words", dae(unit='<unit meter="foot"/>'), "either"
    yield (
        "a matrix of 15 numbers",
        dae(nodes=f'<node><matrix>{"1 " * 15}</matrix><instance_geometry url="#g"/></node>'),
        "refused",
    )
    yield (
        "a matrix of NaN",
        dae(nodes=f'<node><matrix>{"nan " * 16}</matrix><instance_geometry url="#g"/></node>'),
        "refused",
    )
    yield (
        "a scale of zero",
        dae(nodes='<node><scale>0 0 0</scale><instance_geometry url="#g"/></node>'),
        "refused",
    )
    yield (
        "a turn about nothing",
        dae(nodes='<node><rotate>0 0 0 90</rotate><instance_geometry url="#g"/></node>'),
        "either",
    )
    yield "an entity bomb", with_dae_entity(entity_bomb()), "refused"
    yield "a file of the system as entity", with_dae_entity(outer_entity("/etc/passwd")), "refused"
    yield "a device as entity", with_dae_entity(outer_entity("/dev/zero")), "refused"
    yield "100000 nested elements", dae(library=nest("a", 100_000)), "refused"
    yield "UTF-16", dae(head="").encode("utf-16"), "either"
    yield "an unknown encoding", dae(head='<?xml version="1.0" encoding="EBCDIC-9"?>'), "refused"
    yield (
        "a picture of a device",
        dae(
            library='<library_images><image id="i"><init_from>/dev/zero</init_from></image>'
            "</library_images>"
        ),
        "either",
    )


def list_cases() -> Iterator[Case]:
    for name, content, wants in list_3mf():
        yield of_files("mesh", f"3MF, {name}", "body.3mf", content, wants)
    for name, content, wants in list_dae():
        yield of_files("mesh", f"COLLADA, {name}", "body.dae", content, wants)
