"""Folder and size of the cache, from environment variables."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from voxshell.errors import SettingsError

if TYPE_CHECKING:
    from collections.abc import Mapping

DEFAULT_CAPACITY = 2_000_000_000
"""Bytes."""

_UNITS = {"": 1, "b": 1, "kb": 10**3, "mb": 10**6, "gb": 10**9, "tb": 10**12}


def find_folder(environment: Mapping[str, str]) -> Path | None:
    """Return the folder of models; None if there is no home directory.

    Example:
        >>> find_folder({"XDG_CACHE_HOME": "/var/cache/me"})
        PosixPath('/var/cache/me/voxshell/models')
    """
    if folder := environment.get("VOXSHELL_CACHE_DIR"):
        return Path(os.path.abspath(os.path.expanduser(folder)))
    base = environment.get("XDG_CACHE_HOME", "")
    if not os.path.isabs(base):  # the XDG specification says to ignore relative paths
        home = os.path.expanduser("~")
        if not os.path.isabs(home):
            return None
        base = os.path.join(home, ".cache")
    return Path(base, "voxshell", "models")


def read_capacity(environment: Mapping[str, str]) -> int:
    """Return the limit of the models' total size, bytes.

    Raises:
        SettingsError: ``VOXSHELL_CACHE_SIZE`` is not a size.

    Example:
        >>> read_capacity({"VOXSHELL_CACHE_SIZE": "1.5 GB"})
        1500000000
    """
    text = environment.get("VOXSHELL_CACHE_SIZE", "").strip()
    if not text:
        return DEFAULT_CAPACITY
    match = re.fullmatch(r"(\d{1,15}(?:\.\d{1,15})?)\s*([kmgt]?b?)", text.lower())
    if match is None or match[2] in ("k", "m", "g", "t"):
        raise SettingsError(f"VOXSHELL_CACHE_SIZE must be a size such as 500MB, not {text!r}")
    return int(float(match[1]) * _UNITS[match[2]])
