"""Robots from URDF files; COLLADA meshes need an optional part, ``pip install voxshell[urdf]``."""

from voxshell.urdf.load import load_urdf
from voxshell.urdf.robot import Link, Robot, RobotWarning

__all__ = ["Link", "Robot", "RobotWarning", "load_urdf"]
