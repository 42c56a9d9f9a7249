"""Warnings: where they point, and how long they are."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.base.user_warnings import shorten_path, warn_user

LONG = "a_very_long_name_" * 50


def write_large_mesh(folder: Path) -> Path:
    """A box of 20 m, which is probably in millimeters."""
    path = folder / "part.stl"
    trimesh.creation.box((20.0, 20.0, 20.0)).export(path)
    return path


def make_cup() -> trimesh.Trimesh:
    cup = trimesh.creation.cylinder(0.04, 0.1, sections=16)
    cup.update_faces(cup.face_normals[:, 2] < 0.5)
    return cup


def build_large(folder: Path) -> None:
    vx.Model.from_mesh(write_large_mesh(folder), resolution=10)


def add_large(folder: Path) -> None:
    vx.World().add(write_large_mesh(folder))


def add_open(folder: Path) -> None:
    del folder
    vx.World().add(make_cup())


def spin(folder: Path) -> None:
    del folder
    world = vx.World()
    world.add(vx.Sphere(0.1), name=LONG).angular_velocity = (0, 0, 1000)
    world.step()


def load_without_mass(folder: Path) -> None:
    path = folder / "robot.urdf"
    shape = "<collision><geometry><sphere radius='0.1'/></geometry></collision>"
    joint = "<joint name='j' type='floating'><parent link='base'/><child link='{0}'/></joint>"
    path.write_text(
        f"<robot name='r'><link name='base'/><link name='{LONG}'>{shape}</link>{joint.format(LONG)}</robot>"
    )
    vx.load_urdf(vx.World(), path)


def query_sparse(folder: Path) -> None:
    del folder
    sparse = vx.Model.from_mesh(trimesh.creation.box(), voxel_size=0.05, target_points=100)
    vx.contacts(sparse, vx.Box(np.array([0.1, 0.2, 1.0]) / 3.0))


@pytest.mark.parametrize(
    "call", [build_large, add_large, add_open, spin, load_without_mass, query_sparse]
)
def test_a_warning_points_at_the_users_line_and_is_short(
    tmp_path: Path, call: Callable[[Path], None]
):
    """Those of `World.add` pointed into the package, and long names were written in full."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        call(tmp_path)
    assert caught
    for each in caught:
        assert each.filename == __file__, each
        lines = range(call.__code__.co_firstlineno, call.__code__.co_firstlineno + 15)
        assert each.lineno in lines
        text = str(each.message).replace(str(tmp_path), "")
        assert len(text) < 400, text
        assert "\n" not in text
        assert "array(" not in text
        assert "3333333" not in text


def test_a_warning_from_within_calls_of_the_user_points_at_the_innermost():
    def ask() -> None:
        warn_user("doubt", vx.MeshWarning)

    with pytest.warns(vx.MeshWarning, match="^doubt$") as caught:
        ask()
    assert (caught[0].filename, caught[0].lineno) == (__file__, ask.__code__.co_firstlineno + 1)


def test_of_a_long_path_the_end_is_shown():
    assert shorten_path(Path("part.stl")) == "part.stl"
    shown = shorten_path("/home/" + "folder/" * 100 + "part.stl")
    assert shown.startswith("...")
    assert shown.endswith("/folder/part.stl")
    assert len(shown) == 203
