"""Where outputs go: refused before the work, or written whole."""

from __future__ import annotations

import ast
import errno
import fcntl
import os
import signal
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.base.outputs import check_output_file, check_output_folder, filling, replacing
from voxshell.base.unfinished import sweep, unfinished_folder
from voxshell.errors import (
    FileAccessError,
    InputTypeError,
    MissingFileError,
    SettingsError,
    VoxshellError,
)
from voxshell.recording import BodyTrack, ContactTrack, Recording

FORBIDDEN = Path("/sys/kernel")
"""Where not even root may make a file."""
REFUSED = "(Permission denied|Read-only file system)"


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


@pytest.fixture
def umask():
    before = os.umask(0o027)
    yield
    os.umask(before)


def test_what_the_system_refuses_is_told_with_the_path_that_was_asked_for(tmp_path):
    with pytest.raises(FileAccessError, match=rf"^cannot write /sys/kernel/a\.html: {REFUSED}$"):
        check_output_file(FORBIDDEN / "a.html")
    with pytest.raises(FileAccessError, match=rf"^cannot write /sys/kernel/a/b: {REFUSED}$"):
        check_output_folder(FORBIDDEN / "a" / "b")
    (tmp_path / "round").symlink_to("round")
    for check in (check_output_file, check_output_folder):
        with pytest.raises(FileAccessError, match="round: Too many levels of symbolic links"):
            check(tmp_path / "round")


def test_a_full_disk_is_told_with_the_path_that_was_asked_for(tmp_path):
    with (
        pytest.raises(FileAccessError) as raised,
        filling(tmp_path / "out") as folder,
        replacing(folder / "a.txt") as temporary,
    ):
        raise OSError(28, "No space left on device", str(temporary))
    assert str(raised.value) == f"cannot write {tmp_path}/out/a.txt: No space left on device"
    assert list(tmp_path.iterdir()) == []


def test_errors_about_other_files_stay_as_they_are(tmp_path):
    with pytest.raises(FileNotFoundError, match="elsewhere"), replacing(tmp_path / "a"):
        Path("/elsewhere").read_text()


def test_a_file_takes_the_place_of_an_older_one(tmp_path, umask):
    path = tmp_path / "a.txt"
    path.write_text("older")
    with replacing(path) as temporary:
        temporary.write_text("newer")
        assert temporary.suffix == ".txt"
        assert path.read_text() == "older"
    assert path.read_text() == "newer"
    assert mode(path) == 0o640
    assert list(tmp_path.iterdir()) == [path]


def test_a_pipe_is_not_replaced(tmp_path):
    os.mkfifo(tmp_path / "pipe.vxs")
    (tmp_path / "link").symlink_to("pipe.vxs")
    for name in ("pipe.vxs", "link"):
        with (
            pytest.raises(SettingsError, match=f"{name} is not a regular file"),
            replacing(tmp_path / name),
        ):
            pytest.fail("the block is reached")
    assert (tmp_path / "pipe.vxs").is_fifo()
    model = vx.Model.from_mesh(trimesh.creation.box(), resolution=10)
    with pytest.raises(FileAccessError, match=r"pipe\.vxs: it is not a regular file"):
        model.save(tmp_path / "pipe.vxs")
    assert (tmp_path / "pipe.vxs").is_fifo()


def test_links_stay_and_what_they_lead_to_is_written(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "a").write_text("older")
    for name in ("a", "new"):
        (tmp_path / name).symlink_to(Path("there") / name)
        with replacing(tmp_path / name) as temporary:
            temporary.write_text("newer")
        assert (tmp_path / name).is_symlink()
        assert (tmp_path / "there" / name).read_text() == "newer"
    (tmp_path / "folder").symlink_to("made")
    with filling(tmp_path / "folder") as folder:
        (folder / "b").write_text("b")
    assert (tmp_path / "folder").is_symlink()
    (tmp_path / "made" / "c").symlink_to(tmp_path / "there" / "a")
    with filling(tmp_path / "folder") as folder:
        (folder / "c").write_text("c")
    assert (tmp_path / "made" / "c").is_symlink()
    assert (tmp_path / "there" / "a").read_text() == "c"


def test_a_new_folder_appears_with_its_files(tmp_path, umask):
    out = tmp_path / "a" / "b"
    with filling(out) as folder:
        (folder / "one").write_text("1")
        (folder / "two").write_text("2")
        assert not (tmp_path / "a").exists()
    assert sorted(path.name for path in out.iterdir()) == ["one", "two"]
    assert (mode(out), mode(out / "one")) == (0o750, 0o640)
    assert list(tmp_path.iterdir()) == [tmp_path / "a"]


def test_files_of_an_older_run_are_replaced_together(tmp_path):
    for name in ("one", "two", "mine"):
        (tmp_path / name).write_text("older")
    with filling(tmp_path) as folder:
        (folder / "one").write_text("newer")
        (folder / "two").write_text("newer")
        assert (tmp_path / "one").read_text() == "older"
    texts = {path.name: path.read_text() for path in tmp_path.iterdir()}
    assert texts == {"one": "newer", "two": "newer", "mine": "older"}


def test_a_name_that_is_taken_leaves_the_other_files_as_they_were(tmp_path):
    def fill() -> None:
        with filling(tmp_path) as folder:
            (folder / "one").write_text("1")
            (folder / "two").write_text("2")

    (tmp_path / "two").mkdir()
    with pytest.raises(SettingsError, match="two is a folder, and a file"):
        fill()
    assert [path.name for path in tmp_path.iterdir()] == ["two"]


def test_a_killed_writer_leaves_no_half_of_the_files(tmp_path):
    (tmp_path / "older").mkdir()
    (tmp_path / "older" / "one").write_text("older")
    code = """
import os, signal, sys
from pathlib import Path
from voxshell.base.outputs import filling
with filling(Path(sys.argv[1])) as folder:
    (folder / "one").write_text("newer")
    os.kill(os.getpid(), signal.SIGKILL)
"""
    for name in ("older", "new"):
        ended = subprocess.run([sys.executable, "-c", code, tmp_path / name])
        assert ended.returncode == -signal.SIGKILL
    assert not (tmp_path / "new").exists()
    assert [path.name for path in (tmp_path / "older").glob("[!.]*")] == ["one"]
    assert (tmp_path / "older" / "one").read_text() == "older"


def test_a_replay_is_refused_before_it_is_made(tmp_path, monkeypatch):
    from voxshell.viewer import replay

    monkeypatch.setattr(replay, "save_replay", lambda *_, **__: pytest.fail("it is made"))
    track = BodyTrack("flag", np.eye(3), np.array([[0, 1, 2]]), None, np.eye(4)[None])
    recording = Recording(0.01, (track,), ContactTrack.empty(1))
    for path, kind in [
        (tmp_path, SettingsError),
        (tmp_path / "missing" / "a.html", MissingFileError),
        (FORBIDDEN / "a.html", FileAccessError),
        ("", FileAccessError),
        ("a\0b", FileAccessError),
        (3.0, InputTypeError),
    ]:
        with pytest.raises(VoxshellError) as raised:
            recording.save_html(path)
        assert raised.type is kind
    assert list(tmp_path.iterdir()) == []


def test_of_two_writers_of_a_folder_the_second_is_refused(tmp_path):
    """They mixed old and new files."""
    (tmp_path / "one").write_text("older")
    code = """
import sys
from pathlib import Path
from voxshell.base.outputs import filling
with filling(Path(sys.argv[1])) as folder:
    (folder / "one").write_text("first")
    print("ready", flush=True)
    sys.stdin.readline()
"""
    command = [sys.executable, "-c", code, str(tmp_path)]
    first = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert first.stdout is not None
    assert first.stdout.readline() == "ready\n"
    second = pytest.raises(FileAccessError, match="another program is writing into it; wait")
    with second, filling(tmp_path):
        pytest.fail("nobody else may write now")
    first.communicate("\n")
    assert (tmp_path / "one").read_text() == "first"
    with filling(tmp_path) as folder:
        (folder / "one").write_text("second")
    assert (tmp_path / "one").read_text() == "second"
    assert [path.name for path in tmp_path.iterdir()] == ["one"]


def test_a_folder_that_somebody_makes_meanwhile_is_filled(tmp_path):
    """The rename failed, and all was lost."""
    target = tmp_path / "new"
    with filling(target) as outer:
        (outer / "one").write_text("outer")
        with filling(target) as inner:
            (inner / "one").write_text("inner")
            (inner / "two").write_text("inner")
    assert {path.name: path.read_text() for path in target.iterdir()} == {
        "one": "outer",
        "two": "inner",
    }


def test_a_killed_writer_of_a_new_folder_leaves_nothing_once_it_is_run_again(tmp_path):
    """Its temporary folder stayed for ever."""
    code = """
import os, signal, sys
from pathlib import Path
from voxshell.base.outputs import filling
with filling(Path(sys.argv[1])) as folder:
    (folder / "one").write_text("newer")
    if sys.argv[2] == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
"""
    for how in ("killed", "ended"):
        subprocess.run([sys.executable, "-c", code, tmp_path / "a" / "new", how])
    assert [str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*")] == [
        "a",
        "a/new",
        "a/new/one",
    ]


def test_what_a_living_writer_has_not_finished_is_left_to_it(tmp_path):
    with replacing(tmp_path / "a") as slow:
        slow.write_text("a")
        with replacing(tmp_path / "b") as quick:
            quick.write_text("b")
        with filling(tmp_path / "new") as folder:
            (folder / "c").write_text("c")
    texts = {path.name: path.read_text() for path in tmp_path.rglob("*") if path.is_file()}
    assert texts == {"a": "a", "b": "b", "c": "c"}


def test_what_others_name_alike_is_not_swept(tmp_path):
    names = [".unfinished-notes", ".unfinished-01234567-0123456789abcdef0", ".unfinished-x.txt"]
    for name in names:
        (tmp_path / name).mkdir()
        os.utime(tmp_path / name, (0, 0))
    with replacing(tmp_path / "a") as temporary:
        temporary.write_text("a")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*names, "a"])


WRITING = {"write_text", "write_bytes", "mkdir", "mkdtemp", "mkstemp", "rename", "replace", "savez"}
WRITERS = ("base/outputs.py", "base/unfinished.py")
ALLOWED = {
    ("model/cache.py", "mkdir"),  # which warns
    ("model/cache.py", "replace"),  # out of an unfinished folder
}


def test_nothing_else_writes_files():
    """A writer of its own would leave torn files, or litter."""
    package = Path(vx.__file__).parent
    found = set()
    for path in package.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
                continue
            is_method_of_path = node.func.attr != "replace" or len(node.args) == 1
            opens = node.func.attr == "open" and any(
                isinstance(each, ast.Constant) and set(str(each.value)) & set("wxa+")
                for each in node.args
            )
            if opens or (node.func.attr in WRITING and is_method_of_path):
                found.add((str(path.relative_to(package)), node.func.attr))
    found = {each for each in found if each[0] not in WRITERS}
    assert found == ALLOWED


def test_a_folder_that_another_program_sweeps_before_it_is_opened_is_made_again(
    tmp_path, monkeypatch
):
    """The writer failed; of processes that asked for one model, a second one built it."""
    really_open, swept = os.open, []

    def open_late(path, *args, **kwargs):
        if not swept:
            os.rmdir(path)
            swept.append(path)
        return really_open(path, *args, **kwargs)

    with monkeypatch.context() as patched:
        patched.setattr(os, "open", open_late)
        with unfinished_folder(tmp_path, tmp_path) as folder:
            assert folder.is_dir()
            assert folder not in swept
    assert len(swept) == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("failures", [1, 2])
def test_what_could_not_be_locked_is_not_swept_once_locks_work(tmp_path, monkeypatch, failures):
    """Its writer lives, but anybody could lock it: it was taken for that of a dead one."""
    really_lock, failed = fcntl.flock, []

    def lock(*arguments):
        if len(failed) < failures:
            failed.append(arguments)
            raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))
        return really_lock(*arguments)

    monkeypatch.setattr(fcntl, "flock", lock)
    with unfinished_folder(tmp_path, tmp_path) as folder:
        assert len(failed) == failures
        sweep(tmp_path)
        assert folder.is_dir()
    assert not list(tmp_path.iterdir())
