"""PLY, as text and in both byte orders."""

from __future__ import annotations

import struct
from collections.abc import Iterator

import numpy as np

from .bodies import CORNERS, FACES, ply, ply_data, ply_header, ply_text
from .case import Case, Content, Wants, of_files

POINT = "property float x\nproperty float y\nproperty float z\n"


def with_last_face(face: bytes, **header: object) -> bytes:
    return ply(data=ply_data(faces=FACES[:3]) + face, **header)


def list_headers() -> Iterator[tuple[str, Content, Wants]]:
    whole = ply_text()
    yield "empty", "", "refused"
    yield "its name alone", "ply\n", "refused"
    yield "cut in its header", whole[:60], "refused"
    yield "no end of its header", whole.replace("end_header\n", ""), "refused"
    yield "no format", whole.replace("format ascii 1.0\n", ""), "refused"
    yield "an unknown format", whole.replace("ascii", "middle_endian"), "refused"
    yield "version 2.0", whole.replace("1.0\n", "2.0\n", 1), "either"
    yield (
        "two formats",
        whole.replace("element", "format binary_big_endian 1.0\nelement", 1),
        ("refused"),
    )
    yield "other name", whole.replace("ply", "pl7", 1), "refused"
    yield "-1 corners", ply_text(vertices=-1), "refused"
    yield "-1 faces", ply_text(faces=-1), "refused"
    yield "no corners", ply_text(vertices=0), "refused"
    yield "no faces", ply_text(faces=0), "refused"
    yield "a corner too few", ply_text(vertices=5), "refused"
    yield "a corner more than its count", ply_text(vertices=3), "refused"
    yield "a face too few", ply_text(faces=5), "refused"
    yield "a face more than its count", ply_text(faces=3), "either"
    yield "2**31 corners", ply_text(vertices=2**31), "refused"
    yield "2**63 corners", ply_text(vertices=2**63), "refused"
    yield "2**64 + 4 corners", ply_text(vertices=2**64 + 4), "refused"
    yield "1e3 corners", ply_text(vertices="1e3"), "refused"
    yield "a word as count", ply_text(vertices="four"), "refused"
    yield "no count", ply_text(vertices=""), "refused"
    yield "underscores in a count", ply_text(vertices="0_4"), "either"
    yield "no properties of corners", ply_text(point=""), "refused"
    yield "no z", ply_text(point="property float x\nproperty float y\n"), "refused"
    yield "x twice", ply_text(point="property float x\n" + POINT.replace(" z", " x")), "refused"
    yield "x as a list", ply_text(point=POINT.replace("float x", "list uchar float x")), "refused"
    yield "an unknown type", ply_text(point=POINT.replace("float x", "quaternion x")), "refused"
    yield "no type", ply_text(point=POINT.replace("float x", "x")), "refused"
    yield "corners of bytes", ply_text(point=POINT.replace("float", "uchar")), "either"
    yield "corners of integers", ply_text(point=POINT.replace("float", "int")), "either"
    yield "no property of faces", ply_text(listed=""), "refused"
    yield (
        "faces of an unknown property",
        ply_text(listed="property list uchar int rows\n"),
        "refused",
    )
    yield "indices that are no list", ply_text(listed="property int vertex_indices\n"), "refused"
    yield (
        "a property before any element",
        whole.replace("element", "property int a\nelement", 1),
        ("refused"),
    )
    yield (
        "two lists of corners",
        whole.replace("element face", f"element vertex 4\n{POINT}element face"),
        "refused",
    )
    yield (
        "an element without properties, 10**12 times",
        whole.replace("element vertex", f"element nothing {10**12}\nelement vertex"),
        "either",
    )
    yield (
        "an element of 10**12 rows",
        whole.replace("element vertex", f"element other {10**12}\nproperty int a\nelement vertex"),
        "refused",
    )
    yield (
        "100000 lines of comments",
        lambda: ply_text(before="comment a\n" * 100_000).encode(),
        ("either"),
    )
    yield (
        "10000 properties",
        ply_text(point=POINT + "".join(f"property float p{i}\n" for i in range(10_000))),
        "refused",
    )
    yield (
        "10000 elements",
        ply_text(before="".join(f"element e{i} 0\nproperty int a\n" for i in range(10_000))),
        "either",
    )
    yield (
        "a header line of a megabyte",
        ply_text(before="comment " + "a" * 1_000_000 + "\n"),
        ("either"),
    )
    yield "a texture that is a device", ply_text(before="comment TextureFile /dev/zero\n"), "either"
    yield (
        "a texture of the system",
        ply_text(before="comment TextureFile ../../../../../../etc/passwd\n"),
        "either",
    )
    yield (
        "Latin-1 in a comment",
        ply_text(before="comment X\n").encode().replace(b"X", b"\xf6"),
        ("either"),
    )
    yield "UTF-16", whole.encode("utf-16"), "refused"
    yield "a byte order mark", b"\xef\xbb\xbf" + whole.encode(), "either"
    yield "carriage returns alone", whole.replace("\n", "\r"), "either"
    yield "carriage returns and line feeds", whole.replace("\n", "\r\n"), "either"
    yield "nan", whole.replace("0.0 1.0 0.0\n", "0.0 nan 0.0\n"), "refused"
    yield "an exponent of 999", whole.replace("0.0 1.0 0.0\n", "0.0 1e999 0.0\n"), "refused"
    yield "underscores in numbers", whole.replace("0.0 1.0 0.0\n", "0.0 1_0 0.0\n"), "refused"
    yield "a corner of words", whole.replace("0.0 1.0 0.0\n", "0.0 one 0.0\n"), "refused"
    yield "a corner of two numbers", whole.replace("0.0 1.0 0.0\n", "0.0 1.0\n"), "refused"
    yield "an index beyond the corners", whole.replace("3 0 3 2", "3 0 3 4"), "refused"
    yield "a negative index", whole.replace("3 0 3 2", "3 0 3 -2"), "refused"
    yield "a fraction as index", whole.replace("3 0 3 2", "3 0 3 2.5"), "refused"
    yield "a face of two corners", whole.replace("3 0 3 2", "2 0 3"), "either"
    yield "a face of no corners", whole.replace("3 0 3 2", "0"), "either"
    yield "a face of -3 corners", whole.replace("3 0 3 2", "-3 0 3 2"), "refused"
    yield "a face of more than it has", whole.replace("3 0 3 2", "9 0 3 2"), "refused"
    yield "NUL in its header", whole.replace("ascii", "asc\0ii"), "refused"


def list_binary() -> Iterator[tuple[str, Content, Wants]]:
    whole, start = ply(), len(ply(data=b""))
    yield "cut after its header", whole[:start], "refused"
    yield "cut in its corners", whole[: start + 20], "refused"
    yield "cut in its faces", whole[:-5], "refused"
    yield "cut before its last byte", whole[:-1], "refused"
    yield "bytes after its end", whole + b"more", "either"
    yield "the other byte order, little", ply("<", ply_data(">")), "refused"
    yield "the other byte order, big", ply(">", ply_data("<")), "refused"
    yield "big endian", ply(">"), "loaded"
    yield "big endian, cut in its faces", ply(">")[:-5], "refused"
    yield "2**31 corners", ply(vertices=2**31), "refused"
    yield "2**62 faces", ply(faces=2**62), "refused"
    yield "-4 corners", ply(vertices=-4), "refused"
    yield "10**12 rows without properties", ply(before=f"element nothing {10**12}\n"), "either"
    yield "a face of 255 corners", with_last_face(b"\xff" + bytes(12)), "refused"
    yield "a face of no corners", with_last_face(b"\0"), "either"
    yield (
        "a face of 2**32 - 1 corners",
        with_last_face(b"", listed="property list uint int vertex_indices\n"),
        "refused",
    )
    yield (
        "faces of a negative number of corners",
        ply(
            data=ply_data(faces=[]) + struct.pack("<b3i", -3, 0, 3, 2) * 4,
            listed="property list char int vertex_indices\n",
        ),
        "refused",
    )
    yield (
        "numbers of corners that are fractions",
        ply(
            data=ply_data(faces=[]) + b"".join(struct.pack("<f3i", 3.5, *face) for face in FACES),
            listed="property list float int vertex_indices\n",
        ),
        "refused",
    )
    yield (
        "indices that are fractions",
        ply(
            data=ply_data(faces=[])
            + b"".join(struct.pack("<B3f", 3, *(i + 0.5 for i in face)) for face in FACES),
            listed="property list uchar float vertex_indices\n",
        ),
        "refused",
    )
    yield "an index beyond the corners", with_last_face(struct.pack("<B3i", 3, 0, 3, 4)), "refused"
    yield "a negative index", with_last_face(struct.pack("<B3i", 3, 0, 3, -1)), "refused"
    yield "the largest index", with_last_face(struct.pack("<B3I", 3, 0, 3, 2**32 - 1)), "refused"
    yield (
        "NaN",
        ply(data=ply_data(corners=[*CORNERS[:3], (np.nan, 0.0, 1.0)])),
        "refused",
    )
    yield (
        "a header of carriage returns and line feeds",
        (ply(data=b"").replace(b"\n", b"\r\n") + ply_data()),
        "either",
    )
    yield "no end of its header", whole.replace(b"end_header\n", b""), "refused"
    yield (
        "65535 faces of 255 corners",
        lambda: ply(faces=65535, data=ply_data(faces=[]) + (b"\xff" + bytes(1020)) * 65535),
        "refused",
    )
    yield "text called binary", ply_header("binary_little_endian") + ply_text()[-60:], "refused"


def list_cases() -> Iterator[Case]:
    for name, content, wants in list_headers():
        yield of_files("mesh", f"PLY text, {name}", "body.ply", content, wants)
    for name, content, wants in list_binary():
        yield of_files("mesh", f"binary PLY, {name}", "body.ply", content, wants)
