"""What is at a path that is no sound file: folders, devices, links, pipes, and odd names."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable
from pathlib import Path

from .bodies import stl, triangles
from .case import Case, Wants

BODY = stl(triangles())


def open_socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as made:
        here = os.open(path.parent, os.O_RDONLY)
        try:  # a socket's address has at most 108 characters
            made.bind(f"/proc/self/fd/{here}/{path.name}")
        finally:
            os.close(here)


def link_in_a_circle(path: Path) -> None:
    other = path.with_name("other" + path.suffix)
    path.symlink_to(other)
    other.symlink_to(path)


def lock(path: Path) -> None:
    path.write_bytes(BODY)
    path.chmod(0)


def make_sparse(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(5 << 30)


PLACES: dict[str, tuple[Callable[[Path], object], Wants]] = {
    "nothing": (lambda path: None, "refused"),
    "a folder": (Path.mkdir, "refused"),
    "a pipe": (os.mkfifo, "refused"),
    "a socket": (open_socket, "refused"),
    "a link in a circle": (link_in_a_circle, "refused"),
    "a link to itself": (lambda path: path.symlink_to(path), "refused"),
    "a link to nothing": (lambda path: path.symlink_to("missing"), "refused"),
    "a link to a device without end": (lambda path: path.symlink_to("/dev/zero"), "refused"),
    "a link to a device of nothing": (lambda path: path.symlink_to("/dev/null"), "refused"),
    "a link to a folder": (lambda path: path.symlink_to("/"), "refused"),
    "a file of no permissions": (lock, "either"),
    "a sparse file of 5 GiB": (make_sparse, "refused"),
}

SUFFIXES = {
    "mesh": (".stl", ".obj", ".ply", ".off", ".glb", ".gltf", ".3mf", ".dae"),
    "model": (".vxs",),
    "scene": (".toml",),
    "urdf": (".urdf",),
    "mjcf": (".xml",),
    "poses": (".csv", ".npy"),
    "settings": (".toml",),
}

NAMES: dict[str, Wants] = {
    "no suffix": "either",
    "other.xyz": "refused",
    "other.step": "refused",
    "BODY.STL": "loaded",
    "body.stl.exe": "refused",
    "two\nlines.stl": "loaded",
    "\x1b[31mred.stl": "loaded",
    "b\udcf6dy.stl": "loaded",  # a byte that is no UTF-8
    "--help.stl": "either",
    "a" * 251 + ".stl": "loaded",
    ".stl": "either",
    "[brackets].stl": "loaded",
}


def list_cases() -> list[Case]:
    cases: list[Case] = []
    for entrance, suffixes in SUFFIXES.items():
        for number, (name, (make, wants)) in enumerate(PLACES.items()):
            suffix = suffixes[number % len(suffixes)]
            file = f"input{suffix}"

            def write(
                folder: Path, make: Callable[[Path], object] = make, file: str = file
            ) -> None:
                make(folder / file)

            cases.append(Case(f"{name} called {suffix}", entrance, file, write, wants))
    for file, wants in NAMES.items():

        def write_named(folder: Path, file: str = file) -> None:
            (folder / file).write_bytes(BODY)

        cases.append(Case(f"the name {ascii(file)[:40]}", "mesh", file, write_named, wants))
    return cases
