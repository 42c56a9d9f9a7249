"""STL, in binary and as text."""

from __future__ import annotations

import gzip
import struct
from collections.abc import Iterator

import numpy as np

from .bodies import facet, stl, stl_text, tetrahedra, triangles
from .case import Case, Content, Wants, of_files

WHOLE = stl(triangles())


def with_number(number: float) -> bytes:
    body = triangles()
    body[2, 1, 0] = number
    return stl(body)


def with_word(word: str) -> str:
    return stl_text().replace("1.0", word, 1)


def moebius_strip(parts: int = 60) -> np.ndarray:
    turns = np.linspace(0, 2 * np.pi, parts, endpoint=False)
    across = np.array([-0.3, 0.3])[:, None]
    radius = 1 + across * np.cos(turns / 2)
    edges = np.stack(
        [radius * np.cos(turns), radius * np.sin(turns), across * np.sin(turns / 2)], axis=-1
    )
    low, high = edges
    next_low = np.concatenate([low[1:], high[:1]])
    next_high = np.concatenate([high[1:], low[:1]])
    quads = [np.stack([low, next_low, next_high], 1), np.stack([low, next_high, high], 1)]
    return np.concatenate(quads)


def fan_of_needles(count: int) -> np.ndarray:
    """Triangles about one point, of a micrometer at their far ends."""
    turns = np.arange(count) * 1e-6
    rim = np.stack([np.cos(turns), np.sin(turns), np.zeros(count)], 1)
    return np.stack([np.zeros((count, 3)), rim, np.roll(rim, -1, axis=0)], 1)


def random_soup(count: int) -> np.ndarray:
    return np.random.default_rng(1).uniform(size=(count, 3, 3))


def loose_triangles(count: int) -> np.ndarray:
    """Two balls far apart: as sheets, the triangles are thicker than the balls are wide."""
    rng = np.random.default_rng(2)
    middles = rng.normal(size=(count, 1, 3))
    middles *= 0.05 / np.linalg.norm(middles, axis=2, keepdims=True)
    middles[count // 2 :] += (3, 2, 1)
    return middles + rng.uniform(-0.02, 0.02, (count, 3, 3))


def list_binary() -> Iterator[tuple[str, Content, Wants]]:
    yield "empty", b"", "refused"
    yield "one byte", b"s", "refused"
    yield "a header alone", bytes(80), "refused"
    yield "cut in its count", WHOLE[:83], "refused"
    yield "no triangles", stl(triangles()[:0]), "refused"
    yield "a count without triangles", WHOLE[:84], "refused"
    yield "a count one too high", stl(triangles(), 5), "refused"
    yield "a count one too low", stl(triangles(), 3), "refused"
    yield "a count of 2**32 - 1", stl(triangles(), 2**32 - 1), "refused"
    yield "a count whose length overflows", stl(triangles(), 85899346), "refused"
    yield "cut in a triangle", WHOLE[:-20], "refused"
    yield "cut before its last byte", WHOLE[:-1], "refused"
    yield "bytes after its end", WHOLE + b"more", "either"
    yield "NaN", with_number(np.nan), "refused"
    yield "infinity", with_number(np.inf), "refused"
    yield "the largest float", with_number(3.4e38), "either"
    yield "one far corner", with_number(1e30), "either"
    yield "denormal corners", stl(triangles() * 1e-42), "refused"
    yield "all of it tiny", stl(triangles() * 1e-30), "either"
    yield "all of it huge", stl(triangles() * 1e30), "either"
    yield "far from its origin", stl(triangles() + 1e7), "refused"
    yield "one point", stl(np.zeros((4, 3, 3))), "refused"
    yield "one line", stl(triangles() * (1, 0, 0)), "refused"
    yield "one plane", stl(triangles() * (1, 1, 0)), "either"
    yield "one triangle", stl(triangles()[:1]), "either"
    yield "one triangle 1000 times", stl(np.repeat(triangles()[:1], 1000, axis=0)), "either"
    yield "each triangle twice", stl(np.repeat(triangles(), 2, axis=0)), "either"
    yield (
        "each triangle both ways",
        stl(np.concatenate([triangles(), triangles()[:, ::-1]])),
        ("either"),
    )
    yield "coincident shells", stl(np.tile(triangles(), (3, 1, 1))), "either"
    yield "inside out", stl(triangles()[:, ::-1]), "loaded"
    yield "half turned", stl(np.concatenate([triangles()[:2], triangles()[2:, ::-1]])), "either"
    yield "Moebius strip", stl(moebius_strip()), "either"
    yield "fan of needles", stl(fan_of_needles(300)), "either"
    yield "random soup", stl(random_soup(20)), "either"
    yield "sheets that all cross one another", stl(loose_triangles(400)), "refused"
    yield "1000 components", stl(tetrahedra(1000)), "loaded"
    yield "10000 components", lambda: stl(tetrahedra(10_000)), "loaded"
    yield (
        "2000 shells within each other",
        stl(np.concatenate([triangles() * (1 - i / 4000) for i in range(2000)])),
        "either",
    )
    yield "called solid but binary", stl(triangles(), head=b"solid"), "loaded"
    yield "other byte order", stl(triangles(), order=">"), "refused"
    yield "other order of the count", WHOLE[:80] + struct.pack(">I", 4) + WHOLE[84:], "refused"
    yield "packed by gzip", gzip.compress(WHOLE), "refused"
    yield "a picture", b"\x89PNG\r\n\x1a\n" + bytes(100), "refused"
    yield "a program", b"\x7fELF\2\1\1" + bytes(200), "refused"
    yield "noise", np.random.default_rng(0).bytes(5000), "refused"


def list_text() -> Iterator[tuple[str, Content, Wants]]:
    whole = stl_text()
    yield "solid alone", "solid", "refused"
    yield "no facets", "solid a\nendsolid a\n", "refused"
    yield "cut in a facet", whole[: whole.rindex("endloop")], "refused"
    yield "cut in a number", whole[: whole.rindex("vertex") + 9], "refused"
    yield "without its last line", whole[: whole.index("endsolid")], "either"
    yield "a corner of two numbers", with_word(""), "refused"
    yield "a corner of four numbers", with_word("1.0 2.0"), "refused"
    yield "a corner of words", with_word("one"), "refused"
    yield "nan", with_word("nan"), "refused"
    yield "an exponent of 999", with_word("1e999"), "refused"
    yield "an exponent of -999", with_word("1e-999"), "either"
    yield "10000 digits", with_word("1." + "0" * 10_000), "either"
    yield "a million digits", lambda: with_word("1" * 1_000_000).encode(), "refused"
    yield "commas for points", with_word("1,0"), "refused"
    yield "underscores in numbers", with_word("1_0"), "refused"
    yield "hexadecimal numbers", with_word("0x1p3"), "refused"
    yield "Arabic digits", with_word("\u0661"), "refused"
    yield "exponents of Fortran", with_word("1.0D0"), "refused"
    yield "a facet of four corners", f"solid a\n{facet(*[(0, 0, 0)] * 4)}endsolid\n", "refused"
    yield "a facet of two corners", f"solid a\n{facet(*[(0, 0, 0)] * 2)}endsolid\n", "refused"
    yield "two solids", whole + stl_text(triangles() + 3.0, "other"), "loaded"
    yield "a solid in a solid", whole.replace("endsolid", stl_text() + "endsolid"), "either"
    yield "capital letters", whole.upper(), "loaded"
    yield "UTF-16", whole.encode("utf-16"), "loaded"
    yield "a byte order mark", b"\xef\xbb\xbf" + whole.encode(), "either"
    yield "carriage returns alone", whole.replace("\n", "\r"), "either"
    yield "carriage returns and line feeds", whole.replace("\n", "\r\n"), "loaded"
    yield "NUL between its lines", whole.replace("\n", "\n\0"), "either"
    yield "a name in Latin-1", whole.encode().replace(b"solid body", b"solid b\xf6dy"), "loaded"
    yield "all on one line", whole.replace("\n", " "), "either"
    yield "a line of five megabytes", lambda: ("solid " + " " * 5_000_000).encode(), "refused"
    yield (
        "a name of five megabytes",
        lambda: whole.replace("body", "b" * 2_500_000).encode(),
        ("either"),
    )
    yield "100000 empty loops", lambda: ("solid a\n" + facet() * 100_000).encode(), "refused"
    yield "normals of words", whole.replace("normal 0 0 1", "normal a b c"), "either"


def list_cases() -> Iterator[Case]:
    for name, content, wants in list_binary():
        yield of_files("mesh", f"binary STL, {name}", "body.stl", content, wants)
    for name, content, wants in list_text():
        yield of_files("mesh", f"STL text, {name}", "body.stl", content, wants)
