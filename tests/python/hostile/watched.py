"""A process that is warm, and forks for each file: a crash, a hang and a leak stay in the fork.

usage: python watched.py

Reads a request a line, JSON, and answers each with a line of JSON; ends when its input does.
"""

from __future__ import annotations

import contextlib
import faulthandler
import gc
import io
import json
import os
import resource
import select
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

CPU_SECONDS = 10  # of processor time, after which a fork is ended
WALL_SECONDS = 60.0  # after which it waits for something
MEMORY = 1 << 30  # bytes of address space on top of those of the warm process
FILE_SIZE = 256 << 20  # bytes that a file may be written long
STATED_SECONDS = 2.0
TEXT = 3000

PYTHON = Path(__file__).resolve().parents[1]


@dataclass
class Ending:
    """How the opening of a file ended.

    Attributes:
        kind: "loaded"; "refused", with a typed error; or "fault", with a text.
        text: The error, or what is wrong.
        seconds: Of processor time.
        memory: Bytes of the largest resident set on top of that of the warm process.
        warned: The warnings.
    """

    kind: str
    text: str = ""
    seconds: float = 0.0
    memory: int = 0
    warned: list[str] = field(default_factory=list)


# ---- in the fork -----------------------------------------------------------------------------------


def open_in_python(entrance: str, path: Path) -> Ending:
    import voxshell as vx

    from hostile.entrances import IN_PYTHON

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            IN_PYTHON[entrance](path)
            ending = Ending("loaded")
        except vx.VoxshellError as error:
            ending = Ending("refused", f"{type(error).__name__}: {error}")
    ending.warned = [f"{one.category.__name__}: {one.message}" for one in caught]
    return ending


def open_in_program(entrance: str, path: Path, shared: Path) -> Ending:
    from voxshell_program import main

    from hostile.entrances import list_arguments

    sys.argv = ["voxshell", *list_arguments(entrance, path, shared)]
    out, errors = io.StringIO(), io.StringIO()
    code: object = None
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
        try:
            main()
        except SystemExit as ended:
            code = ended.code
    said = errors.getvalue()
    if code in (0, None):
        return Ending("loaded", warned=said.splitlines())
    lines = [line for line in said.splitlines() if line.startswith("error: ")]
    if code in (1, 2) and len(lines) == 1 and "Traceback" not in said:
        return Ending("refused", said[said.index("error: ") :])
    return Ending("fault", f"exit code {code}, and says {said[-TEXT:]!r}")


def call(entrance: str, path: Path, shared: Path, program: bool) -> Ending:
    try:
        if program:
            return open_in_program(entrance, path, shared)
        return open_in_python(entrance, path)
    except BaseException as error:
        import traceback

        where = "".join(traceback.format_tb(error.__traceback__)[-4:])
        return Ending("fault", f"{type(error).__name__}: {str(error)[:TEXT]}\n{where}")


def limit() -> None:
    with open("/proc/self/statm") as file:
        used = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS))
    resource.setrlimit(resource.RLIMIT_FSIZE, (FILE_SIZE, FILE_SIZE))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


# ---- in the warm process ---------------------------------------------------------------------------


def fork(job: Callable[[], Ending], stderr: Path) -> Ending:
    """Runs a job within the limits."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        os.setsid()  # what it starts ends with it
        errors = os.open(stderr, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(errors, 1)
        os.dup2(errors, 2)
        faulthandler.enable()
        limit()
        ending = job()
        with open(writing, "w") as answer:
            json.dump(asdict(ending), answer)
        os._exit(0)
    os.close(writing)
    said, ends = b"", time.monotonic() + WALL_SECONDS
    with open(reading, "rb", buffering=0) as answer:
        while select.select([answer], [], [], max(0.0, ends - time.monotonic()))[0]:
            part = answer.read(1 << 16)
            if not part:
                break
            said += part
        else:
            os.kill(child, signal.SIGKILL)
    _, status, usage = os.wait4(child, 0)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    if os.WIFEXITED(status) and said:
        ending = Ending(**json.loads(said))
    else:
        ending = Ending("fault", describe_end(status) + stderr.read_text(errors="replace")[-TEXT:])
    ending.seconds = usage.ru_utime + usage.ru_stime
    ending.memory = max(0, usage.ru_maxrss - before) << 10
    return ending


def describe_end(status: int) -> str:
    if not os.WIFSIGNALED(status):
        return f"exit code {os.waitstatus_to_exitcode(status)} without an answer\n"
    name = signal.Signals(os.WTERMSIG(status)).name
    if name == "SIGKILL":
        return f"hangs: no end within {CPU_SECONDS} s of processor time or {WALL_SECONDS:g} s\n"
    return f"crash: {name}\n"


def warm_up(shared: Path) -> None:
    """Imports what openings import, and builds once."""
    import voxshell.cli
    from voxshell_program import main  # noqa: F401

    from hostile.entrances import ask, write_partner

    for name in (
        "lxml.etree",
        "collada",
        "networkx",
        "yourdfpy",
        "voxshell.robots",
        "scipy.spatial",
        "voxshell.cli.scene_report",
        "voxshell.scenes.scene_file",
        "voxshell.scenes.scene_world",
    ):
        with contextlib.suppress(ImportError):
            __import__(name)
    import voxshell as vx

    ask(vx.Model.load(write_partner(shared)))
    gc.collect()
    gc.freeze()


def serve() -> None:
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    os.environ.update(COLUMNS="80", NO_COLOR="1", VOXSHELL_CACHE_SIZE="0")
    with tempfile.TemporaryDirectory(prefix="voxshell-hostile-") as folder:
        shared = Path(folder)
        warm_up(shared)
        print(json.dumps({"ready": True}), file=answers, flush=True)
        for line in sys.stdin:
            request: dict[str, Any] = json.loads(line)
            path = Path(request["path"])
            ending = fork(
                lambda path=path, request=request: call(
                    request["entrance"], path, shared, request["program"]
                ),
                shared / "stderr",
            )
            print(json.dumps(asdict(ending)), file=answers, flush=True)


# ---- the other end ---------------------------------------------------------------------------------


class Watched:
    """The warm process, seen from the tests."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, __file__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(PYTHON), *sys.path])},
        )
        self._read()

    def _read(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        assert line, f"the watched process ended with {self._process.wait()}"
        return json.loads(line)

    def open(self, entrance: str, path: Path, program: bool = False) -> Ending:
        """Opens a file by an entrance, in Python or by the command line."""
        assert self._process.stdin is not None
        request = {"entrance": entrance, "path": str(path), "program": program}
        print(json.dumps(request), file=self._process.stdin, flush=True)
        return Ending(**self._read())

    def close(self) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()
        assert self._process.stdout is not None
        self._process.stdout.close()


if __name__ == "__main__":
    serve()
