"""Models of meshes, their parts and files, and analytic shapes."""

from voxshell.model.accuracy import Accuracy, AccuracyWarning, ErrorStatistic
from voxshell.model.cache import CacheWarning
from voxshell.model.field import DistanceField, Field
from voxshell.model.mass_properties import MassProperties
from voxshell.model.meshes import Mesh, MeshWarning
from voxshell.model.model import Model
from voxshell.model.shapes import Box, Capsule, Cone, ConvexPolyhedron, Cylinder, Plane, Sphere
from voxshell.model.shell import PointShell, PointSphereTree

__all__ = [
    "Accuracy",
    "AccuracyWarning",
    "Box",
    "CacheWarning",
    "Capsule",
    "Cone",
    "ConvexPolyhedron",
    "Cylinder",
    "DistanceField",
    "ErrorStatistic",
    "Field",
    "MassProperties",
    "Mesh",
    "MeshWarning",
    "Model",
    "Plane",
    "PointShell",
    "PointSphereTree",
    "Sphere",
]
