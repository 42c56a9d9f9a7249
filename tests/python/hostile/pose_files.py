"""Lists of poses for `voxshell query --poses`."""

from __future__ import annotations

import io
import pickle
import struct
from collections.abc import Iterator

import numpy as np

from .bodies import zipped
from .case import Case, Content, Wants, of_files

POSES = np.tile(np.eye(4), (3, 1, 1))
ROW = "0, 0, 1, 0, 0, 0, 1\n"


def npy(array: np.ndarray, allow_pickle: bool = False) -> bytes:
    out = io.BytesIO()
    np.save(out, array, allow_pickle=allow_pickle)
    return out.getvalue()


def with_header(header: str, data: bytes = b"", version: bytes = b"\1\0") -> bytes:
    text = header.encode("latin-1") + b"\n"
    return b"\x93NUMPY" + version + struct.pack("<H", len(text)) + text + data


def shaped(shape: object, kind: str = "'<f8'") -> bytes:
    header = f"{{'descr': {kind}, 'fortran_order': False, 'shape': {shape}, }}"
    return with_header(header, POSES.tobytes())


class Intruder:
    """Runs a command where it is unpickled."""

    def __reduce__(self) -> tuple[object, tuple[str]]:
        return exec, ("raise SystemExit('the pickle ran')",)


def list_csv() -> Iterator[tuple[str, Content, Wants]]:
    yield "empty", "", "refused"
    yield "comments alone", "# nothing\n", "refused"
    yield "words", "x, y, z\n", "refused"
    yield "five numbers", "0, 0, 0, 0, 0\n", "refused"
    yield "rows of other lengths", ROW + "0, 0, 0\n", "loaded"
    yield "NaN", ROW.replace("1,", "nan,", 1), "refused"
    yield "infinity", ROW.replace("1,", "inf,", 1), "refused"
    yield "1e300", ROW.replace("1,", "1e300,", 1), "either"
    yield "an exponent of 999", ROW.replace("1,", "1e999,", 1), "refused"
    yield "a turn of zeros", "0, 0, 0, 0, 0, 0, 0\n", "refused"
    yield "a matrix that is no turn", ", ".join("2" * 16) + "\n", "refused"
    yield "underscores in numbers", ROW.replace("1,", "1_0,", 1), "refused"
    yield "semicolons", ROW.replace(",", ";"), "either"
    yield "UTF-16", ROW.encode("utf-16"), "refused"
    yield "a byte order mark", b"\xef\xbb\xbf" + ROW.encode(), "either"
    yield "NUL", ROW.replace(",", "\0,", 1), "refused"
    yield "noise", bytes(range(256)), "refused"
    yield "quotes without end", '"0, 0, 0\n' * 5, "refused"
    yield "a line of five megabytes", lambda: b"0," * 2_500_000, "refused"
    yield "a number of a million digits", lambda: b"0, 0, " + b"1" * 1_000_000 + b"\n", "refused"
    yield "1000 rows", ROW * 1000, "either"


def list_npy() -> Iterator[tuple[str, Content, Wants]]:
    whole = npy(POSES)
    yield "empty", b"", "refused"
    yield "its magic alone", whole[:6], "refused"
    yield "cut in its header", whole[:40], "refused"
    yield "cut in its numbers", whole[:-9], "refused"
    yield "version 9", whole[:6] + b"\x09\0" + whole[8:], "refused"
    yield "a header of 65535 bytes", whole[:8] + b"\xff\xff" + whole[10:], "refused"
    yield "a pickle", npy(np.array([Intruder()]), allow_pickle=True), "refused"
    yield "a pickle called array", pickle.dumps(Intruder()), "refused"
    yield "an archive", zipped({"poses.npy": whole}), "refused"
    yield "2**40 poses", shaped((2**40, 4, 4)), "refused"
    yield "2**62 poses", shaped((2**62, 4, 4)), "refused"
    yield "-1 poses", shaped((-1, 4, 4)), "refused"
    yield "no poses", npy(POSES[:0]), "either"
    yield "a shape of words", shaped(("'a'", 4, 4)), "refused"
    yield "a shape of 100 axes", shaped((1,) * 100), "refused"
    yield "an expression as shape", shaped("__import__('os').getcwd()"), "refused"
    yield "an unknown type", shaped((3, 4, 4), "'<q99'"), "refused"
    yield "a type of nothing", shaped((3, 4, 4), "'V0'"), "refused"
    yield "complex numbers", npy(POSES.astype(complex)), "refused"
    yield "words", npy(np.array([["a"] * 7])), "refused"
    yield "booleans", npy(POSES.astype(bool)), "either"
    yield "dates", npy(np.zeros((1, 7), "M8[s]")), "refused"
    yield "records", npy(np.zeros(3, [("a", "f8")])), "refused"
    yield "single precision", npy(POSES.astype(np.float32)), "either"
    yield "the other byte order", npy(POSES.astype(">f8")), "loaded"
    yield "NaN", npy(POSES * np.nan), "refused"
    yield "poses of 3 by 3", npy(POSES[:, :3, :3]), "refused"
    yield "scaled poses", npy(POSES * 2.0), "refused"
    yield "mirrored poses", npy(POSES * [-1.0, 1.0, 1.0, 1.0]), "refused"
    yield "one number", npy(np.array(1.0)), "refused"
    yield "100000 nested brackets", with_header("[" * 60_000), "refused"


def list_cases() -> Iterator[Case]:
    for name, content, wants in list_csv():
        yield of_files("poses", f"CSV, {name}", "poses.csv", content, wants)
    for name, content, wants in list_npy():
        yield of_files("poses", f"numpy, {name}", "poses.npy", content, wants)
