"""Floating-point states that other libraries leave in a thread: the same bits, and the state as found."""

from __future__ import annotations

import ctypes
import platform
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
import trimesh
import voxshell as vx

pytestmark = pytest.mark.skipif(
    platform.system() != "Linux" or platform.machine() != "x86_64", reason="sets MXCSR by glibc"
)

LIBM = ctypes.CDLL("libm.so.6")
FLUSH_TO_ZERO, DENORMALS_ARE_ZERO = 0x8000, 0x0040
STATES = {
    "flush to zero": FLUSH_TO_ZERO | DENORMALS_ARE_ZERO,
    "upward": 0x4000,
    "downward": 0x2000,
    "toward zero": 0x6000,
}


class Environment(ctypes.Structure):
    """glibc's fenv_t of x86-64."""

    _fields_ = (("x87", ctypes.c_uint32 * 7), ("mxcsr", ctypes.c_uint32))


def read_mxcsr() -> int:
    environment = Environment()
    assert LIBM.fegetenv(ctypes.byref(environment)) == 0
    return environment.mxcsr


def write_mxcsr(mxcsr: int) -> None:
    environment = Environment()
    assert LIBM.fegetenv(ctypes.byref(environment)) == 0
    environment.mxcsr = mxcsr
    assert LIBM.fesetenv(ctypes.byref(environment)) == 0


@contextmanager
def floating_point_state(bits: int) -> Iterator[None]:
    before = read_mxcsr()
    write_mxcsr(before | bits)
    try:
        yield
        after = read_mxcsr()
    finally:
        write_mxcsr(before)
    control = 0xFFC0  # all but the flags
    assert after & control == (before | bits) & control


@pytest.fixture(scope="module")
def model() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.icosphere(3, radius=0.1), voxel_size=0.01)


def pose_of(x: float, z: float) -> np.ndarray:
    pose = trimesh.transformations.rotation_matrix(0.3, (1.0, 2.0, 3.0))
    pose[:3, 3] = x, 0.01, z
    return pose


POSES = np.array([pose_of(x, 0.003) for x in np.linspace(0.15, 0.21, 50)])
# NumPy's own arithmetic is the caller's: arguments are made before.
SPOTS = np.random.default_rng(3).uniform(-0.2, 0.2, (200, 3))


def query(model: vx.Model) -> list[bytes]:
    contacts = vx.contacts(model, model, a_pose=POSES[10], margin=0.0033)
    batch = vx.contacts_batch(model, model, a_poses=POSES, threads=3, margin=0.0033)
    near = vx.distance(model, model, a_pose=POSES[-1])
    wrench = vx.wrench(model, model, POSES[0], np.eye(4), stiffness=1e7)
    return [
        contacts.points_a.tobytes(),
        contacts.normals.tobytes(),
        contacts.depths.tobytes(),
        batch.depths.tobytes(),
        batch.points_b.tobytes(),
        vx.collide_batch(model, model, a_poses=POSES).tobytes(),
        vx.distance_batch(model, model, a_poses=POSES, threads=3).tobytes(),
        near.point_a.tobytes(),
        wrench.force.tobytes(),
        wrench.torque.tobytes(),
        model.field.sample(SPOTS).tobytes(),
        model.field.gradient(SPOTS).tobytes(),
    ]


def make_world(model: vx.Model) -> tuple[vx.World, vx.Body]:
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    for height in (0.1, 0.32, 0.55):
        ball = world.add(model, pose=pose_of(0.02 * height, height))
    return world, ball


@pytest.mark.parametrize("state", STATES)
def test_queries_give_the_same_bits_and_leave_the_state_as_found(model: vx.Model, state: str):
    expected = query(model)
    with floating_point_state(STATES[state]):
        found = query(model)
    assert found == expected


@pytest.mark.parametrize("state", STATES)
def test_worlds_give_the_same_bits_and_leave_the_state_as_found(model: vx.Model, state: str):
    (plain, expected), (other, ball) = make_world(model), make_world(model)
    plain.step(150)
    with floating_point_state(STATES[state]):
        other.step(150)
        contacts = other.contacts()
        pose = ball.pose
    np.testing.assert_array_equal(pose, expected.pose)
    np.testing.assert_array_equal(contacts, plain.contacts())


def test_builds_give_the_same_bits_whatever_progress_leaves_behind(tmp_path):
    mesh = trimesh.creation.icosphere(3, radius=0.1)
    mesh.vertices  # noqa: B018
    settings = {"resolution": 40, "threads": 2, "cache": False}
    plain = vx.Model.from_mesh(mesh, **settings)
    before = read_mxcsr()
    try:
        changed = vx.Model.from_mesh(
            mesh,
            progress=lambda stage, fraction: write_mxcsr(before | FLUSH_TO_ZERO | 0x4000),
            **settings,
        )
        after = read_mxcsr()
    finally:
        write_mxcsr(before)
    assert after & 0xFFC0 == before & 0xFFC0
    plain.save(tmp_path / "plain.vxs")
    changed.save(tmp_path / "changed.vxs")
    assert (tmp_path / "plain.vxs").read_bytes() == (tmp_path / "changed.vxs").read_bytes()
