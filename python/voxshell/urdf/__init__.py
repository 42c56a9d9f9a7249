"""Robots from URDF files; an optional part, ``pip install voxshell[urdf]``."""

from voxshell.urdf.load import load_urdf
from voxshell.urdf.robot import Link, Robot

__all__ = ["Link", "Robot", "load_urdf"]
