"""The first touch of two meshes, against closed forms and the overlap of the solids."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import Manifold, Mesh64
from poses import lift
from voxshell_studies.geometry.first_touch import find_first_touch
from voxshell_studies.geometry.models import move
from voxshell_studies.scenes.geometry import SCENES, turn_about
from voxshell_studies.scenes.geometry_bodies import make_body

DOWN = np.array([0.0, 0.0, -1.0])


@pytest.mark.parametrize(
    ("a", "b", "turn", "height"),
    [
        ("cube 50 mm", "slab 1 m", (0.0, 0.0, 0.0), 0.025),
        ("cube 50 mm", "slab 5 m", (45.0, 0.0, 0.0), 0.025 * np.sqrt(2.0)),
        # On a corner, the diagonal is upright.
        (
            "cube 50 mm",
            "slab 1 m",
            (45.0, np.degrees(np.arctan(np.sqrt(0.5))), 0.0),
            0.025 * np.sqrt(3.0),
        ),
        ("ball 30 mm", "slab 2 m", (0.0, 0.0, 0.0), 0.015),
        ("pyramid", "slab 1 m", (0.0, 0.0, 33.0), 0.0),
        # Only edges cross: no corner of either is over a face of the other.
        ("blade", "blade", (180.0, 0.0, 77.0), 0.0),
        ("bar 1 m x 10 mm", "bar 1 m x 10 mm", (0.0, 0.0, 50.0), 0.01),
    ],
)
def test_first_touch_is_the_closed_form(a, b, turn, height):
    pose = lift(0.4, turn_about(np.radians(turn)))
    touch = find_first_touch(make_body(a), make_body(b), pose, DOWN)
    assert touch == pytest.approx(0.4 - height, abs=1e-12)


def test_first_touch_from_inside_a_hole_is_the_play():
    ring, peg = make_body("ring"), make_body("peg")
    along = np.array([1.0, 0.0, 0.0])
    assert find_first_touch(ring, peg, np.eye(4), along, from_here=True) == pytest.approx(5e-4)
    # From far away the ring's outside meets the foot or the pin before.
    assert find_first_touch(ring, peg, np.eye(4), along) < -0.02


def test_first_touch_of_bodies_that_pass_each_other_is_never():
    cube = make_body("cube 50 mm")
    beside = lift(0.3)
    beside[0, 3] = 0.051
    assert find_first_touch(cube, cube, beside, DOWN) == np.inf


@pytest.mark.parametrize("name", SCENES)
def test_first_touch_is_where_the_solids_begin_to_overlap(name):
    scene = SCENES[name]
    solids = [
        Manifold(Mesh64(np.array(m.vertices), np.array(m.faces, dtype=np.uint64)))
        for m in (make_body(scene.a), make_body(scene.b))
    ]
    pose = scene.place(1)
    touch = find_first_touch(
        make_body(scene.a),
        make_body(scene.b),
        pose,
        scene.direction,
        from_here=scene.start == "here",
    )
    for offset, overlaps in ((-1e-6, False), (1e-4, True)):
        moved = move(pose, scene.direction, touch + offset)
        common = solids[0].transform(moved[:3]) ^ solids[1]
        assert (common.volume() > 0.0) == overlaps, offset
