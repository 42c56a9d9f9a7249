"""Models that people share: those of the package pybullet, where it is installed."""

from __future__ import annotations

import warnings
from pathlib import Path

import voxshell as vx

REFUSED = {
    "hopper.xml": 'coordinate="global"',
    "humanoid_fixed.xml": 'type="fixed"',
    "walker2d.xml": 'coordinate="global"',
}
"""Files with a fault, and what the error says; tools/try_robots.py tries more packages."""


def test_every_model_of_pybullet_loads_or_has_a_fault(pybullet_data: Path):
    paths = [
        path for path in (pybullet_data / "mjcf").glob("*.xml") if "<mujoco" in path.read_text()
    ]
    assert len(paths) > 20
    found = {}
    for path in paths:
        world = vx.World()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", vx.RobotWarning)
            warnings.simplefilter("ignore", vx.MeshWarning)
            try:
                vx.load_mjcf(world, path, mesh_as="hull")
                world.step(10)
            except vx.RobotError as error:
                found[path.name] = str(error)
    assert found.keys() == REFUSED.keys()
    for name, text in REFUSED.items():
        assert text in found[name]
