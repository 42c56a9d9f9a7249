"""Everything that voxshell writes, while system calls on its files fail.

usage: LD_PRELOAD=failing_calls.so python write_faults.py

A process that has all libraries loaded forks a child for each attempt; in the child one system call fails,
or all from one on. `Host` is its other end.
"""

from __future__ import annotations

import ctypes
import errno
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

SOURCE = Path(__file__).with_name("failing_calls.cpp")
PATIENCE = 60.0  # seconds of an attempt
ERRORS = ("ENOSPC", "EDQUOT", "EIO", "EROFS", "EACCES", "ENOLCK")
SIGNALS = ("SIGKILL", "SIGTERM", "SIGINT")
LITTER = re.compile(r"\..+|.*\.(tmp|lock)|tmp.{8}")
"""Names of what is not complete, of locks, and of Python's temporary files."""


@dataclass(frozen=True)
class Fault:
    """What fails.

    Attributes:
        number: Of the first call that fails, from 1.
        error: The name of an error; or of a signal, which comes just before the call.
        lasts: Whether all later calls fail, too, that this error may come of.
        takes_half: Whether a write that fails takes half of its bytes first.
    """

    number: int
    error: str
    lasts: bool = False
    takes_half: bool = False

    @property
    def signal(self) -> int:
        """The signal; 0 for an error."""
        return getattr(signal, self.error) if self.error in SIGNALS else 0


@dataclass
class Ending:
    """How an attempt ended.

    Attributes:
        failed: How many calls failed; 0 where the writer made fewer calls.
        call: The name of the first of them.
        error: The type of what was raised, or "".
        text: What it says.
        is_typed: Whether it is an error of the system or of voxshell.
        code: The exit code of a command.
        errors: What it wrote to standard error.
        warned: How many warnings there were.
        signal: That ended the process, or 0.
        files: What the attempt left, by name; contents are digests, or "whole" or "torn".
        litter: What it left unfinished.
    """

    failed: int = 0
    call: str = ""
    error: str = ""
    text: str = ""
    is_typed: bool = True
    code: int | None = None
    errors: str = ""
    warned: int = 0
    signal: int = 0
    files: dict[str, str] = field(default_factory=dict)
    litter: list[str] = field(default_factory=list)


# ---- the writers ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Writer:
    """Something that writes below a folder.

    Attributes:
        write: Does; with variant 0 or 1 of what there is to write.
        set_up: Makes what must be there before.
        is_command: Whether it ends with an exit code.
        never_fails: Whether it goes on without what it cannot write, and warns.
    """

    write: Callable[[Path, int], object]
    set_up: Callable[[Path], object] = lambda folder: None
    is_command: bool = False
    never_fails: bool = False


def list_writers() -> dict[str, Writer]:
    """All of them; imports what they need, and builds what they write."""
    import numpy as np
    import toy_parts
    import trimesh
    import voxshell as vx
    from PIL import Image
    from voxshell.cli import main
    from voxshell.measuring import environment
    from voxshell.measuring.files import write_json
    from voxshell.model import cache as cache_module
    from voxshell.model.cache import ModelCache
    from voxshell.recording import BodyTrack, ContactTrack, Recording
    from voxshell_studies import convex_parts
    from voxshell_studies.part import Part, compute_part
    from voxshell_studies.peers import report as peers_report
    from voxshell_studies.peers.cases import QUICK
    from voxshell_studies.peers.comparison import Comparison
    from voxshell_studies.peers.protocol import PeerResult
    from voxshell_studies.report import paint
    from voxshell_studies.report.catalog import EXPERIMENTS
    from voxshell_studies.report.figures import open_figure
    from voxshell_studies.report.page import write_report
    from voxshell_studies.reproduction import Finding, conclude, plan_studies
    from voxshell_studies.settings import read_settings_file
    from voxshell_studies.store import Store

    cache_module.WORTH_SECONDS = 0.0
    # Two runs write the same, whatever is committed in between.
    environment._find_commit = lambda: "here"
    place = Path(tempfile.mkdtemp(prefix="voxshell-faults-"))
    models = [
        vx.Model.from_mesh(trimesh.creation.box(), resolution=n, padding=0, cache=False)
        for n in (3, 4)
    ]
    trimesh.creation.box().export(place / "box.stl")
    (place / "scene.toml").write_text(SCENE)
    (place / "tiny.toml").write_text(TINY)
    track = BodyTrack("flag", np.eye(3), np.array([[0, 1, 2]]), None, np.eye(4)[None])
    recording = Recording(0.01, (track,), ContactTrack.empty(1))
    sizes = (3, 4)
    parts = [Part("squares", toy_parts.squares, {"count": count}) for count in sizes]
    outcomes = [compute_part(part) for part in parts]
    hulls = [convex_parts.Parts((np.full((n, 3), n),), 1.0, "1") for n in sizes]
    pictures = [Image.effect_mandelbrot((n * 40, 200), (-2, -1, 1, 1), 50) for n in sizes]
    slope = [each for each in EXPERIMENTS if each.name == "slope"]
    study = plan_studies(
        slope,
        place,
        quick=True,
        overrides=read_settings_file(place / "tiny.toml"),
        known=[each.name for each in EXPERIMENTS],
    )[0]
    for part in study.parts:
        study.store.put(part, compute_part(part))
    finding = conclude(study)
    machine = environment.describe_environment()
    comparisons = [
        Comparison(
            QUICK, (), {}, "not asked", [PeerResult("coal", "coal", "skipped", str(n))], machine
        )
        for n in sizes
    ]

    def fetch(folder: Path, variant: int) -> None:
        cache = ModelCache(folder / "models")
        found = cache.fetch(f"{variant:064x}", lambda: models[variant]._core)
        assert found.shell.points.tobytes() == models[variant]._core.shell.points.tobytes()

    def fetch_parts(folder: Path, variant: int) -> None:
        os.environ.update(VOXSHELL_CACHE_DIR=str(folder / "models"), VOXSHELL_CACHE_SIZE="1GB")
        mesh = vx.Mesh(np.full((4, 3), float(variant)), np.zeros((4, 3), np.uint32))
        convex_parts.make_parts = lambda *_: hulls[variant]
        found = convex_parts.split(mesh, convex_parts.RECIPES["coacd"])
        assert np.array_equal(found.hulls[0], hulls[variant].hulls[0])

    def write_figure(folder: Path, variant: int) -> None:
        with open_figure(folder / "figures" / "figure.png", width=2, height=2) as figure:
            figure.subplots().plot([0, variant])

    def animate(folder: Path, variant: int) -> None:
        paint.save_picture(
            pictures[variant],
            folder / "animation.gif",
            save_all=True,
            append_images=pictures,
        )

    def run(*arguments: object) -> None:
        main([str(argument) for argument in arguments])

    def pickle(folder: Path, variant: int) -> None:
        tempfile.tempdir = str(folder)
        copy = vx.Model.__reduce__(models[variant])
        assert copy[0](*copy[1]).shell.points.tobytes() == models[variant].shell.points.tobytes()

    def copy_parts(folder: Path) -> None:
        shutil.copytree(study.folder / "data", folder / "out" / "slope" / "data")

    def copy_pictures(folder: Path) -> None:
        shutil.copytree(study.folder, folder / "slope")

    return {
        "Model.save": Writer(lambda folder, n: models[n].save(folder / "model.vxs")),
        "cache": Writer(fetch, never_fails=True),
        "cache of convex parts": Writer(fetch_parts, never_fails=True),
        "pickled model": Writer(pickle),
        "Recording.save_html": Writer(
            lambda folder, n: recording.save_html(folder / "page.html", title=f"page {n}")
        ),
        "JSON": Writer(lambda folder, n: write_json(folder / "a.json", [n] * 50_000)),
        "part": Writer(lambda folder, n: Store(folder / "data").put(parts[n], outcomes[n])),
        "figure": Writer(write_figure),
        "picture": Writer(lambda folder, n: paint.save_row([pictures[n]], folder / "row.png")),
        "animation": Writer(animate),
        "report": Writer(
            lambda folder, n: write_report(
                folder, [Finding(study, finding.rows, finding.pictures)], command=str(n)
            ),
            copy_pictures,
        ),
        "peers' report": Writer(
            lambda folder, n: peers_report.write_results(folder / "peers", comparisons[n], "")
        ),
        "voxshell build": Writer(
            lambda folder, n: run(
                *("build", place / "box.stl", "-o", folder / "box.vxs"),
                *("--resolution", sizes[n], "--padding", 0, "--json"),
            ),
            is_command=True,
        ),
        "voxshell simulate": Writer(
            lambda folder, n: run(
                "simulate", place / "scene.toml", "--out", folder / "new" / "out", "--json"
            ),
            is_command=True,
        ),
        "voxshell simulate drop": Writer(
            lambda folder, n: run(
                *("simulate", "drop", place / "box.stl", "--out", folder / "out"),
                *("--methods", "hull", "--steps", 5 + n, "--json"),
            ),
            is_command=True,
        ),
        "voxshell view --export": Writer(
            lambda folder, n: run(
                *("view", place / "box.stl", "--export", folder / "box.html"),
                *("--resolution", sizes[n], "--padding", 0),
            ),
            is_command=True,
        ),
        "voxshell reproduce": Writer(
            lambda folder, n: run(
                *("reproduce", "slope", "--quick", "--settings", place / "tiny.toml"),
                *("--jobs", 1, "--out", folder / "out", "--json"),
            ),
            copy_parts,
            is_command=True,
        ),
    }


TINY = """
[slope]
seconds = 0.05
settle_seconds = 0.05
frictions = [0.5]
halvings = 2
voxel_size = 0.02
"""
SCENE = """
[scene]
duration = 0.05
[bodies.ground]
shape = "plane"
[bodies.ball]
shape = "sphere"
radius = 0.1
mass = 0.2
position = [0, 0, 0.1]
[outputs]
replay = true
plot = true
poses = "csv"
contacts = "parquet"
"""


# ---- an attempt ----------------------------------------------------------------------------------


def attempt(writer: Writer, folder: Path, variant: int, fault: Fault | None) -> Ending:
    """Lets a forked process write, with a fault or without."""
    library = ctypes.CDLL(None)
    library.failing_calls_first.restype = ctypes.c_char_p
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        ending = Ending()
        signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            os.close(reading)
            errors, name = tempfile.mkstemp()
            os.unlink(name)
            os.dup2(errors, 2)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
            if fault is not None:
                library.failing_calls_arm(
                    os.fsencode(folder),
                    ctypes.c_long(fault.number),
                    getattr(errno, fault.error, 0),
                    fault.signal,
                    fault.lasts,
                    fault.takes_half,
                )
            with warnings.catch_warnings(record=True) as warned:
                warnings.simplefilter("always")
                try:
                    writer.write(folder, variant)
                except SystemExit as end:
                    ending.code = end.code if isinstance(end.code, int) else -1
                except BaseException as error:
                    ending.error, ending.text = type(error).__name__, str(error)
                    ending.is_typed = isinstance(error, OSError)
                    if not ending.is_typed:
                        ending.text += traceback.format_exc()
            library.failing_calls_disarm()
            ending.warned = len(warned)
            ending.failed = library.failing_calls_failed()
            ending.call = library.failing_calls_first().decode()
            sys.stderr.flush()
            ending.errors = os.pread(errors, 100_000, 0).decode()
            os.write(writing, json.dumps(asdict(ending)).encode())
        finally:
            os._exit(0)
    os.close(writing)
    kill_at = time.monotonic() + PATIENCE
    while (ended := os.waitpid(child, os.WNOHANG))[0] == 0:
        if time.monotonic() > kill_at:
            os.kill(child, signal.SIGKILL)
        time.sleep(0.0005)
    with open(reading, "rb") as pipe:
        said = pipe.read()
    ending = Ending(**json.loads(said)) if said else Ending()
    if os.WIFSIGNALED(ended[1]):
        ending.signal = os.WTERMSIG(ended[1])
        ending.failed, ending.call = 1, "?"
    ending.files, ending.litter = read_files(folder)
    return ending


def read_files(folder: Path) -> tuple[dict[str, str], list[str]]:
    """Digests of what is below a folder, and the names of what is not complete."""
    import hashlib

    files, litter = {}, []
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if any(LITTER.fullmatch(part) for part in path.relative_to(folder).parts):
            litter.append(name)
        elif path.is_file():
            files[name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return files, litter


def is_whole(path: Path) -> bool:
    """Whether a file whose content differs from run to run is complete."""
    content = path.read_bytes()
    try:
        match path.suffix:
            case ".json":
                json.loads(content)
            case ".html":
                return content.rstrip().endswith((b"</html>", b"</body>"))
            case ".md":
                return content.endswith(b"\n")
            case ".png":
                from PIL import Image

                Image.open(path).load()
            case ".parquet":
                from pyarrow import parquet

                parquet.read_table(path)
            case other:
                raise NotImplementedError(other)
    except (ValueError, OSError):
        return False
    return True


class Trial:
    """One writer in a folder, empty or with what the writer wrote there before.

    Args:
        writer: The writer.
        name: Its name.
        place: A folder for its attempts.
    """

    def __init__(self, writer: Writer, name: str, place: Path) -> None:
        self._writer, self._name, self._place = writer, name, place
        self._states: list[dict[str, str]] = []
        self._variable: set[str] = set()
        for variant in (0, 1):
            states = []
            for _ in range(2):
                folder = self._make_folder(over=False)
                ending = attempt(writer, folder, variant, None)
                shutil.rmtree(folder)
                assert not ending.error, f"{name}: {ending.error}: {ending.text}"
                assert not ending.code, f"{name}: {ending.errors}"
                assert not ending.litter, f"{name} leaves {ending.litter}"
                states.append(ending.files)
            self._variable |= {key for key in states[0] if states[0][key] != states[1].get(key)}
            self._states.append(states[0])

    def run(self, fault: Fault, *, over: bool) -> Ending:
        """An attempt with a fault, and one without after it.

        Raises:
            AssertionError: Something is torn, left or told wrongly.
        """
        folder = self._make_folder(over=over)
        before, _ = read_files(folder)
        try:
            ending = attempt(self._writer, folder, 1, fault)
            try:
                self._check(ending, fault, folder, before)
                again = attempt(self._writer, folder, 1, None)
                assert not again.error, f"the next run fails: {again.error}: {again.text}"
                assert not again.code, f"the next run fails: {again.errors}"
                assert not again.litter, f"the next run leaves {again.litter}"
                self._check_files(again, folder, before, must_be_new=True)
            except AssertionError as problem:
                raise AssertionError(
                    f"{self._name}{' over an older one' if over else ''}, {fault}, at {ending.call}: "
                    f"{problem}"
                ) from None
        finally:
            shutil.rmtree(folder)
        return ending

    def _make_folder(self, *, over: bool) -> Path:
        # A path that is as long in every attempt, and holds no name that tells of litter.
        folder = self._place / "work"
        folder.mkdir()
        self._writer.set_up(folder)
        if over:
            attempt(self._writer, folder, 0, None)
        return folder

    def _check(self, ending: Ending, fault: Fault, folder: Path, before: dict[str, str]) -> None:
        assert ending.signal in (0, fault.signal), f"ended by {signal.Signals(ending.signal).name}"
        failed = bool(ending.error or ending.code or ending.signal)
        self._check_files(ending, folder, before, must_be_new=not failed)
        if fault.signal:
            assert "Traceback" not in ending.errors, ending.errors
            assert ending.error in ("", "KeyboardInterrupt"), f"{ending.error}: {ending.text}"
            assert ending.code in (None, 0, 130), f"exit code {ending.code}: {ending.errors}"
            return
        reason = os.strerror(getattr(errno, fault.error))
        if failed:
            assert ending.failed > 0, f"fails without a fault: {ending.text}{ending.errors}"
            assert not self._writer.never_fails, f"raised {ending.error}: {ending.text}"
            assert fault.error != "ENOLCK", f"needs locks: {ending.text}{ending.errors}"
            said = self._find_message(ending)
            assert str(folder) in said, f"names no file: {said}"
            said = said.replace(str(folder), "")
            assert reason in said, f"gives no reason: {said}"
            assert not any(LITTER.fullmatch(part) for part in re.split(r"[/:'\" ]+", said)), said
        else:
            assert "Traceback" not in ending.errors, ending.errors
        # What cannot be removed stays until the next run.
        if not fault.lasts and ending.call not in ("unlink", "unlinkat", "rmdir", "openat"):
            assert not ending.litter, f"leaves {ending.litter}"

    def _find_message(self, ending: Ending) -> str:
        if not self._writer.is_command:
            assert ending.is_typed, f"raised {ending.error}: {ending.text}"
            return ending.text
        assert "Traceback" not in ending.errors, ending.errors
        assert ending.code == 1, f"exit code {ending.code}: {ending.errors} {ending.text}"
        lines = [line for line in ending.errors.splitlines() if line.startswith("error: ")]
        assert len(lines) == 1, f"{len(lines)} errors: {ending.errors}"
        assert ending.errors.splitlines()[-1] == lines[0], ending.errors
        return lines[0]

    def _check_files(
        self, ending: Ending, folder: Path, before: dict[str, str], *, must_be_new: bool
    ) -> None:
        wanted = self._states[1]
        if self._writer.never_fails and ending.warned:
            must_be_new = False
        for name in {*wanted, *before, *ending.files}:
            found = ending.files.get(name)
            if name in self._variable and found is not None:
                assert is_whole(folder / name), f"{name} is torn"
                continue
            allowed = {wanted.get(name, before.get(name))}
            if not must_be_new:
                allowed.add(before.get(name))
            assert found in allowed, f"{name} is {'missing' if found is None else 'torn, or old'}"


# ---- the process and its other end -------------------------------------------------------------


def serve() -> None:
    """Answers each line of a request with a line of what it found."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    os.environ.update(COLUMNS="100", NO_COLOR="1", VOXSHELL_CACHE_SIZE="0")
    writers = list_writers()
    place = Path(tempfile.mkdtemp(prefix="voxshell-faults-"))
    trials: dict[str, Trial] = {}
    print(json.dumps(list(writers)), file=answers, flush=True)
    for line in sys.stdin:
        request = json.loads(line)
        name = request["writer"]
        try:
            if name not in trials:
                trials[name] = Trial(writers[name], name, Path(tempfile.mkdtemp(dir=place)))
            ending = trials[name].run(Fault(**request["fault"]), over=request["over"])
            answer = {"failed": ending.failed, "call": ending.call}
        except AssertionError as problem:
            answer = {"problem": str(problem)}
        except Exception:
            answer = {"problem": traceback.format_exc()}
        print(json.dumps(answer), file=answers, flush=True)


class NoCompilerError(Exception):
    """There is no C++ compiler to build what lets calls fail."""


class Host:
    """Starts the process that writes.

    Raises:
        NoCompilerError: There is none.
    """

    def __init__(self, folder: Path) -> None:
        folder = folder / "faults"
        folder.mkdir()
        library = build_library(folder)
        self._process = subprocess.Popen(
            [sys.executable, __file__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "LD_PRELOAD": str(library), "TMPDIR": str(folder)},
        )
        self.writers: list[str] = json.loads(self._read())

    def run(self, writer: str, fault: Fault, *, over: bool) -> str:
        """Lets a writer meet a fault; returns the call that failed, or "" where it makes fewer.

        Raises:
            AssertionError: Something is torn, left or told wrongly.
        """
        assert self._process.stdin is not None
        request = {"writer": writer, "fault": asdict(fault), "over": over}
        print(json.dumps(request), file=self._process.stdin, flush=True)
        answer: dict[str, Any] = json.loads(self._read())
        assert "problem" not in answer, answer["problem"]
        return answer["call"] if answer["failed"] else ""

    def close(self) -> None:
        """Ends the process."""
        self._process.kill()
        self._process.communicate()

    def _read(self) -> str:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        assert line, "the process that writes has ended"
        return line


def build_library(folder: Path) -> Path:
    """Compiles what lets calls fail."""
    compiler = next(
        (
            found
            for name in (os.environ.get("CXX"), "c++", "g++", "clang++")
            if name and (found := shutil.which(name))
        ),
        None,
    )
    if compiler is None:
        raise NoCompilerError("there is no C++ compiler: set CXX, or install one")
    library = folder / "failing_calls.so"
    options = ["-std=c++20", "-O1", "-shared", "-fPIC", "-ldl"]
    subprocess.run([compiler, str(SOURCE), *options, "-o", str(library)], check=True)
    return library


if __name__ == "__main__":
    serve()
