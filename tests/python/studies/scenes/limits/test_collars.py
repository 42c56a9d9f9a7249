"""Scenes of collars, at a rate at which they slide."""

from __future__ import annotations

import pytest
from voxshell_studies.scenes.limits import SCENES, collars


@pytest.mark.parametrize("scene", collars.SCENES, ids=lambda scene: scene.name)
def test_collars_slide_at_200_hz(scene):
    assert SCENES[scene.name] is scene
    assert scene.run(200.0, 0) == pytest.approx(scene.truth, abs=0.2)
