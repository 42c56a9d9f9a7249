"""Bodies that are driven: doors, belts and grippers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell.model.shapes import Box
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.scene import Z, shift, turn
from voxshell_studies.scenes.limits.scene import LimitScene, count_steps, open_world, put

if TYPE_CHECKING:
    from voxshell.simulation.world import World

DOORS = "Doors that turn"
BELTS = "Belts of Bullet's boxes"
GRIPPERS = "Kinematic grippers"

_DOOR, _HALF_DOOR, _CUBE = 0.8, 0.02, 0.1
"""Length and half thickness of a door, and side of a cube, meters."""


def _push_with_a_door(rate: float, placement: int, spin: float, seconds: float) -> float:
    """Return how deep a corner of a cube is in a door that turns about z, millimeters at most."""
    world = open_world(rate)
    put(world, forms.PLANE)
    hinge_to_door = shift(0.5 * _DOOR, 0.0, 0.2)
    leaf = forms.box(_DOOR, 2.0 * _HALF_DOOR, 0.39)
    door = put(world, leaf, hinge_to_door, driven=True)
    cube = forms.box(_CUBE, _CUBE, _CUBE)
    start = shift(0.6 - 0.05 * placement, _HALF_DOOR + 0.5 * _CUBE + 0.002, 0.5 * _CUBE)
    body = put(world, cube, start, 1.0)
    deepest = 0.0
    for step in range(count_steps(rate, seconds)):
        door_pose = turn(Z, spin * (step + 1) / rate)
        door.pose = door_pose @ hinge_to_door
        world.step()
        corners = cube.vertices @ body.pose[:3, :3].T + body.pose[:3, 3]
        x, y, _ = (corners @ door_pose[:3, :3]).T
        beside = (x > 0.0) & (x < _DOOR) & (y > -_HALF_DOOR)
        deepest = max(deepest, float((_HALF_DOOR - y[beside]).max(initial=0.0)))
    return 1e3 * deepest


def _ride_on_a_belt(rate: float, _: int) -> float:
    """Return how deep a box of Bullet's sinks into a moving belt of Bullet's, millimeters."""
    world = open_world(rate)
    belt = put(world, Box((1.0, 0.2, 0.02)), shift(0.0, 0.0, -0.02), driven=True)
    belt.surface_velocity = (0.3, 0.0, 0.0)
    body = put(world, Box((0.05, 0.05, 0.05)), shift(-0.5, 0.0, 0.05), 1.0)
    lowest = 0.0
    for _step in range(count_steps(rate, 2.0)):
        world.step()
        corners = forms.box(0.1, 0.1, 0.1).vertices @ body.pose[2, :3] + body.pose[2, 3]
        lowest = min(lowest, float(corners.min()))
    return -1e3 * lowest


def _hold_with_a_gripper(rate: float, placement: int, model: bool) -> float:
    """Return how fast a part creeps down between two kinematic fingers, mm/s."""
    world = open_world(rate)
    part = forms.box(0.06, 0.06, 0.1) if model else Box((0.03, 0.03, 0.05))
    body = put(world, part, turn(Z, 0.0), 0.5, friction=0.64)
    overlap = 0.001 * (1 + placement)
    for side in (-1.0, 1.0):
        finger = forms.box(0.01, 0.04, 0.1) if model else Box((0.005, 0.02, 0.05))
        put(world, finger, shift(side * (0.035 - overlap), 0, 0), friction=0.64, driven=True)
    _wait(world, rate, 0.5)
    before = float(body.pose[2, 3])
    _wait(world, rate, 2.0)
    return 1e3 * (before - float(body.pose[2, 3])) / 2.0


def _wait(world: World, rate: float, seconds: float) -> None:
    world.step(count_steps(rate, seconds))


SCENES = (
    *(
        LimitScene(
            f"door of 0.8 m pushes a cube of 0.1 m at {spin:g} rad/s",
            DOORS,
            "depth of a corner",
            "mm",
            0.0,
            lambda rate, placement, spin=spin: _push_with_a_door(rate, placement, spin, 1.2 / spin),
            placements=3,
        )
        for spin in (2.0, 4.0)
    ),
    LimitScene(
        "Bullet's box of 0.1 m on a belt at 0.3 m/s",
        BELTS,
        "depth of a corner",
        "mm",
        0.0,
        _ride_on_a_belt,
    ),
    *(
        LimitScene(
            f"two kinematic fingers hold a part of 0.5 kg, {name}",
            GRIPPERS,
            "creep downward",
            "mm/s",
            0.0,
            lambda rate, placement, model=model: _hold_with_a_gripper(rate, placement, model),
            placements=2,
        )
        for name, model in (("models", True), ("Bullet's boxes", False))
    ),
)
