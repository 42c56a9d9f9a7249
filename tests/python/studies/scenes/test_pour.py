from __future__ import annotations

import numpy as np
from voxshell_studies.scenes.pour import PourSettings


def test_lost_bodies_are_found():
    settings = PourSettings(count=4)
    poses = settings.compute_starts()
    assert not settings.find_lost(poses).any()
    poses[1, 0, 3] = 0.5 * settings.bin_size[0] + 0.01
    poses[2, 2, 3] = -0.01
    poses[3, 0, 0] = np.nan
    assert settings.find_lost(poses).tolist() == [False, True, True, True]
