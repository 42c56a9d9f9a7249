"""Bodies that slide over the seams of others, in a World at its defaults."""

from __future__ import annotations

import math
from functools import cache

import manifold3d as m3
import numpy as np
import pytest
import voxshell as vx
from poses import at
from scipy.spatial.transform import Rotation
from shapely import Polygon
from shapely import box as rectangle
from trimesh.convex import convex_hull
from trimesh.creation import box, cylinder, extrude_polygon, icosphere, torus
from voxshell_studies.scenes.gear import make_gear
from voxshell_studies.scenes.solids import as_mesh

RATES = (1000, 200, 60, 30)
TILE = 0.4  # side of a tile, meters
SMALL_TILE = 0.2
SPEED = 1.0  # m/s

MESHES = {
    "cube": lambda: box((0.1, 0.1, 0.1)),
    "can": lambda: cylinder(0.033, 0.1, sections=64),
    "tile": lambda: box((TILE, TILE, 0.05)),
    "small tile": lambda: box((SMALL_TILE, SMALL_TILE, 0.02)),
    "ball": lambda: icosphere(4, radius=0.05),
    "torus": lambda: torus(0.035, 0.015, 64, 32),
}
TILES = {
    "models": lambda: model("tile"),
    "boxes": lambda: vx.Box((TILE / 2, TILE / 2, 0.025)),
}


@cache
def model(name: str) -> vx.Model:
    return vx.Model.from_mesh(MESHES[name]())


def push(world: vx.World, rate: int, name: str, heading: float = 0.0):
    """A body that stands 0.12 m before the origin and is pushed toward it."""
    ahead = np.array([math.cos(heading), math.sin(heading), 0.0])
    body = world.add(
        model(name), mass=1.0, pose=at(*((0.0013, 0.0007, 0.05) - 0.12 * ahead)), friction=0.0
    )
    world.step(max(rate // 20, 3))
    body.linear_velocity = tuple(SPEED * ahead)
    return body, ahead


@pytest.mark.parametrize("tiles", TILES)
@pytest.mark.parametrize("name", ["cube", "can"])
@pytest.mark.parametrize("rate", RATES)
def test_bodies_do_not_notice_the_seams_of_four_tiles(rate, name, tiles):
    world = vx.World(time_step=1 / rate)
    shape = TILES[tiles]()
    for x in (-0.5, 0.5):
        for y in (-0.5, 0.5):
            world.add(shape, mass=0, pose=at(x * TILE, y * TILE, -0.025), friction=0.0)
    body, ahead = push(world, rate, name, heading=0.3)
    start = body.pose
    for _ in range(round(0.24 / SPEED * rate)):
        world.step()
        cosine = (np.trace(start[:3, :3].T @ body.pose[:3, :3]) - 1) / 2
        assert abs(body.pose[2, 3] - start[2, 3]) < 3e-4
        assert math.degrees(math.acos(np.clip(cosine, -1, 1))) < 1
    assert body.linear_velocity @ ahead == pytest.approx(SPEED, rel=0.02)


@pytest.mark.parametrize("tiles", TILES)
@pytest.mark.parametrize("rate", RATES)
def test_a_step_of_two_millimeters_stops_a_cube(rate, tiles):
    world = vx.World(time_step=1 / rate)
    shape = TILES[tiles]()
    for x, top in ((-0.5, 0.0), (0.5, 0.002)):
        world.add(shape, mass=0, pose=at(x * TILE, 0, top - 0.025), friction=0.0)
    body, _ = push(world, rate, "cube")
    world.step(rate // 5)
    assert body.linear_velocity[0] < 0.5 * SPEED


@pytest.mark.parametrize("rate", RATES)
def test_a_wall_at_the_end_of_the_ground_stops_a_cube_upright(rate):
    world = vx.World(time_step=1 / rate)
    world.add(model("tile"), mass=0, pose=at(0, 0, -0.025), friction=0.0)
    wall = vx.Box((0.05, 0.2, 0.1))
    world.add(wall, mass=0, pose=at(TILE / 2 + 0.05, 0, 0.05), friction=0.0)
    body, _ = push(world, rate, "cube")
    world.step(rate // 2)
    assert body.pose[0, 3] < TILE / 2 - 0.05 + 1e-3
    assert abs(body.linear_velocity[0]) < 0.01
    assert body.pose[2, 3] == pytest.approx(0.05, abs=3e-4)


@pytest.mark.parametrize(
    ("rate", "count", "side", "thickness"),
    [(60, 6, 0.05, 0.001), (60, 5, 0.2, 0.002), (30, 5, 0.1, 0.002), (30, 6, 0.1, 0.002)],
)
def test_flush_stacks_of_thin_plates_lie_still(rate, count, side, thickness):
    """Every other plate is nearer than gravity moves it in a step, and the one between keeps them apart."""
    plate = vx.Model.from_mesh(box((side, side, thickness)))
    world = vx.World(time_step=1 / rate)
    world.add(vx.Plane(), mass=0)
    heights = [thickness * (i + 0.5) for i in range(count)]
    bodies = [world.add(plate, mass=0.05, pose=at(0, 0, z)) for z in heights]
    for _ in range(2 * rate):
        world.step()
        assert max(np.linalg.norm(body.linear_velocity) for body in bodies) < 0.01
    assert [body.pose[2, 3] for body in bodies] == pytest.approx(heights, abs=1e-4)


SMALL_TILES = {
    "models": lambda: model("small tile"),
    "boxes": lambda: vx.Box((SMALL_TILE / 2, SMALL_TILE / 2, 0.01)),
}


@pytest.mark.parametrize("name", ["ball", "torus"])
@pytest.mark.parametrize(
    ("rate", "tiles"),
    [(rate, "models") for rate in RATES] + [(rate, "boxes") for rate in (1000, 200, 60)],
)
def test_round_bodies_roll_over_the_seams_of_tiles(rate, name, tiles):
    """A ball lost half of its speed at 60 Hz: places of it that turn away counted as obstacles."""
    world = vx.World(time_step=1 / rate)
    tile = SMALL_TILES[tiles]()
    for i in range(12):
        for j in (-1, 0, 1):
            world.add(tile, mass=0, pose=at(SMALL_TILE * i, SMALL_TILE * j + 0.03, -0.01))
    pose = at(0.01, 0.0, 0.05)
    pose[:3, :3] = Rotation.from_euler("x", 90.0, degrees=True).as_matrix()
    body = world.add(model(name), mass=0.1, pose=pose)
    body.linear_velocity = (SPEED, 0.0, 0.0)
    body.angular_velocity = (0.0, SPEED / 0.05, 0.0)
    for _ in range(2 * rate):
        world.step()
        assert abs(body.position[2] - 0.05) < 3e-4
    assert body.linear_velocity[0] == pytest.approx(SPEED, rel=0.02)


@cache
def grate() -> vx.Model:
    """A plate of 10 mm with slots of 20 mm along y, 60 mm apart."""
    plate = rectangle(-0.52, -0.2, 0.52, 0.2)
    for x in np.arange(-0.44, 0.5, 0.08):
        plate = plate.difference(rectangle(x - 0.01, -0.15, x + 0.01, 0.15))
    return vx.Model.from_mesh(extrude_polygon(plate, 0.01))


# They kept -0.2 to 0.6 of the way.
@pytest.mark.parametrize("rate", [1000, 200, 60, 30])
@pytest.mark.parametrize("shape", ["cube", "can", "Box", "Cylinder"])
@pytest.mark.parametrize(("friction", "speed"), [(0.0, 0.2), (0.0, 0.5), (0.25, 1.0)])
@pytest.mark.parametrize("yaw", [0, 20])
def test_flat_bodies_glide_over_a_grate(yaw, friction, speed, shape, rate):
    world = vx.World(time_step=1 / rate)
    world.add(grate(), mass=0, pose=(0, 0, -0.01))
    own = {"Box": vx.Box((0.05, 0.05, 0.05)), "Cylinder": vx.Cylinder(0.05, 0.1)}
    pose = vx.pose((-0.25, 0.013, 0.05), euler=(0, 0, np.radians(yaw)))
    body = world.add(own.get(shape) or model(shape), mass=1, pose=pose, friction=2 * friction)
    world.step(rate // 10)
    start = body.position[0]
    body.linear_velocity = (speed, 0, 0)
    world.step(round(0.8 * rate))
    way = speed * 0.8
    if friction > 0:
        way = speed**2 / (2 * friction * 9.81) - 0.5 * speed / rate
    assert body.position[0] - start == pytest.approx(way, rel=0.02)
    assert body.position[2] == pytest.approx(0.05, abs=1e-4)
    assert np.linalg.norm(body.angular_velocity) < 0.3


def wedge(angle: float) -> vx.Model:
    """It rises from the origin along x."""
    corners = [(0, 0), (0.3, 0.3 * math.tan(angle)), (0.3, -0.04), (0, -0.04)]
    points = [(x, y, z) for y in (-0.2, 0.2) for x, z in corners]
    return vx.Model.from_mesh(convex_hull(points))


@pytest.mark.parametrize("rate", [1000, 200, 60])
@pytest.mark.parametrize("shape", ["model", "box"])
def test_a_cube_climbs_a_gentle_ramp_of_another_body(shape, rate):
    angle = math.radians(5)
    world = vx.World(time_step=1 / rate)
    world.add(wedge(angle), mass=0, friction=0)
    floor = vx.Model.from_mesh(box((0.5, 0.4, 0.04)))
    world.add(floor, mass=0, friction=0, pose=(-0.25, 0, -0.02))
    half = np.array((0.03, 0.03, 0.03))
    cube = vx.Box(half) if shape == "box" else box(2 * half)
    body = world.add(cube, mass=1, friction=0, pose=(-0.1, 0.003, 0.03))
    body.linear_velocity = (0.6, 0, 0)
    highest = 0.0
    for _ in range(rate):
        world.step()
        highest = max(highest, body.position[2] - 0.03)
    assert highest == pytest.approx(0.6**2 / (2 * 9.81), rel=0.05)


# Steps of 2 mm and more stop what slides, whatever the body and its rate.
@pytest.mark.parametrize("rate", [1000, 200, 60, 30])
@pytest.mark.parametrize("shape", ["model", "box"])
@pytest.mark.parametrize("height", [0.002, 0.005])
def test_a_low_step_stops_a_cube_on_a_plane(height, shape, rate):
    world = vx.World(time_step=1 / rate)
    world.add(vx.Plane(), mass=0, friction=0)
    step = vx.Model.from_mesh(box((0.4, 0.5, 0.04 + height)))
    world.add(step, mass=0, friction=0, pose=(0.3, 0, height / 2 - 0.02))
    cube = vx.Box((0.05, 0.05, 0.05)) if shape == "box" else model("cube")
    body = world.add(cube, mass=1, friction=0, pose=(0, 0, 0.05))
    body.linear_velocity = (0.4, 0, 0)
    world.step(round(0.5 * rate))
    assert body.position[0] < 0.051
    assert body.position[2] == pytest.approx(0.05, abs=1e-4)
    assert body.linear_velocity[0] <= 0.01


@pytest.mark.parametrize("rate", [1000, 200, 60])
@pytest.mark.parametrize("x", [-0.4, -0.3, -0.123])
def test_a_block_slides_along_the_edge_that_it_overhangs(x, rate):
    world = vx.World(time_step=1 / rate)
    table = vx.Model.from_mesh(box((2.0, 1.0, 0.1)))
    world.add(table, mass=0, pose=(0, -0.5, -0.05), friction=1)
    block = vx.Model.from_mesh(box((0.1, 0.1, 0.04)))
    body = world.add(block, mass=1, pose=(x, -0.03, 0.02), friction=0.2)
    world.step(round(0.3 * rate))
    steps = round(0.3 * rate)

    def pull(_: vx.World) -> None:
        body.apply_force((3.0, 0, 0), at=body.position - (0, 0, 0.02))

    world.step(steps, before=pull)
    assert body.linear_velocity[0] / (steps / rate) == pytest.approx(3.0 - 0.2 * 9.81, rel=0.02)


# Model on box, or box on model, did not move at all.
@pytest.mark.parametrize("rate", [1000, 200, 60])
@pytest.mark.parametrize("below", ["model", "box"])
def test_a_cube_slides_off_an_equal_one_of_another_kind(below, rate):
    world = vx.World(time_step=1 / rate)
    shapes = [model("cube"), vx.Box((0.05, 0.05, 0.05))]
    low, high = shapes if below == "model" else shapes[::-1]
    world.add(low, mass=0, pose=(0, 0, 0.05))
    body = world.add(high, mass=1, pose=(0, 0, 0.15))
    world.step(rate // 2)
    steps = rate // 10
    force = 2 * 0.25 * 9.81

    def pull(_: vx.World) -> None:
        body.apply_force((force, 0, 0), at=body.position - (0, 0, 0.05))

    world.step(steps, before=pull)
    assert body.linear_velocity[0] / (steps / rate) == pytest.approx(0.25 * 9.81, rel=0.05)


# The end of the second channel stopped what slid along its corner: most lost up to 94 % of their speed.
@pytest.mark.parametrize(("rate", "speed"), [(1000, 0.05), (200, 0.05), (60, 0.2)])
@pytest.mark.parametrize("kind", ["model", "box"])
def test_bodies_slide_along_the_corner_of_two_flush_channels(kind, rate, speed):
    section = [(-0.18, -0.03), (0.18, -0.03), (0.18, 0.06), (0.15, 0.06)]
    section += [(0.15, 0), (-0.15, 0), (-0.15, 0.06), (-0.18, 0.06)]
    mesh = extrude_polygon(Polygon(section), 0.6)
    mesh.apply_translation((0, 0, -0.3))
    mesh.apply_transform([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    channel = vx.Model.from_mesh(mesh)
    rng = np.random.default_rng(5)
    for side in (-1, 1, -1, 1):
        rolled = vx.pose(euler=(0, 0, rng.uniform(0, 2 * math.pi))) @ vx.pose(
            euler=(-0.2 * side, 0, 0)
        )
        world = vx.World(1 / rate)
        for x in (-0.3, 0.3):
            world.add(channel, mass=0, friction=0, pose=rolled @ at(x, 0, 0))
        before = rng.uniform(0.5, 1) * 0.16 * speed
        start = at(-before - 0.1, side * (0.09 - 5e-5), 0.05 + 5e-5)
        shape = vx.Box((0.1, 0.06, 0.05)) if kind == "box" else box((0.2, 0.12, 0.1))
        body = world.add(shape, mass=2, friction=0, pose=rolled @ start)
        body.linear_velocity = speed * rolled[:3, 0]
        for _ in range(round((before + 0.01) / speed * rate)):
            world.step()
            assert body.linear_velocity @ rolled[:3, 0] > 0.95 * speed


@cache
def make_plate_and_gears(distance: float) -> list[vx.Model]:
    """12 teeth drive 24, on a plate with pins at this distance."""
    plate = m3.Manifold.cube((0.12, 0.07, 0.004), center=True).translate((0.018, 0, -0.002))
    for x in (0.0, distance):
        pin = m3.Manifold.cylinder(0.011, 0.0039, circular_segments=96)
        plate += pin.translate((x, 0, -0.001))
    solids = [plate, *(make_gear(n, 0.002, 0.008, 0.004, 0.0002) for n in (12, 24))]
    return [vx.Model.from_mesh(as_mesh(solid), voxel_size=0.0004) for solid in solids]


@pytest.mark.filterwarnings("ignore::voxshell.AccuracyWarning")
@pytest.mark.parametrize("speed", [13 / 14, 67 / 70])  # turns/s
def test_contacts_that_are_turned_are_no_deeper_than_before(speed):
    # Edges of teeth touch the plate and the other gear.
    rate, distance = 500, 0.036
    world = vx.World(time_step=1 / rate, sleeping=False)
    plate, *models = make_plate_and_gears(distance)
    world.add(plate, mass=0.0, friction=0.1)
    meshed = vx.pose((distance, 0.0, 0.0), euler=(0.0, 0.0, math.pi / 24))
    small = world.add(models[0], mass=0.05, friction=0.1)
    world.add(models[1], mass=0.2, pose=meshed, friction=0.1)
    inertia = models[0].mass_properties(0.05).inertia[2, 2]
    deepest = 0.0
    for i in range(1000):
        missing = 2.0 * math.pi * speed - small.angular_velocity[2]
        small.apply_torque((0.0, 0.0, float(np.clip(missing * inertia * rate, -0.05, 0.05))))
        world.step(1)
        if i >= 50:  # the pins begin in the gears
            deepest = max(deepest, world.contacts()["depth"].max(initial=0.0))
    assert small.angular_velocity[2] > 0.8 * 2.0 * math.pi * speed
    assert deepest < 4e-5
