from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.robots.description import Primitive
from voxshell.robots.mjcf.geoms import read_geom
from voxshell.robots.mjcf.parts import open_part


@pytest.fixture
def geom(read):
    def geom(attributes: str, assets: str = "", compiler: str = ""):
        file = read(f"<compiler {compiler}/><asset>{assets}</asset><geom {attributes}/>")
        return read_geom(file.root.children[-1], np.eye(4), open_part(file, ""), is_paired=False)

    return geom


SHAPES = {
    "size='2'": Primitive("sphere", (2,)),
    "type='box' size='1 2 3'": Primitive("box", (2, 4, 6)),
    "type='capsule' size='1 2'": Primitive("capsule", (1, 4)),
    "type='cylinder' size='1 2 9'": Primitive("cylinder", (1, 4)),
    "type='ellipsoid' size='1 2 3'": Primitive("ellipsoid", (1, 2, 3)),
    "type='plane' size='0 0 1'": Primitive("plane", ()),
    "type='capsule' size='1' fromto='0 0 0 0 0 4'": Primitive("capsule", (1, 4)),
    "type='box' size='1' fromto='0 0 0 0 3 4'": Primitive("box", (2, 2, 5)),
}


@pytest.mark.parametrize("text", SHAPES)
def test_shapes_have_half_sizes_or_ends(geom, text):
    assert geom(text).surface.geometry == SHAPES[text]


def test_a_geom_with_ends_lies_between_them(geom):
    place = geom(
        "type='capsule' size='0.1' fromto='1 0 0 1 4 0' pos='9 9 9'"
    ).surface.link_from_geometry
    np.testing.assert_allclose(place[:3, 3], (1, 2, 0))
    np.testing.assert_allclose(np.abs(place[:3, 2]), (0, 1, 0), atol=1e-12)


def test_matter_comes_from_mass_or_density(geom):
    ball = 4 / 3 * np.pi * 0.001
    assert geom("size='0.1'").weigh().mass == pytest.approx(1000 * ball)
    assert geom("size='0.1' density='7'").weigh().mass == pytest.approx(7 * ball)
    assert geom("size='0.1' density='7' mass='3'").weigh().mass == 3.0
    assert geom("size='0.1' mass='3'").weigh().inertia[0, 0] == pytest.approx(0.4 * 3 * 0.01)
    assert geom("size='0.1' mass='0'").weigh() is None
    assert geom("size='0.1' group='3'", compiler="inertiagrouprange='0 2'").weigh() is None
    assert geom("type='plane' size='1 1 1'").weigh() is None


def test_a_shell_has_the_mass_and_inertia_of_its_surface(geom):
    box = geom("type='box' size='.1 .2 .3' shellinertia='true'").weigh()
    assert box.mass == pytest.approx(1000 * 2 * (0.2 * 0.4 + 0.4 * 0.6 + 0.6 * 0.2))
    ball = geom("size='0.1' mass='2' shellinertia='true'").weigh()
    assert ball.mass == 2
    assert ball.inertia[0, 0] == pytest.approx(2 / 3 * 2 * 0.01)


def test_bits_say_what_is_only_seen(geom):
    assert geom("size='1'").bits == (1, 1)
    seen = geom("size='1' contype='0' conaffinity='0'")
    assert not seen.collides
    assert geom("size='1' contype='0' conaffinity='4'").collides


def test_colors_are_the_geoms_or_its_materials(geom):
    red = "<material name='red' rgba='1 0 0 1'/>"
    assert geom("size='1' material='red'", red).color == (255, 0, 0)
    assert geom("size='1' material='red' rgba='0 1 0 1'", red).color == (0, 255, 0)
    assert geom("size='1' rgba='x'").color is None


@pytest.mark.parametrize("shape", ["box", "ellipsoid", "cylinder", "capsule", "sphere"])
def test_a_shape_can_be_fitted_to_a_mesh(geom, tmp_path, shape):
    box = trimesh.creation.box((0.2, 0.4, 0.6))
    box.apply_translation((1, 0, 0))
    box.export(tmp_path / "box.stl")
    mesh = "<mesh name='a' file='box.stl'/>"
    surface = geom(f"type='{shape}' mesh='a'", mesh).surface
    np.testing.assert_allclose(surface.link_from_geometry[:3, 3], (1, 0, 0), atol=1e-7)
    fitted = {
        "box": (0.2, 0.4, 0.6),
        "ellipsoid": (0.1, 0.2, 0.3),
        "cylinder": (0.15, 0.6),
        "capsule": (0.15, 0.45),
        "sphere": (0.2,),
    }
    assert surface.geometry.sizes == pytest.approx(fitted[shape], rel=1e-6)
    bounds = geom(f"type='{shape}' mesh='a'", mesh, "fitaabb='true'").surface
    enclosing = fitted | {
        "cylinder": (0.2, 0.6),  # as wide as the box is wide, and no wider
        "capsule": (0.2, 0.2),  # which is as long as the box with its caps
        "sphere": (0.3,),
    }
    assert bounds.geometry.sizes == pytest.approx(enclosing[shape], rel=1e-6)


@pytest.mark.parametrize(
    "text",
    ["size='0'", "size='-1'", "size='1e16'", "type='box' size='1 2'", "size='1' friction='-1'", "size='1' mass='-1'",
     "size='1' contype='0.5'", "type='torus'", "type='capsule' size='1' fromto='0 0 0 0 0 0'",
     "type='mesh'", "size='1' pos='1 2'", "size='1' condim='2'", "size='1' shellinertia='yes'"],
)  # fmt: skip
def test_wrong_geoms_are_refused(geom, text):
    with pytest.raises(vx.RobotError, match=r"model\.xml:1: a geom of the robot has "):
        geom(text).weigh()
