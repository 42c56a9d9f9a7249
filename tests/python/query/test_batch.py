from __future__ import annotations

import gc
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import trimesh
import voxshell as vx
from queries import BATCHES

ARRAYS = ("points_a", "points_b", "normals", "depths", "ids", "segments", "shells")
COUNT = 300


def random_poses(rng: np.random.Generator, count: int, reach: float) -> np.ndarray:
    poses = np.stack(
        [
            trimesh.transformations.rotation_matrix(angle, axis)
            for angle, axis in zip(
                rng.uniform(0.0, 6.0, count), rng.normal(size=(count, 3)), strict=True
            )
        ]
    )
    poses[:, :3, 3] = rng.uniform(-reach, reach, (count, 3))
    return poses


@pytest.fixture(scope="module")
def poses() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    return random_poses(rng, COUNT, 0.7), random_poses(rng, COUNT, 0.05)


@pytest.mark.parametrize("shell", ["auto", "fewest", "a", "b", "both"])
@pytest.mark.parametrize("max_points", [None, 5])
def test_a_batch_is_its_poses_one_by_one(ball, cube, poses, shell, max_points):
    options = {"shell": shell, "margin": 0.002, "level": 3, "max_points": max_points}
    batch = vx.contacts_batch(ball, cube, *poses, **options)
    touches = vx.collide_batch(ball, cube, *poses, shell=shell, margin=0.002)
    assert len(batch) == COUNT
    assert touches.dtype == np.bool_
    assert touches.shape == (COUNT,)
    assert 0.2 * COUNT < np.count_nonzero(touches) < 0.9 * COUNT
    assert batch.offsets[0] == 0
    assert batch.offsets[-1] == len(batch.depths)
    np.testing.assert_array_equal(np.diff(batch.offsets) > 0, touches)
    for i, (contacts, a_pose, b_pose) in enumerate(zip(batch, *poses, strict=True)):
        alone = vx.contacts(ball, cube, a_pose, b_pose, **options)
        assert contacts.shell == alone.shell
        assert contacts.exact
        rows = slice(batch.offsets[i], batch.offsets[i + 1])
        for name in ARRAYS:
            expected = getattr(alone, name)
            np.testing.assert_array_equal(getattr(batch, name)[rows], expected)
            np.testing.assert_array_equal(getattr(contacts, name), expected)
        np.testing.assert_array_equal(contacts.manifold().ids, alone.manifold().ids)


@pytest.mark.parametrize("threads", [1, 2, 7])
def test_any_number_of_threads_gives_the_same(ball, cube, poses, threads):
    one = vx.contacts_batch(ball, cube, *poses, threads=1)
    many = vx.contacts_batch(ball, cube, *poses, threads=threads)
    np.testing.assert_array_equal(one.offsets, many.offsets)
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(one, name), getattr(many, name))
    np.testing.assert_array_equal(
        vx.collide_batch(ball, cube, *poses, threads=threads), np.diff(one.offsets) > 0
    )


def test_one_pose_stands_for_all(ball: vx.Model, cube: vx.Model, poses):
    a_poses, b_poses = poses
    many = np.tile(b_poses[0], (COUNT, 1, 1))
    for one in (b_poses[0], b_poses[0].tolist()):
        np.testing.assert_array_equal(
            vx.collide_batch(ball, cube, a_poses, one), vx.collide_batch(ball, cube, a_poses, many)
        )
        np.testing.assert_array_equal(
            vx.contacts_batch(cube, ball, one, a_poses).depths,
            vx.contacts_batch(cube, ball, many, a_poses).depths,
        )
    np.testing.assert_array_equal(
        vx.collide_batch(ball, cube, a_poses), vx.collide_batch(ball, cube, a_poses, np.eye(4))
    )
    assert len(vx.contacts_batch(ball, cube)) == 1
    assert len(vx.contacts_batch(ball, cube, np.eye(4), np.eye(4)[None])) == 1


def test_no_poses_are_an_empty_batch(ball: vx.Model, cube: vx.Model):
    none = np.empty((0, 4, 4))
    batch = vx.contacts_batch(ball, cube, none)
    assert len(batch) == 0
    assert batch.offsets.tolist() == [0]
    assert batch.points_a.shape == (0, 3)
    assert list(batch) == []
    assert vx.collide_batch(ball, cube, none, np.eye(4)).shape == (0,)


def test_indices_count_from_either_end(ball: vx.Model, poses):
    batch = vx.contacts_batch(ball, vx.Plane(), poses[0])
    np.testing.assert_array_equal(batch[-1].ids, batch[COUNT - 1].ids)
    np.testing.assert_array_equal(batch[np.int64(-COUNT)].ids, batch[0].ids)
    for index in (COUNT, -COUNT - 1, 2**70):
        with pytest.raises(IndexError, match=rf"of a batch of {COUNT}"):
            batch[index]
    for index in (slice(0, 2), 1.0, None, "1"):
        with pytest.raises(vx.InputTypeError, match="index must be an integer"):
            batch[index]


def test_arrays_are_read_only_and_outlive_their_batch(ball: vx.Model, poses):
    batch = vx.contacts_batch(ball, vx.Plane(), poses[0])
    arrays = {name: getattr(batch, name) for name in (*ARRAYS, "offsets")}
    copies = {name: array.copy() for name, array in arrays.items()}
    contacts = batch[1]
    del batch
    gc.collect()
    filler = [np.full(100_000, 7.0) for _ in range(20)]  # would land on freed memory
    for name, array in arrays.items():
        np.testing.assert_array_equal(array, copies[name])
        with pytest.raises(ValueError, match="read-only"):
            array[...] = array
    assert len(contacts.points_a) == len(contacts)
    del filler


# ---- progress, other threads, Ctrl-C -------------------------------------------------------------


@pytest.mark.parametrize("batch", BATCHES)
def test_progress_is_reported_from_this_thread(ball, cube, poses, batch):
    reports = []
    batch(
        ball,
        cube,
        *poses,
        progress=lambda stage, fraction: reports.append((stage, fraction, threading.get_ident())),
    )
    assert reports[-1][1] == 1.0
    assert {ident for _, _, ident in reports} == {threading.get_ident()}
    assert all(0.0 <= fraction <= 1.0 for _, fraction, _ in reports)


@pytest.mark.parametrize("batch", BATCHES)
@pytest.mark.parametrize("kind", [RuntimeError, KeyboardInterrupt])
def test_what_progress_raises_arrives(ball, cube, poses, batch, kind):
    error = kind("enough")

    def stop(stage: str, fraction: float) -> None:
        raise error

    with pytest.raises(kind) as caught:
        batch(ball, cube, *poses, progress=stop)
    assert caught.value is error


ASK_FOR_EVER = """
import sys, numpy as np, trimesh
import voxshell as vx
model = vx.Model.from_mesh(trimesh.creation.icosphere(4), resolution=60)
pose = np.eye(4)
pose[0, 3] = 1.9
poses = np.tile(pose, (100_000, 1, 1))
asked = []
def say(stage, fraction):
    if not asked:
        print("asking", flush=True)
    asked.append(fraction)
try:
    while True:
        vx.{batch}(model, model, poses, progress=say, {options})
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(7)
"""


@pytest.mark.parametrize("batch", ["contacts_batch", "distance_batch"])
@pytest.mark.parametrize("threads", [1, 4])
def test_ctrl_c_stops_a_batch(threads: int, batch: str):
    extra = ", max_points=1" if batch == "contacts_batch" else ""
    program = ASK_FOR_EVER.format(batch=batch, options=f"threads={threads}{extra}")
    child = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        assert child.stdout is not None
        assert child.stdout.readline() == "asking\n"
        child.send_signal(signal.SIGINT)
        output, errors = child.communicate(timeout=60)
    finally:
        child.kill()
    assert output == "interrupted\n", errors
    assert child.returncode == 7


@pytest.mark.parametrize("batch", [vx.collide_batch, vx.distance_batch])
def test_other_threads_run_during_a_batch(ball: vx.Model, cube: vx.Model, poses, batch):
    many = np.tile(poses[0], (100, 1, 1))
    thread = threading.Thread(target=lambda: batch(ball, cube, many, shell="a", threads=1))
    thread.start()
    ticks, start = 0, time.perf_counter()
    while thread.is_alive():
        time.sleep(0.0005)
        ticks += 1
    took = time.perf_counter() - start
    thread.join()
    # With the GIL held there would be one tick, or one every 50 ms.
    assert ticks > 60 * took


# ---- wrong input ---------------------------------------------------------------------------------


@pytest.mark.parametrize("batch", BATCHES)
@pytest.mark.parametrize("name", ["a_poses", "b_poses"])
def test_wrong_poses_are_refused_by_name_and_index(ball: vx.Model, batch, name: str):
    good = np.eye(4)
    scaled = np.diag([2.0, 2.0, 2.0, 1.0])
    hole = good.copy()
    hole[1, 3] = np.nan
    for wrong, message in [
        (np.eye(5), rf"{name} must be \(k, 4, 4\), .*one pose, not an array of shape \(5, 5\)"),
        (np.zeros((2, 4, 3)), r"of shape \(2, 4, 3\)"),
        (np.zeros((1, 2, 4, 4)), r"of shape \(1, 2, 4, 4\)"),
        (np.zeros(16), r"of shape \(16,\)"),
        (np.array(1.0), "not 1.0$"),
        ("poses", "not 'poses'$"),
        (np.eye(4, dtype=complex)[None], "complex"),
        (np.eye(4, dtype=bool), "bool"),
        ([good, np.eye(3)], rf"{name}\[1\] must be a \(4, 4\) matrix, .*of shape \(3, 3\)"),
        ([good, good, [[1], [2, 3]]], rf"{name}\[2\] must be"),
        ([good, scaled], rf"{name}\[1\]: .*orthonormal"),
        ([good] * 99 + [hole], rf"{name}\[99\]: .*finite"),
        (scaled, rf"{name}: .*orthonormal"),
    ]:
        with pytest.raises(vx.PoseError, match=message):
            batch(ball, vx.Plane(), **{name: wrong})


@pytest.mark.parametrize("batch", BATCHES)
def test_unequal_numbers_of_poses_are_refused(ball: vx.Model, batch):
    a, b = np.tile(np.eye(4), (3, 1, 1)), np.tile(np.eye(4), (4, 1, 1))
    with pytest.raises(vx.SettingsError, match=r"same number of poses.*3 and 4"):
        batch(ball, vx.Plane(), a, b)
    with pytest.raises(vx.SettingsError, match=r"same number of poses.*3 and 1"):
        batch(ball, vx.Plane(), a, b[:1])


@pytest.mark.parametrize("batch", BATCHES)
@pytest.mark.parametrize("threads", [0, -1, 1025, 1.5, "2"])
def test_a_wrong_number_of_threads_is_refused(ball: vx.Model, batch, threads):
    with pytest.raises(vx.SettingsError, match="threads"):
        batch(ball, vx.Plane(), threads=threads)
