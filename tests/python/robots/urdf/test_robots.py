"""Robots that people share: those of the package pybullet, where it is installed."""

from __future__ import annotations

import warnings

import voxshell as vx

REFUSED = {
    "biped/biped2d_pybullet.urdf": "<limit lower=",
    "kuka_iiwa/model_for_sdf.urdf": "is missing",
    "plane_implicit.urdf": "has a <plane>",
    "quadruped/microtaur/microtaur.urdf": "rpy=",
    "racecar/racecar_differential.urdf": "scale=",
    "torus_deform.urdf": "it has no <link>",
    "toys/concave_box.urdf": "has a <cdf>",
}
"""Files with a fault, and what the error says; tools/try_robots.py tries more packages."""


def test_every_robot_of_pybullet_loads_or_has_a_fault(pybullet_data):
    found = {}
    paths = [it for it in sorted(pybullet_data.rglob("*.urdf")) if "random_urdfs" not in it.parts]
    assert len(paths) > 90
    for path in paths:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", vx.RobotWarning)
            warnings.simplefilter("ignore", vx.MeshWarning)
            try:
                vx.load_urdf(vx.World(), path, mesh_as="hull")
            except vx.RobotError as error:
                found[path.relative_to(pybullet_data).as_posix()] = str(error)
    assert found.keys() == REFUSED.keys()
    for name, text in REFUSED.items():
        assert text in found[name]
