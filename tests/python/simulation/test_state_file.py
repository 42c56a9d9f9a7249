"""Files of states: damage and forged contents are typed errors."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import voxshell as vx


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Bodies in contact, a joint with a motor that follows another, and a pair apart."""
    world = make_world()
    world.step(100)
    assert len(world.contacts()) > 0
    return world.save_state().save(tmp_path_factory.mktemp("states") / "state.npz")


def make_world() -> vx.World:
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    box = world.add(vx.Box((0.1, 0.1, 0.1)), pose=(0, 0, 0.1))
    arm = world.add(vx.Box((0.1, 0.02, 0.02)), pose=(1, 0, 1))
    other = world.add(vx.Box((0.1, 0.02, 0.02)), pose=(2, 0, 1))
    first = world.add_joint(vx.HingeJoint(), None, arm)
    second = world.add_joint(vx.HingeJoint(), None, other)
    first.set_target_position(0.5, max_force=5.0)
    second.follow(first, max_force=5.0)
    world.set_collision(box, arm, False)
    return world


def change(path: Path, place: Path, table: str, at: object, value: float) -> None:
    with np.load(path) as arrays:
        kept = {name: arrays[name] for name in arrays.files}
    if at is None:
        kept[table] = kept[table][:, :-1]
    else:
        kept[table][at] = value
    np.savez(place, **kept)


@pytest.mark.parametrize(
    ("table", "at", "value", "message"),
    [
        ("whole", (0, 0), -1.0, "number of steps"),
        ("whole", (0, 0), 0.5, "number of steps"),
        ("whole", (0, 1), np.inf, "not finite"),
        ("bodies", (1, 0), 2.0, "a pose that is not rigid"),
        ("bodies", (1, slice(0, 3)), 0.0, "a pose that is not rigid"),
        ("bodies", (1, 20), np.nan, "not finite"),
        ("bodies", (1, 42), 9.0, "neither sleeps nor is awake"),
        ("bodies", (1, 42), 1.5, "must be an integer"),
        ("bodies", None, 0.0, "rows of"),
        ("joints", (0, 0), 7.0, "a motor of an unknown mode"),
        ("joints", (1, 4), 2.0, "it names body or joint 2 of 2"),
        ("apart", (0, 1), 4.0, "it names body or joint 4 of 4"),
        ("apart", (0, 0), -1.0, "it names body or joint -1 of 4"),
        ("manifolds", (0, 2), 1000.0, "fewer points than its manifolds"),
        ("manifolds", (0, 0), 17.0, "it names body or joint 17 of 4"),
        ("points", (0, 0), np.nan, "not finite"),
        ("contacts", (0, 1), 4.0, "it names body or joint 4 of 4"),
    ],
)
def test_forged_numbers_are_refused(path, tmp_path, table, at, value, message):
    forged = tmp_path / "forged.npz"
    change(path, forged, table, at, value)
    with pytest.raises(
        vx.StateError, match=f"cannot read the world state .*forged.npz: .*{message}"
    ):
        vx.WorldState.load(forged)


@pytest.mark.parametrize(
    "scene",
    [None, [], {}, {"settings": {}, "bodies": [3], "joints": []}, {"settings": [], "bodies": 1}],
)
def test_forged_scenes_are_refused(path, tmp_path, scene):
    with np.load(path) as arrays:
        kept = {name: arrays[name] for name in arrays.files}
    header = json.loads(kept["header"].tobytes()) | {"scene": scene}
    kept["header"] = np.frombuffer(json.dumps(header).encode(), dtype=np.uint8)
    np.savez(tmp_path / "forged.npz", **kept)
    with pytest.raises(vx.StateError, match="its scene has"):
        vx.WorldState.load(tmp_path / "forged.npz")


def test_a_scene_without_what_worlds_have_does_not_fit(path, tmp_path):
    with np.load(path) as arrays:
        kept = {name: arrays[name] for name in arrays.files}
    header = json.loads(kept["header"].tobytes())
    header["scene"]["bodies"] = [{} for _ in header["scene"]["bodies"]]
    kept["header"] = np.frombuffer(json.dumps(header).encode(), dtype=np.uint8)
    np.savez(tmp_path / "forged.npz", **kept)
    with pytest.raises(vx.SettingsError, match="has another name"):
        make_world().restore_state(vx.WorldState.load(tmp_path / "forged.npz"))


def test_a_file_with_other_counts_than_its_scene_does_not_fit(path, tmp_path):
    with np.load(path) as arrays:
        kept = {name: arrays[name] for name in arrays.files}
    kept["joints"] = kept["joints"][:0]
    np.savez(tmp_path / "forged.npz", **kept)
    state = vx.WorldState.load(tmp_path / "forged.npz")
    with pytest.raises(vx.SettingsError, match="other bodies or joints"):
        make_world().restore_state(state)


def test_every_damage_is_a_state_error(path, tmp_path):
    whole = path.read_bytes()
    random = np.random.default_rng(3)
    damaged = tmp_path / "damaged.npz"
    refused = 0
    for trial in range(200):
        content = bytearray(whole)
        if trial % 4 == 0:
            content = content[: random.integers(len(whole))]
        else:
            content[random.integers(len(whole))] ^= 1 << random.integers(8)
        damaged.write_bytes(content)
        try:
            vx.WorldState.load(damaged)
        except (vx.StateError, vx.MemoryLimitError):
            refused += 1
    assert refused > 120


def test_other_files_are_not_states(tmp_path):
    make_world().record().recording().save(tmp_path / "a.npz")
    with pytest.raises(vx.StateError, match="it is not a world state of voxshell"):
        vx.WorldState.load(tmp_path / "a.npz")
    with pytest.raises(vx.MissingFileError):
        vx.WorldState.load(tmp_path / "none.npz")


def test_a_world_that_diverged_is_not_written(tmp_path):
    world = vx.World(gravity=(0, 0, 0), solver="nncg")
    ball = world.add(vx.Sphere(1.0), mass=1e-3)
    world.save_state().save(tmp_path / "a.npz")
    ball.apply_torque((1e308, 0, 0))
    with pytest.raises(vx.SimulationError, match="no longer finite"):
        world.step(5)
    with pytest.raises(vx.SimulationError, match="had diverged when its state was saved"):
        world.save_state().save(tmp_path / "b.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["a.npz"]
