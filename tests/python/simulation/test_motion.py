from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from voxshell.simulation.motion import (
    MOTIONS,
    as_mass_and_motion,
    check_surface,
    decide_mass_and_motion,
)


@pytest.mark.parametrize(
    ("mass", "motion", "found"),
    [
        (2.0, None, (2.0, "dynamic")),
        (0.0, None, (0.0, "static")),
        (2.0, "dynamic", (2.0, "dynamic")),
        (2.0, "static", (0.0, "static")),
        (2.0, "kinematic", (0.0, "kinematic")),
        (0.0, "kinematic", (0.0, "kinematic")),
    ],
)
def test_the_mass_decides_where_nobody_says(mass, motion, found):
    assert as_mass_and_motion(mass, motion) == found


def test_wrong_ones_are_told_with_the_right_ones():
    with pytest.raises(vx.SettingsError, match="'dynamic', 'static' or 'kinematic', not 'up'"):
        as_mass_and_motion(1.0, "up")  # type: ignore[arg-type]
    with pytest.raises(vx.SettingsError, match="a dynamic body needs a mass above 0"):
        as_mass_and_motion(0.0, "dynamic")
    with pytest.raises(vx.SettingsError, match="mass must be at least 0"):
        as_mass_and_motion(-1.0, None)


def test_surfaces_of_kinematic_bodies_move_under_the_right_solver():
    check_surface("kinematic", "'belt'", True)
    for motion in MOTIONS.keys() - {"kinematic"}:
        with pytest.raises(vx.SettingsError, match=f"'belt' is {motion}: pass motion='kinematic'"):
            check_surface(motion, "'belt'", True)
    with pytest.raises(vx.SettingsError, match="solver='coulomb' and friction_directions=2"):
        check_surface("kinematic", "'belt'", False)


def test_a_plane_is_static_by_default_and_others_have_the_mass_of_their_inertia():
    matter = vx.MassProperties(3.0, (0.0, 0.0, 0.0), np.eye(3))
    assert decide_mass_and_motion(vx.Plane(), None, "solid", None) == (0.0, "static")
    assert decide_mass_and_motion(vx.Sphere(1.0), None, "solid", None) == (1.0, "dynamic")
    assert decide_mass_and_motion(vx.Sphere(1.0), None, matter, None) == (3.0, "dynamic")
    assert decide_mass_and_motion(vx.Sphere(1.0), 2.0, matter, None) == (2.0, "dynamic")
    with pytest.raises(vx.SettingsError, match="leave out mass"):
        decide_mass_and_motion(vx.Plane(), 1.0, "solid", None)
