from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import pytest
from voxshell.errors import SettingsError
from voxshell_studies.report.catalog import EXPERIMENTS
from voxshell_studies.reproduction import plan_studies
from voxshell_studies.settings import override, read_settings_file


@dataclass(frozen=True)
class Fall:
    height: float = 1.0
    steps: int = 10
    rates: tuple[float, ...] = (1.0,)
    ground: Literal["plane", "box"] = "plane"
    sleeping: bool = False
    level: int | None = None

    def __post_init__(self) -> None:
        if self.height <= 0.0:
            raise SettingsError(f"height must be above 0, not {self.height:g}")


def test_every_kind_of_field_can_be_overridden():
    table = {
        "height": 2,
        "steps": 3,
        "rates": [5, 10.5],
        "ground": "box",
        "sleeping": True,
        "level": 4,
    }
    assert override(Fall(), table, "fall") == Fall(2.0, 3, (5.0, 10.5), "box", True, 4)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"hight": 1.0}, "fall.hight: unknown setting; valid settings: height, steps"),
        ({"height": "high"}, "fall.height must be a number, not 'high'"),
        ({"height": True}, "fall.height must be a number, not True"),
        ({"steps": 1.5}, "fall.steps must be an integer, not 1.5"),
        ({"rates": 5.0}, "fall.rates must be a list, not 5.0"),
        ({"rates": [5.0, "x"]}, r"fall.rates\[1\] must be a number, not 'x'"),
        ({"ground": "ice"}, "fall.ground must be 'plane' or 'box', not 'ice'"),
        ({"sleeping": 1}, "fall.sleeping must be true or false, not 1"),
        ({"height": -1.0}, "fall.height must be above 0, not -1"),
    ],
)
def test_wrong_settings_name_the_key(table, message):
    with pytest.raises(SettingsError, match=message):
        override(Fall(), table, "fall")


def test_file_is_tables(tmp_path):
    path = tmp_path / "settings.toml"
    path.write_text("[ball]\nphases = 3\n")
    assert read_settings_file(path) == {"ball": {"phases": 3}}
    path.write_text("phases = 3\n")
    with pytest.raises(SettingsError, match="phases = 3 stands outside a table"):
        read_settings_file(path)
    path.write_text("[ball\n")
    with pytest.raises(SettingsError, match=r"settings\.toml: not valid TOML"):
        read_settings_file(path)


def test_unknown_tables_are_errors(tmp_path):
    with pytest.raises(SettingsError, match=r"\[bal\] is an unknown table; valid tables: "):
        plan_studies(
            EXPERIMENTS,
            tmp_path,
            quick=True,
            overrides={"bal": {}},
            known=[each.name for each in EXPERIMENTS],
        )


@pytest.mark.parametrize("experiment", EXPERIMENTS, ids=lambda each: each.name)
def test_parts_have_names_of_their_own(experiment):
    for settings in (experiment.settings, experiment.quick):
        parts = experiment.plan(settings)
        assert parts
        names = [part.name for part in parts]
        assert len(set(names)) == len(names)
        assert len({part.address for part in parts}) == len(parts)
        assert experiment.describe(settings)
