"""The promise that all else rests on: contacts are exactly those of a loop over all points.

The oracle is written again here, in numpy, and shares no code with the core. evidence/test_fast_paths
holds every query to the core's own flat loop, in far more poses.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pytest
import voxshell as vx

if TYPE_CHECKING:
    from collections.abc import Iterator

    from voxshell.query.pairs import Collidable

LEAST_HIT_RATE = 0.3

PAIRS = ("bunny-plane", "bunny-bunny", "bunny-box")


# ---- poses ---------------------------------------------------------------------------------------


@dataclass
class Query:
    a_pose: np.ndarray
    b_pose: np.ndarray
    margin: float


def random_pose(rng: np.random.Generator, reach: float) -> np.ndarray:
    """Uniform in orientation (a normalized Gaussian quaternion), within `reach` of the origin."""
    w, x, y, z = (lambda q: q / np.linalg.norm(q))(rng.normal(size=4))
    pose = np.eye(4)
    pose[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    pose[:3, 3] = rng.uniform(-reach, reach, 3)
    return pose


def random_queries(a: Collidable, b: Collidable, seed: int, count: int) -> Iterator[Query]:
    """A third each far apart, touching and deep in one another, as seen along a random direction.

    `a` comes from far along the direction to where it first touches `b`; from there it is moved.
    """
    rng = np.random.default_rng(seed)
    for i in range(count):
        world_from_b = random_pose(rng, reach=2.0)
        b_from_a = random_pose(rng, reach=0.1)
        outwards = rng.normal(size=3)
        if isinstance(b, vx.Plane):
            outwards = b.normal
        outwards /= np.linalg.norm(outwards)
        start = b_from_a[:3, 3].copy()
        near, far = 0.0, 1.0
        for _ in range(12):
            middle = (near + far) / 2.0
            b_from_a[:3, 3] = start + middle * outwards
            near, far = (middle, far) if vx.collide(a, b, b_from_a) else (near, middle)
        gap = (rng.uniform(0.0, 0.05), rng.uniform(-0.002, 0.0005), rng.uniform(-0.06, -0.002))
        b_from_a[:3, 3] = start + (far + gap[i % 3]) * outwards
        yield Query(
            world_from_b @ b_from_a,
            world_from_b,
            margin=(0.0, 0.0, 0.0005, 0.003, -0.001)[i % 5],
        )


@pytest.fixture(params=PAIRS)
def pair(request: pytest.FixtureRequest) -> tuple[str, Collidable | None]:
    """The second body; None stands for the bunny itself."""
    others = {
        "bunny-plane": vx.Plane(normal=(0.1, -0.2, 0.9), offset=0.03),
        "bunny-bunny": None,
        "bunny-box": vx.Box(half_extents=(0.08, 0.05, 0.03)),
    }
    return request.param, others[request.param]


# ---- against a flat loop in numpy ----------------------------------------------------------------

F = np.float32


def dot(a, b):
    """In the order of the core: numpy's own may use several accumulators."""
    return (a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]) + a[..., 2] * b[..., 2]


def length(a):
    return np.sqrt(dot(a, a))


def normalized(a):
    scale = length(a)[..., None]
    return np.divide(a, scale, out=np.zeros_like(a), where=scale > 0)


def rotated(rotation, points):
    return np.stack([dot(row, points) for row in rotation], axis=-1)


def rounded(numbers, size):
    """To a 2^-30th of the least power of two above `size`, then to float32. No zero is negative."""
    quantum = 2.0 ** (np.floor(np.log2(size)) + 1.0 - 30.0)
    return (np.rint(numbers / quantum) * quantum + 0.0).astype(F)


def reach_of_shell(shell_body: vx.Model):
    """Of the points' enclosing sphere, from the origin; this model has no edge segments."""
    assert len(shell_body.shell.edges) == 0
    x, y, z, radius = shell_body.shell.tree.spheres(1)[0].astype(float)
    return np.sqrt(x * x + y * y + z * z) + radius


class NumpyPlane:
    """Carried into the shell's frame in float64, then one dot product in float32."""

    def __init__(self, plane: vx.Plane, rotation, translation, reach):
        self.normal = rounded(rotated(rotation.T, plane.normal), 1.0)
        self.offset = rounded(plane.offset - dot(plane.normal, translation), reach)

    def evaluate(self, points):
        normals = np.broadcast_to(normalized(self.normal), points.shape)
        return dot(self.normal, points) - self.offset, normals


class NumpyPosed:
    """Points are carried into the field's frame in float32, gradients back."""

    def __init__(self, rotation, translation, reach):
        self.rotation, self.translation = rounded(rotation, 1.0), rounded(translation, reach)

    def evaluate(self, points):
        distances, gradients = self.sample(rotated(self.rotation, points) + self.translation)
        x, y, z = (gradients[:, axis, None] for axis in range(3))
        row_x, row_y, row_z = self.rotation
        return distances, normalized((row_x * x + row_y * y) + row_z * z)


class NumpyBox(NumpyPosed):
    def __init__(self, box: vx.Box, rotation, translation, reach):
        super().__init__(rotation, translation, reach + np.linalg.norm(box.half_extents))
        self.half_extents = box.half_extents.astype(F)

    def sample(self, p):
        beyond = np.abs(p) - self.half_extents
        outside = np.maximum(beyond, F(0))
        largest = beyond.max(axis=1)
        distances = length(outside) + np.minimum(largest, F(0))
        nearest_face = np.zeros_like(p)
        rows = np.arange(len(p))
        axes = beyond.argmax(axis=1)
        nearest_face[rows, axes] = np.copysign(F(1), p[rows, axes])
        is_outside = (largest > 0)[:, None]
        return distances, np.where(is_outside, normalized(np.copysign(outside, p)), nearest_face)


class NumpyGrid(NumpyPosed):
    """A model's field, sampled through the package; its own formula is tested with the core."""

    def __init__(self, model: vx.Model, rotation, translation, reach):
        self.field = model.field
        far = self.field.origin + self.field.voxel_size * np.array(self.field.shape)
        size = np.linalg.norm(self.field.origin) + np.linalg.norm(far)
        super().__init__(rotation, translation, reach + size)

    def sample(self, p):
        return self.field.sample(p).astype(F), self.field.gradient(p).astype(F)


def contacts_by_numpy(shell_body: vx.Model, other: Collidable, shell_pose, other_pose, margin):
    """The contacts of `shell_body`'s points in `other`'s field, with the shell as body a."""
    inverse = other_pose[:3, :3].T
    rotation = np.stack([rotated(shell_pose[:3, :3].T, row) for row in inverse])
    translation = rotated(inverse, shell_pose[:3, 3]) - rotated(inverse, other_pose[:3, 3])
    field_type = {vx.Plane: NumpyPlane, vx.Box: NumpyBox, vx.Model: NumpyGrid}[type(other)]
    posed = field_type(other, rotation, translation, reach_of_shell(shell_body))
    points = shell_body.shell.points
    distances, normals = posed.evaluate(points)
    flat = (normals == 0).all(axis=1)
    normals = np.where(flat[:, None], -shell_body.shell.normals, normals)

    ids = np.flatnonzero(distances < F(margin))
    depths = -distances[ids].astype(float)
    points_a = rotated(shell_pose[:3, :3], points[ids].astype(float)) + shell_pose[:3, 3]
    outwards = rotated(shell_pose[:3, :3], normals[ids].astype(float))
    return {
        "ids": ids,
        "depths": depths,
        "points_a": points_a,
        "points_b": points_a + depths[:, None] * outwards,
        "normals": outwards,
    }


@pytest.mark.parametrize("fine", [False, True], ids=["coarse", "fine"])
def test_contacts_are_those_of_a_flat_loop_in_numpy(
    pair: tuple[str, Collidable | None], fine: bool, coarse_bunny: vx.Model, fine_bunny: vx.Model
):
    _, other = pair
    shell = fine_bunny if fine else coarse_bunny
    b = other or fine_bunny
    hits = 0
    for query in random_queries(shell, b, seed=4, count=60):
        found = vx.contacts(shell, b, query.a_pose, query.b_pose, shell="a", margin=query.margin)
        oracle = contacts_by_numpy(shell, b, query.a_pose, query.b_pose, query.margin)
        for name, theirs in oracle.items():
            ours = getattr(found, name)
            assert ours.shape == theirs.shape, name
            # Negative zeros count as zeros; all else must be equal to the last bit.
            assert (ours + 0.0).tobytes() == (theirs + 0.0).tobytes(), name
        hits += len(found) > 0
    assert hits >= LEAST_HIT_RATE * 60
