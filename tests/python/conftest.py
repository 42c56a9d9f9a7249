"""Models that many tests share. They take a second or two to build, once a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
import trimesh
import voxshell as vx

if TYPE_CHECKING:
    from player import Player
    from playwright.sync_api import Browser

BUNNY_LENGTH = 0.2115  # meters along its longest side, as in the thesis' section 5.3
BUNNY_VOXEL_SIZE = 0.002


@pytest.fixture(scope="session")
def bunny_path() -> Path:
    path = Path("/usr/share/glmark2/models/bunny.obj")
    if not path.is_file():
        pytest.fail(f"{path} is missing; install the package glmark2-data (./dev test does)")
    return path


@pytest.fixture(scope="session")
def bunny_mesh(bunny_path: Path) -> trimesh.Trimesh:
    mesh = trimesh.load_mesh(bunny_path, process=False)
    return mesh.apply_scale(BUNNY_LENGTH / mesh.extents.max())


@pytest.fixture(scope="session")
def fine_bunny(bunny_mesh: trimesh.Trimesh) -> vx.Model:
    """Within 1 % of 35,596 points, the thesis' fine shell."""
    return vx.Model.from_mesh(bunny_mesh, voxel_size=BUNNY_VOXEL_SIZE, target_points=35_596)


@pytest.fixture(scope="session")
def coarse_bunny(bunny_mesh: trimesh.Trimesh) -> vx.Model:
    """Within 1 % of 799 points, the thesis' coarse shell."""
    return vx.Model.from_mesh(bunny_mesh, voxel_size=BUNNY_VOXEL_SIZE, target_points=799)


@pytest.fixture(scope="session")
def ball() -> vx.Model:
    """A sphere of radius 0.1 m but for its facets, centered at its origin."""
    return vx.Model.from_mesh(trimesh.creation.icosphere(4, radius=0.1), voxel_size=0.005)


@pytest.fixture(scope="session")
def cube() -> vx.Model:
    """1 m, centered at its origin."""
    return vx.Model.from_mesh(trimesh.creation.box(), voxel_size=0.05)


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    from player import launched_browser

    with launched_browser() as browser:
        yield browser


@pytest.fixture
def play(browser: Browser) -> Iterator[Callable[[Path], Player]]:
    """Opens a page in a browser without network; closed when the test is over."""
    from player import Player

    players: list[Player] = []

    def open_page(path: Path) -> Player:
        players.append(Player(browser, path))
        return players[-1]

    yield open_page
    for player in players:
        player.close()
