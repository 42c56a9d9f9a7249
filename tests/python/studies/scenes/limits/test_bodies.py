"""Bodies of the scenes of limits enclose what they should."""

from __future__ import annotations

import math

import numpy as np
import pytest
from voxshell.simulation.body_shapes import compute_mass_properties
from voxshell.simulation.comparison_shapes import GImpact
from voxshell_studies.scenes.limits import bodies


def volume(form) -> float:
    corners = form.mesh.vertices[form.mesh.faces]
    products = np.einsum("ni,ni->n", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return float(products.sum()) / 6.0


@pytest.mark.parametrize("phase", [0.0, 0.4])
def test_a_half_pipe_is_a_block_with_half_a_circle_cut_out(phase):
    pipe = bodies.half_pipe(0.06, 1.0, 48.0, phase)
    assert volume(pipe) == pytest.approx(0.18 * 0.09 - 0.5 * math.pi * 0.06**2, rel=0.02)


def test_waves_rise_and_fall_along_x():
    ground = bodies.waves(0.02, 0.5, 1.0, 0.025)
    at_crest = np.abs(ground.vertices[:, 0] - 0.125) < 1e-9
    assert ground.vertices[at_crest, 2].max() == pytest.approx(0.02)
    assert volume(ground) == pytest.approx(0.3 * 1.3 * 0.1, rel=0.1)


def test_rings_and_bowls_are_closed():
    channel = bodies.round_channel(0.1, 0.01, 120)
    assert volume(channel) > 0.0
    bowl = bodies.faceted_bowl(0.2, 48)
    properties = compute_mass_properties(GImpact(bowl.mesh), 1.0, "solid")
    assert properties.center_of_mass[2] < -0.05
    assert bowl.vertices[:, 2].max() == pytest.approx(0.0, abs=1e-9)
