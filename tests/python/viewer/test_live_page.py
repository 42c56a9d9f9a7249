"""A view in a real browser: buttons hold up the run, and a drag moves a body."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest
import voxshell as vx
from marks_on_page import read_drawn
from player import PATIENCE, complaints_of
from playwright.sync_api import Browser, Page
from voxshell.simulation.live_frame import LiveFrame
from voxshell.simulation.live_view import LiveView
from voxshell.viewer.live_page import LivePage, find_up

# Of viser's own handler of the mouse; nothing is lost by it.
HARMLESS = ("Unable to preventDefault inside passive event listener invocation.",)
WIDTH, HEIGHT = 900, 560
# Notes when the page shows a picture that was rendered with the body in it, ms since 1970.
NOTE_PICTURE = """
  let before = null;
  function look() {
    const player = window.__viserMutable, points = window.__viserTestpoints;
    const body = player && player.nodeRefFromName && player.nodeRefFromName["BODY"];
    if (body && points) {
      before ??= points.rendererInfo.render.frame;
      if (points.rendererInfo.render.frame > before) return void (window.pictureAt = Date.now());
    }
    requestAnimationFrame(look);
  }
  requestAnimationFrame(look);
"""


class Watched:
    """A box on the ground that is stepped in a thread, and a browser that shows it."""

    def __init__(self, browser: Browser) -> None:
        self.world = vx.World(sleeping=False)
        self.world.add(vx.Plane(), mass=0)
        self.box = self.world.add(vx.Box((0.1, 0.1, 0.1)), mass=2.0, pose=(0, 0, 0.1), name="box")
        self.ends = threading.Event()
        self.view: LiveView = self.world.view(port=0, title="a <box>", speed=1.0)
        self.page: Page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        self.page.set_default_timeout(PATIENCE * 1000.0)
        self.complaints = complaints_of(self.page)
        self.page.goto(self.view.address)
        self.page.wait_for_selector("canvas[data-engine]")
        self.page.add_style_tag(content=".mantine-Notifications-root { display: none; }")
        self.wait(lambda: self.view.page_count == 1, "the page is not counted")
        self.thread = threading.Thread(target=self._run)
        self.thread.start()

    def _run(self) -> None:
        while not self.ends.is_set():
            self.world.step()

    def close(self) -> None:
        self.ends.set()
        self.view.close()
        self.thread.join(PATIENCE)
        assert not self.thread.is_alive()
        if not self.page.is_closed():
            self.page.close()

    def wait(self, wanted: Callable[[], bool], what: str) -> None:
        end = time.monotonic() + PATIENCE
        while not wanted():
            assert time.monotonic() < end, f"{what}; {self.complaints}"
            self.page.wait_for_timeout(50)

    def is_still(self) -> bool:
        before = self.world.time
        self.page.wait_for_timeout(150)
        return self.world.time == before

    def find_box(self) -> tuple[float, float]:
        """Where the middle of the box is on the page, pixels: its color is of no other thing."""
        import io

        from PIL import Image

        shot = self.page.screenshot(timeout=PATIENCE * 1000.0)
        picture = np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), dtype=np.int64)[:, :560]
        strong = picture.max(axis=2) - picture.min(axis=2) > 25
        rows, columns = np.nonzero(strong)
        if len(rows) < 200:
            return (0.0, 0.0)
        return float(np.median(columns)), float(np.median(rows))


@pytest.fixture
def watched(browser: Browser) -> Iterator[Watched]:
    watched = Watched(browser)
    yield watched
    watched.close()


def test_buttons_pause_step_and_resume_and_a_closed_page_lets_the_run_go_on(watched: Watched):
    page, world = watched.page, watched.world
    watched.wait(lambda: world.time > 0.0, "no step")
    page.get_by_role("button", name="Pause").click()
    watched.wait(watched.is_still, "the run goes on")
    page.get_by_text("paused").wait_for()
    before = world.time
    page.get_by_role("button", name="Step").click()
    watched.wait(lambda: world.time > before, "no step")
    assert watched.is_still()
    assert world.time == pytest.approx(before + world.time_step)
    page.get_by_role("button", name="Resume").click()
    watched.wait(lambda: world.time > before + 0.1, "the pause does not end")
    page.get_by_role("button", name="Reset camera").click()
    page.get_by_role("button", name="Pause").click()
    watched.wait(watched.is_still, "the run goes on")
    assert [each for each in watched.complaints if each not in HARMLESS] == []
    before = world.time
    page.close()
    end = time.monotonic() + PATIENCE
    while world.time == before:
        assert time.monotonic() < end, "the run waits for a page that is closed"
        time.sleep(0.05)
    assert watched.view.page_count == 0
    assert watched.view.is_open


def test_the_first_step_waits_until_the_page_has_drawn_the_bodies(browser: Browser):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    ball = world.add(vx.Sphere(0.1), pose=(0, 0, 0.5))
    stepped_at: list[float] = []

    def run() -> None:
        world.step()
        stepped_at.append(1000.0 * time.time())

    with world.view(port=0, speed=1.0, wait=PATIENCE) as view:
        thread = threading.Thread(target=run)
        thread.start()
        page = browser.new_page()
        page.set_default_timeout(PATIENCE * 1000.0)
        page.add_init_script(NOTE_PICTURE.replace("BODY", f"/bodies/dynamic {ball.number}"))
        page.goto(view.address)
        thread.join(0.5 * PATIENCE)
        assert not thread.is_alive(), "the page does not say that it has drawn"
        page.wait_for_function("window.pictureAt")
        assert page.evaluate("window.pictureAt") <= stepped_at[0]
        page.close()


def test_a_view_of_an_empty_world_begins_when_its_page_has_drawn(browser: Browser):
    world = vx.World()
    with world.view(port=0, speed=1.0, wait=PATIENCE) as view:
        thread = threading.Thread(target=world.step)
        thread.start()
        page = browser.new_page()
        page.goto(view.address)
        thread.join(0.5 * PATIENCE)
        assert not thread.is_alive()
        page.close()


def test_a_page_says_when_the_program_makes_no_steps(watched: Watched):
    watched.page.get_by_text("running at").wait_for()
    watched.ends.set()
    watched.page.get_by_text("waiting for the next step").wait_for()
    watched.world.step()
    watched.wait(lambda: watched.is_still(), "the run goes on")
    time_shown = f"{watched.world.time:.3f} s"
    watched.page.get_by_text(time_shown).first.wait_for()
    ball = watched.world.add(vx.Sphere(0.05), pose=(0, 0, 0.5))
    watched.page.get_by_text("3 bodies").wait_for()
    watched.world.remove(ball)
    watched.page.get_by_text("2 bodies").wait_for()


def test_a_page_says_that_its_view_has_ended(watched: Watched):
    watched.page.get_by_text("running at").wait_for()
    watched.view.close()
    watched.page.get_by_text("ended at").wait_for()
    watched.page.get_by_text("the program has ended or closed this view").wait_for()
    watched.page.get_by_role("button", name="Pause").wait_for(state="hidden")
    assert watched.page.get_by_text("running at").count() == 0


def test_a_page_whose_view_has_ended_does_not_try_to_connect_again(watched: Watched):
    told: list[str] = []
    watched.page.on("console", lambda message: told.append(message.text))
    watched.page.get_by_text("running at").wait_for()
    watched.view.close()
    watched.page.get_by_text("ended at").wait_for()
    watched.wait(lambda: any("Disconnected" in each for each in told), "the page stays connected")
    watched.page.wait_for_timeout(1000)  # a page that draws slowly tries until it reads that
    told.clear()
    watched.page.wait_for_timeout(3000)  # it would try every second
    assert not [each for each in told if "Connecting" in each]


def test_the_camera_of_a_view_stays_above_the_ground(watched: Watched):
    page, mouse = watched.page, watched.page.mouse
    read = "window.__viserMutable.cameraControl.camera.position.y"  # the ground is at 0
    watched.wait(lambda: watched.find_box() != (0.0, 0.0), "the box is not seen")
    height = page.evaluate(read)
    mouse.move(30, 500)
    mouse.down()
    for step in range(1, 6):
        mouse.move(30, 500 - 80 * step)
    mouse.up()
    watched.wait(lambda: page.evaluate(read) < 0.3 * height, "the drag turns nothing")
    for _ in range(10):
        page.wait_for_timeout(100)
        assert page.evaluate(read) > 0.0


@pytest.mark.parametrize("ending", ["", "raise SystemExit(3)", "1 / 0"])
def test_a_page_says_that_its_program_has_ended(browser: Browser, ending: str):
    code = f"""
import voxshell as vx
world = vx.World()
world.add(vx.Sphere(0.1))
view = world.view(port=0, wait=60)
print(view.address, flush=True)
world.step()
input()
{ending}
"""
    with subprocess.Popen(
        [sys.executable, "-c", code],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        page = browser.new_page()
        page.set_default_timeout(PATIENCE * 1000.0)
        page.goto(process.stdout.readline().strip())
        page.get_by_text("waiting for the next step").wait_for()
        process.stdin.write("\n")
        process.stdin.close()
        page.get_by_text("the program has ended or closed this view").wait_for()
        process.wait(PATIENCE)
        page.close()


def test_a_page_whose_program_was_killed_says_so_and_tries_ever_less_to_connect_again(
    browser: Browser,
):
    code = """
import voxshell as vx
world = vx.World()
world.add(vx.Sphere(0.1))
view = world.view(port=0)
print(view.address, flush=True)
input()
"""
    told: list[str] = []
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        page = browser.new_page()
        page.set_default_timeout(PATIENCE * 1000.0)
        page.clock.install()
        page.on("console", lambda message: told.append(message.text))
        page.goto(process.stdout.readline().strip())
        page.get_by_text("waiting for the next step").wait_for()
        told.clear()
        process.kill()
    notice = page.get_by_role("alert")
    notice.get_by_text("The program has ended without closing this view.").wait_for()
    assert count_tries(told) <= 2
    notice.get_by_text("tries to connect again").wait_for()
    for _ in range(20):
        page.clock.fast_forward(5_000)  # in which viser asks only once
        page.wait_for_timeout(100)
    assert 5 <= count_tries(told) <= 8  # not 20; some time passes beside
    for _ in range(5):
        page.clock.fast_forward(100_000)
        page.wait_for_timeout(300)
    notice.get_by_text("Close this page.").wait_for()
    told.clear()
    for _ in range(5):
        page.clock.fast_forward(100_000)
        page.wait_for_timeout(300)
    assert count_tries(told) == 0
    page.close()


def count_tries(told: list[str]) -> int:
    return sum("Connecting" in each for each in told)


def test_a_drag_lifts_the_body_and_a_release_drops_it(watched: Watched):
    mouse, box = watched.page.mouse, watched.box
    watched.wait(lambda: watched.find_box() != (0.0, 0.0), "the box is not seen")
    x, y = watched.find_box()
    mouse.move(x, y)
    watched.page.wait_for_timeout(300)
    mouse.down()
    for part in range(1, 9):
        mouse.move(x, y - 20.0 * part)
        watched.page.wait_for_timeout(50)
    watched.wait(lambda: box.position[2] > 0.12, "the drag moves nothing")
    assert len(watched.view.pulls) == 1
    mouse.up()
    watched.wait(lambda: len(watched.view.pulls) == 0, "the hand does not let go")
    watched.wait(lambda: box.position[2] < 0.11, "the box does not fall")
    assert [each for each in watched.complaints if each not in HARMLESS] == []


def test_contacts_are_within_a_pixel_of_where_they_are_playing_and_paused(
    browser: Browser, monkeypatch: pytest.MonkeyPatch
):
    frames: list[LiveFrame] = []
    show = LivePage.show

    def note(page: LivePage, frame: LiveFrame, *, last: bool) -> None:
        frames.append(frame)
        show(page, frame, last=last)

    monkeypatch.setattr(LivePage, "show", note)
    watched = Watched(browser)
    page, view = watched.page, watched.view
    live = view._page
    assert isinstance(live, LivePage)
    scale, body = live._scene.scale, f"/bodies/dynamic {watched.box.number}"

    def find_error() -> float:
        """Pixels between contacts as drawn and those of the frame that has the body's pose as drawn."""
        drawn = read_drawn(page, body, "/contacts")
        if drawn.places[body].shape != (1, 3) or len(drawn.places["/contacts"]) == 0:
            return np.inf
        shown = list(frames)
        middles = np.array([frame.poses[1, :3, 3] for frame in shown]) * scale
        apart = np.linalg.norm(drawn.place(middles) - drawn.places[body], axis=1)
        frame = shown[int(np.argmin(apart))]
        assert apart.min() < 1e-5
        return drawn.pixels_off("/contacts", frame.points * scale)

    try:
        # The box slides, so that the contacts of another frame are elsewhere.
        watched.box.linear_velocity = (0.3, 0.0, 0.0)
        watched.box.friction = 0.0
        watched.wait(lambda: find_error() < np.inf, "no contacts are drawn")
        for _ in range(5):
            assert find_error() < 1.0
            page.wait_for_timeout(100)
        view.pause()
        watched.wait(watched.is_still, "the run goes on")
        assert find_error() < 1.0
    finally:
        watched.close()


def test_a_stranger_is_turned_away(watched: Watched, browser: Browser):
    page = browser.new_page()
    response = page.goto(watched.view.address.rsplit("/", 2)[0] + "/")
    assert response is not None
    assert response.status == 403
    page.close()


@pytest.mark.parametrize(
    ("gravity", "up"),
    [((0, 0, -9.81), "+z"), ((0, -1, 0.1), "+y"), ((2, 0, 0), "-x"), ((0, 0, 0), "+z")],
)
def test_up_is_against_gravity(gravity: tuple[float, float, float], up: str):
    assert find_up(np.array(gravity, dtype=np.float64)) == up


@pytest.mark.parametrize(
    ("window", "free"),
    [
        ((1600, 600), (1600 - 340, 600)),
        ((1200, 700), (1200 - 340, 700)),
        ((700, 560), (700 - 340, 560)),
        ((440, 640), (440, 255)),
    ],
)
def test_bodies_are_beside_the_controls_in_windows_of_any_width(
    window: tuple[int, int], free: tuple[int, int]
):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    half = 0.1
    for x in (0.0, 0.4):
        world.add(vx.Box((half, half, half)), pose=(x, 0, 0.1))
    with world.view(port=0) as view:
        live = view._page
        assert isinstance(live, LivePage)
        assert live._frame is not None
        camera = live._find_camera(live._frame, window)
        scale = live._scene.scale
    assert camera is not None
    corners = np.array([(x, y, z) for x in (-0.1, 0.5) for y in (-0.1, 0.1) for z in (0.0, 0.2)])
    forward = camera.target - camera.position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0, 0, 1)) / np.linalg.norm(np.cross(forward, (0, 0, 1)))
    seen = scale * corners - camera.position
    pixels = window[1] / (2.0 * np.tan(0.5 * camera.field_of_view) * (seen @ forward))
    x = 0.5 * window[0] + pixels * (seen @ right)
    y = 0.5 * window[1] - pixels * (seen @ np.cross(right, forward))
    assert 0 < x.min() < x.max() < free[0]
    assert 0 < y.min() < y.max() < free[1]
    # They fill some of what is free.
    assert np.ptp(x) > 0.3 * free[0] or np.ptp(y) > 0.3 * free[1]
