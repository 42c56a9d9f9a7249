from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from voxshell.model.mass_properties import MassProperties
from voxshell.robots.mjcf.inertias import as_inertial

INERTIAL = "<inertial pos='1 0 0' mass='2' diaginertia='1 2 3'/>"
BALL = "<geom size='0.1' mass='5'/>"


@pytest.fixture
def load(write):
    def load(content: str, compiler: str = ""):
        path = write(
            f"<compiler {compiler}/><worldbody><body><freejoint/>{content}</body></worldbody>"
        )
        return vx.load_mjcf(vx.World(gravity=(0, 0, 0)), path).bodies[0]

    return load


def moment_about_z(body: vx.Body) -> float:
    body.apply_torque_impulse((0, 0, 1))
    return 1 / body.angular_velocity[2]


def test_an_inertial_comes_before_geoms(load):
    assert load(INERTIAL + BALL).mass == 2.0
    assert load(BALL).mass == 5.0
    assert load(INERTIAL + BALL, "inertiafromgeom='true'").mass == 5.0
    with pytest.warns(vx.RobotWarning, match="1 link without a mass"):
        load(BALL, "inertiafromgeom='false'")


def test_tensors_have_two_forms_and_turn_with_their_frame(load):
    assert moment_about_z(load(INERTIAL + BALL)) == pytest.approx(3)
    full = "<inertial pos='0 0 0' mass='2' fullinertia='1 2 3 0.1 0 0'/>"
    assert moment_about_z(load(full + BALL)) == pytest.approx(3)
    turned = "<inertial pos='0 0 0' euler='90 0 0' mass='2' diaginertia='1 2 3'/>"
    assert moment_about_z(load(turned + BALL)) == pytest.approx(2)


def test_masses_and_moments_have_bounds(load):
    assert load(INERTIAL + BALL, "boundmass='7'").mass == 7.0
    assert moment_about_z(load(INERTIAL + BALL, "boundinertia='4'")) == pytest.approx(4)
    odd = "<inertial pos='0 0 0' mass='2' diaginertia='1 1 4'/>"
    assert moment_about_z(load(odd + BALL, "balanceinertia='true'")) == pytest.approx(2)
    assert load(INERTIAL + BALL, "settotalmass='9'").mass == pytest.approx(9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<inertial pos='0 0 0'/>", "<inertial> without mass"),
        ("<inertial pos='0 0 0' mass='-1'/>", "a mass of -1 kg"),
        ("<inertial pos='0 0 0' mass='1' fullinertia='1 2 3'/>", "6 finite numbers"),
    ],
)
def test_wrong_inertials_are_refused(load, text, message):
    with pytest.raises(vx.RobotError, match=message):
        load(text)


def test_an_inertia_that_no_body_has_counts_as_none():
    flat = MassProperties(1.0, np.zeros(3), np.diag([0.0, 1.0, 1.0]))
    inertial = as_inertial(flat)
    assert inertial is not None
    assert inertial.inertia is None
    assert as_inertial(MassProperties(0.0, np.zeros(3), np.eye(3))) is None
