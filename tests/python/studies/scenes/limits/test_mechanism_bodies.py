"""Parts of mechanisms fit each other with their play, and no better."""

from __future__ import annotations

import math

import pytest
import voxshell as vx
from voxshell_studies.everyday.worlds import build_model
from voxshell_studies.scenes.everyday.scene import X, Z, shift, turn
from voxshell_studies.scenes.limits import mechanism_bodies as parts

PLAY = 0.0003


def collide(a, b, a_pose=None, b_pose=None) -> bool:
    return vx.collide(build_model(a), build_model(b), a_pose, b_pose)


@pytest.mark.parametrize("angle", [0.0, 0.5, 2.0])
def test_a_pin_turns_in_its_yoke(angle):
    at = turn(Z, angle)
    x = parts.CRANK * math.cos(angle)
    for off, touches in ((0.0, False), (0.4, False), (0.7, True)):
        yoke = shift(x + off * PLAY, 0.0, 0.0)
        assert collide(parts.crank(), parts.yoke(PLAY), at, yoke) is touches


def test_a_geneva_driver_holds_its_wheel_and_enters_a_slot():
    driver, wheel = parts.geneva_driver(), parts.geneva_wheel(PLAY)
    held = turn(Z, 0.25 * math.pi)
    assert not collide(driver, wheel, shift(parts.GENEVA, 0.0, 0.0), held)
    assert collide(driver, wheel, shift(parts.GENEVA, 0.0, 0.0), held @ turn(Z, 0.05))
    entering = shift(parts.GENEVA, 0.0, 0.0) @ turn(Z, math.pi)
    assert not collide(driver, wheel, entering)
    assert collide(driver, wheel, entering, turn(Z, 0.25 * math.pi))


def test_tongues_fit_their_grooves():
    middle = shift(0.0025, 0.0, parts.THICK + 1e-4)
    assert not collide(parts.hub(PLAY), parts.middle_disc(), None, middle)
    assert collide(parts.hub(PLAY), parts.middle_disc(), None, middle @ turn(Z, 0.05))


def test_studs_fit_below_a_brick():
    assert not collide(parts.brick(1e-4), parts.brick(1e-4), None, shift(4e-5, 0.0, 0.01 + 1e-5))
    assert collide(parts.brick(1e-4), parts.brick(1e-4), None, shift(8e-5, 0.0, 0.01 + 1e-5))


def test_a_screw_passes_the_hole_and_not_the_slot():
    outward = turn(X, 0.5 * math.pi)
    for y, touches in ((0.015, False), (0.0, True)):
        at_head = outward @ shift(0.0, y, 0.008)
        assert collide(parts.screw(), parts.keyhole_plate(), outward, at_head) is touches
    assert not collide(parts.screw(), parts.keyhole_plate(), outward, outward @ shift(0, 0, 0.002))
