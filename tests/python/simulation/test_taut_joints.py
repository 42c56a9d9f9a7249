"""Light links that joints pull on, as those of a hanging chain."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
import voxshell as vx

LINKS, LENGTH = 10, 0.02  # meters


def hang(world, weight, tilt=0.0):
    """Links of 5 g and a weight, in line with a direction that leans by ``tilt``, radians.

    Returns:
        The links, and the weight.
    """
    down = np.array((np.sin(tilt), 0.0, -np.cos(tilt)))
    bodies = []
    for i in range(LINKS + 1):
        is_weight = i == LINKS
        half = LENGTH if is_weight else LENGTH / 2
        size = (half, half, half) if is_weight else (0.002, 0.002, half)
        body = world.add(
            vx.Box(size),
            mass=weight if is_weight else 0.005,
            mask=0,
            pose=vx.pose(down * (LENGTH * i + half), euler=(0, -tilt, 0)),
        )
        world.add_joint(
            vx.HingeJoint(axis=(0, 1, 0)),
            bodies[-1] if bodies else None,
            body,
            world_from_joint=down * LENGTH * i,
        )
        bodies.append(body)
    return bodies


@pytest.mark.parametrize(
    ("rate", "weight"),
    [(1000, 1.0), (1000, 5.0), (200, 0.1), (200, 0.3), (200, 50.0), (60, 0.02), (60, 0.3)],
)
def test_a_hanging_chain_of_light_links_holds_its_weight(rate, weight):
    """The links flew apart, and the weight fell by meters."""
    world = vx.World(1.0 / rate)
    links = hang(world, weight)
    links[4].linear_velocity = (0.1, 0, 0)
    world.step(2 * rate)
    assert links[-1].position == pytest.approx((0, 0, -LENGTH * (LINKS + 1)), abs=2e-3)
    assert max(np.linalg.norm(body.angular_velocity) for body in links) < 20.0


@pytest.mark.parametrize(("rate", "within"), [(1000, 0.001), (200, 0.002), (60, 0.005)])
def test_it_swings_as_fast_as_in_short_steps(rate, within):
    world = vx.World(1.0 / rate)
    weight = hang(world, 0.3, tilt=0.4)[-1]
    places = []
    world.step(4 * rate, callback=lambda _: places.append(weight.position[0]))
    x = np.array(places)
    crossings = np.nonzero((x[:-1] < 0) & (x[1:] >= 0))[0]
    times = (crossings + x[crossings] / (x[crossings] - x[crossings + 1])) / rate
    assert np.diff(times).mean() == pytest.approx(0.9402, rel=within)  # at 4000 Hz
    assert np.linalg.norm(weight.position) == pytest.approx(LENGTH * (LINKS + 1), abs=5e-4)


FIRST_STEP = """
import math, voxshell as vx
for _ in range(20):
    world = vx.World()
    box = world.add(vx.Box((0.2, 0.02, 0.02)), mass=0.2)
    hinge = vx.HingeJoint(axis=(0, 0, 1), limits=(-math.pi, math.pi))
    joint = world.add_joint(hinge, None, box, world_from_joint=(0.2, 0, 0))
    joint.set_target_velocity(5.0, max_force=200.0)
    world.step()
    print(joint.velocity, joint.position)
"""


def test_the_first_step_of_a_joint_does_not_depend_on_what_memory_held():
    runs = {
        subprocess.run(
            [sys.executable, "-c", FIRST_STEP],
            env={**os.environ, "MALLOC_PERTURB_": str(junk)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for junk in (0, 129, 190)  # as doubles: small numbers and large ones
    }
    assert len(runs) == 1
