from __future__ import annotations

import numpy as np
from voxshell_studies.cli.drop_table import explain
from voxshell_studies.drop import DropRun
from voxshell_studies.scenes.drop import METHODS


def make_run(key, lowest):
    columns = {name: np.zeros(len(lowest)) for name in DropRun.__annotations__}
    method = next(method for method in METHODS if method.key == key)
    return DropRun(**{**columns, "method": method, "lowest": np.array(lowest), "recording": None})  # pyright: ignore[reportArgumentType]


def test_bodies_that_left_the_ground_are_told():
    fine = make_run("vps-fine", [0.5, 0.0, -0.001])
    assert "fallen" not in explain([fine], 3)
    gimpact = make_run("gimpact", [0.5, -0.05, -0.3])
    assert explain([fine, gimpact], 3).splitlines()[-1] == (
        "fallen        GImpact is below the ground from step 3 on"
    )
