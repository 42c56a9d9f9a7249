from __future__ import annotations

import numpy as np
import pytest
import trimesh
from voxshell.viewer.handle import Handle
from voxshell.viewer.server import silent_server


def test_a_body_is_where_it_was_put_wherever_its_handle_is():
    turn = trimesh.transformations.rotation_matrix(1.1, (1.0, 2.0, -0.5), (0.3, 0.0, 0.1))
    with silent_server() as server:
        handle = Handle(
            server, "/part", grip=np.array((0.1, 0.2, -0.3)), pose=turn, scale=7.0, size=1.0
        )
        assert handle.pose == pytest.approx(turn)
        handle.pose = np.eye(4)
        assert handle.pose == pytest.approx(np.eye(4))
