"""A page played by a real browser with no network."""

from __future__ import annotations

import io
import os
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser, Page, expect, sync_playwright

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
ARGUMENTS = [
    "--headless=new",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--no-first-run",
    "--disable-component-update",
    "--disable-sync",
]
WIDTH, HEIGHT, BAR = 480, 360, 40
# Software rendering on a busy machine draws a picture in seconds rather than milliseconds.
PATIENCE = 60.0


@contextmanager
def launched_browser() -> Iterator[Browser]:
    """The browser of the machine, headless; a failed test where there is none."""
    names = [os.environ.get("VOXSHELL_BROWSER", ""), *BROWSERS]
    found = next((path for name in names if name and (path := shutil.which(name))), None)
    if found is None:
        pytest.fail(
            f"no browser to play the replay in: looked for {', '.join(BROWSERS)}; install one "
            "(Debian: apt-get install chromium) or name it in VOXSHELL_BROWSER"
        )
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=ARGUMENTS)
        yield browser
        browser.close()


def complaints_of(page: Page) -> list[str]:
    """The errors of a page, its console's and those that nothing caught, as they come."""
    complaints: list[str] = []
    page.on(
        "console",
        lambda message: complaints.append(message.text) if message.type == "error" else None,
    )
    page.on("pageerror", lambda error: complaints.append(str(error)))
    return complaints


class Player:
    """A replay in a browser without network, and everything that it complained of or asked for.

    Close it: a page that plays on takes the time that software rendering has for the next.
    """

    def __init__(self, browser: Browser, path: Path) -> None:
        self._context = browser.new_context(
            viewport={"width": WIDTH, "height": HEIGHT}, offline=True
        )
        self.page: Page = self._context.new_page()
        self.page.set_default_timeout(PATIENCE * 1000.0)
        self.complaints = complaints_of(self.page)
        self.requests: list[str] = []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("websocket", lambda websocket: self.requests.append(websocket.url))
        self.page.goto(path.as_uri())
        self.page.wait_for_selector("canvas[data-engine]")
        # The heading has colors of its own; and without a graphics card the player says so, in a
        # notice over the picture.
        self.page.add_style_tag(
            content="#voxshell-heading { opacity: 0; } .mantine-Notifications-root { display: none; }"
        )

    def close(self) -> None:
        self._context.close()

    def picture(self) -> np.ndarray:
        """(h, w, 3) the picture without the play bar, 0 to 255."""
        shot = self.page.screenshot(timeout=PATIENCE * 1000.0)
        pixels = np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), dtype=np.int64)
        return pixels[: HEIGHT - BAR]

    def wait(self, wanted: Callable[[np.ndarray], bool], what: str) -> np.ndarray:
        """The first picture that is as wanted."""
        end = time.monotonic() + PATIENCE
        while True:
            picture = self.picture()
            if wanted(picture):
                return picture
            if time.monotonic() > end:
                pytest.fail(
                    f"after {PATIENCE:g} s: {what}; mean color "
                    f"{picture.mean(axis=(0, 1)).round(1)}; {self.complaints}"
                )
            time.sleep(0.2)

    def pause(self) -> None:
        """Stops the player where it is; a clock that runs on would overwrite what is typed in."""
        self.page.keyboard.press("Space")

    @property
    def fetched(self) -> list[str]:
        """What was asked for beyond what lies in the page, the page itself included."""
        return [url for url in self.requests if not url.startswith(("data:", "blob:"))]

    def seek(self, seconds: float) -> None:
        """Goes to a time, once paused."""
        clock = self.page.locator("input.mantine-NumberInput-input").first
        clock.fill(f"{seconds:g}")
        clock.blur()
        expect(clock).to_have_value(f"{seconds:.1f}", timeout=PATIENCE * 1000.0)
