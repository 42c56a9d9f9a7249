from __future__ import annotations

import voxshell as vx


def test_a_body_is_a_table_of_its_facts():
    world = vx.World()
    ball = world.add(vx.Sphere(0.1), mass=2.0, pose=(0, 0, 1), name="<ball>")
    table = ball._repr_html_()
    for words in ("&lt;ball&gt;", "2 kg", "(0, 0, 1) m"):
        assert words in table
    world.remove(ball)
    assert "none: removed" in ball._repr_html_()
