from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from player import Player
from voxshell.recording import BodyTrack, ContactTrack, Recording
from voxshell.viewer.lanes import Lane
from voxshell.viewer.lighting import add_lights
from voxshell.viewer.replay import save_replay
from voxshell.viewer.server import silent_server


@pytest.mark.parametrize(("up", "axis"), [("+z", 2), ("-y", 1)])
def test_the_sun_stands_above_and_casts_shadows(up: str, axis: int):
    with silent_server() as server:
        sun, _ = add_lights(server.scene, up=up)
        assert sun.cast_shadow
        place = np.array(sun.position)
        assert place[axis] * (1.0 if up[0] == "+" else -1.0) > 0.7 * np.linalg.norm(place)


def test_the_light_of_a_replay_is_the_same_in_each_round(
    play: Callable[[Path], Player], tmp_path: Path
):
    """viser's player returned to its own suns and to the picture of a room, which it blurred for seconds."""
    pose = np.eye(4)[None].repeat(20, axis=0)
    pose[:, 2, 3] = np.linspace(0.2, 0.0, 20)
    ball = trimesh.creation.icosphere(subdivisions=1, radius=0.1)
    track = BodyTrack("ball", ball.vertices, ball.faces, None, pose)
    recording = Recording(0.02, (track,), ContactTrack.empty(20))
    page = play(
        save_replay(tmp_path / "replay.html", [Lane("", recording)], title="", hold=0.1)
    ).page
    seen = page.evaluate("""() => new Promise((done) => {
        const { scene } = window.__viserMutable, slider = document.querySelector("[role=slider]");
        const seen = new Set();
        let before = 0.0, rounds = 0;
        scene.onAfterRender = () => {
            let suns = 0;
            scene.traverseVisible((object) => { suns += Number(object.isDirectionalLight === true); });
            seen.add(`${suns} suns, ${scene.environment === null ? "no" : "a"} room`);
            const now = Number(slider.getAttribute("aria-valuenow"));
            rounds += Number(now < before);
            before = now;
            if (rounds === 3) done([...seen]);
        };
    })""")
    assert len(seen) == 1
    assert seen[0].endswith("no room")
