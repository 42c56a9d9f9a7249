from __future__ import annotations

import pytest
import trimesh
import voxshell as vx
from voxshell import _core
from voxshell.query import pairs


@pytest.fixture(scope="module")
def uniform() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.box(), voxel_size=0.1)


@pytest.fixture(scope="module")
def sparse() -> vx.Model:
    """By tolerance: few points where the mesh is flat."""
    return vx.Model.from_mesh(trimesh.creation.box(), tolerance=0.01)


def test_analytic_shapes_have_shells_beside_sparse_models_alone(uniform, sparse):
    box = vx.Box((0.1, 0.1, 0.1))
    for shell in ("auto", "both"):
        assert pairs.parts_of_pair(uniform, box, shell)[3] is None
        assert pairs.parts_of_pair(sparse, box, shell)[3] is not None
        assert pairs.parts_of_pair(box, sparse, shell)[1] is not None
        assert pairs.parts_of_pair(sparse, vx.Plane(), shell)[3] is None
    assert pairs.parts_of_pair(sparse, box, "a")[3] is None


def test_fields_and_models_are_told_apart(uniform):
    field_a, model_a, field_b, model_b = pairs.parts_of_pair(uniform, vx.Plane(), "auto")
    assert model_a is not None
    assert model_b is None
    assert isinstance(field_a, _core.Field)
    assert isinstance(field_b, _core.Field)


def test_what_is_no_body_is_told_with_what_is_one(uniform):
    with pytest.raises(vx.InputTypeError, match=r"^b must be a Model, .*Plane.* or \w+, not int$"):
        pairs.parts_of_pair(uniform, 3, "auto")


@pytest.mark.parametrize(
    ("check", "right", "wrong"),
    [
        (pairs.as_shells, ("auto", "fewest", "a", "b", "both"), ("c", None, 1)),
        (pairs.as_margin, (0.0, -0.1, 3.4e38), (3.5e38, float("nan"), "1")),
        (pairs.as_level, (None, 1), (0, 100, 1.5)),
        (pairs.as_max_points, (None, 0, 10), (-1, 0.5)),
        (pairs.as_budget, (None, 1), (0, -1)),
    ],
)
def test_ranges_of_arguments(check, right, wrong):
    for value in right:
        check(value)
    for value in wrong:
        with pytest.raises(vx.SettingsError):
            check(value)


def test_a_scratch_is_a_scratch():
    assert pairs.as_scratch(None) is None
    assert pairs.as_scratch(vx.QueryScratch()) is not None
    with pytest.raises(vx.InputTypeError, match=r"^scratch must be a QueryScratch, not dict$"):
        pairs.as_scratch({})


def test_what_only_a_world_has_is_told_with_what_to_pass_instead(ball):
    world = vx.World()
    body = world.add(vx.Sphere(0.1))
    compound = vx.Compound([(vx.Sphere(0.1), (0, 0, 0))])
    for query in (vx.distance, vx.contacts, vx.collide):
        with pytest.raises(vx.InputTypeError, match=r"not Body; pass .* a=body\.shape and a_pose="):
            query(body, ball)
        with pytest.raises(vx.InputTypeError, match=r"not Body; pass .* b=body\.shape and b_pose="):
            query(ball, body)
        with pytest.raises(vx.InputTypeError, match="not Compound; pass its parts one by one"):
            query(ball, compound)
