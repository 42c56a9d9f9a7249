"""The page of a live view: a scene that follows a world, plots, and buttons to pause."""

from __future__ import annotations

import html
import time
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.base.arguments import as_unicode
from voxshell.base.lengths import metric
from voxshell.viewer.guard import make_token
from voxshell.viewer.lanes import view_axes
from voxshell.viewer.lighting import add_lights
from voxshell.viewer.live_plots import LivePlots
from voxshell.viewer.live_scene import LiveScene
from voxshell.viewer.page import read_part
from voxshell.viewer.palette import FORCE_COLOR, PULL_COLOR
from voxshell.viewer.pins import DEPTH_COLORS
from voxshell.viewer.server import make_address, silent_server
from voxshell.viewer.stage import VIEW_ASPECT, place_camera

if TYPE_CHECKING:
    from collections.abc import Mapping

    import viser
    from numpy.typing import NDArray

    from voxshell.simulation.body import Body
    from voxshell.simulation.live_frame import LiveFrame
    from voxshell.simulation.live_view import LiveView
    from voxshell.viewer.stage import Camera

_TEXT_EVERY = 0.2
"""Seconds between updates of plots and numbers, which take more time than the scene."""

_LAST_WORDS = 0.2
"""Seconds that the end of a view leaves for its last message to reach the pages."""

_CONTROLS, _NARROW = 340, 580
"""Pixels that the controls cover on the right, and the width below which they are a sheet at the foot of the page."""
_USUAL_WINDOW = 1240, 670

_SPEEDS: dict[str, float | None] = {
    "as fast as possible": None,
    "real time": 1.0,
    "1/4 of real time": 0.25,
    "1/20 of real time": 0.05,
}


class LivePage:
    """A server with the page of one world.

    Args:
        view: The view that the page shows and pauses.
        port: Port of the page, or the next free one. 0: the system chooses one.
        title: Heading.
        colors: Colors of bodies, 0 to 255.

    Raises:
        MissingExtraError: viser is not installed.
    """

    def __init__(
        self,
        view: LiveView,
        *,
        port: int,
        title: str,
        colors: Mapping[Body, tuple[int, int, int]],
    ) -> None:
        self._view, self._up = view, find_up(view.gravity)
        self._token = make_token()
        self._stack = ExitStack()
        head = read_part("live_page.html")
        for part in ("canvas.css", "own_look.js", "stay_above.js"):
            head = head.replace(f"{{{{{part.partition('.')[0]}}}}}", read_part(part))
        self._server = self._stack.enter_context(silent_server(port, token=self._token, head=head))
        self._scene = LiveScene(self._server.scene, colors, self._drag)
        self._camera: Camera | None = None
        self._last_text = -1.0
        self._rate: tuple[float, float] | None = None
        self._frame: LiveFrame | None = None
        server = self._server
        server.scene.world_axes.visible = False
        server.scene.set_up_direction(self._up)  # pyright: ignore[reportArgumentType]
        add_lights(server.scene, up=self._up)
        server.gui.configure_theme(show_logo=False, show_share_button=False)
        server.gui.set_panel_label(as_unicode(title))
        self._add_controls(server.gui)
        self._legend = server.gui.add_html("")
        self._drawn = server.gui.add_button("drawn", visible=False)  # the page's script presses it

        @self._drawn.on_click
        def _(_: Any) -> None:
            view.begin()

        self._plots = LivePlots(server.gui)
        server.on_client_connect(self._meet)
        server.on_client_disconnect(self._part)

    @property
    def address(self) -> str:
        """The page's address for a browser on this machine."""
        return make_address(self._server, self._token)

    def show(self, frame: LiveFrame, *, last: bool) -> None:
        """Show a state of the world.

        Args:
            frame: The state.
            last: No step is being made: update numbers and plots now, and say so. Otherwise their
                updates are less frequent.
        """
        self._frame = frame
        with self._server.atomic():
            self._scene.show(frame, self._view.pulls.find_lines())
            if self._camera is None and self._scene.extent is not None:
                self._place_first_camera(frame)
            self._plots.add(frame)
            now = time.perf_counter()
            if last or now - self._last_text >= _TEXT_EVERY:
                self._show_text(frame, now, waits=last)
                self._plots.show()
                self._last_text = now

    def close(self) -> None:
        """Say on the page that the view has ended, take its controls away, and stop the server."""
        with self._server.atomic():
            at = "" if self._frame is None else f" at **{self._frame.time:.3f} s**"
            self._status.content = (
                f"**ended**{at}: the program has ended or closed this view. Close this page."
            )
            for control in self._controls:
                control.visible = False
            self._legend.content += '<span id="voxshell-ended"></span>'  # the page stops to connect
        self._server.flush()
        if self._server.get_clients():
            time.sleep(_LAST_WORDS)  # viser sends in a thread of its own, and drops what is left
        self._stack.close()

    def _add_controls(self, gui: viser.GuiApi) -> None:
        view = self._view
        self._status = gui.add_markdown("")
        self._hold = gui.add_button("Pause")
        others = gui.add_button_group("", ("Step", "Reset camera"))
        initial = next((name for name, speed in _SPEEDS.items() if speed == view.speed), None)
        names = list(_SPEEDS) if initial else [f"{view.speed:g} of real time", *_SPEEDS]
        speeds = {names[0]: view.speed, **_SPEEDS}
        speed = gui.add_dropdown("speed", names, initial_value=initial or names[0])
        through = gui.add_checkbox("see through", initial_value=True)
        self._controls = (self._hold, others, speed, through)
        self._show_pause()

        @through.on_update
        def _(_: Any) -> None:
            self._scene.set_see_through(through.value)

        @self._hold.on_click
        def _(_: Any) -> None:
            if view.paused:
                view.resume()
            else:
                view.pause()
            self._show_pause()

        @others.on_click
        def _(event: viser.GuiEvent[Any]) -> None:
            if others.value == "Step":
                view.pause()
                view.allow_step()
                self._show_pause()
            elif event.client is not None:
                self._reset_camera(event.client)

        @speed.on_update
        def _(_: Any) -> None:
            view.speed = speeds[speed.value]

    def _show_pause(self) -> None:
        label = "Resume" if self._view.paused else "Pause"
        if self._hold.label != label:
            self._hold.label = label

    def _show_text(self, frame: LiveFrame, now: float, *, waits: bool) -> None:
        rate = ""
        if self._rate is not None and now > self._rate[0] and not (waits or self._view.paused):
            rate = (
                f", {max(frame.time - self._rate[1], 0.0) / (now - self._rate[0]):.2g} x real time"
            )
        self._rate = (now, frame.time)
        if self._view.paused:
            state = "**paused**"
        else:
            state = "waiting for the next step" if waits else "running"
        self._status.content = (
            f"{state} at **{frame.time:.3f} s**{rate}  \n"
            f"{_count(len(frame.bodies), 'body', 'bodies')}, "
            f"{_count(len(frame.depths), 'contact', 'contacts')}"
        )
        self._show_pause()
        legend = self._describe()
        if self._legend.content != legend:
            self._legend.content = legend

    def _describe(self) -> str:
        """Return the legend as HTML. It follows the bodies, so a page that has it has been sent them."""
        scene = self._scene
        begin = f'<span id="voxshell-begin" data-button="{self._drawn._impl.uuid}"></span>'
        if scene.extent is None:
            return begin
        colors = ", ".join("#{:02x}{:02x}{:02x}".format(*color) for color in DEPTH_COLORS)
        deepest = scene.deepest
        depth = (
            f'contact depth 0 <span style="display: inline-block; width: 6em; height: 0.7em; border-radius: 0.35em; '
            f'background: linear-gradient(90deg, {colors})"></span> {html.escape(metric(deepest))}<br>'
            if deepest > 0.0
            else ""
        )
        force, pull = ("#{:02x}{:02x}{:02x}".format(*color) for color in (FORCE_COLOR, PULL_COLOR))
        return (
            f'{begin}<div style="padding: 0.2em 1em 0.8em; font-size: 0.85em; line-height: 1.6">{depth}'
            f'<b style="color: {force}">&#8594;</b> normal force on the moving body '
            f"(grows up to {scene.longest_force:.2g} N)<br>"
            f'<b style="color: {pull}">&#8594;</b> spring of the mouse<br>grid: {metric(scene.cell)}<br>'
            "Drag a body to pull it. Drag the background to turn the camera, right-drag to move it.</div>"
        )

    def _place_first_camera(self, frame: LiveFrame) -> None:
        camera = self._find_camera(frame, _USUAL_WINDOW)
        if camera is None:
            return
        self._camera = camera
        initial = self._server.initial_camera
        initial.position, initial.look_at = camera.position, camera.target
        initial.up, initial.fov = view_axes(self._up)[2], camera.field_of_view
        for client in self._server.get_clients().values():
            self._reset_camera(client)

    def _find_camera(self, frame: LiveFrame, window: tuple[int, int]) -> Camera | None:
        """Return a view from the front and slightly above, with all bodies beside the controls.

        Args:
            frame: Where the bodies are.
            window: Width and height, pixels.
        """
        extent = self._scene.find_extent(frame)
        if extent is None:
            return None
        size = float(np.linalg.norm(extent.high - extent.low))
        low, high = extent.low - 0.06 * size, extent.high + 0.06 * size
        width, height = window
        right, _, upward = view_axes(self._up)
        if width <= _NARROW:
            below = 2.0 * size * upward
            low, high = low - np.maximum(below, 0.0), high - np.minimum(below, 0.0)
        else:
            beside = float(np.abs(right @ (high - low))) * _CONTROLS / (width - _CONTROLS)
            high = high + beside * np.maximum(right, 0.0)
            low = low + beside * np.minimum(right, 0.0)
        boxes = [(self._scene.scale * low, self._scene.scale * high)]
        aspect = min(width / max(height, 1), VIEW_ASPECT)
        return place_camera(boxes, rows=1, up=self._up, aspect=aspect)

    def _reset_camera(self, client: viser.ClientHandle) -> None:
        if self._frame is None:
            return
        window = client.camera.image_width, client.camera.image_height
        camera = self._find_camera(self._frame, window)
        if camera is None:
            return
        with client.atomic():
            client.camera.position, client.camera.look_at = camera.position, camera.target
            client.camera.up_direction = view_axes(self._up)[2]

    def _meet(self, client: viser.ClientHandle) -> None:
        self._reset_camera(client)  # to the size of its window
        if self._view.page_count == 0:  # nothing was read since the last page left
            self._plots.interrupt()
        self._view.count_pages(1)

    def _part(self, client: viser.ClientHandle) -> None:
        self._view.pulls.release(client.client_id)
        self._view.count_pages(-1)

    def _drag(self, body: Body, event: viser.SceneNodeDragEvent[Any]) -> None:
        """Handle a drag in viser's event loop, which delivers events in order."""
        pulls, hand = self._view.pulls, event.client_id
        if event.phase == "end":
            pulls.release(hand)
            return
        if event.phase == "start":
            frame = self._frame
            if frame is None or body not in frame.bodies:
                return
            # The page shows the pose of the last frame, but the world is some steps ahead.
            pose = frame.poses[frame.bodies.index(body)]
            point = np.array(event.start_position) / self._scene.scale
            size = np.ptp(self._scene.mesh(body).vertices, axis=0)
            local = pose[:3, :3].T @ (point - pose[:3, 3])
            pulls.grab(hand, body, local, float(np.linalg.norm(size)))
        pulls.move(hand, np.array(event.end_position) / self._scene.scale)


def _count(number: int, one: str, many: str) -> str:
    return f"{number:,} {one if number == 1 else many}"


def find_up(gravity: NDArray[np.float64]) -> str:
    """Return the axis nearest to the opposite of gravity, (3,) m/s2; "+z" without gravity.

    Example:
        >>> find_up(np.array((0.0, -9.81, 0.0)))
        '+y'
    """
    if not gravity.any():
        return "+z"
    axis = int(np.argmax(np.abs(gravity)))
    return ("+" if gravity[axis] < 0.0 else "-") + "xyz"[axis]
