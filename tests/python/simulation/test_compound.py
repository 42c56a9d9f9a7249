"""Compounds of shapes and models: their mass, their rest, and what they may not contain."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at


def test_compound_has_the_matter_of_its_parts():
    left, right = vx.Box((0.5, 0.1, 0.1)), vx.Box((0.5, 0.1, 0.1))
    halves = vx.Compound([(left, at(x=0.2)), (right, at(x=1.2))])
    world = vx.World(gravity=(0, 0, 0))
    whole = world.add(vx.Box((1.0, 0.1, 0.1)), mass=3.0, pose=at(x=0.7, y=3.0))
    joined = world.add(halves, mass=3.0)
    for body, center in ((whole, (0.7, 3, 0)), (joined, (0.7, 0, 0))):
        body.apply_impulse((0, 0, 1.0), at=np.add(center, (0.4, 0.05, 0)))
    np.testing.assert_allclose(joined.angular_velocity, whole.angular_velocity, rtol=1e-9)
    np.testing.assert_allclose(joined.linear_velocity, whole.linear_velocity, rtol=1e-9)


@pytest.mark.parametrize("ground", ["plane", "model"])
def test_compound_of_models_and_shapes_stands_on_its_legs(brick, ground):
    """A stool: a model as its seat, and a leg of each kind."""
    legs = [vx.Cylinder(0.02, 0.2), vx.Box((0.02, 0.02, 0.1)), vx.Capsule(0.02, 0.16), brick]
    sides = [(-0.07, -0.07), (0.07, -0.07), (-0.07, 0.07), (0.07, 0.07)]
    turned = trimesh.transformations.rotation_matrix(np.pi / 2, (0, 1, 0))
    stool = vx.Compound(
        [(brick, at(z=0.03))]
        + [
            (leg, at(x, y, -0.1) @ (turned if leg is brick else np.eye(4)))
            for leg, (x, y) in zip(legs, sides, strict=True)
        ]
    )
    world = vx.World()
    floor = vx.Plane()
    if ground == "model":
        floor = vx.Model.from_mesh(trimesh.creation.box(extents=(1, 1, 0.1)), voxel_size=0.01)
    world.add(floor, mass=0, pose=at(z=-0.05 if ground == "model" else 0.0))
    body = world.add(stool, pose=at(z=0.205))
    world.step(300)
    assert body.pose[2, 3] == pytest.approx(0.2, abs=2e-3)
    assert body.pose[2, 2] > 0.999
    assert np.linalg.norm(body.angular_velocity) < 0.05


@pytest.mark.parametrize(
    ("parts", "error", "part"),
    [
        (lambda: [], vx.SettingsError, "at least one part"),
        (lambda: [vx.Sphere(1.0)], vx.InputTypeError, r"parts\[0\] must be a pair"),
        (
            lambda: [(vx.Plane(), np.eye(4))],
            vx.InputTypeError,
            r"parts\[0\] must be one of .* not Plane",
        ),
        (lambda: [(vx.Sphere(1.0), np.eye(3))], vx.PoseError, r"the pose of parts\[0\]"),
    ],
)
def test_wrong_compounds_are_refused(parts, error, part):
    with pytest.raises(error, match=part):
        vx.Compound(parts())
