"""The compiled module on its own: wrong types stop at its door, with nothing of ours in between."""

from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from voxshell import _core

POINTS = np.zeros((2, 3))
READ_ONLY = POINTS.copy()
READ_ONLY.flags.writeable = False

WRONG_POINTS = [
    None,
    0.0,
    "points",
    np.zeros(3),
    np.zeros((2, 4)),
    np.zeros((1, 2, 3)),
    np.zeros((2, 3), dtype=complex),
]


@pytest.fixture
def parts(ball: vx.Model) -> dict:
    return {
        "field_a": ball.field._core,
        "shell_a": ball.shell._core,
        "field_b": _core.plane_field((0.0, 0.0, 1.0), -0.09),
        "shell_b": None,
        "a_pose": None,
        "b_pose": None,
        "choice": _core.ShellChoice.AUTOMATIC,
        "margin": 0.0,
    }


@pytest.mark.parametrize("method", ["sample", "gradient"])
def test_fields(ball: vx.Model, method: str):
    for field in (
        ball.field._core,
        _core.plane_field((0.0, 0.0, 1.0), 0.0),
        _core.box_field((1.0, 1.0, 1.0)),
        _core.sphere_field(1.0),
    ):
        call = getattr(field, method)
        assert len(call(POINTS)) == len(call(READ_ONLY)) == 2
        for wrong in WRONG_POINTS:
            with pytest.raises(TypeError):
                call(wrong)


@pytest.mark.parametrize(
    ("make", "wrong"),
    [
        (_core.plane_field, [(), ((0, 0), 0), ((0, 0, 1), "0"), (None, 0.0)]),
        (_core.box_field, [(), ((1, 1),), ("box",), (None,)]),
        (_core.sphere_field, [(), ("1",), (None,), ((1,),)]),
    ],
)
def test_shapes(make, wrong):
    for arguments in wrong:
        with pytest.raises(TypeError):
            make(*arguments)


@pytest.mark.parametrize("query", [_core.contacts, _core.contacts_flat, _core.collide])
def test_queries(parts: dict, query):
    level = {} if query is _core.collide else {"level": 1}
    assert query(**parts, **level)
    assert query(**{**parts, "a_pose": np.eye(4), "b_pose": np.eye(4)}, **level)
    for name, wrong in {
        "field_a": [None, 1, parts["shell_a"]],
        "shell_a": [1, parts["field_a"]],
        "field_b": [None, "plane"],
        "shell_b": [parts["field_b"]],
        "a_pose": ["pose", np.eye(3), np.zeros(16), np.eye(4, dtype=complex)],
        "b_pose": [1.0, np.zeros((4, 4, 1))],
        "choice": [None, "a", 7],
        "margin": [None, "0"],
    }.items():
        for value in wrong:
            with pytest.raises(TypeError):
                query(**{**parts, name: value}, **level)


def test_building():
    vertices = np.eye(4)[:, :3] * 1.0
    faces = np.array([[3, 1, 0], [3, 0, 2], [3, 2, 1], [0, 1, 2]], dtype=np.uint32)
    settings = {
        "voxel_size": 0.1,
        "resolution": 0,
        "point_spacing": 0.0,
        "target_points": 0,
        "padding": -1.0,
        "threads": 0,
        "progress": None,
    }
    model = _core.Model.build(vertices, faces, **settings)
    assert len(model.shell) > 0
    for wrong in WRONG_POINTS:
        with pytest.raises(TypeError):
            _core.Model.build(wrong, faces, **settings)
    for wrong in (None, faces[:, :2], faces.astype(complex), faces[0]):
        with pytest.raises(TypeError):
            _core.Model.build(vertices, wrong, **settings)
    for name in settings:
        if name != "progress":
            with pytest.raises(TypeError):
                _core.Model.build(vertices, faces, **{**settings, name: "x"})
    with pytest.raises(TypeError):
        _core.Model.build(vertices, faces)
    for kind in (_core.Model, _core.Field, _core.PointShell, _core.ContactSet):
        with pytest.raises(TypeError, match="no constructor"):
            kind()


def test_trees_and_contact_sets(parts: dict):
    tree = parts["shell_a"].tree
    for call in (tree.spheres, tree.segments, _core.contacts(**parts, level=1).manifold):
        call(1)
        for wrong in (None, "1", 1.5):
            with pytest.raises(TypeError):
                call(wrong)
