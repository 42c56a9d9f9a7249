from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from voxshell.scenes.bolt import BoltSettings


def test_fine_threads_keep_their_clearance_at_any_turn():
    thread = BoltSettings(sections=64, length=0.018, voxel_size=0.0004)
    bolt, nut = thread.build_bolt(), thread.build_nut()
    for turns in np.linspace(0.7, 0.8, 8):
        apart = vx.distance(bolt, nut, None, thread.compute_fit(turns), shell="both").distance
        # 0.4 mm along the radius are less across the flanks, which slope by 45 degrees.
        assert 0.00024 < apart < 0.0004 / np.sqrt(2.0) + 1e-5
    with pytest.raises(vx.SettingsError, match="sections"):
        BoltSettings(sections=3)
