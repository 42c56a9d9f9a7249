from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
import trimesh
import voxshell as vx

SHAPES = {
    "plane": lambda: vx.Plane(normal=(1, 2, 2), offset=0.5),
    "box": lambda: vx.Box(half_extents=(0.3, 0.5, 0.8)),
    "sphere": lambda: vx.Sphere(radius=0.7),
    "capsule": lambda: vx.Capsule(radius=0.4, length=0.9),
    "cylinder": lambda: vx.Cylinder(radius=0.5, length=1.2),
    "cone": lambda: vx.Cone(radius=0.6, height=1.2),
    "convex": lambda: vx.ConvexPolyhedron(trimesh.creation.icosphere(1, radius=0.7)),
}


def distance_to_segment(p: np.ndarray, start, end) -> np.ndarray:
    edge = np.subtract(end, start)
    along = np.clip((p - start) @ edge / (edge @ edge), 0, 1)
    return np.linalg.norm(p - start - along[:, None] * edge, axis=1)


def distance_to_polygon(p: np.ndarray, corners) -> np.ndarray:
    """Of a convex one, counter-clockwise."""
    edges = list(zip(corners, [*corners[1:], corners[0]], strict=True))
    nearest = np.min([distance_to_segment(p, a, b) for a, b in edges], axis=0)
    left = [
        (b[0] - a[0]) * (p[:, 1] - a[1]) - (b[1] - a[1]) * (p[:, 0] - a[0]) > 0 for a, b in edges
    ]
    return np.where(np.all(left, axis=0), -nearest, nearest)


def exact_distance(shape: vx.Field, p: np.ndarray) -> np.ndarray:
    if isinstance(shape, vx.Plane):
        return p @ shape.normal - shape.offset
    if isinstance(shape, vx.Sphere):
        return np.linalg.norm(p, axis=1) - shape.radius
    if isinstance(shape, vx.ConvexPolyhedron):
        triangles = shape.mesh.vertices[shape.mesh.faces]
        normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        return (p @ normals.T - np.sum(normals * triangles[:, 0], axis=1)).max(axis=1)
    profile = np.column_stack([np.hypot(p[:, 0], p[:, 1]), p[:, 2]])
    if isinstance(shape, vx.Capsule):
        end = shape.length / 2
        return distance_to_segment(profile, (0, -end), (0, end)) - shape.radius
    if isinstance(shape, vx.Cylinder):
        r, z = shape.radius, shape.length / 2
        return distance_to_polygon(profile, [(-r, -z), (r, -z), (r, z), (-r, z)])
    if isinstance(shape, vx.Cone):
        r, z = shape.radius, shape.height / 2
        return distance_to_polygon(profile, [(-r, -z), (r, -z), (0, z)])
    assert isinstance(shape, vx.Box)
    beyond = np.abs(p) - shape.half_extents
    return np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)


@pytest.mark.parametrize("kind", SHAPES)
def test_distances_are_exact_and_gradients_their_slopes(kind: str):
    shape = SHAPES[kind]()
    rng = np.random.default_rng(2)
    points = rng.uniform(-1.0, 1.0, (5_000, 3))
    distances = shape.sample(points)
    assert 0.05 < np.mean(distances < 0) < 0.95
    np.testing.assert_allclose(distances, exact_distance(shape, points), atol=1e-6)
    gradients = shape.gradient(points)
    np.testing.assert_allclose(np.linalg.norm(gradients, axis=1), 1.0, atol=1e-6)
    step = 1e-6
    forward = exact_distance(shape, points + step * gradients)
    off = np.abs(forward - exact_distance(shape, points) - step)
    assert np.mean(off < 1e-3 * step) > 0.99  # all but those beside a ridge


def test_where_a_shape_has_no_single_gradient_it_still_gives_one():
    np.testing.assert_array_equal(vx.Sphere(1.0).gradient([[0, 0, 0]]), [[0, 0, 1]])
    np.testing.assert_array_equal(vx.Box((1, 1, 1)).gradient([[0, 0, 0]]), [[1, 0, 0]])
    np.testing.assert_array_equal(vx.Box((1, 1, 1)).gradient([[0.5, -0.5, 0.5]]), [[1, 0, 0]])


def test_a_plane_keeps_its_normal_at_unit_length():
    for scale in (1.0, 1e-300, 1e300):
        plane = vx.Plane(normal=(0.0, 3.0 * scale, 4.0 * scale), offset=2.0)
        np.testing.assert_allclose(plane.normal, (0.0, 0.6, 0.8), rtol=1e-15)
        assert plane.offset == 2.0  # meters along the unit normal, whatever was given
    np.testing.assert_array_equal(vx.Plane().normal, (0, 0, 1))
    assert vx.Plane().offset == 0.0


def test_what_shapes_say_of_themselves():
    assert repr(SHAPES["box"]()) == "Box(half_extents=(0.3, 0.5, 0.8))"
    assert repr(SHAPES["sphere"]()) == "Sphere(radius=0.7)"
    assert repr(SHAPES["capsule"]()) == "Capsule(radius=0.4, length=0.9)"
    assert repr(SHAPES["cylinder"]()) == "Cylinder(radius=0.5, length=1.2)"
    assert repr(SHAPES["cone"]()) == "Cone(radius=0.6, height=1.2)"
    assert repr(SHAPES["convex"]()) == "ConvexPolyhedron(80 faces)"
    assert repr(vx.Plane()) == "Plane(normal=(0.0, 0.0, 1.0), offset=0)"
    box = vx.Box((1, 2, 3))
    box.half_extents[0] = 9.0  # a copy
    np.testing.assert_array_equal(box.half_extents, (1, 2, 3))


def test_shapes_cannot_be_changed():
    with pytest.raises(AttributeError):
        SHAPES["sphere"]().radius = 2.0  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(AttributeError):
        SHAPES["plane"]().normal = (1, 0, 0)  # pyright: ignore[reportAttributeAccessIssue]


WRONG_LENGTHS = [0, -1, np.nan, np.inf, 1e300, None, "1", [1, 2], 1j]


@pytest.mark.parametrize("radius", WRONG_LENGTHS)
def test_a_wrong_radius_is_refused(radius):
    with pytest.raises(vx.SettingsError, match="radius"):
        vx.Sphere(radius)
    for shape in (vx.Capsule, vx.Cylinder, vx.Cone):
        with pytest.raises(vx.SettingsError, match="radius"):
            shape(radius, 1.0)


@pytest.mark.parametrize(
    ("half_extents", "given"),
    [(0.1, "0.1"), ((0.1, 0.2), r"\[0.1, 0.2\]"), (None, "None"), ("1", "'1'")],
)
def test_half_extents_of_a_wrong_shape_are_refused_in_words(half_extents, given: str):
    """The message for a number was "not () float64"."""
    wanted = (
        "half_extents must be three numbers in meters, half of the edge lengths along x, y and z"
    )
    with pytest.raises(vx.SettingsError, match=f"^{wanted}, not {given}$"):
        vx.Box(half_extents)


@pytest.mark.parametrize("length", WRONG_LENGTHS)
def test_a_wrong_length_or_height_is_refused(length):
    for shape in (vx.Capsule, vx.Cylinder):
        with pytest.raises(vx.SettingsError, match="length"):
            shape(1.0, length)
    with pytest.raises(vx.SettingsError, match="height"):
        vx.Cone(1.0, length)


def test_a_convex_polyhedron_takes_what_a_hull_is():
    rng = np.random.default_rng(5)
    points = rng.normal(size=(60, 3))
    hull = vx.ConvexPolyhedron(vx.ConvexHull(points).mesh)
    off = 2e-4 * np.ptp(points, axis=0).max()
    assert abs(hull.sample(points).max()) < off
    assert (hull.sample(points) > -off).sum() >= 4
    assert hull.sample([points.mean(axis=0)])[0] < 0


def test_a_convex_polyhedron_must_be_convex_and_says_by_how_much():
    dented = trimesh.creation.box()
    dented.vertices[np.argmax(dented.vertices.sum(axis=1))] *= 0.4
    with pytest.raises(vx.MeshError, match=r"not convex: vertex .* stands 0\.\d+ m out"):
        vx.ConvexPolyhedron(dented)
    with pytest.raises(vx.MeshError, match=r"watertight.*; repair it$"):
        vx.ConvexPolyhedron((dented.vertices, dented.faces[1:]))
    with pytest.raises(vx.MeshError, match="not finite"):
        vx.ConvexPolyhedron((dented.vertices * np.nan, dented.faces))
    with pytest.raises(vx.MemoryLimitError, match="4096 faces"):
        vx.ConvexPolyhedron(trimesh.creation.icosphere(4))
    with pytest.raises(vx.InputTypeError, match="mesh"):
        vx.ConvexPolyhedron(None)  # pyright: ignore[reportArgumentType]


def test_a_convex_polyhedron_keeps_its_own_mesh():
    box = trimesh.creation.box()
    vertices = np.array(box.vertices)
    polyhedron = vx.ConvexPolyhedron((vertices, box.faces))
    vertices[:] = 9.0
    np.testing.assert_array_equal(polyhedron.mesh.vertices, box.vertices)
    with pytest.raises(ValueError, match="read-only"):
        polyhedron.mesh.vertices[0] = 1.0


@pytest.mark.parametrize("kind", ["capsule", "cylinder", "cone", "convex"])
def test_shapes_meet_models(kind, ball):
    shape = SHAPES[kind]()
    pose = np.eye(4)
    pose[:3, 3] = 0.0, 0.05, 0.0
    touching = vx.contacts(ball, shape, a_pose=pose)
    flat = vx.testing.contacts_flat(ball, shape, a_pose=pose)
    assert len(touching) == len(ball.shell)
    np.testing.assert_array_equal(touching.depths, flat.depths)
    pose[1, 3] = 3.0
    assert not vx.collide(ball, shape, a_pose=pose)


def test_a_convex_polyhedron_makes_no_body():
    with pytest.raises(vx.InputTypeError, match="ConvexPolyhedron"):
        vx.World().add(SHAPES["convex"](), mass=0)


@pytest.mark.parametrize(
    "half_extents",
    [(1, 1), (1, 1, 0), (1, -1, 1), (1, 1, np.nan), (1, 1, 1e300), 1.0, None, "box", [(1, 1, 1)]],
)
def test_wrong_half_extents_are_refused(half_extents):
    with pytest.raises(vx.SettingsError, match="half_extents"):
        vx.Box(half_extents)


@pytest.mark.parametrize("normal", [(0, 0, 0), (1, 0), (np.nan, 0, 1), (np.inf, 0, 0), None, "z"])
def test_a_wrong_normal_is_refused(normal):
    with pytest.raises(vx.SettingsError, match="normal"):
        vx.Plane(normal)


@pytest.mark.parametrize("offset", [np.nan, np.inf, 1e300, None, "1"])
def test_a_wrong_offset_is_refused(offset):
    with pytest.raises(vx.SettingsError, match="offset"):
        vx.Plane(offset=offset)


@pytest.mark.parametrize("kind", SHAPES)
def test_shapes_are_pickled_and_copied_bit_for_bit(kind):
    shape = SHAPES[kind]()
    points = np.random.default_rng(1).normal(size=(100, 3))
    for copied in (pickle.loads(pickle.dumps(shape)), copy.copy(shape), copy.deepcopy(shape)):
        assert type(copied) is type(shape)
        assert repr(copied) == repr(shape)
        assert copied.sample(points).tobytes() == shape.sample(points).tobytes()


def test_a_pickled_plane_keeps_the_bits_of_its_normal():
    for normal in np.random.default_rng(1).normal(size=(200, 3)):
        plane = vx.Plane(normal)
        assert pickle.loads(pickle.dumps(plane)).normal.tobytes() == plane.normal.tobytes()


def test_compounds_and_hulls_are_pickled():
    hull = vx.ConvexHull(trimesh.creation.box().vertices)
    whole = vx.Compound([(vx.Sphere(0.2), (0, 0, 0)), (hull, (1, 0, 0))])
    copied = pickle.loads(pickle.dumps(whole))
    assert repr(copied) == repr(whole)
    assert copied.parts[1][1].tolist() == whole.parts[1][1].tolist()
    vx.World().add(copied)


def test_a_shape_too_long_for_its_thickness_is_named_with_a_remedy():
    model = vx.Model.from_mesh(trimesh.creation.box((0.1, 0.1, 0.1)))
    wire = vx.Cylinder(1e-4, 1000)
    with pytest.raises(
        vx.MemoryLimitError, match=r"points of Cylinder\(radius=0\.0001, length=1000\) .* shell='b'"
    ):
        vx.collide(wire, model)
    assert not vx.collide(wire, model, (0, 0.1, 0), shell="b")
