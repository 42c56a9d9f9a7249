"""Videos of recordings, rendered without a window or browser."""

from __future__ import annotations

import math
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.base.arguments import as_integer, as_positive
from voxshell.base.outputs import replacing
from voxshell.errors import FileAccessError, MissingExtraError, SettingsError
from voxshell.viewer.lanes import Lane, view_axes
from voxshell.viewer.page import metric
from voxshell.viewer.palette import choose_colors
from voxshell.viewer.pins import color_depths, full_depth
from voxshell.viewer.stage import Stage, find_slabs, place_camera, plan_stage
from voxshell.viewer.surface import is_faceted
from voxshell.viewer.timeline import plan_timeline

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell.recording import BodyTrack, Recording
    from voxshell.viewer.timeline import Timeline

_SLAB_COLOR, _GRID_COLOR = (214, 218, 224), (170, 177, 187)
_INK = "#1e2733"
_BALL = 0.012
"""Radius of a contact's ball, in diameters of a typical body."""
_DEFAULT_RATES = {".mp4": 30.0, ".gif": 25.0}
_MOST_CONTACTS = 400


def save_video(
    path: Path,
    recording: Recording,
    *,
    size: tuple[int, int] = (1280, 720),
    frames_per_second: float | None = None,
    speed: float = 1.0,
    up: str = "+z",
    title: str = "",
) -> Path:
    """Write a video of a recording.

    Bodies, grounds and the camera are those of the offline page. Contacts are balls, colored by
    depth.

    Args:
        path: The file, with the suffix .mp4 or .gif; written completely or not at all.
        recording: The recording.
        size: Width and height, pixels, both even, 64 to 7,680.
        frames_per_second: Largest number of frames per second of playback; every n-th frame of the
            recording is shown. The default is 30, and 25 for GIF, which counts in hundredths of a
            second.
        speed: Simulated seconds per second of playback; 1 is real time, 0.25 slow motion.
        up: The world axis that points up, such as "+z" or "+y".
        title: Text at the top left.

    Returns:
        The path of the file.

    Raises:
        MissingExtraError: A library is not installed, or it cannot render on this machine.
        SettingsError: ``size`` is out of range, or no file can be written there.
        RecordingError: Another option is invalid.
        FileAccessError: The file cannot be written.
    """
    pixels = _as_size(size)
    rate = _DEFAULT_RATES[path.suffix.lower()] if frames_per_second is None else frames_per_second
    timeline = plan_timeline(
        [recording],
        frames_per_second=as_positive(rate, "frames_per_second"),
        speed=as_positive(speed, "speed"),
    )
    # A recording of a single frame becomes a still of one second.
    pause = float(timeline.pauses[0]) if len(timeline.pauses) else 1.0
    pyvista, imageio = _import_libraries()
    with replacing(path) as temporary, _drawing(pyvista, pixels) as plotter:
        film = _Film(pyvista, plotter, recording, timeline, up=up, title=title)
        try:
            with _open_writer(imageio, temporary, pause) as writer:
                for instant in range(len(timeline.times)):
                    writer.append_data(film.draw(instant))
        except OSError as error:  # from the encoder or the disk
            raise FileAccessError(f"cannot write {path}: {error}") from error
    return path


def _as_size(size: tuple[int, int]) -> tuple[int, int]:
    """Return width and height, both even, as the encoder requires."""
    if len(size) != 2:
        raise SettingsError(f"size must be (width, height) in pixels, not {size!r}")
    width, height = (as_integer(side, "size", 64, 7680) for side in size)
    if width % 2 or height % 2:
        raise SettingsError(
            f"size must be two even numbers of pixels, not {width} x {height}; "
            f"try {width + width % 2} x {height + height % 2}"
        )
    return width, height


def _import_libraries() -> tuple[Any, Any]:
    """Return PyVista, which renders, and imageio, which encodes."""
    try:
        import_module("imageio_ffmpeg")
        return import_module("pyvista"), import_module("imageio.v2")
    except ImportError as error:
        raise MissingExtraError(
            "videos need pyvista, imageio and imageio-ffmpeg, and one cannot be imported "
            f"({error}); run: pip install 'voxshell[video]'"
        ) from error


@contextmanager
def _drawing(pyvista: Any, size: tuple[int, int]) -> Iterator[Any]:
    """Yield a plotter without a window."""
    core = import_module("vtkmodules.vtkCommonCore")
    # VTK prints that there is no X server, and then works without one.
    verbosity = core.vtkLogger.GetCurrentVerbosityCutoff()
    core.vtkLogger.SetStderrVerbosity(core.vtkLogger.VERBOSITY_OFF)
    warned = core.vtkObject.GetGlobalWarningDisplay()
    core.vtkObject.GlobalWarningDisplayOff()
    try:
        try:
            plotter = pyvista.Plotter(off_screen=True, window_size=size, lighting="three lights")
        except Exception as error:
            raise MissingExtraError(
                f"VTK cannot draw on this machine ({error}); install OpenGL's libraries "
                "(Debian: apt-get install libegl1 libgl1)"
            ) from error
        try:
            yield plotter
        finally:
            plotter.close()
    finally:
        core.vtkObject.SetGlobalWarningDisplay(warned)
        core.vtkLogger.SetStderrVerbosity(verbosity)


def _open_writer(imageio: Any, path: Path, pause: float) -> Any:
    """Return a writer to which pictures can be appended.

    Args:
        imageio: The library.
        path: The file, with the suffix .mp4 or .gif.
        pause: Seconds between frames.
    """
    if path.suffix.lower() == ".gif":
        # Browsers slow down GIFs with less than 20 ms per frame.
        hundredths = max(round(100.0 * pause), 2)
        return imageio.get_writer(path, format="GIF", mode="I", duration=10 * hundredths, loop=0)
    return imageio.get_writer(
        path,
        format="FFMPEG",
        mode="I",
        fps=1.0 / pause,
        codec="libx264",
        pixelformat="yuv420p",
        quality=8,
        macro_block_size=2,
        ffmpeg_log_level="error",
    )


class _Film:
    """A recording on a plotter.

    Args:
        pyvista: The library.
        plotter: The plotter.
        recording: The recording.
        timeline: The instants to show.
        up: The world axis that points up.
        title: Text at the top left.
    """

    def __init__(
        self,
        pyvista: Any,
        plotter: Any,
        recording: Recording,
        timeline: Timeline,
        *,
        up: str,
        title: str,
    ) -> None:
        self._pyvista, self._plotter, self._recording = pyvista, plotter, recording
        self._frames = timeline.frames(recording)
        self._contact_frames = timeline.contact_frames(recording)
        self._deepest = full_depth([recording])
        self._title = title
        lane = Lane("", recording)
        stage = plan_stage([lane], up=up)
        self._ball = _BALL * stage.body_size
        self._moving: list[tuple[Any, BodyTrack]] = []
        plotter.set_background("#dfe6ee", top="#ffffff")
        slabs = find_slabs(recording, stage, up=up)
        for body, color in zip(recording.bodies, choose_colors(recording), strict=True):
            if body.name in slabs:
                slab = slabs[body.name]
                self._add_slab(slab.low, slab.high, body.color or _SLAB_COLOR, stage, up)
            else:
                self._moving.append((self._add_body(body, color), body))
        camera = place_camera([(stage.low, stage.high)], rows=1, up=up)
        plotter.camera_position = [
            tuple(camera.position),
            tuple(camera.target),
            tuple(view_axes(up)[2]),
        ]
        plotter.camera.view_angle = math.degrees(camera.field_of_view)
        plotter.renderer.ResetCameraClippingRange()
        plotter.enable_anti_aliasing("msaa", multi_samples=4)
        self._contacts: Any = None
        self._overlay = self._add_overlay()
        if self._deepest > 0.0:
            self._write(f"contact depth 0 to {metric(self._deepest)}", "upper_right")

    def draw(self, instant: int) -> NDArray[np.uint8]:
        """Return the picture of an instant of the timeline, (h, w, 3)."""
        frame = int(self._frames[instant])
        for actor, body in self._moving:
            actor.user_matrix = body.poses[frame]
        self._draw_contacts(int(self._contact_frames[instant]))
        seconds = frame * self._recording.time_step
        count = int(self._recording.contacts.counts[frame])
        text = f"{seconds:.3f} s, {count} contact{'' if count == 1 else 's'}"
        self._write(f"{self._title}\n{text}" if self._title else text, "upper_left")
        self._plotter.render()
        picture = np.array(self._plotter.screenshot(return_img=True))
        if self._deepest > 0.0:
            self._paint_scale(picture)
        return picture

    @property
    def _font_size(self) -> int:
        return max(6, round(self._plotter.window_size[1] / 60))

    def _add_body(self, body: BodyTrack, color: tuple[int, int, int]) -> Any:
        surface = self._as_surface(body.vertices, body.faces)
        faceted = is_faceted(body.vertices, body.faces)
        return self._plotter.add_mesh(
            surface,
            color=color,
            smooth_shading=not faceted,
            ambient=0.25,
            diffuse=0.65,
            render=False,
        )

    def _add_slab(
        self,
        low: NDArray[np.float64],
        high: NDArray[np.float64],
        color: tuple[int, int, int],
        stage: Stage,
        up: str,
    ) -> None:
        """Add a plate, and lines on it that cross at multiples of the stage's cell."""
        box = self._pyvista.Box(np.stack([low, high], axis=1).reshape(-1))
        self._plotter.add_mesh(box, color=color, lighting=False, render=False)
        _, _, upward = view_axes(up)
        first, second = np.flatnonzero(upward == 0.0)
        top = np.where(upward > 0.0, high, low) * np.abs(upward) + 0.01 * stage.body_size * upward
        ends = []
        for along, across in ((first, second), (second, first)):
            cells = np.arange(
                math.ceil(low[across] / stage.cell), math.floor(high[across] / stage.cell) + 1
            )
            for place in cells * stage.cell:
                for end in (low[along], high[along]):
                    point = top.copy()
                    point[along], point[across] = end, place
                    ends.append(point)
        if ends:
            lines = self._pyvista.line_segments_from_points(np.array(ends))
            self._plotter.add_mesh(
                lines, color=_GRID_COLOR, line_width=1, lighting=False, render=False
            )

    def _draw_contacts(self, frame: int) -> None:
        contacts = self._recording.contacts.frame(frame)
        if self._contacts is not None:
            self._overlay.RemoveActor(self._contacts)
            self._contacts = None
        if len(contacts.points) == 0:
            return
        chosen = np.unique(
            np.linspace(0, len(contacts.points) - 1, _MOST_CONTACTS).round().astype(np.int64)
        )
        points = self._pyvista.PolyData(contacts.points[chosen])
        shares = contacts.depths[chosen] / self._deepest if self._deepest > 0.0 else 0.0 * chosen
        points["color"] = color_depths(shares).round().astype(np.uint8)
        ball = self._pyvista.Sphere(radius=self._ball, theta_resolution=12, phi_resolution=12)
        mapper = self._pyvista.DataSetMapper(
            points.glyph(geom=ball, scale=False, orient=False, color_mode="scalar")
        )
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectColorArray("color")
        mapper.SetColorModeToDirectScalars()
        self._contacts = self._pyvista.Actor(mapper=mapper)
        self._contacts.prop.lighting = False
        self._overlay.AddActor(self._contacts)

    def _add_overlay(self) -> Any:
        """Return a layer in front of all bodies, so that bodies do not hide contacts."""
        overlay = import_module("vtkmodules.vtkRenderingCore").vtkRenderer()
        overlay.SetLayer(1)
        overlay.InteractiveOff()
        overlay.SetActiveCamera(self._plotter.camera)
        self._plotter.render_window.SetNumberOfLayers(2)
        self._plotter.render_window.AddRenderer(overlay)
        return overlay

    def _write(self, text: str, place: str) -> None:
        self._plotter.add_text(
            text, position=place, font_size=self._font_size, color=_INK, name=place, render=False
        )

    def _paint_scale(self, picture: NDArray[np.uint8]) -> None:
        """Draw a bar in the colors of depths below the text at the top right."""
        height, width = picture.shape[:2]
        long, thick = width // 6, max(2, height // 60)
        top, right = 3 * self._font_size, width - self._font_size
        bar = color_depths(np.linspace(0.0, 1.0, long)).round().astype(np.uint8)
        picture[top : top + thick, right - long : right] = bar

    def _as_surface(self, vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> Any:
        return self._pyvista.make_tri_mesh(vertices, faces)
