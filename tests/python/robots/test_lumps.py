from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from voxshell.robots.lumps import find_lumps
from voxshell.robots.urdf.reading import read_urdf

URDF = """<robot name="arm">
  <link name="base"/><link name="mount"/><link name="plate"/><link name="arm"/><link name="tip"/>
  <joint name="a" type="fixed"><parent link="base"/><child link="mount"/><origin xyz="1 0 0"/></joint>
  <joint name="b" type="fixed"><parent link="mount"/><child link="plate"/><origin xyz="0 2 0" rpy="0 0 1.5"/></joint>
  <joint name="c" type="continuous"><parent link="plate"/><child link="arm"/><origin xyz="0 0 3"/></joint>
  <joint name="d" type="fixed"><parent link="arm"/><child link="tip"/><origin xyz="0 0 4"/></joint>
</robot>"""


def test_links_on_fixed_joints_are_one_body_in_the_frame_of_the_first(tmp_path: Path):
    path = tmp_path / "arm.urdf"
    path.write_text(URDF)
    lumps = find_lumps(read_urdf(path))
    assert lumps["base"] is lumps["mount"] is lumps["plate"]
    assert lumps["arm"] is lumps["tip"] is not lumps["base"]
    assert (lumps["plate"].first, lumps["tip"].first) == ("base", "arm")
    plate = lumps["base"].links["plate"]
    assert plate[:3, 3] == pytest.approx([1, 2, 0])
    assert plate[0, 0] == pytest.approx(np.cos(1.5))
    assert lumps["arm"].links["arm"].tolist() == np.eye(4).tolist()
    assert lumps["arm"].links["tip"][:3, 3].tolist() == [0, 0, 4]
