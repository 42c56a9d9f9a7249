"""Files of named arrays: numpy's .npz, with a header in JSON and the arrays as they are.

The header is an object with the name and version of the kind of file. Arrays are read without pickles.
"""

from __future__ import annotations

import io
import json
import tokenize
import zipfile
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from voxshell.base.arguments import show_value
from voxshell.base.input_files import read_small_file
from voxshell.base.outputs import write_bytes
from voxshell.errors import MemoryLimitError, VoxshellError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

Content = TypeVar("Content")

SUFFIX = ".npz"
_ARCHIVE = b"PK"
"""First bytes of any file of arrays."""

_MOST_BYTES = 4 << 30
"""Largest file, and largest sum of its arrays, that is read."""

_MOST_OF_HEADER = 64 << 20
"""Largest header, bytes."""

_DAMAGED = (
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    KeyError,
    NotImplementedError,  # a compression that zipfile does not have
    RuntimeError,  # an encrypted file, or a header that is nested too deeply
    SyntaxError,  # the header of an array
    TypeError,
    ValueError,
    tokenize.TokenError,
    OSError,
)


@dataclass(frozen=True)
class FileKind:
    """A kind of file.

    Attributes:
        name: What such a file is, in headers and error messages: "recording".
        version: The version that is written and read.
        error: Raised for files that are damaged or of another kind or version.
    """

    name: str
    version: int
    error: type[VoxshellError]

    def write(
        self, path: Path, header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]
    ) -> None:
        """Write a file completely or not at all. Equal contents give equal bytes.

        Raises:
            SettingsError: No file can be written there.
            FileAccessError: The system refuses to write it.
        """
        whole = {"format": f"voxshell {self.name}", "version": self.version, **header}
        text = np.frombuffer(json.dumps(whole).encode(), dtype=np.uint8)
        content = io.BytesIO()
        kept: dict[str, Any] = {"header": text, **arrays}
        np.savez_compressed(content, **kept)
        write_bytes(path, content.getbuffer())

    def read(
        self, path: Path, make: Callable[[dict[str, Any], Mapping[str, NDArray[Any]]], Content]
    ) -> Content:
        """Return what is made of a file's header and arrays.

        Args:
            path: The file.
            make: Its errors, such as KeyError and ValueError, mean that the file is damaged.

        Raises:
            MissingFileError: The file does not exist.
            FileAccessError: The system refuses to read it.
            SettingsError: It is a folder or a device.
            VoxshellError: Of the kind's own type: the file is damaged, or has another kind or version.
            MemoryLimitError: Its arrays have more than 4 GiB, or there is no memory for them.
        """
        content = read_small_file(path, _MOST_BYTES, self.name)
        try:
            _check_sizes(content, path)
            with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
                header = self._read_header(arrays)
                return make(header, {name: _read_array(arrays, name) for name in arrays.files})
        except MemoryError as error:
            raise MemoryLimitError(f"no memory left for the {self.name} {path}") from error
        except MemoryLimitError:
            raise
        except _DAMAGED as error:
            raise self.error(
                f"cannot read the {self.name} {path}: {self._explain(error, content)}"
            ) from error

    def _read_header(self, arrays: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return the header, which is read before the arrays: those of other files may take long."""
        header = json.loads(_read_array(arrays, "header").tobytes())
        if not isinstance(header, dict) or header.get("format") != f"voxshell {self.name}":
            raise ValueError(f"it is not a {self.name} of voxshell")
        if header.get("version") != self.version:
            raise ValueError(
                f"it has version {header.get('version')!r}; this package reads version {self.version}"
            )
        return header

    def _explain(self, error: Exception, content: bytes) -> str:
        """Return what is wrong with the content of a file."""
        if isinstance(error, zipfile.BadZipFile) and not content.startswith(_ARCHIVE):
            return f"it is not a {self.name} ({SUFFIX})"
        if isinstance(error, (SyntaxError, tokenize.TokenError)):
            return "the header of an array in it is damaged"
        return f"it has no {error}" if isinstance(error, KeyError) else str(error)


def _check_sizes(content: bytes, path: Path) -> None:
    """Refuse a file whose arrays are too large.

    Raises:
        MemoryLimitError: They have more than 4 GiB.
        ValueError: The header is larger than any that is written.
    """
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        members = archive.infolist()
    size = sum(member.file_size for member in members)
    if size > _MOST_BYTES:
        raise MemoryLimitError(
            f"{path} holds {size / 1e9:.3g} GB of arrays; at most {_MOST_BYTES / 1e9:.3g} GB are read"
        )
    of_header = [member.file_size for member in members if member.filename == "header.npy"]
    if max(of_header, default=0) > _MOST_OF_HEADER:
        raise ValueError(f"its header has more than {_MOST_OF_HEADER / 1e6:.3g} MB")


def _read_array(arrays: Mapping[str, NDArray[Any]], name: str) -> NDArray[Any]:
    if name not in arrays:
        raise KeyError(name)
    array = arrays[name]
    if not isinstance(array, np.ndarray):  # NumPy returns the bytes of other files
        raise ValueError(f"its {show_value(name)} is not an array")
    return array
