from __future__ import annotations

import pytest
import trimesh
import voxshell as vx


@pytest.fixture(scope="session")
def box() -> vx.Model:
    """Of 1 m, with far fewer points than the ball."""
    return vx.Model.from_mesh(trimesh.creation.box(), voxel_size=0.05, target_points=1_500)


@pytest.fixture(scope="session")
def needle() -> vx.Model:
    """Thinner than the cube's points are apart: what is sharp is missed by one shell alone."""
    return vx.Model.from_mesh(trimesh.creation.cone(radius=0.01, height=0.2), voxel_size=0.004)
