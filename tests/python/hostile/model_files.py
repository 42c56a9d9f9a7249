"""Model files that are damaged."""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import voxshell as vx

from .bodies import CORNERS, FACES
from .case import Case, Content, Wants, of_files

FRACTIONS = (0.0, 0.001, 0.01, 0.1, 0.5, 0.9, 0.999)


@functools.cache
def sound() -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "body.vxs")
        model = vx.Model.from_mesh((CORNERS, FACES), resolution=8, cache=False, threads=1)
        model.save(path)
        return path.read_bytes()


def later(damage: Callable[[bytes], bytes]) -> Callable[[], bytes]:
    return lambda: damage(sound())


def with_byte(at: int, flip: int = 0xFF) -> Callable[[], bytes]:
    return later(lambda file: file[:at] + bytes([file[at] ^ flip]) + file[at + 1 :])


def list_damage() -> Iterator[tuple[str, Content, Wants]]:
    yield "empty", b"", "refused"
    yield "one byte", later(lambda file: file[:1]), "refused"
    for size in (4, 8, 16, 63, 64, 65, 400, 768):
        yield f"cut after {size} bytes", later(lambda file, size=size: file[:size]), "refused"
    for fraction in FRACTIONS[2:]:
        yield (
            f"cut after {fraction:.1%}",
            later(lambda file, fraction=fraction: file[: int(fraction * len(file))]),
            "refused",
        )
    yield "cut before its last byte", later(lambda file: file[:-1]), "refused"
    yield "a byte after its end", later(lambda file: file + b"\0"), "refused"
    yield "itself twice", later(lambda file: file * 2), "refused"
    yield "zeros", later(lambda file: bytes(len(file))), "refused"
    yield "zeros after its magic", later(lambda file: file[:8] + bytes(len(file) - 8)), "refused"
    yield "ones after its magic", later(lambda f: f[:8] + b"\xff" * (len(f) - 8)), "refused"
    yield "upside down", later(lambda file: file[::-1]), "refused"
    yield (
        "other byte order",
        later(lambda f: b"".join(f[i : i + 4][::-1] for i in range(0, len(f), 4))),
        "refused",
    )
    for at in (0, 8, 12, 16, 24, 32, 40, 64, 72, 80, 88, 96, 500):
        yield f"byte {at} changed", with_byte(at), "refused"
    yield "its last byte changed", with_byte(-64), "refused"
    yield (
        "one bit changed in its middle",
        later(lambda f: f[: len(f) // 2] + bytes([f[len(f) // 2] ^ 1]) + f[len(f) // 2 + 1 :]),
        "refused",
    )
    yield "64 bytes left out", later(lambda f: f[:1024] + f[1088:]), "refused"
    yield "64 bytes too many", later(lambda f: f[:1024] + f[960:]), "refused"
    yield "line feeds made carriage returns", later(lambda f: f.replace(b"\n", b"\r\n")), "refused"
    yield "through UTF-8", later(lambda f: f.decode("latin-1").encode()), "refused"
    yield "a mesh", b"solid a\nendsolid a\n", "refused"


def list_cases() -> Iterator[Case]:
    for name, content, wants in list_damage():
        yield of_files("model", name, "body.vxs", content, wants)
