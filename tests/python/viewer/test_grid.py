from __future__ import annotations

from voxshell.viewer.grid import add_grid
from voxshell.viewer.server import silent_server


def test_a_floor_takes_shadows_and_fades_and_lines_alone_do_not():
    with silent_server() as server:
        lines = add_grid(server.scene, "/lines", size=(2.0, 3.0), cell=0.1)
        assert (lines.plane_opacity, lines.shadow_opacity) == (0.0, 0.0)
        assert (lines.width, lines.height, lines.section_size) == (2.0, 3.0, 0.5)
        floor = add_grid(
            server.scene, "/floor", size=(2.0, 2.0), cell=0.1, fade=1.0, floor_color=(10, 20, 30)
        )
        assert floor.plane_opacity == 1.0
        assert floor.shadow_opacity > 0.2
        assert (floor.fade_distance, floor.fade_from) == (1.0, "origin")
        assert tuple(floor.plane_color) == (10, 20, 30)
