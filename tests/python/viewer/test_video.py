"""Recordings as videos, read back picture by picture.

Tests that draw are skipped without PyVista and imageio, which ``./dev`` does not install; install them with
``pip install imageio imageio-ffmpeg pyvista``.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import voxshell as vx
from recorded_fall import come_later, turn_and_fall


# imageio leaves the pipes to ffmpeg to the garbage collector.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("suffix", [".mp4", ".gif"])
def test_a_video_shows_the_ball_going_right_and_its_contacts(tmp_path: Path, suffix: str):
    for name in ("pyvista", "imageio", "imageio_ffmpeg"):
        pytest.importorskip(name, reason="needs pyvista, imageio and imageio-ffmpeg")
    imageio = importlib.import_module("imageio.v2")
    path = turn_and_fall().save_video(
        tmp_path / f"fall{suffix}", size=(320, 200), frames_per_second=10, title="fall"
    )
    with imageio.get_reader(path) as reader:
        pictures = np.array([picture[..., :3] for picture in reader], dtype=np.int64)
        pause = reader.get_meta_data()["duration"] / (len(pictures) if suffix == ".mp4" else 1000)
    assert pictures.shape == (11, 200, 320, 3)
    assert pause == pytest.approx(0.1, abs=0.005)
    red = (pictures[..., 0] > 130) & (pictures[..., 1:].max(axis=-1) < 90)
    columns = [np.median(np.nonzero(each)[1]) for each in red]
    assert red.sum(axis=(1, 2)).min() > 30
    assert columns[-1] > columns[0] + 30
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("size", [640, "640x480", (640,)])
def test_a_size_is_two_numbers(tmp_path: Path, size):
    with pytest.raises(vx.SettingsError, match=r"size must be \(width, height\) in pixels, not"):
        turn_and_fall().save_video(tmp_path / "fall.mp4", size=size)


def test_a_video_has_no_option_of_another_name(tmp_path: Path):
    with pytest.raises(vx.InputTypeError, match="'fps': did you mean frames_per_second"):
        turn_and_fall().save_video(tmp_path / "fall.mp4", fps=30)
    with pytest.raises(vx.SettingsError, match="up must be"):
        turn_and_fall().save_video(tmp_path / "fall.mp4", up="y")


def test_a_video_of_an_odd_size_is_refused(tmp_path: Path):
    with pytest.raises(
        vx.SettingsError, match="two even numbers of pixels, not 321 x 200; try 322 x 200"
    ):
        turn_and_fall().save_video(tmp_path / "fall.mp4", size=(321, 200))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"size": (640, 360, 3)}, r"size must be \(width, height\) in pixels"),
        ({"size": (32, 64)}, "size must be from 64 to 7680"),
        ({"speed": 0.0}, "speed must be above 0"),
        ({"frames_per_second": -1.0}, "frames_per_second must be above 0"),
    ],
)
def test_bad_options_are_refused_before_any_library_is_asked_for(
    tmp_path: Path, monkeypatch, options: dict, message: str
):
    monkeypatch.setattr("voxshell.viewer.video.import_module", lambda _: pytest.fail("imported"))
    with pytest.raises(vx.VoxshellError, match=message):
        turn_and_fall().save_video(tmp_path / "fall.mp4", **options)


@pytest.mark.parametrize(
    ("name", "missing"), [("fall.mp4", "imageio_ffmpeg"), ("fall.gif", "pyvista")]
)
def test_without_a_library_an_error_says_what_to_install(
    tmp_path: Path, monkeypatch, name: str, missing: str
):
    find = importlib.import_module

    def fail(asked: str):
        if asked == missing:
            raise ImportError(f"No module named {missing!r}")
        return find("json") if asked.startswith(("imageio", "pyvista")) else find(asked)

    monkeypatch.setattr("voxshell.viewer.video.import_module", fail)
    with pytest.raises(vx.MissingExtraError, match=r"pip install 'voxshell\[video\]'"):
        turn_and_fall().save_video(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_body_that_comes_later_is_not_drawn_before(tmp_path: Path):
    for name in ("pyvista", "imageio", "imageio_ffmpeg"):
        pytest.importorskip(name, reason="needs pyvista, imageio and imageio-ffmpeg")
    imageio = importlib.import_module("imageio.v2")
    path = come_later(30).save_video(tmp_path / "late.mp4", size=(320, 200), frames_per_second=10)
    with imageio.get_reader(path) as reader:
        pictures = np.array([picture[..., :3] for picture in reader], dtype=np.int64)
    red = (pictures[..., 0] > 130) & (pictures[..., 1:].max(axis=-1) < 90)
    assert (red.sum(axis=(1, 2)) > 30).tolist() == [False] * 5 + [True] * 6


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, object]]:
    """Videos are written without their libraries; what encoders were asked for."""
    opened: list[dict[str, object]] = []

    @contextmanager
    def draw(*_: object) -> Iterator[None]:
        yield

    class Writer:
        def __enter__(self) -> Writer:
            return self

        def __exit__(self, *_: object) -> None:
            pass

        def append_data(self, picture: object) -> None:
            pass

    def open_writer(path: Path, **options: object) -> Writer:
        path.write_bytes(b"video")
        opened.append(options)
        return Writer()

    class Film:
        def __init__(self, *_: object, **__: object) -> None:
            pass

        def draw(self, instant: int) -> np.ndarray:
            return np.full((8, 8, 3), instant, np.uint8)

    encoder = SimpleNamespace(get_writer=open_writer)
    monkeypatch.setattr("voxshell.viewer.video._import_libraries", lambda: (None, encoder))
    monkeypatch.setattr("voxshell.viewer.video._drawing", draw)
    monkeypatch.setattr("voxshell.viewer.video._Film", Film)
    return opened


def test_a_video_tells_how_far_it_is(tmp_path: Path, drawn: list[dict[str, object]]):
    told: list[tuple[str, float]] = []
    turn_and_fall().save_video(
        tmp_path / "fall.mp4",
        frames_per_second=10,
        progress=lambda stage, fraction: told.append((stage, fraction)),
    )
    assert drawn[0]["fps"] == pytest.approx(10.0)
    assert [stage for stage, _ in told] == ["draw"] * 11
    assert [fraction for _, fraction in told] == pytest.approx(np.arange(1, 12) / 11)

    def stop(stage: str, fraction: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        turn_and_fall().save_video(tmp_path / "stopped.mp4", progress=stop)
    assert [path.name for path in tmp_path.iterdir()] == ["fall.mp4"]
    with pytest.raises(vx.InputTypeError, match="progress must be callable, not int"):
        turn_and_fall().save_video(tmp_path / "fall.mp4", progress=1)


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("fall.mp4", {"frames_per_second": 40}, "30 frames per second instead of 40: it shows one in 2 of the 60"),
        ("fall.mp4", {"frames_per_second": 60, "speed": 0.5}, "30 frames per second instead of 60: it shows all of the 30"),
        ("fall.gif", {"frames_per_second": 60}, "50 frames per second instead of 60"),
        ("fall.mp4", {"frames_per_second": 30}, ""),
        ("fall.mp4", {}, ""),
        ("fall.gif", {}, ""),
    ],
)  # fmt: skip
def test_a_video_with_fewer_frames_than_asked_for_says_so(
    tmp_path: Path, drawn: list[dict[str, object]], name: str, options: dict, message: str
):
    if not message:
        turn_and_fall().save_video(tmp_path / name, **options)
        return
    with pytest.warns(UserWarning, match=message):
        turn_and_fall().save_video(tmp_path / name, **options)


def test_a_video_without_a_callback_tells_the_terminal_how_far_it_is(
    tmp_path: Path, drawn: list[dict[str, object]], monkeypatch: pytest.MonkeyPatch
):
    told: list[tuple[str, float]] = []

    @contextmanager
    def show(description: str) -> Iterator[object]:
        assert description == "draw fall.gif"
        yield lambda stage, fraction: told.append((stage, fraction))

    monkeypatch.setattr("voxshell.viewer.video.on_terminal", show)
    turn_and_fall().save_video(tmp_path / "fall.gif", frames_per_second=10)
    assert len(told) == 11
    assert told[-1] == ("draw", 1.0)
    turn_and_fall().save_video(
        tmp_path / "fall.gif", frames_per_second=10, progress=lambda *_: None
    )
    assert len(told) == 11
