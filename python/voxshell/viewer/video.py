"""Videos of recordings, rendered without a window or browser."""

from __future__ import annotations

import math
from contextlib import contextmanager, nullcontext
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.base.arguments import as_integer, as_positive, check_callable
from voxshell.base.calls import explain_calls
from voxshell.base.extras import explain_import
from voxshell.base.lengths import metric
from voxshell.base.outputs import replacing
from voxshell.errors import FileAccessError, MissingExtraError, SettingsError
from voxshell.viewer.arrows import mesh_arrows
from voxshell.viewer.lanes import Lane, activity_bounds, view_axes
from voxshell.viewer.marks import MarkedContacts
from voxshell.viewer.palette import FLOOR_COLOR, FORCE_COLOR, choose_colors
from voxshell.viewer.pins import color_depths
from voxshell.viewer.shading import split_creases
from voxshell.viewer.stage import VIEW_ASPECT, find_paths, find_slabs, place_camera, plan_stage
from voxshell.viewer.terminal_progress import on_terminal
from voxshell.viewer.timeline import plan_timeline
from voxshell.viewer.video_bodies import BodyView, DrawnBody
from voxshell.viewer.video_encoder import as_pause, open_writer, warn_of_rate
from voxshell.viewer.video_ground import BACKGROUND, Ground, add_light, sample_surface

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell.recording import BodyTrack, Recording
    from voxshell.viewer.stage import Slab
    from voxshell.viewer.timeline import Timeline

_SLAB_COLOR, _GRID_COLOR = (214, 218, 224), (170, 177, 187)
_INK = "#1e2733"
_DEFAULT_RATES = {".mp4": 30.0, ".gif": 25.0}
_MOST_CONTACTS = 400
_LINE_SPACING = 1.3
_FINER = 1.5
"""Pixels drawn for one of the video, along a side. VTK's own smoothing of edges costs twice as much here."""


@explain_calls
def save_video(
    path: Path,
    recording: Recording,
    *,
    size: tuple[int, int] = (1280, 720),
    frames_per_second: float | None = None,
    speed: float = 1.0,
    up: str = "+z",
    title: str = "",
    progress: Callable[[str, float], object] | None = None,
) -> Path:
    """Write a video of a recording.

    Bodies have the colors of the offline page, and the camera sees their whole paths. Contacts are balls, colored by
    depth, with arrows of the normal forces on the moving body.

    Args:
        path: The file, with the suffix .mp4 or .gif; written completely or not at all.
        recording: The recording.
        size: Width and height, pixels, both even, 64 to 7,680.
        frames_per_second: Largest number of frames per second of playback; every n-th frame of the
            recording is shown, so that motion is even. The default is 30, and 25 for GIF, which
            counts in hundredths of a second.
        speed: Simulated seconds per second of playback; 1 is real time, 0.25 slow motion.
        up: The world axis that points up, such as "+z" or "+y".
        title: Text at the top left.
        progress: Called after each frame with the name of the stage and its completed fraction, 0
            to 1. If it raises, no file is written, and the same exception is raised. None: a bar on
            stderr if that is a terminal; ``lambda *_: None`` shows nothing.

    Returns:
        The path of the file.

    Raises:
        InputTypeError: ``progress`` cannot be called.
        MissingExtraError: A library is not installed, or it cannot render on this machine.
        SettingsError: An option is out of range, or no file can be written there.
        InputTypeError: There is no such option.
        FileAccessError: The file cannot be written.

    Warns:
        UserWarning: The video has fewer frames per second than ``frames_per_second``. The message
            says how many, and why.
    """
    check_callable(progress, "progress")
    pixels = _as_size(size)
    view_axes(up)  # a wrong axis is refused before libraries are loaded
    rate = _DEFAULT_RATES[path.suffix.lower()] if frames_per_second is None else frames_per_second
    timeline = plan_timeline(
        [recording],
        frames_per_second=as_positive(rate, "frames_per_second"),
        speed=as_positive(speed, "speed"),
    )
    # A recording of a single frame becomes a still of one second.
    pause = float(timeline.pauses[0]) if len(timeline.pauses) else 1.0
    pause = as_pause(pause, path)
    pyvista, imageio = _import_libraries()
    if frames_per_second is not None:
        warn_of_rate(path, recording, timeline, 1.0 / pause, frames_per_second)
    with (
        on_terminal(f"draw {path.name}") if progress is None else nullcontext(progress) as tell,
        replacing(path) as temporary,
        _drawing(pyvista, pixels) as plotter,
    ):
        film = _Film(pyvista, plotter, recording, timeline, size=pixels, up=up, title=title)
        try:
            count = len(timeline.times)
            is_gif = path.suffix.lower() == ".gif"
            looks = sorted({0, count // 2, count - 1}) if is_gif else []
            samples = [film.draw(instant) for instant in looks]
            with open_writer(imageio, temporary, pause, samples) as writer:
                for instant in range(count):
                    writer.append_data(film.draw(instant))
                    tell("draw", (instant + 1) / count)
        except OSError as error:  # from the encoder or the disk
            raise FileAccessError(f"cannot write {path}: {error}") from error
    return path


def _as_size(size: tuple[int, int]) -> tuple[int, int]:
    """Return width and height, both even, as the encoder requires."""
    if not isinstance(size, (tuple, list)) or len(size) != 2:
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
        raise explain_import(
            error,
            "videos need pyvista, imageio and imageio-ffmpeg, and one cannot be imported "
            f"({error}); run: pip install 'voxshell[video]'",
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
            finer = [round(_FINER * side) for side in size]
            plotter = pyvista.Plotter(off_screen=True, window_size=finer, lighting="none")
            plotter.render_window.SetMultiSamples(0)  # the picture is drawn finer instead
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


class _Film:
    """A recording on a plotter.

    Args:
        pyvista: The library.
        plotter: The plotter.
        recording: The recording.
        timeline: The instants to show.
        size: Width and height of the pictures, pixels.
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
        size: tuple[int, int],
        up: str,
        title: str,
    ) -> None:
        self._size = size
        self._pyvista, self._plotter, self._recording = pyvista, plotter, recording
        self._frames = timeline.frames(recording)
        self._contact_frames = timeline.contact_frames(recording)
        self._marked = MarkedContacts(recording, up=up, limit=_MOST_CONTACTS)
        self._title = title
        self._images = import_module("PIL.Image")  # imageio needs it, too
        lane = Lane("", recording)
        stage = plan_stage([lane], up=up)
        self._stage, self._up = stage, up
        self._drawn: list[DrawnBody] = []
        self._ground: Ground | None = None
        plotter.set_background(BACKGROUND)
        add_light(pyvista, plotter, up=up)
        slabs = find_slabs(recording, stage, up=up)
        upward = view_axes(up)[2]
        level = upward == 0.0
        grounds: list[tuple[NDArray[np.float64], tuple[int, int, int]]] = []
        for body, color in zip(recording.bodies, choose_colors(recording), strict=True):
            slab = slabs.get(body.name)
            if slab is None:
                points = sample_surface(body.vertices, body.faces)
                bounds = np.stack([body.vertices.min(axis=0), body.vertices.max(axis=0)])
                self._drawn.append(DrawnBody(self._add_body(body, color), body, points, bounds))
            elif (slab.low[level] <= stage.low[level]).all() and (
                slab.high[level] >= stage.high[level]
            ).all():
                top = slab.high if up[0] == "+" else slab.low
                grounds.append((top, body.color or FLOOR_COLOR))
            else:
                self._add_slab(slab, body.color or _SLAB_COLOR)
        if not slabs:  # for shadows and for scale
            low, high = activity_bounds(recording)
            grounds.append((low if up[0] == "+" else high, FLOOR_COLOR))
        if grounds:  # the highest hides the others
            self._add_ground(*max(grounds, key=lambda ground: float(upward @ ground[0])))
        aspect = min(size[0] / size[1], VIEW_ASPECT)
        camera = place_camera(find_paths(recording), rows=1, up=up, aspect=aspect)
        plotter.camera_position = [
            tuple(camera.position),
            tuple(camera.target),
            tuple(view_axes(up)[2]),
        ]
        plotter.camera.view_angle = math.degrees(camera.field_of_view)
        plotter.renderer.ResetCameraClippingRange()
        finer = (round(_FINER * size[0]), round(_FINER * size[1]))
        actors = [drawn.actor for drawn in self._drawn]
        self._bodies = BodyView(plotter, actors, size=finer, body_size=stage.body_size)
        self._ball = pyvista.Sphere(
            radius=self._marked.ball, theta_resolution=12, phi_resolution=12
        )
        self._marks: list[Any] = []
        self._overlay = self._add_overlay()
        legend = []
        if self._marked.strongest > 0.0:
            legend.append(f"longest arrow {self._marked.strongest:g} N")
        if self._marked.deepest > 0.0:  # last: the bar is drawn below
            legend.append(f"contact depth 0 to {metric(self._marked.deepest)}")
        self._write("\n".join(legend), "upper_right")

    def draw(self, instant: int) -> NDArray[np.uint8]:
        """Return the picture of an instant of the timeline, (h, w, 3)."""
        frame = int(self._frames[instant])
        for drawn in self._drawn:
            drawn.actor.user_matrix = drawn.body.poses[frame]
            drawn.actor.visibility = frame >= drawn.body.start
        shown = [drawn for drawn in self._drawn if frame >= drawn.body.start]
        self._bodies.look_at([(drawn.bounds, drawn.body.poses[frame]) for drawn in shown])
        if self._ground is not None:
            self._ground.cast([(drawn.points, drawn.body.poses[frame]) for drawn in shown])
        self._draw_contacts(int(self._contact_frames[instant]))
        seconds = frame * self._recording.time_step
        count = int(self._recording.contacts.counts[frame])
        text = f"{seconds:.3f} s, {count} contact{'' if count == 1 else 's'}"
        self._write(f"{self._title}\n{text}" if self._title else text, "upper_left")
        self._plotter.render()
        drawn = self._images.fromarray(np.array(self._plotter.screenshot(return_img=True)))
        picture = np.array(drawn.resize(self._size, self._images.Resampling.LANCZOS))
        if self._marked.deepest > 0.0:
            self._paint_scale(picture)
        return picture

    @property
    def _font_size(self) -> int:
        return max(6, round(_FINER * self._size[1] / 75))

    def _add_body(self, body: BodyTrack, color: tuple[int, int, int]) -> Any:
        surface = self._pyvista.make_tri_mesh(*split_creases(body.vertices, body.faces))
        return self._plotter.add_mesh(
            surface,
            color=color,
            smooth_shading=True,
            ambient=0.3,
            diffuse=0.75,
            specular=0.12,
            specular_power=24,
            render=False,
        )

    def _add_ground(self, place: NDArray[np.float64], color: tuple[int, int, int]) -> None:
        """Add the ground at the height of a place."""
        self._ground = Ground(
            self._pyvista,
            self._plotter,
            up=self._up,
            place=place,
            low=self._stage.low,
            high=self._stage.high,
            cell=self._stage.cell,
            color=color,
        )

    def _add_slab(self, slab: Slab, color: tuple[int, int, int]) -> None:
        """Add a plate, and lines on it that cross at multiples of the stage's cell."""
        low, high, cell = slab.low, slab.high, self._stage.cell
        box = self._pyvista.Box(np.stack([low, high], axis=1).reshape(-1))
        self._plotter.add_mesh(box, color=color, lighting=False, render=False)
        _, _, upward = view_axes(self._up)
        first, second = np.flatnonzero(upward == 0.0)
        top = (
            np.where(upward > 0.0, high, low) * np.abs(upward)
            + 0.01 * self._stage.body_size * upward
        )
        ends = []
        for along, across in ((first, second), (second, first)):
            cells = np.arange(math.ceil(low[across] / cell), math.floor(high[across] / cell) + 1)
            for place in cells * cell:
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
        for actor in self._marks:
            self._overlay.RemoveActor(actor)
        self._marks = []
        marks = self._marked.frame(frame)
        if len(marks.arrows):
            surface = mesh_arrows(marks.arrows, body_size=self._marked.body_size)
            mapper = self._pyvista.DataSetMapper(self._pyvista.make_tri_mesh(*surface))
            mapper.ScalarVisibilityOff()
            self._add_marks(mapper).prop.color = FORCE_COLOR
        if len(marks.points):
            points = self._pyvista.PolyData(marks.points)
            points["color"] = marks.colors.round().astype(np.uint8)
            mapper = self._pyvista.DataSetMapper(
                points.glyph(geom=self._ball, scale=False, orient=False, color_mode="scalar")
            )
            mapper.SetScalarModeToUsePointFieldData()
            mapper.SelectColorArray("color")
            mapper.SetColorModeToDirectScalars()
            self._add_marks(mapper)

    def _add_marks(self, mapper: Any) -> Any:
        actor = self._pyvista.Actor(mapper=mapper)
        actor.prop.lighting = False
        self._overlay.AddActor(actor)
        self._marks.append(actor)
        return actor

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
        width, height = (_FINER * side for side in self._size)
        beside, above = self._font_size / width, self._font_size / height
        is_right = place == "upper_right"
        actor = self._plotter.add_text(
            text,
            position=(1.0 - beside if is_right else beside, 1.0 - above),
            viewport=True,
            font_size=self._font_size,
            color=_INK,
            name=place,
            render=False,
        )
        style = actor.GetTextProperty()
        style.SetVerticalJustificationToTop()
        style.SetLineSpacing(_LINE_SPACING)
        if is_right:
            style.SetJustificationToRight()

    def _paint_scale(self, picture: NDArray[np.uint8]) -> None:
        """Draw a bar in the colors of depths below the text at the top right."""
        height, width = picture.shape[:2]
        long, thick = width // 6, max(2, height // 60)
        lines = 2 if self._marked.strongest > 0.0 else 1
        letter = self._font_size / _FINER
        top, right = round((1.5 + 2.5 * lines) * letter), width - round(letter)
        bar = color_depths(np.linspace(0.0, 1.0, long)).round().astype(np.uint8)
        picture[top : top + thick, right - long : right] = bar
