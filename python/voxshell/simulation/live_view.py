"""Live view of a world: what the page can do to it, and when it is updated."""

from __future__ import annotations

import atexit
import html
import sys
import threading
import time
from typing import TYPE_CHECKING, Protocol

import numpy as np

from voxshell.base.arguments import as_flag, as_not_negative, as_positive
from voxshell.base.near_names import suggest_on_set
from voxshell.simulation.body_properties import read_only
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
"""Seconds without a step after which the page is updated with the newest state."""

_MOST_BEHIND = 0.2
"""Seconds that a run may lag behind its speed; it does not catch up more than this."""

FIRST_PAGE = 30.0
"""Seconds that the first step of a view with a speed waits until a page has drawn the world."""


class Page(Protocol):
    """The page that shows a view."""

    @property
    def address(self) -> str:
        """The address for a browser on this machine."""
        ...

    def show(self, frame: LiveFrame, *, last: bool) -> None:
        """Show a state of the world; only one thread at a time calls this.

        Args:
            frame: The state.
            last: True if no other state may follow for long, so that all of the page must be
                updated now.
        """
        ...

    def close(self) -> None:
        """Close the page."""
        ...


@suggest_on_set
class LiveView:
    """A page that follows a world while it steps; made by :meth:`voxshell.World.view`.

    The thread that calls :meth:`World.step` does three things for a view. Before a step it waits
    while the view is paused, and pulls at bodies that are dragged. After a step it reads the world,
    at most ``frames_per_second`` times per second and only while a page is open. Another thread
    sends the data. Nothing else touches the world, and reading does not change it.

    Start: a view with a speed is made to be watched. So the first step waits up to 30 seconds until the
        first page has drawn the world, and says on the terminal where the page is. ``wait`` changes that
        time.

    Pause: ``World.step`` blocks until the view is resumed or closed, even in the middle of
        ``step(1000)``. Ctrl-C ends the wait just as it ends a run. When the last page is closed, a
        paused run continues. A view that was made with ``paused=True`` waits for its first page.

    Drag: a spring pulls the grabbed point toward the pointer, in the plane through that point that
        faces the camera. The spring is critically damped and scaled with the body's effective mass
        at that point, so that light and heavy bodies follow alike. A body that hangs on the spring
        sags by about 2 % of its diameter, or more if the time step is long. The force does not grow
        beyond a stretch of one diameter. While a body is held, its rotation decays at 2/s. Static
        and kinematic bodies cannot be dragged.

    Any thread may call any method.
    """

    __slots__ = (
        "__weakref__",
        "_bodies",
        "_closed",
        "_due",
        "_frame",
        "_gate",
        "_has_unseen",
        "_last_step",
        "_news",
        "_page",
        "_pages",
        "_pause_between",
        "_paused",
        "_pulls",
        "_shown",
        "_simulation",
        "_speed",
        "_start",
        "_steps_allowed",
        "_thread",
        "_time_step",
        "_wait",
    )

    def __init__(
        self,
        simulation: _bullet.Simulation,
        bodies: list[Body],
        *,
        time_step: float,
        frames_per_second: float = 30.0,
        speed: float | None = None,
        paused: bool = False,
        wait: float | None = None,
    ) -> None:
        # Do not store the world: it refers to its view, and the cycle would delay freeing memory.
        self._simulation, self._bodies = simulation, bodies
        self._time_step = time_step
        self._pause_between = 1.0 / as_positive(frames_per_second, "frames_per_second")
        self._speed = None if speed is None else as_positive(speed, "speed")
        usual = 0.0 if speed is None else FIRST_PAGE
        self._wait = usual if wait is None else as_not_negative(wait, "wait")
        self._pulls = Pulls(time_step)
        self._page: Page | None = None
        self._pages = 0
        self._shown = 0
        self._closed = False
        self._gate = threading.Condition()
        self._paused, self._steps_allowed = as_flag(paused, "paused"), 0
        self._news = threading.Condition()
        self._frame: LiveFrame | None = None
        self._has_unseen = True
        self._due = self._last_step = 0.0
        self._start: tuple[float, float] | None = None
        self._thread: threading.Thread | None = None

    def open(self, make_page: Callable[[], Page]) -> None:
        """Start to show the world; :meth:`World.view` calls this.

        Args:
            make_page: Makes the page.
        """
        self._page = make_page()
        try:
            frame = self._take()
            if frame is not None:
                self._page.show(frame, last=True)
        except BaseException:
            self.close()
            raise
        self._thread = threading.Thread(target=self._send, name="voxshell view", daemon=True)
        self._thread.start()
        # Before the server ends, which does so at the exit as well, so that the page can say why.
        atexit.register(self.close)

    @property
    def address(self) -> str:
        """The page's address for a browser on this machine; it contains a secret."""
        assert self._page is not None
        return self._page.address

    @property
    def is_open(self) -> bool:
        """True until :meth:`close`: the page is served."""
        return not self._closed

    @property
    def page_count(self) -> int:
        """Number of browsers that show the page now."""
        return self._pages

    @property
    def frame_count(self) -> int:
        """Number of states shown so far."""
        return self._shown

    @property
    def paused(self) -> bool:
        """True while :meth:`World.step` waits."""
        return self._paused

    @property
    def speed(self) -> float | None:
        """Limit of simulated seconds per second while a page is open, or None. Settable.

        Raises:
            SettingsError: The new value is neither None nor a number above 0.
        """
        return self._speed

    @speed.setter
    def speed(self, value: float | None) -> None:
        self._speed = None if value is None else as_positive(value, "speed")
        self._start = None

    @property
    def gravity(self) -> NDArray[np.float64]:
        """The world's present gravity, (3,) m/s2, world frame, read-only."""
        return read_only(np.array(self._simulation.gravity()))

    @property
    def pulls(self) -> Pulls:
        """The pulls on dragged bodies; the page fills it."""
        return self._pulls

    def pause(self) -> None:
        """Make :meth:`World.step` wait until :meth:`resume`, :meth:`close` or Ctrl-C."""
        with self._gate:
            self._paused, self._steps_allowed = True, 0
        self._refresh()

    def resume(self) -> None:
        """End a pause."""
        with self._gate:
            self._paused, self._start = False, None
            self._gate.notify_all()
        self._refresh()

    def allow_step(self) -> None:
        """Let a paused run make one step."""
        with self._gate:
            self._steps_allowed += 1
            self._gate.notify_all()

    def close(self) -> None:
        """Close the page and end any pause; the world continues. A second call does nothing."""
        with self._gate:
            if self._closed:
                return
            self._closed = True
            self._gate.notify_all()
        atexit.unregister(self.close)
        self._pulls.release_all()
        with self._news:
            self._news.notify_all()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join()
        if self._page is not None:
            self._page.close()

    def before_step(self) -> None:
        """Wait for a page or while paused, and pull at bodies; the world calls this."""
        if self._wait > 0.0:
            self._wait_for_page()
        if self._paused:
            with self._gate:
                while self._paused and self._steps_allowed == 0 and not self._closed:
                    self._gate.wait()
                self._steps_allowed = max(self._steps_allowed - 1, 0)
        if len(self._pulls):
            self._pulls.apply()

    def after_step(self) -> None:
        """Read the world if an update is due, and wait for the view's speed; the world calls it."""
        self._has_unseen = True
        if self._pages == 0 or self._closed:
            return
        now = self._last_step = time.perf_counter()
        if now >= self._due:
            # From the due time on, so that long steps do not lower the mean rate.
            self._due = max(self._due + self._pause_between, now)
            frame = self._take()
            with self._news:
                self._frame = frame
                self._news.notify_all()
        if self._speed is not None:
            self._wait_for_speed(self._speed)

    def count_pages(self, change: int) -> None:
        """Count browsers that open or close the page; the page calls this."""
        with self._news:
            self._pages += change
        self._refresh()
        if self._pages == 0:
            self.resume()

    def begin(self) -> None:
        """End the wait of the first step: a page has drawn the world; the page calls this."""
        with self._gate:
            self._wait = 0.0
            self._gate.notify_all()

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
        """Return the page for a notebook whose browser runs on this machine."""
        if not self.is_open:
            return "<p>This view is closed.</p>"
        address = html.escape(self.address)
        return (
            f'<iframe src="{address}" style="width: 100%; height: 560px; border: 1px solid #d5dbe2; '
            f'border-radius: 6px"></iframe><p><a href="{address}" target="_blank">Open in a window of its own</a></p>'
        )

    def _refresh(self) -> None:
        """Allow an update of the page although no step may follow."""
        with self._news:
            self._has_unseen = True
            self._news.notify_all()

    def _find_bodies(self) -> tuple[Body, ...]:
        return tuple(body for body in self._bodies if not body.removed)

    def _take(self) -> LiveFrame | None:
        return take_frame(self._simulation, self._bodies, self.gravity, self._time_step)

    def _send(self) -> None:
        """Show the states in a separate thread, which reads the world itself if no step is made."""
        assert self._page is not None
        shown = self._find_bodies()
        while not self._closed:
            with self._news:
                if self._frame is None and not self._closed:
                    self._news.wait(_STILL if self._pages else None)
                frame, self._frame = self._frame, None
            is_last = frame is None and time.perf_counter() - self._last_step > _STILL
            if is_last and self._pages and (self._has_unseen or self._find_bodies() != shown):
                self._has_unseen = False
                frame = self._take()
            if frame is not None and not self._closed:
                self._page.show(frame, last=is_last)
                self._shown, shown = self._shown + 1, frame.bodies

    def _wait_for_page(self) -> None:
        """Wait until the first page has drawn the world, once; a pause waits for a page anyway."""
        with self._gate:
            seconds, end = self._wait, time.monotonic() + self._wait
            if not (self._paused or self._closed) and sys.stderr is not None:
                sys.stderr.write(
                    f"voxshell: open {self.address} to watch; the first step waits {seconds:g} s for it\n"
                )
                sys.stderr.flush()
            while self._wait > 0.0 and not (self._paused or self._closed):
                if not self._gate.wait(end - time.monotonic()):
                    break
            self._wait = 0.0

    def _wait_for_speed(self, speed: float) -> None:
        now, simulated = time.perf_counter(), self._simulation.step_count() * self._time_step
        if self._start is None:
            self._start = (now, simulated)
        ahead = self._start[0] + (simulated - self._start[1]) / speed - now
        if not -_MOST_BEHIND < ahead < _MOST_BEHIND + 2.0 * self._time_step / speed:
            self._start = None  # a slow stretch, or steps without an open page
        elif ahead > 0.0:
            time.sleep(ahead)
