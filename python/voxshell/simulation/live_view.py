"""A world watched while it runs: what the page may do to it, and when it is shown."""

from __future__ import annotations

import html
import threading
import time
from typing import TYPE_CHECKING, Protocol

import numpy as np

from voxshell.base.arguments import as_positive
from voxshell.simulation.live_frame import take_frame
from voxshell.simulation.live_pull import Pulls

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

    from numpy.typing import NDArray

    from voxshell import _bullet
    from voxshell.simulation.body import Body
    from voxshell.simulation.live_frame import LiveFrame

_STILL = 0.1
"""Seconds without a step after which the newest state is shown, whoever steps or not."""

_MOST_BEHIND = 0.2
"""Seconds by which a run may be late of its speed; it does not hurry to make up for more."""


class Page(Protocol):
    """Where a view is shown."""

    @property
    def address(self) -> str:
        """For a browser on this machine."""
        ...

    def show(self, frame: LiveFrame, *, last: bool) -> None:
        """Shows a state of the world; one thread at a time calls it.

        Args:
            frame: The state.
            last: Whether none may follow for long: then all of the page must be brought up to date.
        """
        ...

    def close(self) -> None:
        """Ends the page."""
        ...


class LiveView:
    """A page that follows a world while it steps; made by :meth:`voxshell.World.view`.

    The thread that calls :meth:`World.step` does three things for a view. Before a step it waits while the view is
    paused, and pulls at bodies that are dragged. After a step it reads the world, at most ``frames_per_second`` times a
    second and only while a page is open. Another thread sends what was read. Nothing else touches the world, and
    reading does not change it.

    Pause: ``World.step`` blocks until the view is resumed or closed, also in the middle of ``step(1000)``. Ctrl-C ends
    the wait as it ends a run. When the last page is closed, a paused run goes on. A view that was made with
    ``paused=True`` waits for its first page.

    Drag: a spring pulls the grabbed point towards the pointer, in the plane through that point that faces the camera.
    It is critically damped, and scaled with the body's effective mass at that point, so that light and heavy bodies
    follow alike. A body that hangs on the spring sinks by about 2 % of its diameter, or more where the time step is
    long. Beyond one diameter of stretch the force no longer grows. While a body is held, its turning dies away at 2/s.
    Static and kinematic bodies cannot be dragged.

    All methods may be called from any thread.
    """

    def __init__(
        self,
        simulation: _bullet.Simulation,
        bodies: list[Body],
        *,
        gravity: NDArray[np.float64],
        time_step: float,
        frames_per_second: float = 30.0,
        speed: float | None = None,
        paused: bool = False,
    ) -> None:
        # Not the world: it refers to its view, and memory would stay until a collection.
        self._simulation, self._bodies = simulation, bodies
        self._gravity, self._time_step = gravity, time_step
        self._pause_between = 1.0 / as_positive(frames_per_second, "frames_per_second")
        self._speed = None if speed is None else as_positive(speed, "speed")
        self._pulls = Pulls(gravity, time_step)
        self._page: Page | None = None
        self._pages = 0
        self._shown = 0
        self._closed = False
        self._gate = threading.Condition()
        self._paused, self._steps_allowed = bool(paused), 0
        self._news = threading.Condition()
        self._frame: LiveFrame | None = None
        self._has_unseen = True
        self._due = self._last_step = 0.0
        self._start: tuple[float, float] | None = None
        self._thread: threading.Thread | None = None

    def open(self, make_page: Callable[[], Page]) -> None:
        """Begins to show the world; :meth:`World.view` calls it.

        Args:
            make_page: Makes the page.
        """
        self._page = make_page()
        frame = self._take()
        if frame is not None:
            self._page.show(frame, last=True)
        self._thread = threading.Thread(target=self._send, name="voxshell view", daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """Of the page, for a browser on this machine; it holds a secret."""
        assert self._page is not None
        return self._page.address

    @property
    def is_open(self) -> bool:
        """Whether the page is served: True until :meth:`close`."""
        return not self._closed

    @property
    def page_count(self) -> int:
        """Browsers that show the page now."""
        return self._pages

    @property
    def frame_count(self) -> int:
        """States of the world that were shown so far."""
        return self._shown

    @property
    def paused(self) -> bool:
        """Whether :meth:`World.step` waits."""
        return self._paused

    @property
    def speed(self) -> float | None:
        """Simulated seconds in a second at most while a page is open; None: as fast as the machine can. Settable.

        Raises:
            SettingsError: It is set to anything but None or a number above 0.
        """
        return self._speed

    @speed.setter
    def speed(self, value: float | None) -> None:
        self._speed = None if value is None else as_positive(value, "speed")
        self._start = None

    @property
    def gravity(self) -> NDArray[np.float64]:
        """Of the world, (3,) m/s2, world frame, read-only."""
        return self._gravity

    @property
    def pulls(self) -> Pulls:
        """What is dragged; the page fills it."""
        return self._pulls

    def pause(self) -> None:
        """Lets :meth:`World.step` wait before its next step, until :meth:`resume`, :meth:`close` or Ctrl-C."""
        with self._gate:
            self._paused, self._steps_allowed = True, 0
        self._refresh()

    def resume(self) -> None:
        """Ends a pause."""
        with self._gate:
            self._paused, self._start = False, None
            self._gate.notify_all()
        self._refresh()

    def allow_step(self) -> None:
        """Lets a paused run make one step."""
        with self._gate:
            self._steps_allowed += 1
            self._gate.notify_all()

    def close(self) -> None:
        """Ends the page and any pause; the world goes on. Closing twice does nothing."""
        with self._gate:
            if self._closed:
                return
            self._closed = True
            self._gate.notify_all()
        self._pulls.release_all()
        with self._news:
            self._news.notify_all()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join()
        if self._page is not None:
            self._page.close()

    def before_step(self) -> None:
        """Waits while paused, and pulls at what is dragged; the world calls it."""
        if self._paused:
            with self._gate:
                while self._paused and self._steps_allowed == 0 and not self._closed:
                    self._gate.wait()
                self._steps_allowed = max(self._steps_allowed - 1, 0)
        if len(self._pulls):
            self._pulls.apply()

    def after_step(self) -> None:
        """Reads the world if it is time to, and waits for the view's speed; the world calls it."""
        self._has_unseen = True
        if self._pages == 0 or self._closed:
            return
        now = self._last_step = time.perf_counter()
        if now >= self._due:
            self._due = now + self._pause_between
            frame = self._take()
            with self._news:
                self._frame = frame
                self._news.notify_all()
        if self._speed is not None:
            self._wait_for_speed(self._speed)

    def count_pages(self, change: int) -> None:
        """Notes that browsers have come or gone; the page calls it."""
        with self._news:
            self._pages += change
        self._refresh()
        if self._pages == 0:
            self.resume()

    def __enter__(self) -> LiveView:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"LiveView({self.address if self.is_open else 'closed'})"

    def _repr_html_(self) -> str:
        """The page inside a notebook, whose browser must run on this machine."""
        if not self.is_open:
            return "<p>This view is closed.</p>"
        address = html.escape(self.address)
        return (
            f'<iframe src="{address}" style="width: 100%; height: 560px; border: 1px solid #d5dbe2; '
            f'border-radius: 6px"></iframe><p><a href="{address}" target="_blank">Open in a window of its own</a></p>'
        )

    def _refresh(self) -> None:
        """Lets the page be brought up to date although nobody may step."""
        with self._news:
            self._has_unseen = True
            self._news.notify_all()

    def _take(self) -> LiveFrame | None:
        self._has_unseen = False
        return take_frame(self._simulation, self._bodies, self._gravity, self._time_step)

    def _send(self) -> None:
        """Shows what was read, in a thread of its own; where nobody steps, reads for itself."""
        assert self._page is not None
        while not self._closed:
            with self._news:
                if self._frame is None and not self._closed:
                    self._news.wait(_STILL if self._pages else None)
                frame, self._frame = self._frame, None
            is_last = frame is None and time.perf_counter() - self._last_step > _STILL
            if is_last and self._pages and self._has_unseen:
                frame = self._take()
            if frame is not None and not self._closed:
                self._page.show(frame, last=is_last)
                self._shown += 1

    def _wait_for_speed(self, speed: float) -> None:
        now, simulated = time.perf_counter(), self._simulation.step_count() * self._time_step
        if self._start is None:
            self._start = (now, simulated)
        ahead = self._start[0] + (simulated - self._start[1]) / speed - now
        if not -_MOST_BEHIND < ahead < _MOST_BEHIND + 2.0 * self._time_step / speed:
            self._start = None  # a slow stretch, or steps that no page was open for
        elif ahead > 0.0:
            time.sleep(ahead)
