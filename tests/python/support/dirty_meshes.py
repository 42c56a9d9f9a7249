"""Meshes as they come: what is wrong with real ones, fetched when tests run and never kept in git.

All are from the wheel of pybullet 3.2.7 on PyPI, folder pybullet_data. The wheel's license is zlib;
beside the meshes it states these: franka_panda Apache 2.0 (its LICENSE.txt), kuka_iiwa BSD (its
model.urdf), husky BSD (its husky.urdf).
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import tempfile
import time
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
FOLDER = ROOT / "build/downloads/pybullet-3.2.7"
# One file for all machines: only its data are used.
WHEEL = [
    "pybullet==3.2.7",
    "--only-binary=:all:",
    "--implementation=cp",
    "--python-version=311",
    "--platform=manylinux2014_x86_64",
    "--platform=manylinux_2_17_x86_64",
]
PAUSES = (0, 5, 20)  # seconds before each attempt
WHEEL_SHA256 = "5d858abf7c12a21ef3ed351cf81dac1b5e486ec25c9ab59bfc84beb89034edff"


@dataclass(frozen=True)
class Faults:
    """Edges of a mesh after vertices at the same place are made one."""

    open_edges: int
    non_manifold_edges: int
    flipped_edges: int
    places: np.ndarray  # (n, 3), the middles of these edges


def fetch(names: list[str]) -> Path:
    """The folder that has these files of pybullet_data.

    Skips the test, with a reason, where there is neither a copy nor, in several attempts, a network;
    in CI, which has one, that is a failure.
    """
    if all((FOLDER / name).is_file() for name in names):
        return FOLDER
    said = ""
    for pause in PAUSES:
        time.sleep(pause)
        try:
            _download(names)
        except (OSError, subprocess.SubprocessError) as error:
            said = str(getattr(error, "stderr", None) or error)
        else:
            return FOLDER
    reason = f"pybullet's wheel, which has the meshes, cannot be had from PyPI: {said[-300:]}"
    if os.environ.get("CI") == "true":
        pytest.fail(reason)
    pytest.skip(reason)


def _download(names: list[str]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        pip = [sys.executable, "-m", "pip", "download", "--no-deps", "--no-input", "--quiet"]
        subprocess.run(
            [*pip, "--disable-pip-version-check", f"--dest={folder}", *WHEEL],
            check=True,
            capture_output=True,
            text=True,
            timeout=300,
        )
        (wheel,) = Path(folder).glob("*.whl")
        assert hashlib.sha256(wheel.read_bytes()).hexdigest() == WHEEL_SHA256
        with zipfile.ZipFile(wheel) as archive:
            for name in names:
                target = FOLDER / name
                target.parent.mkdir(parents=True, exist_ok=True)
                partial = target.with_name(f"{target.name}.{os.getpid()}")
                partial.write_bytes(archive.read(f"pybullet_data/{name}"))
                partial.replace(target)


def find_faults(vertices: np.ndarray, faces: np.ndarray) -> Faults:
    """Counted in numpy, apart from the core's own count."""
    places, merged = np.unique(vertices, axis=0, return_inverse=True)
    corners = merged.reshape(-1)[faces]
    distinct = (
        (corners[:, 0] != corners[:, 1])
        & (corners[:, 1] != corners[:, 2])
        & (corners[:, 2] != corners[:, 0])
    )
    corners = corners[distinct]
    directed = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    forwards = directed[:, 0] < directed[:, 1]
    edges, index = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True)
    index = index.reshape(-1)
    uses = np.bincount(index, minlength=len(edges))
    ahead = np.bincount(index[forwards], minlength=len(edges))
    is_open, is_crowded = uses == 1, uses > 2
    is_flipped = (uses == 2) & (ahead != 1)
    faulty = edges[is_open | is_crowded | is_flipped]
    return Faults(
        int(is_open.sum()),
        int(is_crowded.sum()),
        int(is_flipped.sum()),
        places[faulty].mean(axis=1),
    )


def winding_numbers(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """How often the triangles, (m, 3, 3), go around each point, by their solid angles."""
    numbers = np.empty(len(points))
    for i, point in enumerate(points):
        a, b, c = np.moveaxis(triangles - point, 1, 0)
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        along = np.einsum("ij,ij->i", a, np.cross(b, c))
        below = (
            la * lb * lc
            + np.einsum("ij,ij->i", a, b) * lc
            + np.einsum("ij,ij->i", b, c) * la
            + np.einsum("ij,ij->i", c, a) * lb
        )
        numbers[i] = np.arctan2(along, below).sum() / (2.0 * np.pi)
    return numbers
