"""What clang-tidy has passed is known by content, wherever the checkout is."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest
import run_clang_tidy


@pytest.fixture
def key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Finds the key of a source of a checkout, whose header and command have the given content."""
    system = tmp_path / "usr/include/vector"
    system.parent.mkdir(parents=True)

    def find(folder: str, *, own="", others="", option="-O3", checks=(), settings=""):
        root = tmp_path / folder
        for file in (*run_clang_tidy.SETTINGS, "core/a.cpp", "core/a.h"):
            path = root / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text({"core/a.h": own, ".clang-tidy": settings}.get(file, ""))
        system.write_text(others)
        monkeypatch.setattr(run_clang_tidy, "ROOT", root)
        run_clang_tidy.digest_of.cache_clear()
        included = {"a.o": {root / "core/a.cpp", root / "core/a.h", system}}
        monkeypatch.setattr(run_clang_tidy, "included_by_object", lambda build: included)
        command = f"c++ -I{root}/core {option} -o a.o -c {root}/core/a.cpp"
        commands = {"core/a.cpp": {"command": command}}
        return run_clang_tidy.keys_by_source(root / "build", commands, list(checks))["core/a.cpp"]

    yield find
    run_clang_tidy.digest_of.cache_clear()


def test_a_checkout_elsewhere_has_the_same_key(key):
    assert key("one") == key("zoo/other")


@pytest.mark.parametrize(
    "change",
    [
        {"own": "int a;"},
        {"others": "int b;"},
        {"option": "-O1"},
        {"checks": ("--checks=-clang-analyzer-*",)},
        {"settings": "Checks: misc-*"},
    ],
    ids=str,
)
def test_what_changes_what_it_says_changes_the_key(key, change):
    assert key("one", **change) != key("one")


def test_what_nobody_asks_for_is_forgotten(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    passed = run_clang_tidy.find_passed()
    old = time.time() - 86_400 * (run_clang_tidy.KEPT_DAYS + 1)
    for name, when in (("old", old), ("new", time.time())):
        (passed / name).touch()
        os.utime(passed / name, (when, when))
    assert run_clang_tidy.find_passed() == passed
    assert [stamp.name for stamp in passed.iterdir()] == ["new"]
