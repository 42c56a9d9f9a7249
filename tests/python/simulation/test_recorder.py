from __future__ import annotations

import gc
import subprocess
import sys
import textwrap
import weakref
from pathlib import Path

import numpy as np
import pytest
import voxshell as vx


def test_recording_holds_what_the_world_did():
    world = vx.World()
    world.add(vx.Plane(), mass=0, name="ground")
    start = np.eye(4)
    start[2, 3] = 0.3
    ball = world.add(vx.Sphere(0.1), pose=start, name="ball")
    recorder = world.record(every=5)
    poses = [ball.pose]
    for _ in range(40):
        world.step(5)
        poses.append(ball.pose)
    recording = recorder.recording()
    assert [body.name for body in recording.bodies] == ["ground", "ball"]
    assert recording.time_step == pytest.approx(5 / 200)
    np.testing.assert_array_equal(recording.bodies[1].poses, poses)
    assert recording.contacts.counts[0] == 0
    assert recording.contacts.counts[-1] == len(world.contacts()) == 1
    np.testing.assert_allclose(recording.contacts.frame(40).points[0, 2], 0.0, atol=1e-3)
    np.testing.assert_allclose(recording.contacts.frame(40).forces, [[0, 0, 9.81]], rtol=1e-3)


def test_bodies_of_one_name_are_told_apart():
    world = vx.World()
    for _ in range(2):
        world.add(vx.Sphere(0.1), name="ball")
    names = [body.name for body in world.record().recording().bodies]
    assert names == ["ball (0)", "ball (1)"]


def test_a_recorded_world_is_freed_without_a_collection():
    gc.disable()
    try:
        world = vx.World()
        world.add(vx.Sphere(0.1))
        recorder = world.record()
        world.step(3)
        gone = weakref.ref(world), weakref.ref(recorder)
        del world
        assert gone[0]() is None
        assert recorder.recording().frame_count == 4  # it outlives its world
        del recorder
        assert gone[1]() is None
    finally:
        gc.enable()


def test_a_world_without_bodies_has_nothing_to_record():
    with pytest.raises(vx.RecordingError):
        vx.World().record().recording()


@pytest.mark.parametrize("first", [0, 1])
def test_bodies_added_later_are_recorded_from_the_next_frame_on(first: int):
    world = vx.World()
    for _ in range(first):
        world.add(vx.Sphere(0.1), name="first")
    recorder = world.record(every=2)
    world.step(3)
    late = world.add(vx.Sphere(0.2), pose=(1, 0, 0), name="late")
    poses = []
    for _ in range(3):
        world.step(1 if not poses else 2)
        poses.append(late.pose)
    recording = recorder.recording()
    assert [body.name for body in recording.bodies] == ["first"] * first + ["late"]
    track = recording.bodies[-1]
    assert (track.start, recording.frame_count) == (2, 5)
    np.testing.assert_array_equal(track.poses, [poses[0]] * 2 + poses)
    assert [body.start for body in recording.bodies[:-1]] == [0] * first
    assert repr(recorder) == f"Recorder(frames=5, bodies={1 + first}, time_step=0.01 s)"


def test_forces_on_bodies_added_later_are_those_on_the_moving_body():
    world = vx.World()
    recorder = world.record()
    world.add(vx.Sphere(0.1), mass=2.0, pose=(0, 0, 0.1))
    world.add(vx.Plane(), mass=0)
    world.step(400)
    forces = recorder.recording().contacts.frame(400).forces
    np.testing.assert_allclose(forces, [[0, 0, 2 * 9.81]], rtol=1e-3)


def test_removed_bodies_stay_at_their_last_pose():
    world = vx.World()
    ball = world.add(vx.Sphere(0.1))
    recorder = world.record()
    world.step(3)
    last = ball.pose
    world.remove(ball)
    world.step(2)
    np.testing.assert_array_equal(recorder.recording().bodies[0].poses[3:], [last] * 3)


def test_a_recorder_says_how_much_it_holds():
    world = vx.World()
    world.add(vx.Sphere(0.1), name="ball")
    recorder = world.record(every=2)
    world.step(4)
    assert repr(recorder) == "Recorder(frames=3, bodies=1, time_step=0.01 s)"


@pytest.mark.parametrize("kind", ["html", "video", "gltf", "usd"])
def test_a_recorder_saves_what_its_recording_saves(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    asked: list[tuple[vx.Recording, object, dict[str, object]]] = []

    def note(recording: vx.Recording, path: Path, **options: object) -> Path:
        asked.append((recording, path, options))
        return path

    monkeypatch.setattr(vx.Recording, f"save_{kind}", note)
    world = vx.World()
    ball = world.add(vx.Sphere(0.1))
    recorder = world.record()
    world.step(2)
    path = tmp_path / "fall"
    assert getattr(recorder, f"save_{kind}")(path, colors={ball: (1, 2, 3)}, up="+y") == path
    ((recording, place, options),) = asked
    assert (recording.frame_count, place, options) == (3, path, {"up": "+y"})
    assert recording.bodies[0].color == (1, 2, 3)


def test_a_stopped_recorder_takes_no_more_frames():
    world = vx.World()
    world.add(vx.Sphere(0.1))
    with world.record() as first:
        second = world.record()
        world.step(3)
        assert not first.stopped
    world.step(2)
    second.stop()
    second.stop()
    world.step(2)
    assert first.stopped
    assert second.stopped
    assert first.recording().frame_count == 4
    assert second.recording().frame_count == 6
    assert repr(second) == "Recorder(frames=6, bodies=1, time_step=0.005 s, stopped)"


def test_a_recorder_that_is_dropped_records_no_more():
    world = vx.World()
    world.add(vx.Sphere(0.1))
    kept = [world.record()]
    dropped = weakref.ref(kept[0])
    world.step(1)
    # It is dropped within a run of steps, too.
    world.step(5, lambda _: kept.clear())
    assert dropped() is None
    assert not world._recorders


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc and sets RLIMIT_AS")
def test_a_recorder_that_runs_out_of_memory_raises():
    """nanobind ended the process where it found no memory for the array of a pose."""
    program = """
        import os, resource
        import voxshell as vx

        world = vx.World(threads=1)
        world.add(vx.Plane(), mass=0)
        for number in range(3):
            world.add(vx.Sphere(0.1), pose=(number, 0, 0.1))
        recorder = world.record()
        world.step(5)
        with open("/proc/self/statm") as sizes:
            pages = int(sizes.read().split()[0])
        endings = set()
        for kilobytes in range(0, 8000, 400):
            child = os.fork()
            if child == 0:
                most = pages * os.sysconf("SC_PAGE_SIZE") + 1024 * kilobytes
                resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
                resource.setrlimit(resource.RLIMIT_AS, (most, most))
                try:
                    while True:
                        world.step(1000)
                except vx.MemoryLimitError:
                    os._exit(42)
            endings.add(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
        print(endings)
    """
    ended = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(program)],
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert (ended.stdout, ended.stderr) == ("{42}\n", "")
