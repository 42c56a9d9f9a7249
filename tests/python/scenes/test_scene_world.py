"""The world of a scene file: keys act as the arguments of the calls that they stand for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.scenes.scene_file import read_scene
from voxshell.scenes.scene_world import build_world

MESH = '[meshes.part]\nfile = "part.stl"\n'
BODY = '[bodies.part]\nmesh = "part"\n'
BALL = '[bodies.ball]\nshape = "sphere"\nradius = 0.1\n'


def build(folder: Path, text: str) -> vx.World:
    path = folder / "scene.toml"
    path.write_text(text)
    return build_world(read_scene(path), lambda *_: None)


def build_model(folder: Path, keys: str) -> vx.Model:
    model = build(folder, f"{MESH}{keys}{BODY}").bodies[0].shape
    assert isinstance(model, vx.Model)
    return model


@pytest.fixture
def cup(tmp_path: Path) -> Path:
    """The file of a cup without a lid: a sheet by default."""
    cup = trimesh.creation.cylinder(0.04, 0.1, sections=32)
    cup.update_faces(cup.face_normals[:, 2] < 0.5)
    cup.export(tmp_path / "part.stl")
    return tmp_path / "part.stl"


def test_a_tolerance_is_that_of_the_model(tmp_path: Path):
    trimesh.creation.box((0.1, 0.1, 0.1)).export(tmp_path / "part.stl")
    assert build_model(tmp_path, "tolerance = 0.0007\n").tolerance == 0.0007
    assert build_model(tmp_path, "voxel_size = 0.01\n").tolerance is None


def test_an_open_mesh_becomes_what_the_file_says(cup: Path):
    folder = cup.parent
    solid = build_model(folder, 'tolerance = 0.001\nopen = "solid"\nsign = "winding"\n')
    sheet = build_model(folder, 'tolerance = 0.001\nopen = "sheet"\nsheet_thickness = 0.004\n')
    inside = [[0.0, 0.0, 0.0]]
    assert solid.field.sample(inside)[0] < -0.03
    assert sheet.field.sample(inside)[0] > 0.03
    one = vx.Model.from_mesh(cup, tolerance=0.001, open="sheet", sheet_thickness=0.004)
    assert one.shell.points.tobytes() == sheet.shell.points.tobytes()


@pytest.mark.parametrize(
    ("keys", "motion", "mass"),
    [
        ("", "dynamic", 1.0),
        ("mass = 0\n", "static", 0.0),
        ('motion = "static"\nmass = 2\n', "static", 0.0),
        ('motion = "kinematic"\n', "kinematic", 0.0),
        ('motion = "dynamic"\nmass = 2\n', "dynamic", 2.0),
    ],
)
def test_a_motion_is_that_of_the_body(tmp_path: Path, keys: str, motion: str, mass: float):
    world = build(tmp_path, BALL + keys)
    [ball] = world.bodies
    assert (ball.motion, ball.mass) == (motion, mass)
    world.step(10)
    assert (ball.position[2] < 0.0) == (motion == "dynamic")


def test_groups_and_masks_decide_what_collides(tmp_path: Path):
    ground = '[bodies.ground]\nshape = "plane"\ngroup = 0b10\n'
    for keys, stays in (("", True), ("mask = 0b110\n", True), ("mask = 0b101\n", False)):
        ball = f"{BALL}position = [0, 0, 0.1]\ngroup = 0b100\n{keys}"
        world = build(tmp_path, ground + ball)
        floor, body = world.bodies
        assert (floor.group, floor.mask) == (2, 2**31 - 1)
        assert body.group == 4
        world.step(100)
        assert (body.position[2] > 0.09) == stays


def test_damping_and_surface_velocity_are_those_of_the_body(tmp_path: Path):
    keys = 'motion = "kinematic"\nsurface_velocity = [0.5, 0, 0]\n'
    [belt] = build(tmp_path, BALL + keys).bodies
    assert belt.surface_velocity.tolist() == [0.5, 0.0, 0.0]
    [ball] = build(tmp_path, f"{BALL}linear_damping = 0.25\nangular_damping = 0.5\n").bodies
    assert (ball.linear_damping, ball.angular_damping) == (0.25, 0.5)


@pytest.mark.parametrize("kind", ["model", "hull", "gimpact"])
def test_parts_are_one_body(tmp_path: Path, kind: str):
    trimesh.creation.box((0.2, 0.2, 0.2)).export(tmp_path / "part.stl")
    handle = (
        '[[bodies.hammer.parts]]\nshape = "cylinder"\nradius = 0.05\nlength = 0.4\n'
        "rotation_vector = [0, 1.5707963267948966, 0]\n"
    )
    head = '[[bodies.hammer.parts]]\nmesh = "part"\nposition = [0.3, 0, 0]\n'
    keys = f'collide_as = "{kind}"\n' + ("resolution = 20\n" if kind == "model" else "")
    body = "[bodies.hammer]\nmass = 2\nposition = [1, 2, 3]\n"
    [hammer] = build(tmp_path, f"{MESH}{keys}{body}{handle}{head}").bodies
    assert isinstance(hammer.shape, vx.Compound)
    shapes = [shape for shape, _ in hammer.shape.parts]
    assert isinstance(shapes[0], vx.Cylinder)
    assert hammer.mass == 2.0
    np.testing.assert_allclose(hammer.bounds, [(0.8, 1.9, 2.9), (1.4, 2.1, 3.1)], atol=0.03)
    volumes = np.pi * 0.05**2 * 0.4, 0.008
    center = (1 + 0.3 * volumes[1] / sum(volumes), 2, 3)
    np.testing.assert_allclose(hammer.center_of_mass, center, atol=2e-3)


def test_a_missing_mesh_is_said_at_its_line(tmp_path: Path):
    message = r"scene\.toml:2: meshes\.part\.file: cannot read .*part\.stl: it does not exist"
    with pytest.raises(vx.SettingsError, match=message):
        build(tmp_path, MESH + BODY)


@pytest.mark.parametrize("kind", ["model", "hull", "gimpact"])
def test_a_long_mesh_is_doubted_with_the_key_that_scales_it(tmp_path: Path, kind: str):
    trimesh.creation.box((80, 60, 20)).export(tmp_path / "part.stl")
    keys = f'collide_as = "{kind}"\n' if kind != "model" else "resolution = 20\n"
    with pytest.warns(vx.MeshWarning, match=r"80 m long.*scale = 0\.001 in a scene file"):
        build(tmp_path, MESH + keys + BODY)
