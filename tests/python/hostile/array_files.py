"""Files of states and recordings, which are archives of arrays, damaged and forged."""

from __future__ import annotations

import functools
import io
import json
import pickle
import struct
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import voxshell as vx

from .bodies import zip_of_zeros, zipped
from .case import Case, Content, of_files

Members = dict[str, bytes]


def make_world() -> vx.World:
    """A ball on a plane, and an arm with a motor."""
    world = vx.World()
    world.add(vx.Plane())
    world.add(vx.Sphere(0.1), pose=(0, 0, 0.1))
    arm = world.add(vx.Box((0.1, 0.02, 0.02)), pose=(1, 0, 1))
    world.add_joint(vx.HingeJoint(), None, arm).set_target_position(0.5, max_force=5.0)
    return world


def save_state(path: Path) -> None:
    world = make_world()
    world.step(10)
    world.save_state().save(path)


def save_recording(path: Path) -> None:
    world = make_world()
    recorder = world.record()
    world.step(10)
    recorder.recording().save(path)


SAVE = {"state": save_state, "recording": save_recording}


@functools.cache
def sound(entrance: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "sound.npz")
        SAVE[entrance](path)
        return path.read_bytes()


def unzipped(entrance: str) -> Members:
    with zipfile.ZipFile(io.BytesIO(sound(entrance))) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def as_file(array: object, *, pickled: bool = False) -> bytes:
    out = io.BytesIO()
    np.lib.format.write_array(out, np.asarray(array), allow_pickle=pickled)
    return out.getvalue()


def claiming(header: str) -> bytes:
    """An array's file with any header, and a few bytes of content."""
    text = header.encode() + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + bytes(64)


def nested(depth: int) -> bytes:
    text = b"[" * depth + b"]" * depth
    return as_file(np.frombuffer(b'{"format": ' + text + b"}", np.uint8))


ARRAYS: dict[str, bytes] = {
    "nothing": b"",
    "a text": b"not an array",
    "no numbers": as_file(np.zeros(0)),
    "one number": as_file(np.float64(3.0)),
    "texts": as_file(np.array(["a", "b"])),
    "complex numbers": as_file(np.ones((2, 2), complex)),
    "records": as_file(np.zeros(3, [("a", "f8"), ("b", "i4")])),
    "a pickle": as_file(np.array([print, 3], object), pickled=True),
    "only a pickle": pickle.dumps([1, 2, 3]),
    "ten dimensions": as_file(np.zeros((1,) * 10)),
    "not a number": as_file(np.full((3, 3), np.nan)),
    "huge numbers": as_file(np.full((3, 3), 1e300)),
    "negative ones": as_file(np.full((3, 3), -1, np.int64)),
    "the largest integers": as_file(np.full((3, 3), 2**64 - 1, np.uint64)),
    "other bytes": as_file(np.ones((3, 3), ">f8")),
    "a trillion rows": claiming(
        "{'descr': '<f8', 'fortran_order': False, 'shape': (10**12, 3)}".replace("10**12", "1" * 12)
    ),
    "a negative size": claiming("{'descr': '<f8', 'fortran_order': False, 'shape': (-1, 3)}"),
    "a size that wraps": claiming(
        f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({2**61}, {2**3})}}"
    ),
    "a header that computes": claiming("{'descr': '<f8', 'shape': (9**9**9,)}"),
    "a header of brackets": claiming("(" * 3000),
    "no header": claiming(""),
    "an unknown type": claiming("{'descr': '|V999999999', 'fortran_order': False, 'shape': (1,)}"),
}
"""What may stand in place of an array."""

HEADERS: dict[str, bytes] = {
    "no JSON": b"{",
    "a list": b"[]",
    "null": b"null",
    "a number": b"1e999",
    "no UTF-8": b"\xff\xfe",
    "nothing": b"",
    "two formats": b'{"format": 1, "format": 2}',
    "digits": b'{"version": ' + b"9" * 5000 + b"}",
}
"""What may stand in place of the header's text."""


def later(entrance: str, damage: Callable[[bytes], bytes]) -> Callable[[], bytes]:
    return lambda: damage(sound(entrance))


def forged(entrance: str, change: Callable[[Members], object]) -> Callable[[], bytes]:
    """The sound file with other members."""

    def make() -> bytes:
        members = unzipped(entrance)
        change(members)
        return zipped(dict(members), stored=True)

    return make


def with_header(entrance: str, change: dict[str, object]) -> Callable[[], bytes]:
    def make(members: Members) -> None:
        text = np.load(io.BytesIO(members["header.npy"])).tobytes()
        content = json.dumps({**json.loads(text), **change}).encode()
        members["header.npy"] = as_file(np.frombuffer(content, np.uint8))

    return forged(entrance, make)


def list_forged(entrance: str) -> Iterator[tuple[str, Content]]:
    for member in unzipped(entrance):
        if member.startswith(("body1", "body2")):
            continue  # as the first body
        yield f"without {member}", forged(entrance, lambda m, it=member: m.pop(it))
        for what, array in ARRAYS.items():
            yield (
                f"{what} as {member}",
                forged(entrance, lambda m, it=member, a=array: m.update({it: a})),
            )
    for what, text in HEADERS.items():
        header = as_file(np.frombuffer(text, np.uint8))
        yield (
            f"{what} as the header's text",
            forged(entrance, lambda m, h=header: m.update({"header.npy": h})),
        )
    for depth in (100, 100_000):
        header = nested(depth)
        yield (
            f"{depth} lists in the header",
            forged(entrance, lambda m, h=header: m.update({"header.npy": h})),
        )
    for change in ({"format": "x"}, {"version": 10**9}, {"version": None}, {"unknown": 1}):
        yield f"a header with {json.dumps(change)}", with_header(entrance, change)
    for name in ("../../outside.npy", "/tmp/outside.npy", "a" * 5000 + ".npy", "more.npy"):
        yield (
            f"a member {name[:20]!r} more",
            forged(entrance, lambda m, it=name: m.update({it: as_file(1.0)})),
        )


def list_damaged(entrance: str) -> Iterator[tuple[str, Content]]:
    yield "empty", b""
    yield "one byte", later(entrance, lambda file: file[:1])
    for fraction in (0.01, 0.1, 0.5, 0.9, 0.999):
        yield (
            f"cut after {fraction:.1%}",
            later(entrance, lambda f, it=fraction: f[: int(it * len(f))]),
        )
    yield "itself twice", later(entrance, lambda file: file * 2)
    yield "zeros", later(entrance, lambda file: bytes(len(file)))
    yield "upside down", later(entrance, lambda file: file[::-1])
    yield "through UTF-8", later(entrance, lambda file: file.decode("latin-1").encode())
    yield "the bytes of a model", b"VOXSHELL" + bytes(500)
    yield "an archive of nothing", zipped({})
    yield "an archive of a text", zipped({"readme.txt": "hello"})
    yield "an archive within an archive", lambda: zipped({"header.npy": sound(entrance)})
    yield "1 GiB of zeros", lambda: zip_of_zeros("bodies.npy", 1 << 30)
    yield "1 GiB of zeros as its header", lambda: zip_of_zeros("header.npy", 1 << 30)


def list_cases() -> Iterator[Case]:
    for entrance in SAVE:
        for name, content in (*list_damaged(entrance), *list_forged(entrance)):
            yield of_files(entrance, name, "saved.npz", content)
