from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from voxshell.robots.description import JointDescription
from voxshell.robots.kinematics import Twist, find_child, find_twists, move_along


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


def test_twists_add_up_along_a_chain_and_only_what_is_carried_moves_differently():
    """Hinges and a slider whose children have the axes of the world."""

    def link(name: str, kind: str, parent: str, child: str, axis: tuple[float, float, float]):
        return JointDescription(
            name, "f:9", kind, parent, child, vx.pose((1, 0, 0)), np.eye(4), axis=axis
        )

    joints = [
        link("p", "revolute", "a", "b", (0, 0, 2.0)),
        link("q", "prismatic", "b", "c", (0, 3.0, 0)),
        link("r", "floating", "c", "d", (1.0, 0, 0)),
        link("s", "fixed", "c", "e", (1.0, 0, 0)),
    ]
    poses = {name: vx.pose((x, 0, 0)) for x, name in enumerate("abcde")}
    still = Twist(np.zeros(3), np.zeros(3))
    twists = find_twists(joints, {"p": 2.0, "q": 0.5}, poses, dict.fromkeys("abcde", still))
    assert set(twists) == {"b", "c", "e"}
    for name in twists:
        np.testing.assert_allclose(twists[name].angular, (0, 0, 2.0))
        slide = 0.0 if name == "b" else 0.5
        np.testing.assert_allclose(twists[name].linear_at(np.array((3.0, 0, 0))), (0, 4 + slide, 0))
    spinning = {name: twists.get(name, still) for name in "abcde"}
    assert set(find_twists(joints, {"q": 0.0}, poses, spinning)) == {"c", "e"}
