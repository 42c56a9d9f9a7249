"""The study of limits: what is planned, what settings choose, and what a run of a scene yields."""

from __future__ import annotations

import math

import pytest
from voxshell.errors import SettingsError
from voxshell_studies.limits import LimitsSettings, measure_scene, name_run, plan
from voxshell_studies.report.limits import LIMITS, TABLE
from voxshell_studies.reproduction import conclude, plan_studies, run_studies
from voxshell_studies.scenes.limits import SCENES

NAME = "Bullet's box of 0.1 m on a belt at 0.3 m/s"
MANY = "model ball rolls in a tube of 50 mm with 0.5 mm of clearance"


def test_plan_has_a_part_for_each_scene_and_rate():
    parts = plan(LimitsSettings(scenes=(NAME, MANY), rates=(200.0, 30.0), placements=2))
    assert [part.name for part in parts] == [
        name_run(SCENES[name], rate) for name in (NAME, MANY) for rate in (200.0, 30.0)
    ]
    assert [part.arguments["placements"] for part in parts] == [1, 1, 2, 2]


def test_all_scenes_have_names_of_their_own():
    parts = plan(LimitsSettings())
    assert len({part.name for part in parts}) == len(parts)
    assert len(parts) == sum(len(scene.rates) for scene in SCENES.values())


@pytest.mark.parametrize("wrong", [{"scenes": ("belt",)}, {"rates": (0.0,)}, {"placements": 0}])
def test_wrong_settings_are_refused(wrong):
    with pytest.raises(SettingsError, match=next(iter(wrong))):
        LimitsSettings(**wrong)


def test_a_run_has_a_value_for_each_placement():
    runs = measure_scene(NAME, 200.0, 1)["runs"]
    assert runs["placement"].tolist() == [0.0]
    assert math.isfinite(runs["value"][0])


def test_a_quick_run_of_one_scene_writes_its_table_and_is_not_repeated(tmp_path):
    settings = {"scenes": [NAME], "rates": [200.0, 30.0]}
    studies = plan_studies(
        (LIMITS,), tmp_path, quick=True, overrides={"limits": settings}, known=["limits"]
    )
    ran = []
    for _ in range(2):
        run_studies(studies, jobs=1, done=lambda part: ran.append(part.name))
    assert sorted(ran) == sorted(name_run(SCENES[NAME], rate) for rate in (200.0, 30.0))
    (row,) = conclude(studies[0]).rows
    assert row.verdict == "for information"
    assert f"| {NAME}: depth of a corner, mm | 0 |" in (tmp_path / "limits" / TABLE).read_text()
