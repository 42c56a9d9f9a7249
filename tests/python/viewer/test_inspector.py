"""The inspector in a real browser: controls change the picture, a drag moves contacts."""

from __future__ import annotations

import io
import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from PIL import Image
from player import PATIENCE, Player, complaints_of
from playwright.sync_api import Browser, Page
from voxshell.viewer.inspector import Inspector
from voxshell.viewer.layers import describe_slice, find_box, find_level_surface, paint_slice
from voxshell.viewer.page import plain_head
from voxshell.viewer.server import make_address, silent_server

HALF = (0.03, 0.02, 0.01)


@pytest.fixture(scope="module")
def brick() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.box(2.0 * np.array(HALF)), resolution=60)


def test_a_slice_shows_the_field_the_right_way_round():
    mesh = trimesh.creation.box((0.06, 0.04, 0.02))
    mesh.apply_translation((0.01, 0.0, 0.005))
    tower = trimesh.creation.box((0.02, 0.01, 0.03)).apply_translation((0.03, 0.012, 0.02))
    model = vx.Model.from_mesh(
        trimesh.util.concatenate([mesh, tower]), sign="winding", resolution=60
    )
    low, high = find_box(model)
    for number, axis in enumerate("xyz"):
        fraction = (np.array((0.03, 0.012, 0.02))[number] - low[number]) / (high - low)[number]
        picture = paint_slice(model, axis, float(fraction)).astype(int)
        blue = picture[..., 2] > picture[..., 0] + 20
        rows, columns = np.nonzero(blue)
        first, second = (i for i in range(3) if i != number)
        tall = np.array(picture.shape[:2]) - 1
        found = low[second] + rows / tall[0] * (high - low)[second]
        across = low[first] + columns / tall[1] * (high - low)[first]
        # Of the part of the solid that is in this plane: where it ends, on both sides.
        solid = [(-0.02, 0.04), (-0.02, 0.02), (-0.005, 0.035)]
        if axis == "z":
            solid = [(0.02, 0.04), (0.007, 0.017), (0.0, 0.0)]
        for values, side in ((across, solid[first]), (found, solid[second])):
            assert (values.min(), values.max()) == pytest.approx(side, abs=0.002)


def test_a_level_surface_lies_where_the_field_has_that_value(brick):
    for distance in (-0.004, 0.0, 0.005):
        surface = find_level_surface(brick, distance)
        assert len(surface.faces) > 100
        values = brick.field.sample(surface.vertices)
        assert np.median(np.abs(values - distance)) < 1e-4
        # Level surfaces are made on a grid of their own, and cut edges off.
        assert np.abs(values - distance).max() < 0.001
    assert len(find_level_surface(brick, -0.1).faces) == 0


class Visit:
    """A page of the inspector in the browser, and what it complained of."""

    def __init__(self, browser: Browser, address: str) -> None:
        self.page: Page = browser.new_page(viewport={"width": 760, "height": 420})
        self.page.set_default_timeout(PATIENCE * 1000.0)
        self.complaints = complaints_of(self.page)
        self.page.goto(address)
        self.page.wait_for_selector("canvas[data-engine]")
        self.page.add_style_tag(content=".mantine-Notifications-root { display: none; }")

    def picture(self) -> np.ndarray:
        """(h, w, 3) what is beside the controls, 0 to 255."""
        shot = self.page.screenshot(timeout=PATIENCE * 1000.0)
        return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), dtype=np.int64)[:, :420]

    def wait(self, wanted: Callable[[], bool], what: str) -> None:
        end = time.monotonic() + PATIENCE
        while not wanted():
            assert time.monotonic() < end, f"{what}; {self.complaints}"
            time.sleep(0.1)

    def differs(self, before: np.ndarray, pixels: int = 100) -> bool:
        return int(np.sum(np.abs(self.picture() - before).max(axis=2) > 25)) > pixels

    def settled(self) -> np.ndarray:
        """The picture once it no longer changes."""
        before, now = self.picture(), self.picture()
        while np.abs(now - before).max() > 25:
            time.sleep(0.1)
            before, now = now, self.picture()
        return now

    def type(self, number: int, value: str) -> None:
        """Types into one of the fields of numbers, counted from the first."""
        field = self.page.get_by_role("textbox").filter(visible=True).nth(number)
        field.fill(value)
        field.blur()

    def readout(self) -> tuple[int, float]:
        """Contacts, and signed distance in millimeters."""
        text = self.page.get_by_text(re.compile(r"\d contacts, ")).inner_text()
        count, value, side = re.fullmatch(r"([\d,]+) contacts, ([\d.]+) mm (\w+)", text).groups()
        return int(count.replace(",", "")), float(value) * (-1.0 if side == "deep" else 1.0)


@pytest.fixture
def visit(browser: Browser, brick: vx.Model) -> Iterator[tuple[Visit, Inspector]]:
    with silent_server(token="secret", head=plain_head()) as server:
        inspector = Inspector(server, brick, vx.Sphere(0.015), name="brick")
        visit = Visit(browser, make_address(server, "secret"))
        visit.wait(lambda: int(np.sum(visit.picture().min(axis=2) < 240)) > 2000, "nothing is seen")
        yield visit, inspector
        visit.page.close()


def colored(picture: np.ndarray, red: int, green: int, blue: int) -> np.ndarray:
    """Whether each pixel is about of a color."""
    return np.abs(picture - (red, green, blue)).max(axis=2) < 30


def drag_up(page: Visit, *, right: bool) -> None:
    """Pulls a body by its blue arrow, which is along z and drawn up."""
    rows, columns = np.nonzero(colored(page.settled(), 54, 142, 226))
    side = (columns > 330) == right
    rows, columns = rows[side], columns[side]
    grip = np.argsort(rows)[20]
    x, y = float(columns[grip]), float(rows[grip])
    mouse = page.page.mouse
    mouse.move(x, y)
    time.sleep(0.5)
    mouse.down()
    for part in range(1, 6):
        time.sleep(0.1)
        mouse.move(x, y - 12.0 * part)
    mouse.up()


def still_for(inspector: Inspector, seconds: float) -> bool:
    """Whether no body moves for a while, as the page sends the rest of a drag late."""
    before = inspector.poses
    time.sleep(seconds)
    return np.array_equal(inspector.poses, before)


def test_a_drag_moves_either_body_and_its_contacts(visit: tuple[Visit, Inspector]):
    page, inspector = visit
    # A brick of 60 mm, and right of it a sphere of 15 mm that touches it.
    assert page.readout()[0] == 0
    assert page.readout()[1] == pytest.approx(0.0, abs=0.2)
    for moved in (1, 0):
        before, told = inspector.poses, page.readout()
        drag_up(page, right=moved == 1)
        page.wait(lambda moved=moved: inspector.poses[moved][2, 3] > 0.01, "the drag moves nothing")
        page.wait(lambda: still_for(inspector, 1.0), "the body does not come to rest")
        page.wait(lambda told=told: page.readout() != told, "contacts do not follow")
        lift = inspector.poses[moved] - before[moved]
        lift[2, 3] = 0.0
        assert np.abs(lift).max() < 1e-6
        assert np.array_equal(inspector.poses[1 - moved], before[1 - moved])
    assert page.complaints == []


def test_a_page_of_a_slow_machine_is_not_pale(visit: tuple[Visit, Inspector]):
    page, _ = visit
    canvas = "getComputedStyle(document.querySelector('canvas[data-engine]'))"
    # viser fades it in over five pictures, and draws the next one when something changes.
    assert page.page.evaluate(f"{canvas}.opacity") == "1"
    # A picture of a room would be blurred for its light, for seconds.
    assert page.page.evaluate("window.__viserMutable.scene.environment") is None


def test_a_place_typed_in_moves_either_body_and_its_contacts(
    visit: tuple[Visit, Inspector], brick: vx.Model
):
    page, inspector = visit
    count = page.page.get_by_role("textbox").filter(visible=True).count()
    for field, value, wanted in ((-3, "40", -5.0), (-6, "5", -10.0)):
        page.type(count + field, value)
        page.wait(
            lambda wanted=wanted: page.readout()[1] == pytest.approx(wanted, abs=0.01),
            "the field moves nothing",
        )
        first, second = inspector.poses
        assert second[0, 3] - first[0, 3] == pytest.approx(0.045 + 1e-3 * wanted)
        assert page.readout()[0] == len(vx.contacts(brick, vx.Sphere(0.015), first, second)) > 0
    assert page.complaints == []


@pytest.mark.slow
def test_every_control_changes_the_picture(visit: tuple[Visit, Inspector]):
    page, _ = visit
    boxes = page.page.get_by_role("checkbox")
    surface, slice_, level, points, normals, spheres = range(6)
    assert boxes.count() == 6
    opacity, at, distance, tree_level = range(4)

    def tick(number: int) -> Callable[[], None]:
        return lambda: boxes.nth(number).click()

    def type_in(number: int, value: str) -> Callable[[], None]:
        return lambda: page.type(number, value)

    def choose_axis() -> None:
        page.page.get_by_role("combobox", name="across").click()
        page.page.get_by_role("option", name="x").click()

    steps: list[tuple[str, Callable[[], None]]] = [
        ("opacity", type_in(opacity, "0.3")),
        ("surface", tick(surface)),
        ("slice", tick(slice_)),
        ("across", choose_axis),
        ("at", type_in(at, "0.8")),
        ("slice, off", tick(slice_)),
        ("level surface", tick(level)),
        ("distance", type_in(distance, "9")),
        ("level surface, off", tick(level)),
        ("points", tick(points)),
        ("tree level, of points", type_in(tree_level, "6")),
        ("points, off", tick(points)),
        ("normals", tick(normals)),
        ("tree level, of normals", type_in(tree_level, "1")),
        ("normals, off", tick(normals)),
        ("spheres", tick(spheres)),
        ("tree level, of spheres", type_in(tree_level, "4")),
        ("spheres, off", tick(spheres)),
    ]
    for label, act in steps:
        before = page.settled()
        act()
        page.wait(lambda before=before: page.differs(before), f"{label} changes nothing")
    assert page.complaints == []


def test_the_exported_page_shows_the_scene_offline(
    play: Callable[[Path], Player], brick: vx.Model, tmp_path: Path
):
    with silent_server() as server:
        inspector = Inspector(
            server, brick, vx.Sphere(0.015), show=("slice", "points"), name="a <brick>"
        )
        path = inspector.save_html(tmp_path / "brick.html")
    player = play(path)
    picture = player.wait(lambda p: int(np.sum(p.min(axis=2) < 200)) > 3000, "nothing is seen")
    # No arrows and rings: nothing would follow them.
    assert not colored(picture, 255, 45, 98).any()
    assert player.page.title() == "a <brick>"
    assert player.complaints == []
    assert player.fetched == [path.as_uri()]


def test_the_exported_page_explains_the_colors_of_its_layers(brick: vx.Model, tmp_path: Path):
    pose = np.eye(4)
    pose[0, 3] = 0.04  # 5 mm deep
    with silent_server() as server:
        inspector = Inspector(
            server, brick, vx.Sphere(0.015), pose=pose, show=("slice", "points"), name="brick"
        )
        shown = inspector.save_html(tmp_path / "layers.html").read_text()
        plain = Inspector(server, brick).save_html(tmp_path / "plain.html").read_text()
    legend = shown[shown.index('<div class="legend">') :]
    assert "slice: " in legend
    assert describe_slice(brick) in legend
    assert "a color: the points of one sphere of the tree's level 3" in legend
    assert "contact depth 0" in legend
    assert f"{len(brick.mesh.faces):,} triangles" in shown[shown.index("<h1>") :]
    legend = plain[plain.index('<div class="legend">') :]
    assert not any(word in legend for word in ("slice: ", "a color: ", "contact depth"))


def test_the_legend_of_a_slice_has_its_distances_and_the_width_of_a_band():
    # The box around a ball of radius 0.1 is enlarged by a fifth of its side on all sides.
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(2, radius=0.1), voxel_size=0.02)
    legend = describe_slice(ball)
    assert "14 cm inside" in legend
    assert "14 cm outside" in legend
    assert "a band: 1.17 cm" in legend
