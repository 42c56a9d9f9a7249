"""Views without a server."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from live_worlds import Screen


@pytest.fixture
def screens(monkeypatch: pytest.MonkeyPatch) -> list[Screen]:
    """The pages of the views that a test opens, which keep what they are shown."""
    from live_worlds import Screen

    made: list[Screen] = []

    def make(view: object, **options: object) -> Screen:
        made.append(Screen(view, **options))
        return made[-1]

    monkeypatch.setattr("voxshell.viewer.live_page.LivePage", make)
    return made
