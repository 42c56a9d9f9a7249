"""What notebooks show of models, contacts, recordings and views."""

from __future__ import annotations

import html
import io
import re
import time
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from PIL import Image
from player import PATIENCE, complaints_of
from playwright.sync_api import Browser
from voxshell.base.notebook import make_table
from voxshell.recording import BodyTrack, ContactTrack, Recording
from voxshell.recording import recording as recording_module


def test_worlds_and_robots_are_tables(tmp_path: Path):
    world = vx.World(gravity=(0, 0, 0))
    assert "<td" in world._repr_html_()
    assert "0.005 s" in world._repr_html_()
    path = tmp_path / "pair.urdf"
    path.write_text(
        "<robot name='pair'><link name='a'/><link name='b'><inertial><mass value='1'/>"
        "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
        "<joint name='turn' type='continuous'><parent link='a'/><child link='b'/></joint></robot>"
    )
    robot = vx.load_urdf(world, path)
    assert "turn" in robot._repr_html_()
    assert "0 rad" in robot._repr_html_()
    robot.remove()
    assert "removed" in robot._repr_html_()


def make_recording(name: str = "ball") -> Recording:
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=0.1)
    poses = np.tile(np.eye(4), (40, 1, 1))
    poses[:, 0, 3] = np.linspace(0.0, 0.3, 40)
    body = BodyTrack(name, mesh.vertices, mesh.faces, (220, 40, 40), poses)
    frames = [([[0, 0, 0]], [[0, 0, 1]], [0.001])] * 40
    return Recording(0.05, (body,), ContactTrack.from_frames(frames))


def cells_of(page: str) -> dict[str, str]:
    found = re.findall(r"<tr><td[^>]*>(.*?)</td><td[^>]*>(.*?)</td></tr>", page)
    return {name: html.unescape(value) for name, value in found}


def test_a_table_escapes_what_it_shows():
    page = make_table("<b>", {"a & b": "<script>"})
    assert "<script>" not in page
    assert cells_of(page) == {"a &amp; b": "<script>"}


def test_a_model_shows_its_facts(ball: vx.Model):
    facts = cells_of(ball._repr_html_())
    assert facts["size"] == "200 x 200 x 200 mm"
    assert facts["triangles"] == f"{len(ball.mesh.faces):,}"
    assert facts["points of the shell"].startswith(f"{len(ball.shell):,}, ")
    assert "5 mm apart" in facts["field"]


def test_contacts_show_their_facts(ball: vx.Model):
    contacts = vx.contacts(ball, vx.Plane(), vx.pose((0, 0, 0.095)))
    facts = cells_of(contacts._repr_html_())
    assert facts["contacts"] == f"{len(contacts)} of a's points"
    assert facts["depth"].endswith("to 5 mm")
    assert facts["normal there"] == "(0, 0, 1), from b to a"
    assert set(facts) == {"contacts", "depth", "deepest at", "normal there"}
    none = vx.contacts(ball, vx.Plane(), vx.pose((0, 0, 1)))
    assert cells_of(none._repr_html_()) == {"contacts": "0 of a's points"}


def test_contacts_say_in_a_notebook_if_some_may_be_missing(ball: vx.Model):
    contacts = vx.contacts(ball, ball, vx.pose((0, 0, 0.19)), budget=1)
    assert not contacts.exact
    depth = f"{1e3 * contacts.depth_bound:.4g} mm"
    assert cells_of(contacts._repr_html_())["missing"] == (
        f"perhaps some: the budget ended the search; none is deeper than {depth}"
    )
    box = vx.Model.from_mesh(trimesh.creation.box((0.1, 0.1, 0.1)))
    unknown = vx.contacts(box, box, budget=1)
    assert unknown.depth_bound == np.inf
    facts = cells_of(unknown._repr_html_())
    assert facts["missing"] == "perhaps some: the budget ended the search"


def test_a_recording_shows_its_facts_and_its_replay():
    page = make_recording()._repr_html_()
    assert cells_of(page)["time"] == "1.95 s, 40 frames, 50 ms apart"
    assert cells_of(page)["contacts"] == "40, at most 1 at a time"
    assert cells_of(page)["bodies"] == "1, moving: 1"
    assert '<iframe sandbox="allow-scripts" srcdoc="' in page
    assert len(page) < 3_000_000


def test_a_large_recording_says_how_to_see_it(monkeypatch: pytest.MonkeyPatch):
    for name in ("_MOST_SHOWN", "_MOST_RAW"):
        with monkeypatch.context() as patched:
            patched.setattr(recording_module, name, 1000)
            page = make_recording()._repr_html_()
        assert "iframe" not in page
        assert "call save_html('replay.html') and open that file" in cells_of(page)["replay"]


def test_a_recording_without_the_viewer_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    def fail(*_: object, **__: object) -> str:
        raise vx.MissingExtraError("no viser")

    monkeypatch.setattr("voxshell.viewer.replay.make_replay", fail)
    facts = cells_of(make_recording()._repr_html_())
    assert facts["replay"] == "needs the viewer: pip install 'voxshell[viewer]'"


def test_the_replay_in_a_notebook_plays(browser: Browser, tmp_path: Path):
    path = tmp_path / "notebook.html"
    path.write_text(f"<!doctype html><body>{make_recording()._repr_html_()}</body>")
    page = browser.new_page(viewport={"width": 600, "height": 700})
    complaints = complaints_of(page)
    page.goto(path.as_uri())
    frame = page.frame_locator("iframe")
    frame.locator("canvas[data-engine]").wait_for(timeout=PATIENCE * 1000.0)
    end = time.monotonic() + PATIENCE
    while True:
        shot = page.locator("iframe").screenshot(timeout=PATIENCE * 1000.0)
        picture = np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), dtype=np.int64)
        if int(np.sum(picture[..., 0] - picture[..., 1] > 60)) > 300:
            break
        assert time.monotonic() < end, f"no ball is seen; {complaints}"
    assert complaints == []
    page.close()


def test_a_live_view_shows_its_page_and_tells_when_it_is_closed():
    world = vx.World()
    world.add(vx.Sphere(0.1))
    with world.view(port=0) as view:
        assert f'<iframe src="{view.address}"' in view._repr_html_()
    assert view._repr_html_() == "<p>This view is closed.</p>"
