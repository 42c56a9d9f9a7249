"""Robots and models that people share."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def pybullet_data() -> Path:
    """The folder of the files that the package pybullet brings, where it is installed."""
    spec = importlib.util.find_spec("pybullet_data")
    if spec is None or spec.origin is None:
        pytest.skip("needs the package pybullet")
    return Path(spec.origin).parent
