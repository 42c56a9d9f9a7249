from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import cache_races
import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.model import cache as cache_module
from voxshell.model.cache import ModelCache, compute_key, open_cache
from voxshell.model.cache_place import find_folder, read_capacity


@pytest.fixture(autouse=True)
def nothing_in_memory(monkeypatch):
    """Nothing that other tests did, and every model is worth to be kept."""
    monkeypatch.setattr(cache_module, "WORTH_SECONDS", 0.0)
    cache_module._memory.clear()
    cache_module._warned.clear()


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    folder = tmp_path / "models"
    monkeypatch.setenv("VOXSHELL_CACHE_DIR", str(folder))
    monkeypatch.setenv("VOXSHELL_CACHE_SIZE", "1GB")
    return folder


def key_of(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def build_core(size=0.1):
    return vx.Model.from_mesh(
        trimesh.creation.box(extents=(size,) * 3), resolution=3, padding=0, cache=False
    )._core


@pytest.fixture(scope="module")
def core():
    return build_core()


class Builder:
    """Counts how often it is asked."""

    def __init__(self, core):
        self.core = core
        self.count = 0

    def __call__(self):
        self.count += 1
        return self.core


def files(folder: Path) -> list[str]:
    """Without the seals in the names of models."""
    return sorted(re.sub(r"-[0-9a-f]{16}(?=\.vxs)", "", name) for name in os.listdir(folder))


def path_of(folder: Path, key: str) -> Path:
    return next(folder.glob(f"{key}-*.vxs"))


def test_a_model_is_built_once_and_then_found(folder, core):
    build = Builder(core)
    found = [ModelCache(folder).fetch(key_of("a"), build) for _ in range(3)]
    assert build.count == 1
    for model in found:
        np.testing.assert_array_equal(model.shell.points, core.shell.points)
    ModelCache(folder).fetch(key_of("b"), build)
    assert build.count == 2
    assert files(folder) == sorted(key_of(name) + ".vxs" for name in "ab")


@pytest.mark.parametrize(
    ("name", "kept"),
    [("part.stl", "part.stl"), ("a/b c:ü-1.stl", "a_b_c_ü-1.stl"), ("é" * 80, "é" * 50), ("", "")],
)
def test_an_entry_has_the_name_of_its_mesh(folder, core, name, kept):
    build, cache = Builder(core), ModelCache(folder)
    for _ in range(2):
        cache.fetch(key_of("a"), build, name=name)
    cache.fetch(key_of("a"), build, name="the same under another name")
    assert build.count == 1
    (entry,) = cache.entries()
    assert (entry.name, entry.key) == (kept, key_of("a"))
    assert cache.clear() == 1


def test_a_mesh_is_named_by_its_file(tmp_path, folder, monkeypatch):
    monkeypatch.setattr("voxshell.model.cache.WORTH_SECONDS", 0.0)
    path = tmp_path / "bent pipe.stl"
    trimesh.creation.box().export(path)
    vx.Model.from_mesh(path, resolution=5)
    vx.Model.from_mesh(str(path), resolution=6)
    vx.Model.from_mesh(trimesh.load_mesh(path), resolution=7)
    vx.Model.from_mesh(trimesh.creation.box(), resolution=8)
    assert sorted(entry.name for entry in ModelCache(folder).entries()) == [
        "",
        *["bent_pipe.stl"] * 3,
    ]


@pytest.mark.parametrize("how", ["copied", "renamed"])
def test_a_sound_model_under_the_key_of_another_is_not_believed(folder, core, how):
    cache, other = ModelCache(folder), build_core(0.2)
    cache.fetch(key_of("a"), Builder(core))
    cache.fetch(key_of("b"), Builder(other))
    wrong = path_of(folder, key_of("b"))
    if how == "copied":
        path_of(folder, key_of("a")).write_bytes(wrong.read_bytes())
    else:
        path_of(folder, key_of("a")).unlink()
        wrong.rename(folder / wrong.name.replace(key_of("b"), key_of("a")))
    build = Builder(core)
    for _ in range(2):
        model = cache.fetch(key_of("a"), build)
        np.testing.assert_array_equal(model.shell.points, core.shell.points)
    assert build.count == 1


def test_from_mesh_finds_what_it_built(folder):
    stages: list[str] = []

    def build(**options):
        stages.clear()
        options = {"resolution": 12, "progress": lambda stage, _: stages.append(stage), **options}
        return vx.Model.from_mesh(trimesh.creation.icosphere(2), **options)

    first = build()
    assert stages
    again = build()
    assert not stages
    np.testing.assert_array_equal(first.shell.points, again.shell.points)
    assert repr(first) == repr(again)
    build(threads=1)  # which changes nothing
    assert not stages
    assert len(files(folder)) == 1
    for other in (
        {"resolution": 13},
        {"target_points": 100},
        {"point_spacing": 0.3},
        {"padding": 1.0},
        {"scale": 2.0},
        {"cache": False},
    ):
        build(**other)
        assert stages, other
    assert len(files(folder)) == 6


def test_keys_differ_wherever_models_may(monkeypatch):
    mesh = vx.Mesh(np.zeros((4, 3)), np.zeros((4, 3), np.uint32))
    keys = {compute_key(mesh, {"voxel_size": 0.1, "resolution": 0})}
    keys.add(compute_key(mesh, {"voxel_size": 0.2, "resolution": 0}))
    keys.add(compute_key(mesh, {"voxel_size": 0.0, "resolution": 1}))
    keys.add(compute_key(mesh, {"voxel_size": np.nextafter(0.1, 1), "resolution": 0}))
    moved = vx.Mesh(mesh.vertices + 1e-300, mesh.faces)
    keys.add(compute_key(moved, {"voxel_size": 0.1, "resolution": 0}))
    turned = vx.Mesh(mesh.vertices, mesh.faces + np.uint32(1))
    keys.add(compute_key(turned, {"voxel_size": 0.1, "resolution": 0}))
    fewer = vx.Mesh(mesh.vertices[:2], np.zeros((8, 3), np.uint32))  # the same bytes
    keys.add(compute_key(fewer, {"voxel_size": 0.1, "resolution": 0}))
    monkeypatch.setattr(cache_module, "_digest_of_code", lambda: b"another build")
    keys.add(compute_key(mesh, {"voxel_size": 0.1, "resolution": 0}))
    assert len(keys) == 8
    assert compute_key(vx.Mesh(np.empty((0, 3)), np.empty((0, 3), np.uint32)), {}) not in keys


def test_models_that_are_built_at_once_are_not_kept(folder, core, monkeypatch):
    monkeypatch.setattr(cache_module, "WORTH_SECONDS", 60.0)
    build = Builder(core)
    for _ in range(2):
        ModelCache(folder).fetch(key_of("a"), build)
    assert build.count == 2
    assert files(folder) == []


def test_what_cannot_be_built_is_not_kept(folder):
    def fail():
        raise vx.MeshError("broken")

    for _ in range(2):
        with pytest.raises(vx.MeshError, match="broken"):
            ModelCache(folder).fetch(key_of("a"), fail)
    assert files(folder) == []


@pytest.mark.parametrize(
    "damage", ["cut", "flipped", "empty", "text", "pipe", "open pipe", "folder"]
)
def test_a_damaged_model_is_built_again(folder, core, damage):
    build = Builder(core)
    cache = ModelCache(folder)
    cache.fetch(key_of("a"), build)
    path = path_of(folder, key_of("a"))
    whole = path.read_bytes()
    if damage == "folder":
        path.unlink()
        path.mkdir()
        with pytest.warns(vx.CacheWarning, match="directory"):
            cache.fetch(key_of("a"), build)
        assert build.count == 2
        return
    writer = None
    if "pipe" in damage:
        path.unlink()
        os.mkfifo(path)
        if damage == "open pipe":
            writer = os.open(path, os.O_RDWR)
    else:
        path.write_bytes(
            {
                "cut": whole[:-1000],
                "flipped": whole[:5000] + bytes([whole[5000] ^ 1]) + whole[5001:],
                "empty": b"",
                "text": b"hello",
            }[damage]
        )
    model = cache.fetch(key_of("a"), build)
    if writer is not None:
        os.close(writer)
    assert build.count == 2
    np.testing.assert_array_equal(model.shell.points, core.shell.points)
    assert path.read_bytes() == whole
    cache.fetch(key_of("a"), build)
    assert build.count == 2


def test_the_least_recently_used_go_first(folder, core):
    size = len(save_to_bytes(core))
    cache = ModelCache(folder, capacity=3 * size + size // 2)
    build = Builder(core)
    for name in "abc":
        cache.fetch(key_of(name), build)
        time.sleep(0.01)
    cache.fetch(key_of("a"), build)  # used again
    assert build.count == 3
    cache.fetch(key_of("d"), build)
    kept = {entry.key for entry in cache.entries()}
    assert kept == {key_of(name) for name in "acd"}
    assert cache.entries()[0].key == key_of("d")
    assert cache.entries()[-1].key == key_of("c")
    assert sum(entry.size for entry in cache.entries()) == 3 * size
    # One that does not fit at all is not kept, and works.
    small = ModelCache(folder, capacity=size - 1)
    small.fetch(key_of("e"), build)
    assert small.entries() == []


def save_to_bytes(core) -> bytes:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "model")
        core.save(os.fsencode(path))
        return path.read_bytes()


def test_a_size_of_zero_turns_the_cache_off(tmp_path, core):
    build = Builder(core)
    for _ in range(2):
        ModelCache(tmp_path / "models", capacity=0).fetch(key_of("a"), build)
    assert build.count == 2
    assert not (tmp_path / "models").exists()


def test_a_folder_that_cannot_be_made_leaves_models_in_memory_with_one_warning(tmp_path, core):
    (tmp_path / "file").write_text("no folder")
    cache = ModelCache(tmp_path / "file" / "models")
    build = Builder(core)
    with pytest.warns(vx.CacheWarning, match="kept in memory"):
        cache.fetch(key_of("a"), build)
    for _ in range(3):  # a second warning would be an error
        assert cache.fetch(key_of("a"), build) is core
    assert build.count == 1
    for number in range(cache_module.MOST_IN_MEMORY):
        cache.fetch(key_of(str(number)), build)
    assert build.count == 1 + cache_module.MOST_IN_MEMORY
    cache.fetch(key_of("a"), build)  # was the oldest
    assert build.count == 2 + cache_module.MOST_IN_MEMORY


def test_without_a_home_models_stay_in_memory(monkeypatch, core):
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)
    assert find_folder({}) is None
    cache = ModelCache(find_folder({}))
    build = Builder(core)
    with pytest.warns(vx.CacheWarning, match="no home directory"):
        cache.fetch(key_of("a"), build)
    cache.fetch(key_of("a"), build)
    assert build.count == 1
    assert cache.entries() == []


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_is_read_only_still_serves_what_it_has(folder, core):
    build = Builder(core)
    cache = ModelCache(folder)
    cache.fetch(key_of("a"), build)
    folder.chmod(0o500)
    cache.fetch(key_of("a"), build)
    assert build.count == 1
    with pytest.warns(vx.CacheWarning, match="Permission denied"):
        cache.fetch(key_of("b"), build)
    cache.fetch(key_of("b"), build)
    assert build.count == 2


def run(script: str, *arguments: object) -> str:
    result = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script), *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        env={**os.environ, "PYTHONPATH": str(Path(cache_races.__file__).parent)},
    )
    assert result.returncode == 0, result.stderr
    return result.stdout


PREPARE = """
    import json, os, random, resource, signal, sys, time, warnings
    from pathlib import Path
    import trimesh
    import voxshell as vx
    from voxshell.model import cache as cache_module
    from voxshell.model.cache import ModelCache
    from cache_races import kill_while_storing, race
    cache_module.WORTH_SECONDS = 0.0
    core = vx.Model.from_mesh(
        trimesh.creation.box(), resolution=3, padding=0, cache=False
    )._core
    folder = Path(sys.argv[1])
    cache = ModelCache(folder)
"""


def test_a_full_disk_leaves_models_in_memory_with_one_warning(folder):
    script = """
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
    builds = 0
    def build():
        global builds
        builds += 1
        return core
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for key in "aab":
            cache.fetch(64 * key, build)
    print(json.dumps([builds, [str(w.message) for w in caught]]))
    """
    builds, messages = json.loads(run(PREPARE + script, folder))
    assert builds == 2
    assert len(messages) == 1
    assert "File too large" in messages[0]
    assert files(folder) == []


def test_of_eight_processes_one_builds_and_all_get_it(folder):
    script = """
    builds, answers = race(cache, 64 * "a", core, 8, build_seconds=0.2)
    print(json.dumps([builds, len(answers), len(set(answers)), len(answers[0])]))
    """
    assert json.loads(run(PREPARE + script, folder)) == [1, 8, 1, 32]
    assert files(folder) == ["a" * 64 + ".vxs"]


class SweepBefore:
    """Sweeps a folder once, before a call of the system that has a given number, from 1."""

    def __init__(self, folder: Path, number: int):
        self.folder, self.number = folder, number
        self.calls = 0
        self.is_sweeping = False
        self.removed = False

    def __call__(self):
        if self.is_sweeping:
            return
        self.calls += 1
        if self.calls == self.number and self.folder.exists():
            self.is_sweeping = True
            before = os.listdir(self.folder)
            ModelCache(self.folder).sweep()
            self.removed = before != os.listdir(self.folder)
            self.is_sweeping = False


def test_a_sweep_before_any_call_of_a_builder_costs_no_second_build(folder, core):
    """Between making and opening its folder, a builder lost it to the sweep of a process that looked
    for the model: its model stayed in memory, and a second process built it again."""
    removed = number = calls = 0
    while number <= calls:
        number += 1
        sweep, build = SweepBefore(folder, number), Builder(core)
        with cache_races.before_each_call(sweep):
            ModelCache(folder).fetch(key_of("a"), build)
        ModelCache(folder).fetch(key_of("a"), build)
        assert build.count == 1, f"swept before call {number}"
        assert files(folder) == [key_of("a") + ".vxs"]
        ModelCache(folder).clear()
        calls, removed = sweep.calls, removed + sweep.removed
    assert number > 30
    assert removed > 0


def test_processes_that_are_held_up_between_calls_build_once(folder):
    script = """
    print(json.dumps([race(cache, f"{seed:064x}", core, 4, 0.0, seed)[0] for seed in range(5)]))
    """
    assert json.loads(run(PREPARE + script, folder)) == [1] * 5


def test_threads_of_one_process_build_once(folder, core):
    builder = Builder(core)

    def build():
        time.sleep(0.05)
        return builder()

    threads = [
        threading.Thread(target=lambda: ModelCache(folder).fetch(key_of("a"), build))
        for _ in range(6)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert builder.count == 1
    assert len(files(folder)) == 1


def test_what_builds_a_model_may_ask_for_the_same_one(folder, core):
    cache = ModelCache(folder)
    nested = Builder(core)

    def build():
        cache.fetch(key_of("a"), nested, pytest.fail)  # does not wait
        return slow()

    slow = Builder(core)
    cache.fetch(key_of("a"), build)
    assert (slow.count, nested.count) == (1, 1)
    assert files(folder) == [key_of("a") + ".vxs"]


def test_one_that_waits_may_be_stopped_and_need_not_wait_for_ever(folder, core, monkeypatch):
    cache = ModelCache(folder)
    with cache._locked(key_of("a"), lambda: None) as problem:
        assert problem is None

        def stop():
            raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            cache.fetch(key_of("a"), Builder(core), stop)
        monkeypatch.setattr(cache_module, "LONGEST_WAIT", 0.05)
        build = Builder(core)
        cache.fetch(key_of("a"), build)
        assert build.count == 1
    assert files(folder) == [key_of("a") + ".vxs"]


def test_killed_at_any_moment_nothing_torn_is_left(folder):
    script = """
    generator = random.Random(8)
    for series in range(40):
        kill_while_storing(cache, core, generator.uniform(0.0, 0.05), series)
    whole = 0
    for entry in cache.entries():
        vx.Model.load(cache._path(entry))
        whole += 1
    left = [name for name in os.listdir(folder) if not name.endswith(".vxs")]
    # What the dead were at can be done at once, and what they left goes away, also where nothing is built.
    cache.fetch(next(iter(cache.entries())).key, lambda: core)
    after = [name for name in os.listdir(folder) if not name.endswith(".vxs")]
    print(json.dumps([whole, len(left), len(after)]))
    """
    whole, left, after = json.loads(run(PREPARE + script, folder))
    print(f"{whole} whole models, {left} files left by the dead")
    assert whole > 20
    assert after == 0


def test_sweeping_leaves_what_is_held_not_ours_or_young_and_of_another_machine(folder, core):
    cache = ModelCache(folder)
    cache.fetch(key_of("a"), Builder(core))
    names = {
        "old": ".unfinished-00000000-0123456789abcdef",
        "young": ".unfinished-00000000-0123456789abcdee",
        "held": key_of("held") + ".lock",
        "free": key_of("free") + ".lock",
        "foreign": "notes.txt",
        "foreign lock": "other.lock",
    }
    for name in names.values():
        (folder / name).write_text("")
    with cache._locked(key_of("held"), lambda: None):
        for name, file in names.items():
            if name != "young":
                os.utime(folder / file, (0, 0))
        cache.sweep()
        kept = {"young", "held", "foreign", "foreign lock"}
        assert set(files(folder)) == {names[name] for name in kept} | {key_of("a") + ".vxs"}


def test_clearing_removes_models_alone(folder, core):
    cache = ModelCache(folder)
    assert cache.clear() == 0
    for name in "ab":
        cache.fetch(key_of(name), Builder(core))
    (folder / "notes.txt").write_text("mine")
    assert cache.clear() == 2
    assert files(folder) == ["notes.txt"]


def test_where_models_are_kept():
    assert find_folder({"VOXSHELL_CACHE_DIR": "/a/b", "XDG_CACHE_HOME": "/c"}) == Path("/a/b")
    assert find_folder({"XDG_CACHE_HOME": "/c"}) == Path("/c/voxshell/models")
    at_home = Path(os.path.expanduser("~"), ".cache", "voxshell", "models")
    assert find_folder({}) == at_home
    assert find_folder({"XDG_CACHE_HOME": "relative"}) == at_home
    folder = find_folder({"VOXSHELL_CACHE_DIR": "relative"})
    assert folder is not None
    assert folder.is_absolute()


SIZES = {
    "": 2 * 10**9,
    "0": 0,
    "123": 123,
    "1kB": 1000,
    "500 MB": 5 * 10**8,
    "1.5gb": 15 * 10**8,
    "2TB": 2 * 10**12,
    " 7b ": 7,
}


@pytest.mark.parametrize(("text", "size"), SIZES.items())
def test_sizes(text, size):
    assert read_capacity({"VOXSHELL_CACHE_SIZE": text}) == size


@pytest.mark.parametrize("text", ["big", "-1", "1 GiB", "1e9", "nan", "1,5GB", "9" * 400, "2G"])
def test_what_is_no_size_is_refused(folder, monkeypatch, text):
    monkeypatch.setenv("VOXSHELL_CACHE_SIZE", text)
    with pytest.raises(vx.SettingsError, match="VOXSHELL_CACHE_SIZE"):
        open_cache()
    with pytest.raises(vx.SettingsError, match="VOXSHELL_CACHE_SIZE"):
        vx.Model.from_mesh(trimesh.creation.box(), resolution=5)
