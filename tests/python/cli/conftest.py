"""Runs the command line inside the tests' process, which takes milliseconds."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import pytest
import trimesh
import voxshell as vx
from voxshell.cli import main


@dataclass(frozen=True)
class Ending:
    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        """All of standard output, which must be JSON without NaN or infinities."""

        def refuse(name: str) -> None:
            pytest.fail(f"{name} is no JSON")

        return json.loads(self.out, parse_constant=refuse)


@pytest.fixture
def voxshell(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("NO_COLOR", "1")

    def run(*arguments: object) -> Ending:
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            main([str(argument) for argument in arguments])
        code = ended.value.code
        assert isinstance(code, int)
        captured = capsys.readouterr()
        return Ending(code, captured.out, captured.err)

    return run


@pytest.fixture(scope="session")
def cone_path(tmp_path_factory):
    """A cone of 60 x 60 x 50 millimeters."""
    path = tmp_path_factory.mktemp("mesh") / "cone.stl"
    trimesh.creation.cone(radius=30, height=50).export(path)
    return path


@pytest.fixture(scope="session")
def cone_model_path(cone_path):
    path = cone_path.with_suffix(".vxs")
    vx.Model.from_mesh(cone_path, scale=0.001, voxel_size=0.002).save(path)
    return path
