from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from poses import at, random_poses, turned

STIFFNESS = 1e6  # N/m3


def test_a_cube_in_the_ground_is_pushed_up_by_its_weight_of_springs(cube: vx.Model):
    bottom = cube.shell.points[:, 2] < -0.4999
    area = float(cube.shell.areas[bottom].sum())
    wrench = vx.wrench(cube, vx.Plane(), at(3.0, 4.0, 0.499), None, stiffness=STIFFNESS)
    np.testing.assert_allclose(wrench.force, [0, 0, STIFFNESS * area * 1e-3], rtol=2e-3, atol=0.1)
    np.testing.assert_allclose(wrench.torque, 0.0, atol=1.0)
    assert abs(area - 1.0) < 0.2
    assert wrench.force.shape == wrench.torque.shape == (3,)


def test_an_eccentric_push_turns_about_the_origin_of_a(cube: vx.Model):
    # Half of the cube stands on a box that ends below its middle; its center of pressure is at
    # x = 0.25 of the cube, in whatever frame the world has.
    world = at(5.0, -3.0, 2.0) @ turned((1, 2, 3), 0.8)
    wrench = vx.wrench(
        cube,
        vx.Box((1.0, 1.0, 1.0)),
        world @ at(z=0.998),
        world @ at(1.0, 0, -0.5),
        stiffness=STIFFNESS,
    )
    force, torque = (world[:3, :3].T @ v for v in (wrench.force, wrench.torque))
    assert force[2] > 0.4 * STIFFNESS * 0.002
    np.testing.assert_allclose(torque[1], -0.25 * force[2], rtol=0.15)


@pytest.mark.parametrize("shell", ["a", "b"])
def test_action_is_reaction_whichever_body_is_a(ball: vx.Model, cube: vx.Model, shell: str):
    pose, other = (
        at(0.05, 0.02, 0.57) @ turned((1, 2, 3), 0.7),
        at(0.1) @ turned((3, 1, 2), 0.1),
    )
    on_ball = vx.wrench(ball, cube, pose, other, stiffness=STIFFNESS, shell=shell)
    mirrored = "b" if shell == "a" else "a"
    on_cube = vx.wrench(cube, ball, other, pose, stiffness=STIFFNESS, shell=mirrored)
    size = np.linalg.norm(on_ball.force)
    assert size > 1.0
    np.testing.assert_allclose(on_ball.force, -on_cube.force, atol=1e-9 * size)
    about_the_world = [
        w.torque + np.cross(p[:3, 3], w.force) for w, p in ((on_ball, pose), (on_cube, other))
    ]
    np.testing.assert_allclose(about_the_world[0], -about_the_world[1], atol=1e-9 * size)


def test_it_is_the_sum_over_the_contacts(ball: vx.Model):
    # On a plane, gradients are the contacts' normals.
    pose = at(1.0, 2.0, 0.08) @ turned((1, 2, 3), 0.7)
    contacts = vx.contacts(ball, vx.Plane(), pose)
    weights = STIFFNESS * ball.shell.areas[contacts.ids].astype(float) * contacts.depths
    forces = weights[:, None] * contacts.normals
    wrench = vx.wrench(ball, vx.Plane(), pose, None, stiffness=STIFFNESS)
    np.testing.assert_allclose(wrench.force, forces.sum(axis=0), rtol=1e-4, atol=1e-3)
    arms = contacts.points_a - pose[:3, 3]
    np.testing.assert_allclose(
        wrench.torque, np.cross(arms, forces).sum(axis=0), rtol=1e-3, atol=1e-3
    )


def test_apart_and_without_stiffness_it_is_zero(ball: vx.Model, cube: vx.Model):
    for a, b, pose, stiffness in (
        (ball, cube, at(z=0.7), STIFFNESS),
        (ball, vx.Plane(), at(z=0.1001), STIFFNESS),
        (cube, ball, at(z=0.5), 0.0),
    ):
        wrench = vx.wrench(a, b, pose, stiffness=stiffness)
        np.testing.assert_array_equal(wrench.force, np.zeros(3))
        np.testing.assert_array_equal(wrench.torque, np.zeros(3))
        assert not np.signbit([*wrench.force, *wrench.torque]).any()


def test_it_grows_from_zero_without_jumps(ball: vx.Model, cube: vx.Model):
    heights = np.linspace(0.61, 0.55, 601)
    forces = np.array(
        [vx.wrench(ball, cube, at(0.03, 0.02, z), None, stiffness=STIFFNESS).force for z in heights]
    )
    assert (forces[0] == 0.0).all()
    assert np.abs(forces[-1]).max() > 10.0
    # No step adds more than the springs of the whole ball would.
    most = STIFFNESS * float(ball.shell.areas.sum()) * (heights[0] - heights[1])
    assert np.abs(np.diff(forces, axis=0)).max() < most


def test_the_wrench_of_both_shells_counts_area_once(ball: vx.Model, cube: vx.Model):
    for pose in random_poses(20, 0.5):
        a, b, both = (
            vx.wrench(ball, cube, pose, None, stiffness=1.0, shell=shell)
            for shell in ("a", "b", "both")
        )
        np.testing.assert_allclose(both.force, 0.5 * (a.force + b.force), rtol=1e-12, atol=1e-9)
        np.testing.assert_allclose(both.torque, 0.5 * (a.torque + b.torque), rtol=1e-12, atol=1e-9)


def test_the_wrench_of_both_shells_has_no_jumps(ball: vx.Model, cube: vx.Model):
    # Into the cube through its face until the ball is wholly inside.
    forces = np.array(
        [
            vx.wrench(ball, cube, at(0.01, 0.02, z), None, stiffness=1.0, shell="both").force
            for z in np.linspace(0.65, 0.3, 2000)
        ]
    )
    steps = np.linalg.norm(np.diff(forces, axis=0), axis=1)
    assert np.linalg.norm(forces, axis=1).max() > 0.0
    assert steps.max() < 0.01 * np.linalg.norm(forces, axis=1).max()


@pytest.mark.parametrize("stiffness", [-1.0, np.nan, np.inf, -np.inf, "1", None, [1.0], 1j])
def test_a_wrong_stiffness_is_refused(ball: vx.Model, stiffness):
    with pytest.raises(vx.SettingsError, match="stiffness"):
        vx.wrench(ball, vx.Plane(), stiffness=stiffness)


def test_the_stiffness_must_be_given(ball: vx.Model):
    with pytest.raises(TypeError, match="stiffness"):
        vx.wrench(ball, vx.Plane())  # pyright: ignore[reportCallIssue]


def test_poses_are_the_identity_by_default(ball: vx.Model, cube: vx.Model):
    default = vx.wrench(ball, cube, stiffness=STIFFNESS)
    given = vx.wrench(ball, cube, np.eye(4), np.eye(4), stiffness=STIFFNESS)
    assert default.force.tolist() == given.force.tolist()


def test_a_missing_stiffness_is_explained(ball):
    with pytest.raises(vx.InputTypeError, match=r"wrench\(\) needs stiffness: .* N where 1 cm2 is"):
        vx.wrench(ball, vx.Plane())  # pyright: ignore[reportCallIssue]
