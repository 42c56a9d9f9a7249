"""Inertias that are too large for a link's collision geometry, and those of the shapes instead of them."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.robots.description import (
    Collision,
    Inertial,
    LinkDescription,
    Primitive,
    RobotDescription,
)
from voxshell.robots.inertia_doubts import find_large_inertias, find_reach
from voxshell.robots.lumps import Lump

DOMINO = (0.00635, 0.0254, 0.0508)
BOX = '<collision><geometry><box size="{} {} {}"/></geometry></collision>'.format(*DOMINO)


def inertial(moment: float, mass: float = 0.025, place: str = "") -> str:
    return (
        f'<inertial>{place}<mass value="{mass}"/><inertia ixx="{moment}" iyy="{moment}" izz="{moment}" '
        'ixy="0" ixz="0" iyz="0"/></inertial>'
    )


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str], Path]:
    def write(content: str) -> Path:
        path = tmp_path / "domino.urdf"
        path.write_text(f'<robot name="cube"><link name="baseLink">{content}</link></robot>')
        return path

    return write


def load(path: Path, **options: object) -> tuple[vx.Body, list[str]]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        robot = vx.load_urdf(vx.World(), path, fixed_base=False, **options)  # pyright: ignore[reportArgumentType]
    assert all(it.category is vx.RobotWarning and it.filename == __file__ for it in caught)
    return robot.bodies[0], [str(it.message) for it in caught]


def solid_box(mass: float) -> np.ndarray:
    squares = np.square(DOMINO)
    return mass / 12.0 * np.diag(squares.sum() - squares)


def test_a_placeholder_for_the_inertia_is_doubted_and_the_shape_gives_another(write):
    path = write(inertial(1.0) + BOX)
    body, [said] = load(path)
    np.testing.assert_allclose(body.inertia, np.eye(3), atol=1e-9)  # the file's, as before
    times = 1.0 / (0.025 * np.square(DOMINO).sum() / 4.0)
    assert 48_500 < times < 49_500
    assert "the size of the collision geometry can have ('baseLink': 49,000 times)" in said
    assert "pybullet ignores a file's inertias by default: pass inertia='shape'" in said
    body, said = load(path, inertia="shape")
    assert said == []
    assert body.mass == 0.025
    np.testing.assert_allclose(body.inertia, solid_box(0.025), atol=1e-12)


def test_inertias_up_to_a_factor_are_not_doubted(write):
    most = 0.025 * np.square(DOMINO).sum() / 4.0
    assert load(write(inertial(24.0 * most) + BOX))[1] == []
    assert len(load(write(inertial(26.0 * most) + BOX))[1]) == 1
    # A link whose center of mass is far from its collision geometry, as that of a foot, may have more.
    away = '<origin xyz="0.3 0 0"/>'
    assert load(write(inertial(26.0 * most, place=away) + BOX))[1] == []


def test_the_inertia_of_the_shape_is_about_the_center_of_the_file(write):
    path = write(inertial(1.0, place='<origin xyz="0 0 0.01" rpy="0.3 0 0"/>') + BOX)
    body, _ = load(path, inertia="shape")
    np.testing.assert_allclose(body.center_of_mass, (0.0, 0.0, 0.01), atol=1e-12)
    np.testing.assert_allclose(body.inertia, solid_box(0.025), atol=1e-12)


def test_links_without_collision_geometry_keep_their_inertia(write):
    body, said = load(write(inertial(1.0)), inertia="shape")
    assert said == []
    np.testing.assert_allclose(body.inertia, np.eye(3), atol=1e-9)


def test_another_word_for_the_inertia_is_refused(write):
    with pytest.raises(vx.SettingsError, match="inertia must be 'file' or 'shape'"):
        load(write(inertial(1.0) + BOX), inertia="solid")


def test_meshes_reach_as_far_as_their_points(write, tmp_path):
    trimesh.creation.box(DOMINO).export(tmp_path / "box.stl")
    path = write(
        inertial(1.0) + '<collision><geometry><mesh filename="box.stl"/></geometry></collision>'
    )
    _, [said] = load(path, mesh_as="hull")
    assert "('baseLink': 49,000 times)" in said


@pytest.mark.parametrize(
    ("kind", "sizes", "reach"),
    [
        ("box", (2.0, 4.0, 4.0), 3.0),
        ("sphere", (2.0,), 2.0),
        ("capsule", (0.5, 3.0), 2.0),
        ("cylinder", (2.0, 2.0), 3.0),  # of the box about it
        ("ellipsoid", (1.0, 2.0, 2.0), 3.0),  # as above
        ("plane", (), np.inf),
    ],
)
def test_reach_of_primitives(kind, sizes, reach):
    part = Collision(Primitive(kind, sizes), np.eye(4))
    assert find_reach(LinkDescription("a", "f:1", (part,), None, None), np.zeros(3)) == reach
    moved = Collision(Primitive(kind, sizes), vx.pose((0, 0, 5)))
    link = LinkDescription("a", "f:1", (part, moved), None, None)
    assert find_reach(link, np.array((0.0, 0.0, 5.0))) >= 5.0


def test_reach_without_geometry_is_0():
    assert find_reach(LinkDescription("a", "f:1", (), None, None), np.ones(3)) == 0.0


def test_a_reach_whose_square_is_not_finite_is_no_doubt():
    part = Collision(Primitive("sphere", (1e200,)), np.eye(4))
    inertial = Inertial(1.0, np.zeros(3), np.eye(3))
    link = LinkDescription("a", "f:1", (part,), inertial, None)
    robot = RobotDescription("f", "r", {"a": np.eye(4)}, {"a": link})
    assert find_large_inertias(robot, [Lump({"a": np.eye(4)})]) == {}
