"""A brick that many tests put into worlds, and views without a server."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
import trimesh
import voxshell as vx

if TYPE_CHECKING:
    from live_worlds import Screen


@pytest.fixture(scope="session")
def brick() -> vx.Model:
    """0.2 m x 0.1 m x 0.06 m, centered at its origin."""
    return vx.Model.from_mesh(trimesh.creation.box(extents=(0.2, 0.1, 0.06)), voxel_size=0.005)


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
