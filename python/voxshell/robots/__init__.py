"""Robots from URDF and MJCF files. COLLADA meshes need an extra: ``pip install voxshell[urdf]``."""

from voxshell.robots.link import Link
from voxshell.robots.mjcf.load import load_mjcf
from voxshell.robots.robot import Robot
from voxshell.robots.robot_warning import RobotWarning
from voxshell.robots.urdf.load import load_urdf

__all__ = ["Link", "Robot", "RobotWarning", "load_mjcf", "load_urdf"]
