from __future__ import annotations

import numpy as np
import pytest
from voxshell.viewer.lighting import add_lights
from voxshell.viewer.server import silent_server


@pytest.mark.parametrize(("up", "axis"), [("+z", 2), ("-y", 1)])
def test_the_sun_stands_above_and_casts_shadows(up: str, axis: int):
    with silent_server() as server:
        sun, _ = add_lights(server.scene, up=up)
        assert sun.cast_shadow
        place = np.array(sun.position)
        assert place[axis] * (1.0 if up[0] == "+" else -1.0) > 0.7 * np.linalg.norm(place)
