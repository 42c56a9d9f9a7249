"""Random damage at every entrance: meshes, robots, scenes, models, states, recordings, poses, arguments and the viewer.

Files are opened in a watched process (`tests/python/hostile`), which tells crashes, hangs and errors of
other libraries apart. The viewer must go on answering those who have its secret, and nobody else.
"""

from __future__ import annotations

import contextlib
import http.client
import resource
import socket
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

from soak.task import Check, Outcome, Task, Totals, UnavailableError
from soak.tasks import wrong_arguments

sys.path.append(str(Path(__file__).resolve().parents[3] / "tests/python"))

from hostile import mutations
from hostile.case import judge
from hostile.entrances import IN_PYTHON, ON_THE_COMMAND_LINE
from hostile.watched import STATED_SECONDS, Watched

ENTRANCES = (
    *(
        "mesh",
        "urdf",
        "arguments",
        "mesh",
        "scene",
        "model",
        "mesh",
        "viewer",
        "arguments",
        "poses",
    ),
    *(
        "mesh",
        "urdf",
        "arguments",
        "state",
        "scene",
        "model",
        "mesh",
        "viewer",
        "mjcf",
        "recording",
    ),
)
"""Of the cases, in turn."""

TOKEN = "a-secret"

Open = Callable[[np.random.Generator], tuple[str, float]]
"""Hands in one input; returns how it ended, and the seconds of processor time."""


def make_opener(entrance: str, watched: Watched) -> Open:
    def open_file(rng: np.random.Generator) -> tuple[str, float]:
        case = mutations.choose(entrance, rng)
        by_program = entrance in ON_THE_COMMAND_LINE and (
            entrance not in IN_PYTHON or bool(rng.integers(3) == 0)
        )
        with tempfile.TemporaryDirectory(prefix="hostile-") as folder:
            path = mutations.write_mutated(case, Path(folder), rng)
            ending = watched.open(entrance, path, by_program)
        wrong = judge(case, ending)
        assert not wrong, f"{case.id}, mutated: {wrong}"
        assert ending.seconds <= STATED_SECONDS, (
            f"{case.id}, mutated: took {ending.seconds:.1f} s of processor time"
        )
        return ending.kind, ending.seconds

    return open_file


def make_caller() -> Open:
    calls = wrong_arguments.list_calls()
    wants: dict[str, object] = {}
    for name, call in calls.items():
        if name not in wrong_arguments.WITHOUT_ANSWER:
            wants[name] = wrong_arguments.digest(call.function(**call.arguments))

    def call_one(rng: np.random.Generator) -> tuple[str, float]:
        name = str(rng.choice(list(calls)))
        before = resource.getrusage(resource.RUSAGE_SELF).ru_utime
        ended = wrong_arguments.run(name, calls[name], wants.get(name), rng)
        seconds = resource.getrusage(resource.RUSAGE_SELF).ru_utime - before
        return {"answered": "loaded"}.get(ended, ended), seconds

    return call_one


def make_client() -> Open:
    try:
        import viser
        from voxshell.viewer.server import silent_server
    except ImportError as error:
        raise UnavailableError(f"viser: {error}") from error
    opened = contextlib.ExitStack()
    server = opened.enter_context(silent_server(token=TOKEN))
    port = server.get_port()
    protocol = f"viser-v{viser.__version__}"

    def ask(path: str) -> int:
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20.0)
        with contextlib.closing(connection):
            connection.request("GET", path)
            return connection.getresponse().status

    def send(rng: np.random.Generator, stack: contextlib.ExitStack = opened) -> tuple[str, float]:
        path = f"/{TOKEN}/" if rng.integers(2) else "/"
        sent = mutations.make_request(path, port, protocol, rng)
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port)) as client:
            client.settimeout(0.05)
            client.sendall(sent)
            answer = client.recv(1000)
            if TOKEN.encode() not in sent:
                assert not answer.startswith((b"HTTP/1.1 200", b"HTTP/1.1 101")), (
                    f"without the secret {sent[:300]!r} is answered by {answer[:100]!r}"
                )
        assert ask(f"/{TOKEN}/") == 200, f"the viewer is gone after {sent[:300]!r}"
        assert ask("/") == 403, f"the viewer is open after {sent[:300]!r}"
        return "refused", 0.0

    return send


def prepare() -> Check:
    warnings.simplefilter("ignore")
    watched = Watched()
    openers: dict[str, Open] = {"arguments": make_caller(), "viewer": make_client()}
    for entrance in dict.fromkeys(ENTRANCES):
        openers.setdefault(entrance, make_opener(entrance, watched))

    def check(case: int) -> Outcome:
        rng = np.random.default_rng([case, 11])
        entrance = ENTRANCES[case % len(ENTRANCES)]
        ended, seconds = openers[entrance](rng)
        return Outcome(1, {entrance: 1, ended: 1}, {"seconds": seconds})

    return check


def describe(totals: Totals) -> str:
    entrances = ", ".join(
        f"{totals.tallies[name]:,.0f} {name}"
        for name in dict.fromkeys(ENTRANCES)
        if name in totals.tallies
    )
    refused = totals.tallies.get("refused", 0) / totals.count
    return f"{entrances}; {refused:.0%} refused; longest {totals.peaks['seconds']:.2f} s"


def doubt(totals: Totals) -> str:
    refused = totals.tallies.get("refused", 0) / totals.count
    return "" if totals.count < 500 or 0.3 <= refused <= 0.97 else f"{refused:.0%} were refused"


TASK = Task(
    promise="Hostile input is accepted or refused with one typed error, within two seconds",
    oracle="a monitored process, and the type and text of the error",
    unit="inputs",
    target=2_000,
    prepare=prepare,
    describe=describe,
    doubt=doubt,
    patience=120.0,
)
