"""`./dev soak`: what is found is counted, and what was counted is kept."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import fast_paths
import numpy as np
import pytest
import toy_soak
import voxshell as vx
from soak import __main__ as program
from soak import page, runner
from soak.__main__ import main, parse
from soak.ledger import DamagedFileError, Ledger, Record, digest
from soak.task import Totals, UnavailableError
from soak.tasks import (
    TASKS,
    field_values,
    fuzzing,
    random_worlds,
    tree_poses,
    write_faults,
    wrong_arguments,
)
from soak.worker import CaseError, Worker

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(autouse=True)
def importable(monkeypatch: pytest.MonkeyPatch):
    """By workers, as ./dev soak has it."""
    monkeypatch.setenv("PYTHONPATH", f"{ROOT}/tools:{ROOT}/tests/python/support")


@pytest.fixture
def ledger(tmp_path: Path) -> Ledger:
    return Ledger(tmp_path, tmp_path / "committed.json")


def run(
    ledger: Ledger, *names: str, seconds: float = 30.0, jobs: int = 1, **changes: float
) -> dict[str, Record]:
    tasks = {name: replace(toy_soak.TASKS[name], **changes) for name in names}
    runner.run("toy_soak", tasks, ledger, seconds, lambda *_: None, jobs)
    return {name: ledger.load(name, task) for name, task in tasks.items()}


def test_cases_are_counted_until_the_target_is_met(ledger: Ledger):
    record = run(ledger, "sound")["sound"]
    assert record.totals == Totals(10, {"sum": 0 + 1 + 2 + 3 + 4}, {"largest": 4})
    assert record.next_case == 5
    assert record.found == 0
    assert re.fullmatch(r"[0-9a-f]{12}(-dirty)?", record.commit)


def test_the_next_run_goes_on_where_the_last_one_ended(ledger: Ledger):
    run(ledger, "sound")
    record = run(ledger, "sound", target=20)["sound"]
    assert record.totals.count == 20
    assert record.totals.tallies["sum"] == sum(range(10))


def test_several_jobs_share_the_cases_of_a_task(ledger: Ledger):
    # The workers of a task that hangs for two seconds leave time for others to start.
    records = run(ledger, "hanging", "sound", jobs=3, target=200)
    sound = records["sound"]
    assert sound.found == 0
    assert sound.totals.tallies["sum"] == sum(range(sound.next_case))
    assert records["hanging"].found == 1


def test_cases_of_one_process_run_one_at_a_time(ledger: Ledger):
    record = run(ledger, "exclusive", jobs=4, seconds=3.0, alone=True)["exclusive"]
    assert record.found == 0
    assert record.totals.count > 0


def test_a_changed_task_begins_again(ledger: Ledger):
    record = run(ledger, "sound")["sound"]
    ledger.save("sound", replace(record, code="of another source"))
    assert ledger.load("sound", toy_soak.TASKS["sound"]).totals.count == 0


def test_other_code_begins_again(ledger: Ledger):
    run(ledger, "sound")
    task = toy_soak.TASKS["sound"]
    assert ledger.load("sound", task).totals.count == 10
    assert ledger.load("sound", replace(task, sources=("README.md",))).totals.count == 0


def test_sources_that_a_promise_is_not_about_leave_its_counter():
    sources = {name: task.sources for name, task in TASKS.items()}
    assert "bullet" in sources["random_worlds"]
    assert "python" in sources["wrong_arguments"]
    for about_queries in ("tree_poses", "swept_motions", "field_values", "fuzz_parsing"):
        assert "core" in sources[about_queries]
        assert not {"bullet", "python"} & set(sources[about_queries])
    assert all((ROOT / path).exists() for paths in sources.values() for path in paths)


def test_another_machine_goes_on_from_what_was_committed(tmp_path: Path):
    committed = tmp_path / "evidence.json"
    here = Ledger(tmp_path / "here", committed)
    here.commit(run(here, "sound", "wrong"))
    assert "Traceback" not in committed.read_text()
    assert str(ROOT) not in committed.read_text()
    there = run(Ledger(tmp_path / "there", committed), "sound", "wrong", target=20)
    assert there["sound"].totals.tallies["sum"] == sum(range(10))
    assert there["wrong"].faults[0]["case"] == 3
    # What this machine counted since then is more.
    assert (
        Ledger(tmp_path / "there", committed).load("sound", toy_soak.TASKS["sound"])
        == there["sound"]
    )


def test_counters_of_older_code_stay_on_the_page_with_a_mark(ledger: Ledger):
    record = run(ledger, "sound")["sound"]
    task = replace(toy_soak.TASKS["sound"], sources=("README.md",))
    assert ledger.load_latest("sound", task) == record
    assert "10 cases **older** | 10 |" in page.render({"sound": task}, {"sound": record})
    assert "10 cases | 10 |" in page.render({"sound": toy_soak.TASKS["sound"]}, {"sound": record})
    newer = run(ledger, "sound", sources=("README.md",), target=2)["sound"]
    assert ledger.load_latest("sound", task) == newer


@pytest.mark.parametrize("content", ["", "{", "5", '{"sound": {"totals": 3}}'])
@pytest.mark.parametrize("is_committed", [True, False])
def test_a_damaged_file_is_named(ledger: Ledger, content: str, is_committed: bool):
    path = ledger.committed if is_committed else ledger.folder / "sound.json"
    path.write_text(content)
    with pytest.raises(DamagedFileError, match=rf"{path} holds no counters .*; delete it"):
        ledger.load("sound", toy_soak.TASKS["sound"])


@pytest.mark.parametrize(
    ("name", "case", "text"),
    [
        ("wrong", 3, "case three is wrong"),
        ("deadly", 1, "SIGSEGV"),
        ("hanging", 0, "no answer within 2 s"),
    ],
)
def test_a_planted_fault_is_found_with_its_case(ledger: Ledger, name: str, case: int, text: str):
    record = run(ledger, name)[name]
    assert record.found == 1
    assert record.faults[0]["case"] == case
    assert text in record.faults[0]["what"]
    assert record.totals.count == 10, "the others run all the same"
    assert text in page.render({name: toy_soak.TASKS[name]}, {name: record})


def test_a_task_that_cannot_run_says_so_and_the_others_run(ledger: Ledger):
    records = run(ledger, "missing", "sound")
    assert records["missing"].unavailable == "no such tool"
    assert records["sound"].totals.count == 10
    tasks = {name: toy_soak.TASKS[name] for name in records}
    rows = [line for line in page.render(tasks, records).splitlines() if " holds |" in line]
    # Short ones first.
    assert "0 cases **short** | 10 | 0 | not run: no such tool" in rows[0]
    assert "10 cases | 10 | 0 | 10 cases" in rows[1]


@pytest.mark.parametrize("is_committed", [True, False])
def test_a_task_that_cannot_run_keeps_figures_of_older_code(ledger: Ledger, is_committed: bool):
    """A counter of zero replaced them, in the file and on the page."""
    older = replace(run(ledger, "sound")["sound"], code="of another source")
    if is_committed:
        ledger.commit({"missing": older})
    else:
        ledger.save("missing", older)
    assert run(ledger, "missing")["missing"].totals.count == 0
    tasks = {"missing": toy_soak.TASKS["missing"]}
    assert ledger.load_latest("missing", tasks["missing"]) == older
    text = page.render(tasks, {"missing": ledger.load_latest("missing", tasks["missing"])})
    assert "| 10 cases **older** | 10 | 0 | 10 cases |" in text


def test_a_task_that_cannot_run_any_more_keeps_its_figures_and_their_date(ledger: Ledger):
    task = replace(toy_soak.TASKS["missing"], target=20)
    figures = Record(
        digest(task), 5, Totals(10), seconds=3.0, commit="abc", last="2026-01-02 03:04"
    )
    ledger.save("missing", figures)
    record = run(ledger, "missing", target=20)["missing"]
    assert record == replace(figures, unavailable="no such tool")
    text = page.render({"missing": task}, {"missing": record})
    assert "| 10 cases **short** | 20 | 0 | 10 cases |" in text
    assert "2026-01-02 03:04 | `abc`" in text


def test_a_run_without_a_whole_case_keeps_older_figures(ledger: Ledger):
    """As when it is interrupted."""
    older = replace(run(ledger, "sound")["sound"], code="of another source")
    ledger.save("sound", older)
    ledger.save("sound", Record("of this source", next_case=1))
    assert ledger.load_latest("sound", toy_soak.TASKS["sound"]) == older


def test_a_run_says_what_it_lacks(
    ledger: Ledger, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(program, "REGISTRY", "toy_soak")
    monkeypatch.setattr(
        program, "TASKS", {name: toy_soak.TASKS[name] for name in ("missing", "sound")}
    )
    monkeypatch.setattr(program, "Ledger", lambda: ledger)
    assert main(["--minutes", "0.2", "--jobs", "1"]) == 0
    lines = capsys.readouterr().err.splitlines()
    assert lines == ["missing was not run, and its figures stay what they were: no such tool"]


@pytest.mark.parametrize(
    ("prepare", "module", "name", "missing", "remedy"),
    [
        (fuzzing.PARSING.prepare, fuzzing, "ROOT", Path("/nowhere"), "run ./dev fuzz 1"),
        (field_values.prepare, field_values, "load_library", None, "run ./dev soak"),
    ],
)
def test_a_task_that_cannot_run_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
    prepare: Callable[[], object],
    module: object,
    name: str,
    missing: object,
    remedy: str,
):
    def lack(*_: object) -> None:
        raise vx.MissingExtraError("no such module")

    monkeypatch.setattr(module, name, missing or lack)
    with pytest.raises(UnavailableError, match=remedy):
        prepare()


def test_a_task_that_cannot_be_prepared_is_one_finding(ledger: Ledger):
    record = run(ledger, "broken")["broken"]
    assert record.found == 1
    assert "no such file" in record.faults[0]["what"]
    assert record.unavailable == "cannot be prepared"


def test_a_run_that_is_killed_loses_at_most_a_turn(tmp_path: Path):
    program = f"""
import sys
from pathlib import Path
from dataclasses import replace
import toy_soak
from soak import runner
from soak.ledger import Ledger
tasks = {{"sound": replace(toy_soak.TASKS["sound"], target=1e9)}}
report = lambda name, record: print(record.next_case, flush=True)
runner.run("toy_soak", tasks, Ledger(Path({str(tmp_path)!r})), 2.0, report)
"""
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        cases = int(process.stdout.readline())
        process.kill()
    assert ledger_cases(tmp_path) >= cases > 0


def ledger_cases(folder: Path) -> int:
    return Ledger(folder).load("sound", toy_soak.TASKS["sound"]).next_case


def test_an_interrupt_keeps_what_was_counted_and_ends_the_workers(tmp_path: Path):
    program = f"""
from pathlib import Path
import soak.__main__ as program
import toy_soak
from dataclasses import replace
from soak.ledger import Ledger
program.TASKS = {{"sound": replace(toy_soak.TASKS["sound"], target=1e9)}}
program.REGISTRY = "toy_soak"
program.Ledger = lambda: Ledger(Path({str(tmp_path)!r}))
raise SystemExit(program.main(["--minutes", "5"]))
"""
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert "counting" in process.stdout.readline()
        time.sleep(3.0)
        process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "rerun the command to resume" in said
    assert ledger_cases(tmp_path) > 0
    assert not (Path("/proc") / str(process.pid)).exists()


@pytest.mark.parametrize("name", TASKS)
def test_every_task_runs_a_case(name: str):
    worker = Worker("soak.tasks", name, patience=120.0)
    try:
        outcome = worker.run(0)
    except CaseError as error:
        pytest.fail(str(error))
    except Exception as lack:
        pytest.skip(str(lack))
    finally:
        worker.close()
    totals = Totals()
    totals.add(outcome)
    assert name == "memory" or totals.count > 0
    assert TASKS[name].describe(totals) or name == "memory"


# ---- the oracles find what is planted --------------------------------------------------------------


def test_a_contact_that_a_query_misses_is_found(monkeypatch: pytest.MonkeyPatch):
    real = vx.contacts
    check = tree_poses.prepare()
    check(10)
    monkeypatch.setattr(
        fast_paths.vx, "contacts", lambda *args, **more: real(*args, **{**more, "max_points": 1})
    )
    with pytest.raises(AssertionError):
        check(10)


def test_an_untyped_error_is_found():
    def divide(number: object) -> float:
        return 1.0 / (0.0 if isinstance(number, str) else 2.0)

    call = wrong_arguments.Call(divide, {"number": 2.0})
    texts: list[str] = []
    for seed in range(20):
        try:
            wrong_arguments.run("divide", call, "0.5", np.random.default_rng(seed))
        except AssertionError as error:
            texts.append(str(error))
    assert any("untyped ZeroDivisionError" in text for text in texts)
    assert any(text.endswith("which is wrong: taken") for text in texts)


def test_energy_out_of_nothing_is_found(monkeypatch: pytest.MonkeyPatch):
    step = vx.World.step

    def push(world: vx.World, steps: int = 1) -> None:
        step(world, steps)
        for body in world.bodies:
            if body.motion == "dynamic":
                body.linear_velocity = 3.0 * body.linear_velocity + 1.0

    check = random_worlds.prepare()
    monkeypatch.setattr(vx.World, "step", push)
    gains = 0
    for case in range(10):
        try:
            check(case)
        except AssertionError as error:
            gains += "gains" in str(error)
    assert gains > 0


@pytest.mark.parametrize("count", [16, 17, 18])
def test_every_writer_meets_every_kind_of_fault(count: int):
    """Kinds came at random: of the first cases none met a full disk, a bad one, or one without locks."""
    writers = [str(number) for number in range(count)]
    met = {write_faults.choose(case, writers) for case in range(9 * count)}
    assert len(met) == 9 * count
    assert len({write_faults.choose(case, writers)[1] for case in range(9)}) == 9


def test_a_kind_of_fault_that_never_came_is_doubted():
    from write_faults import ERRORS, SIGNALS

    tallies = dict.fromkeys((*ERRORS, *SIGNALS), 200.0)
    task = TASKS["write_faults"]
    assert task.doubt(Totals(1800, tallies)) == ""
    assert "ENOLCK" in task.doubt(Totals(1600, {**tallies, "ENOLCK": 0.0}))


# ---- the command line ------------------------------------------------------------------------------


def test_help_names_every_task(capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    said = capsys.readouterr().out
    assert all(name in said for name in TASKS)


def test_a_case_needs_one_task(capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit):
        parse(["--case", "3"])
    assert "--only" in capsys.readouterr().err


def test_the_page_has_a_row_for_every_task():
    text = (ROOT / "docs/evidence.md").read_text()
    for name, task in TASKS.items():
        assert task.promise in text, name
        assert f"| {name} |" in text
