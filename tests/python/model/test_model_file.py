from __future__ import annotations

import json
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from hostile_files import NAMES, hostile_files, read_table, sealed


@pytest.fixture(scope="module")
def part() -> vx.Model:
    """Small, and not convex."""
    bar = trimesh.creation.box(extents=(0.1, 0.02, 0.02))
    return vx.Model.from_mesh(bar, voxel_size=0.02, target_points=100, padding=0)


@pytest.fixture(scope="module")
def sound_file(part: vx.Model, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("sound") / "part.vxs"
    part.save(path)
    return path.read_bytes()


def assert_equal(a: vx.Model, b: vx.Model) -> None:
    for one, other in (
        (a.mesh.vertices, b.mesh.vertices),
        (a.mesh.faces, b.mesh.faces),
        (a.shell.points, b.shell.points),
        (a.shell.normals, b.shell.normals),
        (a.shell.areas, b.shell.areas),
        (a.bounds, b.bounds),
        (a.mass_properties().inertia, b.mass_properties().inertia),
    ):
        np.testing.assert_array_equal(one, other)
    assert a.field.shape == b.field.shape
    assert a.field.voxel_size == b.field.voxel_size
    assert a.shell.spacing == b.shell.spacing
    points = np.random.default_rng(1).uniform(2 * a.bounds[0], 2 * a.bounds[1], (1000, 3))
    np.testing.assert_array_equal(a.field.sample(points), b.field.sample(points))


def test_a_loaded_model_is_the_one_that_was_saved(ball, tmp_path):
    path = tmp_path / "ball.vxs"
    ball.save(path)
    loaded = vx.Model.load(path)
    assert_equal(ball, loaded)
    assert repr(loaded) == repr(ball)
    pose = np.eye(4)
    pose[:3, 3] = 0.05, 0.12, 0.0
    before, after = vx.contacts(ball, ball, b_pose=pose), vx.contacts(loaded, loaded, b_pose=pose)
    assert len(before) > 10
    np.testing.assert_array_equal(before.ids, after.ids)
    np.testing.assert_array_equal(before.depths, after.depths)


def test_a_file_keeps_its_model_after_the_model_is_gone(part, tmp_path):
    path = tmp_path / "part.vxs"
    part.save(path)
    points = vx.Model.load(path).shell.points
    np.testing.assert_array_equal(points, part.shell.points)


@pytest.mark.parametrize(
    "name", ["part.vxs", "näme with spaces.vxs", b"\xff\xfe.vxs", "a" * 200 + ".vxs"]
)
def test_files_may_have_any_name_before_the_suffix(part, tmp_path, name):
    path = os.path.join(os.fsencode(tmp_path), os.fsencode(name))
    part.save(os.fsdecode(path))
    assert_equal(part, vx.Model.load(path))
    assert os.listdir(os.fsencode(tmp_path)) == [os.fsencode(name)]


@pytest.mark.parametrize("name", ["part.stl", "PART.OBJ", "new.glb"])
def test_a_model_does_not_replace_a_mesh(part, tmp_path, name):
    path = tmp_path / name
    path.write_bytes(b"a mesh")
    with pytest.raises(vx.SettingsError, match=rf"ends in \.vxs, but '{name}' ends in"):
        part.save(path)
    assert path.read_bytes() == b"a mesh"


def test_the_same_model_gives_the_same_bytes(part, sound_file, tmp_path):
    path = tmp_path / "again.vxs"
    vx.Model.from_mesh(part.mesh, voxel_size=0.02, target_points=100, padding=0).save(path)
    assert path.read_bytes() == sound_file


def test_files_that_cannot_be_reached_are_errors(part, tmp_path):
    for path in (tmp_path / "missing.vxs", tmp_path, tmp_path / "no" / "folder.vxs"):
        with pytest.raises(vx.FileAccessError, match=str(path)):
            vx.Model.load(path)
    for path in (tmp_path, tmp_path / "no" / "folder.vxs"):
        with pytest.raises(vx.FileAccessError, match=str(path)):
            part.save(path)
    missing = tmp_path / "no" / "folder.vxs"
    with pytest.raises(vx.MissingFileError, match=f"the folder {missing.parent} does not exist"):
        part.save(missing)
    for path in ("", "a\0b"):
        with pytest.raises(vx.FileAccessError, match="must name a file"):
            vx.Model.load(path)
    for path in (None, 3, part):
        with pytest.raises(vx.InputTypeError, match="path"):
            vx.Model.load(path)  # pyright: ignore[reportArgumentType]
        with pytest.raises(vx.InputTypeError, match="path"):
            part.save(path)  # pyright: ignore[reportArgumentType]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_permission_is_an_error(part, tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(vx.FileAccessError, match="Permission denied"):
        part.save(tmp_path / "part.vxs")


def test_a_full_disk_is_an_error_and_leaves_the_file_before(tmp_path):
    script = """
        import resource, signal, sys
        import trimesh, voxshell as vx
        model = vx.Model.from_mesh(trimesh.creation.box(), resolution=4)
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
        try:
            model.save(sys.argv[1])
        except vx.FileAccessError as error:
            print(error)
    """
    path = tmp_path / "part.vxs"
    path.write_bytes(b"before")
    run = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script), str(path)],
        capture_output=True,
        text=True,
        check=True,
    )
    assert f"cannot write {path}" in run.stdout
    assert path.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [path]


def test_the_format_is_as_described(part, sound_file):
    """By the independent reader of the hostile files."""
    assert sound_file[:8] == b"\x89VXS\r\n\x1a\n"
    assert sealed(sound_file) == sound_file
    table = dict(zip(NAMES, read_table(sound_file), strict=True))
    for name, want in (
        ("vertices", part.mesh.vertices),
        ("triangles", part.mesh.faces),
        ("points", part.shell.points),
        ("normals", part.shell.normals),
        ("areas", part.shell.areas),
    ):
        section = table[name]
        assert section.offset % 64 == 0
        assert sound_file[section.offset : section.end] == want.tobytes()
    levels = [part.shell.tree.spheres(level) for level in range(1, part.shell.tree.levels + 1)]
    spheres = table["spheres"]
    assert sound_file[spheres.offset : spheres.end] == np.concatenate(levels).tobytes()


READER = """
    import json, resource, sys, time
    from pathlib import Path
    import voxshell as vx
    sound, folder = Path(sys.argv[1]), Path(sys.argv[2])
    vx.Model.load(sound)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    limit = used + (64 << 20)
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    results = {}
    for path in sorted(folder.iterdir()):
        start = time.perf_counter()
        try:
            vx.Model.load(path)
            outcome = "accepted"
        except vx.VoxshellError as error:
            outcome = type(error).__name__
            assert str(error).startswith(str(path)), error
        results[path.name] = (outcome, time.perf_counter() - start)
    vx.Model.load(sound)
    print(json.dumps(results))
"""


def read_in_child(sound: Path, folder: Path) -> dict[str, tuple[str, float]]:
    run = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(READER), str(sound), str(folder)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout)


def test_every_hostile_file_is_refused_under_a_memory_limit(sound_file, tmp_path):
    sound, folder = tmp_path / "sound.vxs", tmp_path / "hostile"
    sound.write_bytes(sound_file)
    folder.mkdir()
    what: dict[str, str] = {}
    for number, (reason, content) in enumerate(hostile_files(sound_file)):
        name = f"{number:04}"
        (folder / name).write_bytes(content)
        what[name] = reason
    assert len(what) > 300
    results = read_in_child(sound, folder)
    assert set(results) == set(what)
    print(len(what), "files, at most", max(seconds for _, seconds in results.values()), "s")
    wrong = {
        what[name]: result for name, (result, _) in results.items() if result != "ModelFileError"
    }
    assert wrong == {}


def test_a_file_with_more_than_there_is_memory_is_refused(sound_file, tmp_path):
    """Sparse on the disk, but it says of itself that it is as long as it is."""
    sound, folder = tmp_path / "sound.vxs", tmp_path / "huge"
    sound.write_bytes(sound_file)
    folder.mkdir()
    table = read_table(sound_file)
    for size in (2**30, 2**33):
        count = (size - table[1].offset) // table[1].item_size
        with (folder / str(size)).open("wb") as file:
            file.write(sound_file[:40] + size.to_bytes(8, "little") + sound_file[48:112])
            file.write(count.to_bytes(8, "little"))
            file.truncate(size)
    results = read_in_child(sound, folder)
    assert results[str(2**33)][0] == "MemoryLimitError"
    assert results[str(2**30)][0] in ("MemoryLimitError", "ModelFileError")


@pytest.mark.parametrize("section", ["samples", "planes", "exact triangles"])
def test_a_file_that_lies_about_its_field_crashes_nothing(sound_file, part, tmp_path, section):
    """Which is all that is promised: its contacts may be wrong."""
    entry = read_table(sound_file)[NAMES.index(section)]
    noise = np.random.default_rng(5)
    content = bytearray(sound_file)
    if section == "samples":
        content[entry.offset : entry.end] = noise.bytes(entry.end - entry.offset)
    else:
        content[entry.offset : entry.end] = bytes(entry.end - entry.offset)
    path = tmp_path / "lie.vxs"
    path.write_bytes(sealed(bytes(content)))
    try:
        lie = vx.Model.load(path)
    except vx.ModelFileError:
        return
    for _ in range(100):
        pose = trimesh.transformations.random_rotation_matrix(noise.random(3))
        pose[:3, 3] = noise.uniform(-0.05, 0.05, 3)
        for a, b in ((lie, part), (part, lie), (lie, lie)):
            assert np.isfinite(vx.contacts(a, b, pose).depths).all()
            vx.collide(a, b, pose)
            assert np.isfinite(vx.distance(a, b, pose).distance)


@pytest.mark.parametrize("name", ["part.txt", "part", "part.stl"])
def test_a_model_file_has_its_own_suffix(part, tmp_path, name):
    with pytest.raises(vx.SettingsError, match=r"ends in \.vxs, but .*; try 'part\.vxs'"):
        part.save(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_only_models_are_built_from_meshes():
    with pytest.raises(vx.InputTypeError, match=r"build a model with Model\.from_mesh\(mesh\)"):
        vx.Model()


def test_a_mesh_file_is_not_a_model_file_and_the_error_says_what_to_call(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    trimesh.creation.box((1.0, 1.0, 1.0)).export("box.STL", file_type="stl")
    with pytest.raises(
        vx.ModelFileError, match=r"not a model file: .*: Model.from_mesh\('box.STL'\)"
    ):
        vx.Model.load("box.STL")
