"""Hostile inputs without number: cases of the corpus with random damage, and requests to the viewer."""

from __future__ import annotations

import dataclasses
import io
import struct
import zipfile
import zlib
from pathlib import Path

import numpy as np

from .assumptions import sealed
from .bodies import zipped
from .case import Case
from .corpus import list_cases

MOST_BYTES = 200_000
"""Of a file that is mutated: larger ones only take time."""

MOST_STEPS = 200
"""Of a scene: longer ones are slow as they should be."""

TOKENS = (
    *(b"nan", b"-inf", b"1e999", b"-1", b"0", b"1e-320", b"2147483648", b"4294967296", b"1_0"),
    *(b"18446744073709551616", b"-9223372036854775808", b"true", b"null", b'""', b"[]", b"{}"),
    *(b"\0", b"\xff\xfe", b"\xed\xa0\x80", b"9" * 400, b"../../../etc/passwd", b"/dev/zero"),
    *(b"<", b">", b"&x;", b"'", b'"', b"]", b"}", b"\n", b"\r", b"#", b"%s%n", b"a" * 5000),
)


def mutate(content: bytes, rng: np.random.Generator) -> bytes:
    """A few bytes, words or lines changed, left out, repeated or swapped."""
    data = bytearray(content)
    for _ in range(rng.integers(1, 5)):
        if not data:
            return b""
        at = int(rng.integers(len(data)))
        length = int(rng.integers(1, 64))
        match rng.integers(9):
            case 0:
                data[at] = rng.integers(256)
            case 1:
                data[at] ^= 1 << int(rng.integers(8))
            case 2:
                del data[at : at + length]
            case 3:
                data[at:at] = data[at : at + length]
            case 4:
                del data[at:]
            case 5:
                number = int(rng.choice([0, 1, 2**31 - 1, 2**31, 2**32 - 1, 255, 65535]))
                data[at : at + 4] = struct.pack("<I", number)
            case 6:
                replace_word(data, at, rng)
            case 7:
                swap_lines(data, rng)
            case _:
                other = int(rng.integers(len(data)))
                data[at : at + length] = data[other : other + length]
    return bytes(data)


def replace_word(data: bytearray, at: int, rng: np.random.Generator) -> None:
    """The word about a place, by something that readers trip over."""
    ends = b" \t\r\n<>\"'=,:[]{}/"
    begin = end = at
    while begin > 0 and data[begin - 1] not in ends:
        begin -= 1
    while end < len(data) and data[end] not in ends:
        end += 1
    data[begin:end] = TOKENS[rng.integers(len(TOKENS))]


def swap_lines(data: bytearray, rng: np.random.Generator) -> None:
    lines = bytes(data).split(b"\n")
    a, b = rng.integers(len(lines), size=2)
    lines[a], lines[b] = lines[b], lines[a]
    data[:] = b"\n".join(lines)


def mutate_archive(content: bytes, rng: np.random.Generator) -> bytes:
    """The texts in an archive, which random bytes of it would hardly reach."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            sizes = sum(member.file_size for member in archive.infolist())
            if sizes > MOST_BYTES:
                return content
            files = {name: archive.read(name) for name in archive.namelist()}
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, zlib.error):
        return mutate(content, rng)
    return zipped({name: mutate(file, rng) for name, file in files.items()})


def takes_long(scene: bytes) -> bool:
    """Whether a sound scene asks for many steps."""
    from voxshell.base.settings import parse_toml

    try:
        world = parse_toml(scene.decode())["scene"]
        return float(world.get("duration", 2)) * float(world.get("rate", 200)) > MOST_STEPS
    except Exception:  # it is damaged, and refused at once
        return False


def write_mutated(case: Case, folder: Path, rng: np.random.Generator) -> Path:
    """Writes a case's files, and damages the one that is opened."""
    case.write(folder)
    path = folder / case.file
    if not path.is_file() or path.is_symlink() or path.stat().st_size > MOST_BYTES:
        return path
    content = path.read_bytes()
    if path.suffix in (".3mf", ".npz") and rng.integers(4):
        changed = mutate_archive(content, rng)
    else:
        changed = mutate(content, rng)
    if path.suffix == ".vxs" and rng.integers(4):
        changed = sealed(changed)  # else the checksum alone would refuse it
    if case.entrance == "scene" and takes_long(changed):
        changed = content
    path.write_bytes(changed)
    return path


def choose(entrance: str, rng: np.random.Generator) -> Case:
    """A case of an entrance; mutated, it may end either way."""
    cases = [case for case in list_cases() if case.entrance == entrance]
    return dataclasses.replace(cases[rng.integers(len(cases))], wants="either")


# ---- the viewer ------------------------------------------------------------------------------------


def request(path: str, port: int, *headers: str) -> bytes:
    lines = [f"GET {path} HTTP/1.1", f"Host: 127.0.0.1:{port}", *headers, "", ""]
    return "\r\n".join(lines).encode()


def upgrade(path: str, port: int, protocol: str) -> bytes:
    return request(
        path,
        port,
        f"Origin: http://127.0.0.1:{port}",
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        "Sec-WebSocket-Version: 13",
        f"Sec-WebSocket-Protocol: {protocol}",
    )


def frame(rng: np.random.Generator) -> bytes:
    """Of a WebSocket: any kind, any length that it may claim, masked or not."""
    body = rng.bytes(int(rng.integers(200)))
    kind = int(rng.integers(256))
    match rng.integers(4):
        case 0:
            return bytes([kind, 0x80 | min(len(body), 125)]) + bytes(4) + body[:125]
        case 1:
            return bytes([kind, min(len(body), 125)]) + body
        case 2:
            return bytes([0x82, 0xFF]) + struct.pack(">Q", 2 ** int(rng.integers(64))) + body
        case _:
            return body


def make_request(path: str, port: int, protocol: str, rng: np.random.Generator) -> bytes:
    """What a hostile client sends to the viewer."""
    match rng.integers(6):
        case 0:
            return mutate(request(path, port), rng)
        case 1:
            return mutate(upgrade(path, port, protocol), rng)
        case 2:
            frames = [frame(rng) for _ in range(rng.integers(1, 5))]
            return upgrade(path, port, protocol) + b"".join(frames)
        case 3:
            return rng.bytes(int(rng.integers(2000)))
        case 4:
            return request(path + "a" * int(rng.integers(20_000)), port)
        case _:
            return request(path, port, *["A: " + "b" * 100] * int(rng.integers(1000)))
