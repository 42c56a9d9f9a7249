from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from voxshell.robots.mjcf.model_file import ModelFile, read_model
from voxshell.robots.xml_elements import Element


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo appends its warnings to MUJOCO_LOG.TXT in the working folder."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    """Writes a model of the given content, and returns its path."""

    def write(*content: str, name: str = "model.xml") -> Path:
        path = tmp_path / name
        path.write_text(f'<mujoco model="tester">{"".join(content)}</mujoco>')
        return path

    return write


@pytest.fixture
def read(write) -> Callable[..., ModelFile]:
    """Writes a model of the given content, and reads its elements."""
    return lambda *content: read_model(write(*content))


@pytest.fixture
def element(read) -> Callable[[str], Element]:
    """Writes and reads one element."""
    return lambda text: read(text).root.children[0]
