"""A world that a browser can show while it steps."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING

from voxshell.base.arguments import as_flag, as_integer, as_text
from voxshell.errors import SettingsError
from voxshell.simulation.body_colors import as_body_colors
from voxshell.simulation.live_view import LiveView
from voxshell.simulation.world_queries import WorldQueries

if TYPE_CHECKING:
    from collections.abc import Mapping

    from voxshell.simulation.body import Body


class ViewedWorld(WorldQueries):
    """A world with a live view."""

    __slots__ = ("_time_step", "_view")

    _time_step: float
    _view: LiveView | None

    @property
    def time_step(self) -> float:
        """Seconds per step, as given to the constructor."""
        return self._time_step

    def view(
        self,
        *,
        port: int = 8080,
        title: str = "voxshell",
        colors: Mapping[Body, tuple[int, int, int]] | None = None,
        frames_per_second: float = 30.0,
        speed: float | None = None,
        paused: bool = False,
        wait: float | None = None,
        open_browser: bool = False,
    ) -> LiveView:
        """Show the world live in a browser while you call :meth:`step`.

        The page shows bodies, contacts, the force of each contact, and plots of the energy, the
        number of contacts and the largest depth over time. It has buttons to pause, to make one
        step and to reset the camera. The mouse drags bodies with a spring; see
        :class:`voxshell.LiveView`. A pause blocks :meth:`step`. Several browsers may open the page;
        they share one view.

        A viewed world takes the same steps, bit for bit, unless somebody drags a body.

        Args:
            port: Port of the page on this machine, or the next free one. 0: the system chooses one.
            title: Heading of the page.
            colors: Red, green and blue, 0 to 255, of bodies; the viewer chooses the other colors.
            frames_per_second: Largest number of updates of the page per second of wall-clock time.
            speed: Largest number of simulated seconds per second while a page is open; :meth:`step`
                waits if it would be faster. None: no limit. The page can change it. Unless ``wait`` is
                given, the first step waits up to 30 s until a page has drawn the world.
            paused: Wait before the first step until somebody presses "Resume" on the page.
            wait: Largest time that the first step waits until the first page has drawn the world,
                seconds. The terminal says so, with the address. By default 30 where a ``speed`` is
                given, and otherwise 0. A paused view waits for its page in any case.
            open_browser: Open the page in the default browser of this machine.

        Returns:
            The view. Its ``address`` contains a secret, so that other pages in the browser cannot
            read the world. The view ends with its ``close()``, at the end of a ``with`` block, or
            with the world.

        Raises:
            MissingExtraError: The viewer is not installed.
            SettingsError: A view of this world is open already, or an argument is out of range.
            InputTypeError: ``colors`` does not map bodies to colors, or ``title`` is not a string.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ground = world.add(vx.Plane(), mass=0)
            >>> ball = world.add(vx.Sphere(0.1), pose=(0, 0, 0.5))
            >>> with world.view(port=0) as view:
            ...     print(view.address)
            ...     world.step(200)
            http://127.0.0.1:...
        """
        if self._view is not None and self._view.is_open:
            raise SettingsError(
                f"this world already has a view at {self._view.address}; open that address in another browser, or "
                "call the view's close() first"
            )
        from voxshell.viewer.live_page import LivePage

        number = as_integer(port, "port", 0, 65535)
        as_text(title, "title")
        opens_browser = as_flag(open_browser, "open_browser")
        chosen = as_body_colors(colors)
        view = LiveView(
            self._simulation,
            self._bodies,
            time_step=self.time_step,
            frames_per_second=frames_per_second,
            speed=speed,
            paused=paused,
            wait=wait,
        )
        view.open(lambda: LivePage(view, port=number, title=title, colors=chosen))
        self._view = view
        weakref.finalize(self, view.close)
        if opens_browser:
            import webbrowser

            webbrowser.open(view.address)
        return view
