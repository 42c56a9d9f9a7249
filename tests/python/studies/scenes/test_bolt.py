from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from voxshell_studies.scenes.bolt import BoltSettings, make_bolt, make_nut, measure_turns


def test_fine_threads_keep_their_clearance_at_any_turn():
    thread = BoltSettings(length=0.018, voxel_size=0.0004)
    bolt, nut = thread.build_bolt(), thread.build_nut()
    for turns in np.linspace(0.7, 0.8, 8):
        apart = vx.distance(bolt, nut, None, thread.compute_fit(turns), shell="both").distance
        assert 0.00024 < apart < thread.compute_clearance() + 1e-5
    with pytest.raises(vx.SettingsError, match="sections"):
        BoltSettings(sections=3)


def test_clearance_across_the_flanks_is_that_of_the_meshes():
    thread = BoltSettings(length=0.018)
    rod = (thread.radius, thread.depth, thread.pitch)
    corners = (thread.segments, thread.sections)
    bolt = make_bolt(*rod, thread.length, thread.head, *corners)
    nut = make_nut(*rod, thread.height, thread.clearance, *corners)
    apart = bolt.min_gap(nut.transform(thread.compute_fit(0.77)[:3]), 0.001)
    # 0.4 mm along the radius are less across the flanks, which slope by 45 degrees.
    assert thread.compute_clearance() == pytest.approx(0.0004 / np.sqrt(2.0), rel=0.005)
    assert 0.96 * thread.compute_clearance() < apart < thread.compute_clearance()


def test_turns_are_those_of_the_pose():
    settings = BoltSettings()
    assert measure_turns(settings.compute_fit(3.25)) == pytest.approx(0.25)
    assert settings.compute_fit(3.25)[2, 3] == pytest.approx(3.25 * settings.pitch)
