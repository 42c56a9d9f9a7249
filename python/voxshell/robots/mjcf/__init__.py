"""Robots and scenes from MJCF files, the XML of MuJoCo."""
