"""The pictures of the gallery: light, shadow, marks and legend."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

EXAMPLES = Path(__file__).resolve().parents[3] / "examples/python"
SIZE = (120, 90)


@pytest.fixture
def examples(monkeypatch: pytest.MonkeyPatch) -> None:
    """Imports of the examples' modules."""
    monkeypatch.syspath_prepend(str(EXAMPLES))


@pytest.mark.usefixtures("examples")
def test_a_ball_is_colored_and_shades_the_ground_away_from_the_sun():
    from rendering import SUN, make_surface, place_camera, render

    ball = trimesh.creation.icosphere(3, 0.1)
    surface = make_surface(ball.vertices, ball.faces, (40, 90, 200), dots=5_000)
    pose = np.eye(4)
    pose[2, 3] = 0.1
    around = np.array([[-0.4, -0.4, 0.0], [0.4, 0.4, 0.3]])
    camera = place_camera(around, SIZE, elevation=60.0, azimuth=0.0)
    bodies = [(surface, pose)]
    options = {"ground": 0.0, "cell": 0.1, "suns": 4, "skies": 12}
    picture = render(bodies, camera, SIZE, **options).astype(int)
    assert picture.shape == (90, 120, 3)

    def look(*point: float) -> np.ndarray:
        seen = camera.axes @ (np.array(point) - camera.position)
        scale = 0.5 * SIZE[1] / camera.tangent / -seen[2]
        return picture[round(45 - scale * seen[1]), round(60 + scale * seen[0])]

    blue = look(0.0, -0.05, 0.2)
    assert blue[2] > blue[0] + 60
    away = -0.12 * SUN[:2] / np.linalg.norm(SUN[:2])
    # Between lines of the grid.
    lit, shaded = look(-0.25, -0.25, 0.0), look(*away, 0.0)
    assert lit.min() > 190
    assert shaded.max() < lit.min() - 30
    np.testing.assert_array_equal(picture, render(bodies, camera, SIZE, **options))


@pytest.mark.usefixtures("examples")
def test_marks_show_through_bodies():
    from rendering import make_surface, place_camera, render

    box = trimesh.creation.box((0.2, 0.2, 0.2))
    dot = trimesh.creation.icosphere(1, 0.03)
    surface = make_surface(box.vertices, box.faces, (120, 120, 120), dots=5_000)
    mark = make_surface(dot.vertices, dot.faces, (220, 20, 60), dots=1)
    camera = place_camera(box.vertices, SIZE)
    options = {"suns": 2, "skies": 4}
    bodies = [(surface, np.eye(4))]
    plain = render(bodies, camera, SIZE, **options).astype(int)
    marked = render(bodies, camera, SIZE, marks=[(mark, np.eye(4))], **options).astype(int)
    changed = np.abs(marked - plain).max(axis=2) > 40
    assert changed[45, 60]
    assert 0.005 < changed.mean() < 0.1
    red = marked[45, 60]
    assert red[0] > red[1] + 60


@pytest.mark.usefixtures("examples")
def test_edges_stay_sharp_and_round_surfaces_become_smooth():
    from rendering import make_surface

    box = trimesh.creation.box()
    surface = make_surface(box.vertices, box.faces, (0, 0, 0), dots=10)
    np.testing.assert_allclose(np.abs(surface.normals).max(axis=-1), 1.0)
    ball = trimesh.creation.icosphere(3)
    surface = make_surface(ball.vertices, ball.faces, (0, 0, 0), dots=10)
    np.testing.assert_allclose(surface.normals, surface.corners, atol=0.02)
    assert surface.area == pytest.approx(ball.area)


@pytest.mark.usefixtures("examples")
def test_a_recording_is_drawn_with_a_legend_and_opened_where_it_is_told(tmp_path: Path):
    from drawing import draw
    from voxshell.recording import BodyTrack, ContactTrack, Recording

    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, 2, 3] = 0.01
    shell = trimesh.boolean.difference(
        [trimesh.creation.box((1, 1, 1)), trimesh.creation.icosphere(2, 0.4)]
    )
    body = BodyTrack("shell", 0.1 * shell.vertices, shell.faces, (92, 141, 208), poses)
    one = ([[0, 0, 0]], [[0, 0, 1]], [0.001], [[0, 0, 3.0]])
    recording = Recording(0.1, (body,), ContactTrack.from_frames([one, one]))
    for name, cut in (("whole", ()), ("open", ("shell",))):
        view = {"size": (480, 300), "quality": 0.2, "azimuth": 35.0}
        draw(tmp_path / f"{name}.png", recording, cut=cut, **view)
    whole, opened = (
        np.asarray(Image.open(tmp_path / f"{name}.png").convert("RGB"), int)
        for name in ("whole", "open")
    )
    assert whole.shape == (300, 480, 3)
    assert np.abs(whole - opened).max(axis=2)[125:175, 215:265].mean() > 20.0
    foot = whole[-20:]
    assert ((foot[..., 0] > foot[..., 2] + 80).any(axis=0)).sum() > 60, (
        "the bar of depths and the arrow"
    )


@pytest.mark.usefixtures("examples")
def test_shadows_on_the_ground_have_no_steps():
    """Each sample of the light cast a shadow with an edge of its own."""
    from rendering import make_surface, place_camera, render

    ball = trimesh.creation.icosphere(3, 0.1)
    surface = make_surface(ball.vertices, ball.faces, (40, 90, 200), dots=300_000)
    pose = np.eye(4)
    pose[2, 3] = 0.2
    around = np.array([[0.05, 0.0, 0.0], [0.25, 0.2, 0.0]])  # its shadow
    size = (240, 180)
    camera = place_camera(around, size, elevation=80.0, azimuth=0.0, fill=0.9)
    bodies = [(surface, pose)]
    picture = render(bodies, camera, size, ground=0.0, suns=4, skies=8).astype(float).mean(axis=2)
    ground = picture[:, 60:]  # right of the ball
    assert np.ptp(ground) > 60.0
    assert max(np.abs(np.diff(ground, axis=axis)).max() for axis in (0, 1)) < 10.0


def studio_of(force: float, color: tuple[int, int, int], **view: object):
    """A box of 10 cm on which a force acts, in front of a camera."""
    from drawing import Studio
    from voxshell.recording import BodyTrack, ContactTrack, Recording

    box = trimesh.creation.box((0.1, 0.1, 0.1))
    body = BodyTrack("box", box.vertices, box.faces, color, np.eye(4)[None])
    contact = ([[0, 0, 0.05]], [[0, 0, 1]], [0.001], [[0, 0, force]])
    recording = Recording(0.1, (body,), ContactTrack.from_frames([contact]))
    return Studio(recording, size=(480, 300), quality=0.2, **view)


@pytest.mark.usefixtures("examples")
def test_arrows_are_within_the_picture():
    studio = studio_of(3.0, (92, 141, 208))
    ((_, tip),) = studio._find_arrows(0)
    right, up, back = studio.camera.axes @ (tip - studio.camera.position)
    across, upward = right / -back / studio.camera.tangent / 1.6, up / -back / studio.camera.tangent
    assert tip[2] > 0.05  # beyond the box
    assert max(abs(across), abs(upward)) < 0.9


@pytest.mark.usefixtures("examples")
def test_the_legend_is_read_in_front_of_dark_bodies():
    picture = np.asarray(studio_of(3.0, (10, 10, 10), fill=3.0).picture(0), int)
    assert np.median(picture[:250]) < 100
    assert np.median(picture[-8:].min(axis=2)) > 180


@pytest.mark.usefixtures("examples")
def test_a_label_names_a_place():
    plain, named = (
        np.asarray(studio_of(0.0, (200, 200, 200), labels=labels).picture(0), int)
        for labels in (None, {"a corner": (0.05, -0.05, 0.05)})
    )
    rows, columns = np.nonzero(np.abs(plain - named).max(axis=2) > 20)
    assert 20 < np.ptp(rows) < 80
    assert 40 < np.ptp(columns) < 120
