"""Descriptions of scenes: equal ones have no difference, and others are told apart."""

from __future__ import annotations

import json

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.simulation.scene_identity import describe_scene, find_difference

MESH = trimesh.creation.box(extents=(0.2, 0.2, 0.2))
OTHER = trimesh.creation.box(extents=(0.2, 0.2, 0.20001))
SHAPES = {
    "plane": lambda other: vx.Plane(offset=0.1 if other else 0.0),
    "box": lambda other: vx.Box((0.1, 0.1, 0.2 if other else 0.1)),
    "sphere": lambda other: vx.Sphere(0.2 if other else 0.1),
    "capsule": lambda other: vx.Capsule(0.1, 0.2 if other else 0.1),
    "cylinder": lambda other: vx.Cylinder(0.1, 0.2 if other else 0.1),
    "cone": lambda other: vx.Cone(0.1, 0.2 if other else 0.1),
    "gimpact": lambda other: vx.GImpact(OTHER if other else MESH),
    "hull": lambda other: vx.ConvexHull(OTHER if other else MESH),
    "margin": lambda other: vx.ConvexHull(MESH, margin=0.002 if other else 0.001),
    "model": lambda other: vx.Model.from_mesh(OTHER if other else MESH, voxel_size=0.02),
    "compound": lambda other: vx.Compound([(vx.Sphere(0.1), (0, 0, 0.2 if other else 0.1))]),
    "kind": lambda other: vx.Cylinder(0.1, 0.1) if other else vx.Capsule(0.1, 0.1),
}


def describe(world: vx.World) -> dict:
    return describe_scene(world._settings, world.bodies, world.joints)


@pytest.mark.parametrize("kind", SHAPES)
def test_shapes_are_told_apart(kind):
    def make(other):
        world = vx.World()
        world.add(SHAPES[kind](other), mass=0, name="it")
        return describe(world)

    from_file = json.loads(json.dumps(make(False)))
    assert find_difference(from_file, make(False)) == ""
    assert find_difference(from_file, make(True)) == "body 0 of the world, 'it', has another shape"


def make_jointed(**changes):
    world = vx.World()
    parent = world.add(vx.Sphere(0.1), pose=(0, 0, 1))
    child = world.add(vx.Sphere(0.1))
    at = changes.pop("at", (0, 0, 0.5))
    ends = (None, child) if changes.pop("on_world", False) else (parent, child)
    collide = changes.pop("collide", False)
    kind = changes.pop("kind", vx.HingeJoint)(**changes)
    world.add_joint(kind, *ends, world_from_joint=vx.pose(at), collide=collide, name="it")
    return world


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"kind": vx.SliderJoint}, "kind"),
        ({"on_world": True}, "parent"),
        ({"at": (0, 0, 0.6)}, "frame in its parent"),
        ({"axis": (0, 1, 0)}, "frame in its parent"),
        ({"collide": True}, "collide"),
        ({"limits": (0.0, 1.0)}, "limits"),
        ({"friction": 1.0}, "friction"),
        ({"armature": 1.0}, "armature"),
    ],
)
def test_joints_are_told_apart(changes, what):
    then = json.loads(json.dumps(describe(make_jointed())))
    assert find_difference(then, describe(make_jointed())) == ""
    now = describe(make_jointed(**changes))
    assert find_difference(then, now) == f"joint 0 of the world, 'it', has another {what}"


@pytest.mark.parametrize(
    ("settings", "names"),
    [
        ({"contact": "regular"}, "contact"),
        ({"shell": "fewest"}, "shell"),
        ({"margin": 0.001, "level": 3}, "level and another margin"),
        ({"ccd_motion_threshold": np.inf}, "ccd_motion_threshold"),
        ({"sleeping": False}, "sleeping"),
        ({"solver": "dantzig"}, "solver and another iterations and another default of iterations"),
        ({"iterations": 10}, "default of iterations"),
        ({"friction_directions": 1}, "friction_directions"),
        ({"split_impulse_threshold": -0.04}, "split_impulse_threshold"),
    ],
)
def test_settings_of_worlds_are_told_apart(settings, names):
    then = json.loads(json.dumps(describe(vx.World())))
    now = describe(vx.World(**settings))
    assert find_difference(then, now) == f"the world was made with another {names}"
    assert find_difference(json.loads(json.dumps(now)), now) == ""


def test_gravity_and_threads_are_not_part_of_a_scene():
    then = describe(vx.World())
    assert find_difference(then, describe(vx.World(gravity=(0, 0, 0), threads=1))) == ""


def test_rounding_is_no_difference():
    then, now = describe(make_jointed()), describe(make_jointed())
    then["joints"][0]["frame in its child"][0][3] += 1e-15
    then["bodies"][0]["mass"] *= 1 + 1e-14
    assert find_difference(then, now) == ""
