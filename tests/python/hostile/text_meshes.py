"""OBJ and OFF."""

from __future__ import annotations

from collections.abc import Iterator

from .bodies import CORNERS, FACES, obj, off
from .case import Case, Content, Wants, of_files

FAN = [(i % 7 * 0.1, i % 11 * 0.1, i % 13 * 0.1) for i in range(1001)]


def with_face(face: str) -> str:
    return obj(faces=FACES[:3], after=f"f {face}\n")


def with_corner(corner: str) -> str:
    return obj().replace("v 1.0 0.0 0.0", f"v {corner}")


def list_obj() -> Iterator[tuple[str, Content, Wants]]:
    whole = obj()
    yield "empty", "", "refused"
    yield "comments alone", "# nothing\n" * 100, "refused"
    yield "corners alone", obj(faces=[]), "refused"
    yield "faces alone", "f 1 2 3\n", "refused"
    yield "lines and points alone", obj(faces=[], after="l 1 2\np 3\n"), "refused"
    yield (
        "curves and surfaces",
        obj(faces=[], after="cstype bezier\ncurv 0 1 1 2\nend\n"),
        "refused",
    )
    yield "faces before corners", "\n".join(reversed(whole.splitlines())) + "\n", "either"
    yield "index 0", with_face("0 1 2"), "refused"
    yield "an index beyond the corners", with_face("1 4 5"), "refused"
    yield "indices from the end", with_face("-4 -1 -2"), "loaded"
    yield "an index before the corners", with_face("-5 -1 -2"), "refused"
    yield "index 2**31", with_face(f"1 4 {2**31}"), "refused"
    yield "index 2**32 + 3", with_face(f"1 4 {2**32 + 3}"), "refused"
    yield "index 2**63", with_face(f"1 4 {2**63}"), "refused"
    yield "index 2**64 + 3", with_face(f"1 4 {2**64 + 3}"), "refused"
    yield "index -2**63", with_face(f"1 4 {-(2**63)}"), "refused"
    yield "an index of 10000 digits", with_face("1 4 " + "3" * 10_000), "refused"
    yield "a fraction as index", with_face("1 4 3.5"), "refused"
    yield "underscores in an index", with_face("1 4 0_3"), "refused"
    yield "Arabic digits as index", with_face("1 4 \u0663"), "refused"
    yield "a word as index", with_face("1 four 3"), "refused"
    yield "a face of one corner", with_face("1"), "either"
    yield "a face of two corners", with_face("1 2"), "either"
    yield "a face without corners", with_face(""), "either"
    yield "the same corner three times", with_face("1 1 1"), "either"
    yield "a texture index of words", with_face("1/a 4/b 3/c"), "either"
    yield "normals beyond their list", with_face("1//9 4//9 3//9"), "either"
    yield "four indices a corner", with_face("1/1/1/1 4/1/1/1 3/1/1/1"), "either"
    yield "a face of 1001 corners", obj(FAN, [range(1001)]), "refused"
    yield (
        "a face of a million corners",
        lambda: with_face(" 1" * 1_000_000).encode(),
        "refused",
    )
    yield "nan", with_corner("nan 0 0"), "refused"
    yield "infinity", with_corner("inf 0 0"), "refused"
    yield "an exponent of 400", with_corner("1e400 0 0"), "refused"
    yield "beyond single precision", with_corner("1e200 0 0"), "either"
    yield "a corner of two numbers", with_corner("1.0 0.0"), "refused"
    yield "a corner of one number", with_corner("1.0"), "refused"
    yield "a corner of 1000 numbers", with_corner("1 " * 1000), "either"
    yield "a corner of words", with_corner("one zero zero"), "refused"
    yield "underscores in numbers", with_corner("1_0 0 0"), "refused"
    yield "commas for points", with_corner("1,0 0,0 0,0"), "refused"
    yield "a corner continued on the next line", with_corner("1.0 \\\n0.0 0.0"), "either"
    yield "UTF-16", whole.encode("utf-16"), "either"
    yield "a byte order mark", b"\xef\xbb\xbf" + whole.encode(), "either"
    yield "carriage returns alone", whole.replace("\n", "\r"), "either"
    yield "NUL in a line", whole.replace("v 1", "v\0001", 1), "either"
    yield "NUL after its end", whole + "\0" * 1000, "either"
    yield "Latin-1 in a name", b"o b\xf6dy\n" + whole.encode(), "loaded"
    yield "cut in a corner", whole[: whole.index("v 0.0 1.0") + 5], "refused"
    yield "cut in a face", whole[: whole.rindex(" ")], "either"
    yield "a command of the shell", "csh rm -rf nowhere\ncall other.obj\n" + whole, "either"
    yield (
        "10000 groups of one face",
        lambda: obj(faces=[], after="".join(f"g g{i}\nf 1 2 3\n" for i in range(10_000))).encode(),
        "either",
    )
    yield (
        "10000 unknown materials",
        lambda: obj(
            after="".join(f"usemtl m{i}\nf 1 3 2\n" for i in range(10_000)),
        ).encode(),
        "either",
    )
    yield "a line of five megabytes", lambda: ("v" + " 1" * 2_500_000).encode(), "refused"


MATERIALS = {
    "a missing file": ("missing.mtl", {}),
    "itself": ("body.obj", {}),
    "a device without end": ("/dev/zero", {}),
    "a file of the system": ("../../../../../../etc/passwd", {}),
    "noise": ("noise.mtl", {"noise.mtl": bytes(range(256)) * 20}),
    "a texture that is a device": (
        "dev.mtl",
        {"dev.mtl": "newmtl m\nKd 1 1 1\nmap_Kd /dev/zero\n"},
    ),
    "a texture that is noise": (
        "noise.mtl",
        {"noise.mtl": "newmtl m\nmap_Kd noise.png\n", "noise.png": b"\x89PNG" + bytes(100)},
    ),
    "colors of words": ("words.mtl", {"words.mtl": "newmtl m\nKd red green\nd\nNs x\n"}),
}


def list_off() -> Iterator[tuple[str, Content, Wants]]:
    whole = off()
    yield "empty", "", "refused"
    yield "its name alone", "OFF\n", "refused"
    yield "its counts alone", "OFF\n4 4 0\n", "refused"
    yield "comments alone", "OFF\n# a\n# b\n", "refused"
    yield "other name", off(head="MESH"), "refused"
    yield "binary by its name", off(head="OFF BINARY"), "refused"
    yield "four dimensions", off(head="4OFF"), "refused"
    yield "colors by its name alone", off(head="COFF"), "either"
    yield "counts on the first line", "OFF 4 4 0\n" + whole.split("\n", 2)[2], "either"
    yield "negative counts", off(counts="-4 -4 0"), "refused"
    yield "a negative count of faces", off(counts="4 -1 0"), "refused"
    yield "no corners", off(counts="0 4 0"), "refused"
    yield "no faces", off(counts="4 0 0"), "refused"
    yield "2**31 corners", off(counts=f"{2**31} 4 0"), "refused"
    yield "2**64 + 4 corners", off(counts=f"{2**64 + 4} 4 0"), "refused"
    yield "1e18 faces", off(counts=f"4 {10**18} 0"), "refused"
    yield "fractions as counts", off(counts="4.5 4.5 0"), "refused"
    yield "words as counts", off(counts="four four none"), "refused"
    yield "one count", off(counts="4"), "refused"
    yield "a corner too few", off(counts="5 4 0"), "refused"
    yield "a face too few", off(counts="4 5 0"), "refused"
    yield "a face more than its count", off(counts="4 3 0"), "either"
    yield "cut in a face", whole[:-3], "refused"
    yield "cut in a corner", whole[: whole.index("0.0 1.0 0.0") + 6], "refused"
    yield "nan", whole.replace("1.0", "nan", 1), "refused"
    yield "infinity", whole.replace("1.0", "-inf", 1), "refused"
    yield "underscores in numbers", whole.replace("1.0", "1_0", 1), "refused"
    yield "a corner of words", whole.replace("1.0", "one", 1), "refused"
    yield "an index beyond the corners", off(faces=[*FACES[:3], (0, 3, 4)]), "refused"
    yield "a negative index", off(faces=[*FACES[:3], (0, 3, -2)]), "refused"
    yield "index 2**32 + 2", off(faces=[*FACES[:3], (0, 3, 2**32 + 2)]), "refused"
    yield "a fraction as index", whole.replace("3 0 3 2", "3 0 3 2.5"), "refused"
    yield "a face of no corners", whole.replace("3 0 3 2", "0"), "either"
    yield "a face of minus three corners", whole.replace("3 0 3 2", "-3 0 3 2"), "refused"
    yield "a face of a billion corners", whole.replace("3 0 3 2", "1000000000 0 3 2"), "refused"
    yield "a face of two corners", whole.replace("3 0 3 2", "2 0 3"), "either"
    yield "a face of 1001 corners", off(FAN, [range(1001)]), "refused"
    yield "faces with colors", whole.replace("3 0 3 2", "3 0 3 2 255 0 0"), "loaded"
    yield "faces with colors of words", whole.replace("3 0 3 2", "3 0 3 2 red"), "either"
    yield "UTF-16", whole.encode("utf-16"), "either"
    yield "a byte order mark", b"\xef\xbb\xbf" + whole.encode(), "either"
    yield "carriage returns and line feeds", whole.replace("\n", "\r\n"), "loaded"
    yield "NUL between its lines", whole.replace("\n", "\n\0"), "either"
    yield "Latin-1 in a comment", b"OFF\n# b\xf6dy\n" + whole.encode()[4:], "either"
    yield "corners of a second file after its end", whole + whole, "either"


def list_cases() -> Iterator[Case]:
    for name, content, wants in list_obj():
        yield of_files("mesh", f"OBJ, {name}", "body.obj", content, wants)
    for name, (file, others) in MATERIALS.items():
        text = obj([(*corner, 0.5, 0.5) for corner in CORNERS], before=f"mtllib {file}\nusemtl m\n")
        yield of_files("mesh", f"OBJ, materials of {name}", "body.obj", text, "either", others)
    for name, content, wants in list_off():
        yield of_files("mesh", f"OFF, {name}", "body.off", content, wants)
