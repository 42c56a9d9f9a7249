"""The compiled module on its own: wrong types stop at its door, with nothing of ours in between."""

from __future__ import annotations

import sys

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
        "model_a": ball._core,
        "field_b": _core.plane_field((0.0, 0.0, 1.0), -0.09),
        "model_b": None,
        "a_pose": None,
        "b_pose": None,
        "shells": _core.Shells.AUTOMATIC,
    }


SEARCH = {"margin": 0.0, "level": 1, "max_points": None, "budget": None, "scratch": None}


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


@pytest.mark.parametrize(
    ("query", "own"),
    [
        (_core.contacts, SEARCH),
        (_core.contacts_flat, SEARCH),
        (_core.collide, {"margin": 0.0}),
        (_core.distance, {"max_distance": 1.0, "scratch": None}),
        (_core.wrench, {"stiffness": 1.0, "scratch": None}),
    ],
)
def test_queries(parts: dict, query, own: dict):
    assert query(**parts, **own)
    assert query(**{**parts, "a_pose": np.eye(4), "b_pose": np.eye(4)}, **own)
    for name, wrong in {
        "field_a": [None, 1, parts["model_a"]],
        "model_a": [1, parts["field_a"]],
        "field_b": [None, "plane"],
        "model_b": [parts["field_b"]],
        "a_pose": ["pose", np.eye(3), np.zeros(16), np.eye(4, dtype=complex)],
        "b_pose": [1.0, np.zeros((4, 4, 1))],
        "shells": [None, "a", 7],
        "margin": [None, "0"],
        "level": [None, 1.5],
        "max_points": ["all", -1],
        "budget": [0.5, -1],
        "scratch": [1, parts["model_a"]],
        "max_distance": [None, "0"],
        "stiffness": [None, "0"],
    }.items():
        if name not in {**parts, **own}:
            continue
        for value in wrong:
            with pytest.raises(TypeError):
                query(**{**parts, **own, name: value})


def lay_out(pose: np.ndarray) -> dict[str, np.ndarray]:
    """The same numbers, as arrays may hold them."""
    wide, packed = np.zeros((8, 12)), np.zeros(4, dtype=[("row", "f8", 4), ("end", "i1")])
    wide[::2, ::3], packed["row"] = pose, pose
    read_only = pose.copy()
    read_only.flags.writeable = False
    return {
        "by columns": np.asfortranarray(pose),
        "in a larger one": wide[::2, ::3],
        "backwards": pose[::-1, ::-1].copy()[::-1, ::-1],
        "not aligned": packed["row"],
        "read-only": read_only,
    }


def test_poses_are_read_however_they_lie_in_memory(parts: dict):
    pose = np.eye(4)
    pose[:3, :3] = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    pose[:3, 3] = (0.3, 0.2, 0.005)
    want = _core.contacts(**{**parts, "a_pose": pose}, **SEARCH)
    assert len(want.depths) > 0
    for layout, same in lay_out(pose).items():
        found = _core.contacts(**{**parts, "a_pose": same}, **SEARCH)
        np.testing.assert_array_equal(found.points_a, want.points_a, err_msg=layout)


@pytest.mark.parametrize(
    "wrong",
    [np.eye(4, dtype=np.float32), np.eye(4, dtype=np.int64), np.eye(4, dtype=">f8"), bytes(128)],
    ids=["single", "integers", "other byte order", "bytes"],
)
def test_poses_of_other_numbers_are_refused_and_let_go(parts: dict, wrong):
    references = sys.getrefcount(wrong)
    for _ in range(10):
        with pytest.raises(TypeError):
            _core.collide(**{**parts, "a_pose": wrong}, margin=0.0)
    assert sys.getrefcount(wrong) == references


@pytest.mark.parametrize(
    ("query", "own"),
    [(_core.contacts_batch, {"level": 1, "max_points": None}), (_core.collide_batch, {})],
)
def test_batches(parts: dict, query, own: dict):
    bodies = {name: parts[name] for name in ("field_a", "model_a", "field_b", "model_b", "shells")}
    arguments = {
        **bodies,
        "a_poses": np.eye(4)[None],
        "b_poses": None,
        "count": 1,
        "margin": 0.0,
        "threads": 1,
        "progress": None,
        **own,
    }
    assert len(query(**arguments)) == 1
    for name, wrong in {
        "field_a": [None],
        "a_poses": ["pose", np.eye(4), np.zeros((2, 4, 3)), np.eye(4, dtype=complex)[None]],
        "b_poses": [1.0, np.eye(4)],
        "count": [None, "yes", -1],
        "threads": [None, -1, "1"],
        "shells": ["a"],
    }.items():
        for value in wrong:
            with pytest.raises(TypeError):
                query(**{**arguments, name: value})
    with pytest.raises(ValueError, match="not as many poses"):
        query(**{**arguments, "count": 3, "a_poses": np.tile(np.eye(4), (2, 1, 1))})
    with pytest.raises(IndexError):
        _core.contacts_batch(**arguments, **({} if own else {"level": 1, "max_points": None})).at(1)


def test_building():
    vertices = np.eye(4)[:, :3] * 1.0
    faces = np.array([[3, 1, 0], [3, 0, 2], [3, 2, 1], [0, 1, 2]], dtype=np.uint32)
    settings = {
        "tolerance": 0.0,
        "voxel_size": 0.1,
        "resolution": 0,
        "point_spacing": 0.0,
        "target_points": 0,
        "padding": -1.0,
        "sign": "auto",
        "open": "auto",
        "sheet_thickness": 0.0,
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
                _core.Model.build(vertices, faces, **{**settings, name: b"x"})
    with pytest.raises(TypeError):
        _core.Model.build(vertices, faces)
    for kind in (
        _core.Model,
        _core.Field,
        _core.PointShell,
        _core.ContactSet,
        _core.ContactBatch,
    ):
        with pytest.raises(TypeError, match="no constructor"):
            kind()


def test_trees_and_contact_sets(parts: dict):
    tree = parts["model_a"].shell.tree
    for call in (tree.spheres, tree.segments, _core.contacts(**parts, **SEARCH).manifold):
        call(1)
        for wrong in (None, "1", 1.5):
            with pytest.raises(TypeError):
                call(wrong)
