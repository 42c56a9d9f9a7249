"""Replays, written and then played by a real browser with no network."""

from __future__ import annotations

import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
import viser
from marks_on_page import read_drawn
from player import PATIENCE, Player
from playwright.sync_api import expect
from voxshell.errors import RecordingError, SettingsError
from voxshell.recording import BodyTrack, ContactTrack, Recording
from voxshell.viewer.lanes import Lane, arrange_lanes
from voxshell.viewer.replay import _describe_rate, save_replay
from voxshell.viewer.stage import place_camera, plan_stage
from voxshell.viewer.timeline import plan_timeline

BALL = trimesh.creation.icosphere(subdivisions=2, radius=0.1)
BLOCK = trimesh.creation.box((2.0, 2.0, 0.5))
FRAMES, TIME_STEP = 200, 1 / 200  # one second
LANDS = 100  # the step from which on there are contacts


def fall_and_roll(seed: int = 0) -> Recording:
    """A tumbling ball that falls, lands after half a second, and rolls on with contacts."""
    rng = np.random.default_rng(seed)
    step = np.arange(FRAMES)
    poses = np.array(
        [trimesh.transformations.rotation_matrix(0.05 * i, [1.0, 2.0, 0.5]) for i in step]
    )
    poses[:, 0, 3] = np.where(step > LANDS, 0.001 * (step - LANDS), 0.0)
    poses[:, 2, 3] = 0.095 + 0.4 * np.clip(1.0 - step / LANDS, 0.0, 1.0) ** 0.5
    ground = np.tile(np.eye(4), (FRAMES, 1, 1))
    ground[:, 2, 3] = -0.25
    contacts = []
    for i in step:
        count = int(rng.integers(5, 40)) if i >= LANDS else 0
        points = np.zeros((count, 3))
        points[:, :2] = poses[i, :2, 3] + rng.uniform(-0.04, 0.04, (count, 2))
        normals = np.tile([0.0, 0.0, 1.0], (count, 1))
        contacts.append((points, normals, rng.uniform(0.0, 0.005, count)))
    bodies = (
        BodyTrack("ball", BALL.vertices, BALL.faces, (60, 110, 220), poses),
        BodyTrack("ground", BLOCK.vertices, BLOCK.faces, None, ground),
    )
    return Recording(TIME_STEP, bodies, ContactTrack.from_frames(contacts))


@pytest.fixture(scope="module")
def replay(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("replay") / "replay.html"
    lanes = arrange_lanes({"fine": fall_and_roll(1), "coarse": fall_and_roll(2)})
    return save_replay(path, lanes, title="A ball & a block")


def blue(picture: np.ndarray) -> int:
    """Pixels of the balls' color."""
    red, green, blue = np.moveaxis(picture, 2, 0)
    return int(np.sum((blue > red + 40) & (blue > green + 20)))


def warm(picture: np.ndarray) -> int:
    """Pixels of the contacts' colors."""
    red, _, blue = np.moveaxis(picture, 2, 0)
    return int(np.sum(red > blue + 60))


def test_the_page_plays_offline(play: Callable[[Path], Player], replay: Path):
    player = play(replay)
    first = player.wait(lambda p: blue(p) > 200, "no ball is seen")
    player.wait(
        lambda p: blue(p) > 200 and int(np.sum(np.abs(p - first).max(axis=2) > 30)) > 100,
        "the picture does not change while it plays",
    )
    # Before the balls land there are no contacts, afterwards there are; and back again.
    player.pause()
    player.seek(0.1)
    player.wait(lambda p: blue(p) > 200 and warm(p) == 0, "contacts before there are any")
    player.seek(0.9)
    through = warm(player.wait(lambda p: blue(p) > 200 and warm(p) > 50, "contacts are not seen"))
    player.page.uncheck("#voxshell-through")
    player.wait(lambda p: warm(p) < 0.7 * through, "bodies do not hide contacts when told to")
    player.seek(0.1)
    player.wait(lambda p: blue(p) > 200 and warm(p) == 0, "contacts stay when seeking back")
    # Of plots 240 wide, over the 0.995 s of the recording.
    marks = player.page.locator("#voxshell-plots .now").all()
    places = [float(mark.get_attribute("x1") or "nan") for mark in marks]
    assert places == pytest.approx([240 * 0.1 / 0.995] * 2, abs=1.0)
    assert player.page.title() == "A ball & a block"
    assert "Plays in real time" in player.page.inner_text("#voxshell-heading")
    assert player.complaints == []
    assert player.fetched == [replay.as_uri()]


def test_a_body_that_comes_later_is_not_seen_before(play: Callable[[Path], Player], tmp_path: Path):
    recording = fall_and_roll(4)
    ball, ground = recording.bodies
    late = BodyTrack(ball.name, ball.vertices, ball.faces, ball.color, ball.poses, LANDS)
    recording = Recording(TIME_STEP, (late, ground), recording.contacts)
    player = play(recording.save_html(tmp_path / "late.html"))
    player.pause()
    for _ in range(2):
        player.seek(0.9)
        player.wait(lambda p: blue(p) > 200, "no ball is seen")
        player.seek(0.1)
        player.wait(lambda p: blue(p) == 0, "a ball is seen before it is there")


def test_contacts_are_within_a_pixel_of_where_they_are_playing_and_paused(
    play: Callable[[Path], Player], tmp_path: Path
):
    recording = fall_and_roll(3)
    lane = Lane("", recording)
    player = play(save_replay(tmp_path / "replay.html", [lane], title=""))
    scale = plan_stage([lane], up="+z").scale
    body, contacts = "/lane 1/ball", "/lane 1/contacts"
    # At 60 pictures a second, every fourth of 200 steps a second, and the last.
    shown = np.append(np.arange(0, FRAMES, 4), FRAMES - 1)

    def find_error() -> tuple[int, float]:
        """The frame that has the body's place as drawn, and how far its contacts are off, pixels."""
        drawn = read_drawn(player.page, body, contacts)
        middles = recording.bodies[0].poses[shown, :3, 3] * scale
        apart = np.linalg.norm(drawn.place(middles) - drawn.places[body], axis=1)
        assert apart.min() < 0.01
        frame = int(shown[np.argmin(apart)])
        return frame, drawn.pixels_off(contacts, recording.contacts.frame(frame).points * scale)

    player.wait(lambda p: blue(p) > 200, "no ball is seen")
    found = []
    for _ in range(10):
        player.page.wait_for_timeout(120)
        found.append(find_error())
    player.pause()
    for seconds in (0.6, 0.9):
        player.seek(seconds)
        player.wait(lambda p: warm(p) > 50, "contacts are not seen")
        found.append(find_error())
    assert max(error for _, error in found) < 1.0
    assert found[-1][0] > LANDS


def test_the_clock_and_the_bar_end_with_the_recording(play: Callable[[Path], Player], replay: Path):
    player = play(replay)
    player.wait(lambda p: blue(p) > 200, "no ball is seen")
    player.pause()
    bar = player.page.locator("#voxshell-bar")
    clock = player.page.locator("input.mantine-NumberInput-input").first
    assert bar.get_attribute("max") == "0.995"
    player.seek(0.4)
    expect(bar).to_have_value("0.4", timeout=PATIENCE * 1000.0)
    clock.fill("1.7")  # while the last picture stays
    clock.blur()
    expect(bar).to_have_value("0.995", timeout=PATIENCE * 1000.0)
    expect(clock).to_have_value("1.0", timeout=PATIENCE * 1000.0)
    player.wait(lambda p: blue(p) > 200 and warm(p) > 50, "the last picture does not stay")
    bar.fill("0.1")
    expect(clock).to_have_value("0.1", timeout=PATIENCE * 1000.0)
    player.wait(lambda p: blue(p) > 200 and warm(p) == 0, "contacts stay when seeking back")
    player.page.locator(".mantine-Slider-root").wait_for(state="hidden")


def test_the_speed_is_written_out(play: Callable[[Path], Player], replay: Path):
    speed = play(replay).page.locator("input.mantine-Select-input").first
    assert speed.input_value() == "1x"
    room = """(input) => {
        const style = getComputedStyle(input), canvas = document.createElement("canvas").getContext("2d");
        canvas.font = style.font;
        const sides = parseFloat(style.paddingLeft) + parseFloat(style.paddingRight);
        return input.clientWidth - sides - canvas.measureText("0.5x").width;
    }"""
    assert speed.evaluate(room) >= 0.0


def test_a_typed_time_is_kept_to_the_hundredth(play: Callable[[Path], Player], replay: Path):
    player = play(replay)
    player.wait(lambda p: blue(p) > 200, "no ball is seen")
    player.pause()
    clock = player.page.locator("input.mantine-NumberInput-input").first
    slider = player.page.locator("[role=slider]")
    clock.fill("0.42")
    expect(slider).to_have_attribute("aria-valuenow", "0.42", timeout=PATIENCE * 1000.0)
    clock.blur()
    expect(clock).to_have_value("0.42", timeout=PATIENCE * 1000.0)
    player.page.wait_for_timeout(500)
    assert slider.get_attribute("aria-valuenow") == "0.42"


def test_the_camera_stays_above_the_ground(play: Callable[[Path], Player], tmp_path: Path):
    player = play(fall_and_roll(1).save_html(tmp_path / "replay.html"))
    player.wait(lambda p: blue(p) > 200, "no ball is seen")
    # The ground is at 0. In the player, +y points up.
    read = "window.__viserMutable.cameraControl.camera.position.y"
    height = player.page.evaluate(read)
    mouse = player.page.mouse
    mouse.move(60, 250)
    mouse.down()
    for step in range(1, 6):
        mouse.move(60, 250 - 40 * step)
    mouse.up()

    def lowest() -> float:
        return min(
            player.page.evaluate(read) for _ in range(5) if not player.page.wait_for_timeout(100)
        )

    end = time.monotonic() + PATIENCE
    while lowest() > 0.5 * height:
        assert time.monotonic() < end, "the drag turns nothing"
    assert 0.0 < lowest() < 0.2 * height


def test_contacts_that_show_through_bodies_hide_each_other_as_solid_things_do(
    play: Callable[[Path], Player], tmp_path: Path
):
    _, ground = fall_and_roll().bodies
    poses = np.tile(np.eye(4), (2, 1, 1))
    ball = BodyTrack("ball", BALL.vertices, BALL.faces, None, poses)
    ground = BodyTrack("ground", BLOCK.vertices - (0, 0, 0.35), BLOCK.faces, None, poses)
    empty = Recording(0.1, (ball, ground), ContactTrack.empty(2))
    stage = plan_stage([Lane("", empty)], up="+z")
    camera = place_camera([(stage.low * stage.scale, stage.high * stage.scale)], rows=1, up="+z")
    # Both are in the middle of the picture, inside the ball, and the far one is drawn last.
    away = camera.target - camera.position
    away /= np.linalg.norm(away)
    center = camera.target / stage.scale
    points = center + np.array([[-0.03], [0.03]]) * away
    frame = (points, np.tile([0.0, 0.0, 1.0], (2, 1)), np.array([0.0, 0.005]))
    recording = Recording(0.1, empty.bodies, ContactTrack.from_frames([frame, frame]))
    player = play(recording.save_html(tmp_path / "replay.html"))

    player.wait(lambda p: warm(p) > 4, "no contact is seen")
    drawn = read_drawn(player.page, "/lane 1/contacts")
    column, row = drawn.project(drawn.places["/lane 1/contacts"])[0].round().astype(int)
    seen = player.picture()[row, column]
    assert seen[1] > 100, "the far contact, dark red, is before the near one, yellow"


def test_the_browser_refuses_what_a_page_might_fetch(play: Callable[[Path], Player], replay: Path):
    player = play(replay)
    fetched = player.page.evaluate(
        "fetch('https://example.org/').then(() => 'fetched', (error) => String(error))"
    )
    assert fetched != "fetched"
    assert any("Content Security Policy" in complaint for complaint in player.complaints)


def test_writing_is_silent_and_leaves_no_server(tmp_path, capfd, monkeypatch):
    servers: list[tuple[str, int]] = []
    start = viser.ViserServer.__init__

    def spy(self, *args, **kwargs):
        start(self, *args, **kwargs)
        servers.append((self.get_host(), self.get_port()))

    monkeypatch.setattr(viser.ViserServer, "__init__", spy)
    fall_and_roll().save_html(tmp_path / "replay.html")
    assert capfd.readouterr() == ("", "")
    assert [host for host, _ in servers] == ["127.0.0.1"]
    with socket.socket() as probe:
        assert probe.connect_ex(servers[0]) != 0


def test_a_mesh_in_several_lanes_is_stored_once(tmp_path):
    mesh = trimesh.creation.icosphere(subdivisions=5)
    mesh.vertices += 0.01 * np.random.default_rng(4).normal(size=mesh.vertices.shape)
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, 2, 3] = 0.1
    body = BodyTrack("stone", mesh.vertices, mesh.faces, None, poses)
    recording = Recording(0.1, (body,), ContactTrack.empty(2))
    one = save_replay(tmp_path / "one.html", [Lane("", recording)], title="")
    names = {str(i): recording for i in range(5)}
    five = save_replay(tmp_path / "five.html", arrange_lanes(names), title="")
    assert five.stat().st_size < one.stat().st_size + 20_000


def test_a_failed_write_leaves_the_old_page(tmp_path, monkeypatch):
    path = tmp_path / "replay.html"
    path.write_text("old")

    def fail(self, target):
        raise OSError("disk full")

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(OSError, match="disk full"):
        fall_and_roll().save_html(path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("frames", "rate", "text"),
    [
        (81, 40, "Plays in real time: 2 s, recorded at 40 frames per second. It shows all frames."),
        (401, 200, "2 s, recorded at 200 frames per second. It shows one frame in 4."),
    ],
)
def test_the_caption_counts_frames_of_the_recording(frames: int, rate: int, text: str):
    poses = np.tile(np.eye(4), (frames, 1, 1))
    poses[:, 2, 3] = np.linspace(1.0, 0.0, frames)
    body = BodyTrack("ball", BALL.vertices, BALL.faces, None, poses)
    recording = Recording(1 / rate, (body,), ContactTrack.empty(frames))
    timeline = plan_timeline([recording])
    assert text in _describe_rate(timeline, [Lane("", recording)])


@pytest.mark.parametrize(
    ("lanes", "options", "message"),
    [
        ([Lane("", fall_and_roll())], {"hold": -1.0}, "hold must be seconds"),
        ([Lane("", fall_and_roll())], {"max_contacts": -1}, "max_contacts must be at least 0"),
        ([Lane("", fall_and_roll())], {"up": "up"}, "up must be"),
        ([Lane("", fall_and_roll())], {"speed": 0.0}, "speed must be positive"),
    ],
)
def test_bad_options_are_refused(tmp_path, lanes, options, message):
    with pytest.raises(SettingsError, match=message):
        save_replay(tmp_path / "replay.html", lanes, title="", **options)
    assert list(tmp_path.iterdir()) == []


def test_no_lanes_are_refused(tmp_path):
    with pytest.raises(RecordingError, match="no lanes"):
        save_replay(tmp_path / "replay.html", [], title="")
    assert list(tmp_path.iterdir()) == []


def test_importing_the_viewer_does_not_load_viser():
    code = "import sys, voxshell.viewer.replay; print('viser' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
