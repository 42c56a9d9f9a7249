"""Links of a robot: their poses and motions."""

from __future__ import annotations

import numpy as np
import voxshell as vx
from voxshell.robots.link import Link, find_twist


def test_a_link_moves_with_its_body():
    world = vx.World(gravity=(0, 0, 0))
    body = world.add(vx.Box((0.1, 0.2, 0.3)), pose=(1.0, 0, 0))
    body.linear_velocity, body.angular_velocity = (1.0, 2.0, 3.0), (0, 0, 4.0)
    link = Link("hand", body, vx.pose((0, 0.5, 0)), None)
    np.testing.assert_array_equal(link.pose[:3, 3], (1.0, 0.5, 0))
    twist = find_twist(link)
    np.testing.assert_allclose(twist.angular, (0, 0, 4.0))
    np.testing.assert_allclose(twist.linear, (1.0, -2.0, 3.0), atol=1e-12)
    place = link.pose[:3, 3]
    np.testing.assert_allclose(twist.linear_at(place), body.velocity_at(place), atol=1e-12)


def test_a_link_without_a_body_stays_where_it_is():
    link = Link("hook", None, vx.pose((0, 0, 2.0)), None)
    np.testing.assert_array_equal(link.pose, vx.pose((0, 0, 2.0)))
    assert not find_twist(link).angular.any()
    assert not find_twist(link).linear.any()
