from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from voxshell.robots.description import JointDescription
from voxshell.robots.kinematics import find_child, move_along


def joint(kind: str, position: float = 0.0) -> JointDescription:
    """1 m along x and on an axis along y, which is half a meter above the child."""
    return JointDescription(
        "j", "f:9", kind, "a", "b", vx.pose((1, 0, 0)), vx.pose((0, 0, 0.5)), position,
        axis=(0.0, 2.0, 0.0),
    )  # fmt: skip


def test_a_slider_moves_along_its_axis_by_the_way_from_the_position_of_the_file():
    np.testing.assert_allclose(find_child(joint("prismatic", 0.2), 0.5), vx.pose((1, 0.3, 0)))


def test_a_hinge_turns_about_its_axis():
    turned = find_child(joint("revolute"), np.pi / 2.0)
    np.testing.assert_allclose(turned @ (0, 0, 0, 1), (0.5, 0, 0.5, 1), atol=1e-15)
    np.testing.assert_allclose(turned @ (0, 0, 0.5, 1), (1, 0, 0.5, 1), atol=1e-15)


def test_at_the_position_of_the_file_the_child_is_exactly_where_the_file_has_it():
    it = joint("continuous", 0.3)
    assert find_child(it, 0.3) is it.parent_from_child


@pytest.mark.parametrize(("kind", "there"), [("prismatic", (0, 2, 0)), ("revolute", (0, 0, 0))])
def test_motions_are_in_the_frame_of_the_joint(kind, there):
    np.testing.assert_allclose(move_along(joint(kind), 2.0)[:3, 3], there, atol=1e-15)
