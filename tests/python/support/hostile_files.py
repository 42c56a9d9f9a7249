"""Malformed model files, made from a sound one: the kept corpus is this generator.

Written from the description of the format alone, checksum included, so that a reader and a writer
that are wrong in the same way do not agree with it.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

HEADER = 64
ENTRY = 32
NAMES = (
    "record",
    "vertices",
    "triangles",
    "brick entries",
    "samples",
    "planes",
    "points",
    "normals",
    "areas",
    "spheres",
    "sphere blocks",
    "bricks with exact cells",
    "masks of exact cells",
    "lists of exact cells",
    "listed triangles",
    "exact triangles",
    "feature normals",
    "edge middles",
    "edge halves",
    "edge normals",
    "edge spheres",
    "edge sphere blocks",
)
TABLE_END = -(-(HEADER + ENTRY * len(NAMES)) // 64) * 64

_MASK = 2**64 - 1
_P1, _P2, _P3 = 0x9E3779B185EBCA87, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9
_P4, _P5 = 0x85EBCA77C2B2AE63, 0x27D4EB2F165667C5


@dataclass(frozen=True)
class Section:
    """One line of a file's table."""

    kind: int
    item_size: int
    offset: int
    count: int

    @property
    def end(self) -> int:
        return self.offset + self.item_size * self.count


def xxh64(data: bytes) -> int:
    """With seed 0, of whole stripes of 32 bytes."""

    def turn(value: int, bits: int) -> int:
        return (value << bits | value >> (64 - bits)) & _MASK

    def mix(lane: int, word: int) -> int:
        return turn((lane + word * _P2) & _MASK, 31) * _P1 & _MASK

    lanes = [(_P1 + _P2) & _MASK, _P2, 0, -_P1 & _MASK]
    words = struct.unpack(f"<{len(data) // 8}Q", data)
    for i in range(4):
        lane = lanes[i]
        for word in words[i::4]:
            lane = (lane + word * _P2) & _MASK
            lane = (lane << 31 | lane >> 33) * _P1 & _MASK
        lanes[i] = lane
    if data:
        turned = [turn(lane, n) for lane, n in zip(lanes, (1, 7, 12, 18), strict=True)]
        value = sum(turned) & _MASK
        for lane in lanes:
            value = ((value ^ mix(0, lane)) * _P1 + _P4) & _MASK
    else:
        value = _P5
    value = (value + len(data)) & _MASK
    value = (value ^ value >> 33) * _P2 & _MASK
    value = (value ^ value >> 29) * _P3 & _MASK
    return value ^ value >> 32


def read_table(file: bytes) -> list[Section]:
    return [
        Section(*struct.unpack_from("<IIQQ", file, HEADER + ENTRY * i)) for i in range(len(NAMES))
    ]


def sealed(file: bytes) -> bytes:
    """With the right checksum, where the file is long enough to have one."""
    if len(file) < HEADER:
        return file
    whole = file[32 : 32 + (len(file) - 32) // 32 * 32]
    return file[:8] + struct.pack("<Q", xxh64(whole)) + file[16:]


def patched(file: bytes, offset: int, form: str, value: float) -> bytes:
    patch = struct.pack("<" + form, value)
    return sealed(file[:offset] + patch + file[offset + len(patch) :])


def resized(file: bytes) -> bytes:
    """That says of itself to be as long as it is."""
    return patched(file, 40, "Q", len(file)) if len(file) >= 48 else file


def hostile_files(file: bytes) -> Iterator[tuple[str, bytes]]:
    """(what is wrong, bytes) of a few hundred files."""
    yield from _ends(file)
    yield from _headers(file)
    yield from _tables(file)
    yield from _contents(file)


def _ends(file: bytes) -> Iterator[tuple[str, bytes]]:
    for size in (0, 1, 7, 8, 15, 16, 31, 32, 47, 48, 63, 64, 96, TABLE_END - 1, TABLE_END):
        yield f"ends after {size} bytes", file[:size]
    for section, name in zip(read_table(file), NAMES, strict=True):
        middle = (section.offset + section.end) // 2
        for where, size in (("before", section.offset), ("in", middle), ("after", section.end)):
            if size < len(file):
                yield f"ends {where} its {name}", file[:size]
                yield f"ends {where} its {name}, as if meant", resized(file[:size])
    yield "goes on for a byte", file + b"\0"
    yield "goes on for 64 bytes, as if meant", resized(file + bytes(64))
    yield "is there twice, as if meant", resized(file + file)
    yield "has nothing but zeros", bytes(len(file))
    yield "has nothing but ones", b"\xff" * len(file)
    yield "is a text", b"solid part\nendsolid part\n" * 1000
    yield "went through a change of line ends", file.replace(b"\r\n", b"\n")


def _headers(file: bytes) -> Iterator[tuple[str, bytes]]:
    for i in range(8):
        yield f"has another magic byte {i}", patched(file, i, "B", file[i] ^ 0x20)
    yield "has another checksum", file[:8] + bytes(8) + file[16:]
    for i in (16, 24, 48, 56):
        yield f"has a bit set at {i}", patched(file, i, "Q", 1 << 63)
    for version in (0, 1, 3, 255, 2**32 - 1):
        yield f"has version {version}", patched(file, 32, "I", version)
    for count in (0, 1, len(NAMES) - 1, len(NAMES) + 1, 2**32 - 1):
        yield f"has {count} sections", patched(file, 36, "I", count)
    for size in (0, 1, len(file) - 1, len(file) + 1, 2**32, 2**63, 2**64 - 1):
        yield f"says it has {size} bytes", patched(file, 40, "Q", size)


def _tables(file: bytes) -> Iterator[tuple[str, bytes]]:
    sections = read_table(file)
    for i, (section, name) in enumerate(zip(sections, NAMES, strict=True)):
        at = HEADER + ENTRY * i
        other = sections[(i + 1) % len(sections)]
        for kind in (0, other.kind, 2**32 - 1):
            yield f"says kind {kind} of its {name}", patched(file, at, "I", kind)
        for size in (0, section.item_size + 1, 2**31, 2**32 - 1):
            yield f"says item size {size} of its {name}", patched(file, at + 4, "I", size)
        for offset in {0, other.offset, section.offset + 1, 2**63, 2**64 - 64} - {section.offset}:
            yield f"says offset {offset} of its {name}", patched(file, at + 8, "Q", offset)
        for count in (section.count + 100, 2**32, 2**40, 2**60, 2**63, 2**64 - 1):
            yield f"says {count} {name}", patched(file, at + 16, "Q", count)
        yield f"has a bit set in the line of its {name}", patched(file, at + 24, "Q", 1)
        if section.end % 64:
            yield f"has a bit set after its {name}", patched(file, section.end, "B", 1)


def _contents(file: bytes) -> Iterator[tuple[str, bytes]]:
    by_name = dict(zip(NAMES, read_table(file), strict=True))
    nan, infinity = float("nan"), float("inf")

    def changed(name: str, index: int, offset: int, form: str, value: float) -> tuple[str, bytes]:
        section = by_name[name]
        at = section.offset + section.item_size * index + offset
        return f"has {value} at {offset} of {name}[{index}]", patched(file, at, form, value)

    record = by_name["record"]
    for i in range(record.item_size // 8):
        if i in (2, 4, 6, 7, 13, 14, 15, 22, 28, *range(30, 36), 45, 47, 53, 64):
            continue  # integers
        yield changed("record", 0, 8 * i, "d", nan)
        yield changed("record", 0, 8 * i, "d", infinity)
    for i in (6, 7, 28, 30, 64):
        for choice in (3, -1, 2**40):
            yield changed("record", 0, 8 * i, "q", choice)
    for i in (13, 14, 15):
        for bricks in (0, -1, 2, 2**20, 2**31, 2**63 - 1):
            yield changed("record", 0, 8 * i, "q", bricks)
    for quanta in (0, -1, 255, 2**20, 2**63 - 1):
        yield changed("record", 0, 8 * 22, "q", quanta)
    for name, width in (
        ("points", 3),
        ("normals", 3),
        ("areas", 1),
        ("spheres", 4),
        ("sphere blocks", 1),
    ):
        last = by_name[name].count - 1
        for column in range(width):
            for value in (nan, infinity, -infinity, -3e38):
                yield changed(name, last, 4 * column, "f", value)
    for column in range(3):
        for value in (nan, infinity, 1e300):
            yield changed("vertices", 0, 8 * column, "d", value)
        for index in (by_name["vertices"].count, 2**31, 2**32 - 1):
            yield changed("triangles", 0, 4 * column, "I", index)
    for entry in (2**32 - 1, 2**32 - 5, 0x80000003, 4, 0xFFFFFF84):
        yield changed("brick entries", 0, 0, "I", entry)
