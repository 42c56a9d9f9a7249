from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from poses import at
from queries import BATCHES, FEW, ONE_SHELL, QUERIES, SEARCHES, WITH_MARGIN, wrench

SCALED = np.diag([2.0, 2.0, 2.0, 1.0])
MIRRORED = np.diag([1.0, 1.0, -1.0, 1.0])
HOLE = at(z=np.nan)
PROJECTIVE = np.eye(4) + np.eye(4, k=-1) * [[0], [0], [0], [1]]


@pytest.mark.parametrize("query", QUERIES)
@pytest.mark.parametrize("name", ["a_pose", "b_pose"])
@pytest.mark.parametrize(
    ("pose", "message"),
    [
        (
            np.eye(3),
            r"\(4, 4\) matrix, .*not an array of shape \(3, 3\) and type float64; for a rotation",
        ),
        (np.eye(4).ravel(), r"of shape \(16,\) .*reshape"),
        (np.eye(4)[None], r"of shape \(1, 4, 4\)"),
        ("pose", "not 'pose'$"),
        (0.5, "not 0.5$"),
        ((1.5, 2.5), r"not \[1.5, 2.5\]$"),
        ([["1"] * 4] * 4, "not"),
        ([[1, 2], [3]], r"not \[\[1, 2\], \[3\]\]$"),
        (((1, 2, 3), np.eye(3)), r"call voxshell.pose\(position, rotation=\.\.\.\)$"),
        (np.eye(4, dtype=complex), "complex"),
        (np.eye(4, dtype=bool), "bool"),
        (np.full((4, 4), None), "object"),
        (HOLE, "finite"),
        (at(x=np.inf), "finite"),
        (at(x=1e300), r"1e\+300 m from its origin"),
        (SCALED, "orthonormal"),
        (MIRRORED, "mirrors"),
        (PROJECTIVE, "last row"),
        (np.zeros((4, 4)), "last row"),
    ],
)
def test_a_wrong_pose_is_refused_by_name(ball: vx.Model, query, name, pose, message):
    with pytest.raises(vx.PoseError, match=message) as caught:
        query(ball, vx.Plane(), **{name: pose})
    assert name in str(caught.value)
    assert isinstance(caught.value, (vx.VoxshellError, ValueError))
    assert caught.value.__suppress_context__  # one traceback, without that of the core's error


@given(
    hnp.arrays(
        dtype=st.sampled_from(
            [np.float64, np.float32, np.int64, np.uint8, np.complex128, np.bool_]
        ),
        shape=hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=5),
    )
)
@settings(max_examples=1_000, deadline=None)
def test_any_array_as_a_pose_is_an_error_or_a_pose(ball, array):
    try:
        vx.contacts(ball, vx.Plane(), a_pose=array)
    except vx.PoseError:
        return
    if array.shape == (4, 4):
        np.testing.assert_allclose(array[:3, :3] @ array[:3, :3].T, np.eye(3), atol=2e-3)
    else:
        assert array.shape == (3,)


@pytest.mark.parametrize("query", [*QUERIES, *BATCHES])
def test_a_wrong_body_is_refused_by_name(ball: vx.Model, query):
    with pytest.raises(
        vx.InputTypeError, match=r"a must be a Model, .*Plane, .* Cone or ConvexPolyhedron, not int"
    ):
        query(1, ball)
    with pytest.raises(vx.InputTypeError, match=r"b must be a Model.* not Trimesh"):
        query(ball, trimesh.creation.box())
    with pytest.raises(TypeError):
        query(ball, None)
    with pytest.raises(TypeError):
        query(ball)


@pytest.mark.parametrize("query", [*QUERIES, *BATCHES])
def test_a_pair_without_the_shell_asked_for_is_refused(ball: vx.Model, query):
    with pytest.raises(vx.SettingsError, match="neither body has a point shell"):
        query(vx.Plane(), vx.Sphere(1.0))
    with pytest.raises(vx.SettingsError, match="body b has no point shell"):
        query(ball, vx.Plane(), shell="b")
    with pytest.raises(vx.SettingsError, match="body a has no point shell"):
        query(vx.Plane(), ball, shell="a")
    if query not in ONE_SHELL:
        with pytest.raises(vx.SettingsError, match="body b has no point shell"):
            query(ball, vx.Plane(), shell="both")


@pytest.mark.parametrize("query", [*QUERIES, *BATCHES, vx.contact_bounds])
@pytest.mark.parametrize("shell", ["c", "", None, 0, ["a"], "A", ("a", "b"), np.array(["a", "b"])])
def test_a_wrong_shell_is_refused(ball: vx.Model, query, shell):
    choices = "'auto', 'fewest', 'a', 'b' or 'both'"
    with pytest.raises(vx.SettingsError, match=choices):
        query(ball, ball, shell=shell)


@pytest.mark.parametrize("query", WITH_MARGIN)
@pytest.mark.parametrize("margin", [np.nan, np.inf, -np.inf, 1e300, "1", None, [0.1, 0.2], 1j])
def test_a_wrong_margin_is_refused(ball: vx.Model, query, margin):
    with pytest.raises(vx.SettingsError, match="margin"):
        query(ball, vx.Plane(), margin=margin)


@pytest.mark.parametrize("query", [*SEARCHES, vx.deepest_per_segment, vx.contacts_batch])
@pytest.mark.parametrize("level", [0, -1, 13, 2**70, 1.0, "1"])
def test_a_wrong_level_is_refused(ball: vx.Model, query, level):
    with pytest.raises(vx.SettingsError, match="level"):
        query(ball, vx.Plane(), level=level)


@pytest.mark.parametrize("query", [*SEARCHES, vx.contacts_batch])
@pytest.mark.parametrize("max_points", [-1, 2**70, 1.0, "1", [1]])
def test_a_wrong_number_of_points_is_refused(ball: vx.Model, query, max_points):
    with pytest.raises(vx.SettingsError, match="max_points"):
        query(ball, vx.Plane(), max_points=max_points)


@pytest.mark.parametrize("max_points", [0, 5, 2**70, 1.0, "1", None])
def test_a_wrong_size_of_a_manifold_is_refused(ball: vx.Model, max_points):
    with pytest.raises(vx.SettingsError, match="max_points"):
        vx.manifold(ball, vx.Plane(), max_points=max_points)


@pytest.mark.parametrize("query", SEARCHES)
@pytest.mark.parametrize("budget", [0, -1, 2**70, 1.0, "1"])
def test_a_wrong_budget_is_refused(ball: vx.Model, query, budget):
    with pytest.raises(vx.SettingsError, match="budget"):
        query(ball, vx.Plane(), budget=budget)


@pytest.mark.parametrize("query", [*SEARCHES, *FEW, vx.distance, wrench])
def test_a_wrong_scratch_is_refused(ball: vx.Model, query):
    for scratch in (1, "scratch", [], vx.QueryScratch):
        with pytest.raises(vx.InputTypeError, match="scratch must be a QueryScratch"):
            query(ball, vx.Plane(), scratch=scratch)


@pytest.mark.parametrize(
    ("body", "advice"),
    [
        ("part.stl", "not str; build a model of the file: Model.from_mesh('part.stl')"),
        (Path("a/b.obj"), "; build a model of the file: Model.from_mesh('a/b.obj')"),
        (trimesh.creation.box(), "not Trimesh; build a model of the mesh: Model.from_mesh(mesh)"),
    ],
)
def test_a_mesh_is_no_body_and_the_error_says_how_to_build_one(ball: vx.Model, body, advice: str):
    with pytest.raises(vx.InputTypeError, match=re.escape(advice)):
        vx.contacts(body, ball)


@pytest.mark.parametrize("query", [vx.contacts, vx.distance])
def test_many_poses_for_a_single_query_are_refused_with_the_queries_of_many(ball: vx.Model, query):
    with pytest.raises(
        vx.PoseError,
        match=r"for many poses, call contacts_batch\(\), collide_batch\(\) or distance_batch",
    ):
        query(ball, ball, a_pose=np.tile(np.eye(4), (3, 1, 1)))
