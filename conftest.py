"""Tests build their models, whatever was built before, and leave nobody's cache fuller.

Tests that only use models share them within a run, in a cache of its own: each model is built once.
"""

import os
import shutil
import signal
import tempfile
from pathlib import Path

import pytest

USERS_OF_MODELS = ("robots", "scenes", "simulation", "studies")
"""Folders of tests/python whose tests share models. The others test building, files and caches."""

os.environ["VOXSHELL_CACHE_SIZE"] = "0"

# A run in the background ignores interrupts, and so would the programs that tests interrupt.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_configure(config: pytest.Config) -> None:
    """Makes the cache of this run, which xdist's workers inherit."""
    if not hasattr(config, "workerinput"):
        os.environ["VOXSHELL_CACHE_DIR"] = tempfile.mkdtemp(prefix="voxshell-tests-")


def pytest_unconfigure(config: pytest.Config) -> None:
    """Removes it."""
    if not hasattr(config, "workerinput"):
        shutil.rmtree(os.environ["VOXSHELL_CACHE_DIR"], ignore_errors=True)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Turns the cache on or off before fixtures build models."""
    tests = Path(__file__).parent / "tests" / "python"
    shares = (
        item.path.is_relative_to(tests) and item.path.relative_to(tests).parts[0] in USERS_OF_MODELS
    )
    os.environ["VOXSHELL_CACHE_SIZE"] = "2GB" if shares else "0"
