"""Collision of any mesh with any mesh at haptic rates, exactly as sampled.

A mesh is made ready once, as a :class:`Model`: a signed distance field, a shell of points on the
surface and mass properties. Models, and the analytic shapes (:class:`Plane`, :class:`Box`,
:class:`Sphere`, :class:`Capsule`, :class:`Cylinder`, :class:`Cone`, :class:`ConvexPolyhedron`), then
collide in any pose:

    >>> import numpy as np
    >>> import trimesh
    >>> import voxshell as vx
    >>> model = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
    >>> pose = np.eye(4)
    >>> pose[2, 3] = 0.099  # the lowest point is 1 mm below the ground
    >>> contacts = vx.contacts(model, vx.Plane(), a_pose=pose)
    >>> float(contacts.depths.max())
    0.001...

In a :class:`World` they fall, bounce and rest by the physics of stock Bullet.

Conventions: metres, kilograms, seconds, radians; right-handed frames; poses are 4x4
``world_from_body`` matrices; signed distances are negative inside; depths are positive inside;
a contact's normal is on body b and points towards body a.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from voxshell import testing
from voxshell._core import version as __version__
from voxshell.accuracy import Accuracy, AccuracyWarning, ErrorStatistic
from voxshell.batch import ContactBatch, collide_batch, contacts_batch
from voxshell.cache import CacheWarning
from voxshell.contact_bounds import ContactBounds, contact_bounds
from voxshell.contact_set import Contacts
from voxshell.errors import (
    FileAccessError,
    InputTypeError,
    MemoryLimitError,
    MeshError,
    MissingExtraError,
    ModelFileError,
    PoseError,
    RecordingError,
    RobotError,
    SettingsError,
    SimulationError,
    VoxshellError,
)
from voxshell.field import DistanceField, Field
from voxshell.mass_properties import MassProperties
from voxshell.meshes import Mesh, MeshWarning
from voxshell.model import Model
from voxshell.poses import pose
from voxshell.queries import (
    Distance,
    Wrench,
    collide,
    contacts,
    deepest_per_segment,
    distance,
    manifold,
    wrench,
)
from voxshell.query_scratch import QueryScratch
from voxshell.shapes import Box, Capsule, Cone, ConvexPolyhedron, Cylinder, Plane, Sphere
from voxshell.shell import PointShell, PointSphereTree
from voxshell.sweeps import Sweep, SweepBatch, interpolate_pose, sweep, sweep_batch

if TYPE_CHECKING:
    from voxshell.body import Body
    from voxshell.comparison_shapes import ConvexDecomposition, ConvexHull, GImpact
    from voxshell.compound import Compound
    from voxshell.joints import (
        FixedJoint,
        HingeJoint,
        Joint,
        PointJoint,
        Reaction,
        SliderJoint,
    )
    from voxshell.urdf import Link, Robot, RobotWarning, load_urdf
    from voxshell.world import World
    from voxshell.world_state import WorldState

# What needs Bullet; loaded when it is first asked for.
_SIMULATION = {
    "Body": "voxshell.body",
    "Compound": "voxshell.compound",
    "ConvexDecomposition": "voxshell.comparison_shapes",
    "ConvexHull": "voxshell.comparison_shapes",
    "FixedJoint": "voxshell.joints",
    "GImpact": "voxshell.comparison_shapes",
    "HingeJoint": "voxshell.joints",
    "Joint": "voxshell.joints",
    "Link": "voxshell.urdf",
    "PointJoint": "voxshell.joints",
    "Reaction": "voxshell.joints",
    "Robot": "voxshell.urdf",
    "RobotWarning": "voxshell.urdf",
    "SliderJoint": "voxshell.joints",
    "World": "voxshell.world",
    "WorldState": "voxshell.world_state",
    "load_urdf": "voxshell.urdf",
}

__all__ = [
    "Accuracy",
    "AccuracyWarning",
    "Body",
    "Box",
    "CacheWarning",
    "Capsule",
    "Compound",
    "Cone",
    "ContactBatch",
    "ContactBounds",
    "Contacts",
    "ConvexDecomposition",
    "ConvexHull",
    "ConvexPolyhedron",
    "Cylinder",
    "Distance",
    "DistanceField",
    "ErrorStatistic",
    "Field",
    "FileAccessError",
    "FixedJoint",
    "GImpact",
    "HingeJoint",
    "InputTypeError",
    "Joint",
    "Link",
    "MassProperties",
    "MemoryLimitError",
    "Mesh",
    "MeshError",
    "MeshWarning",
    "MissingExtraError",
    "Model",
    "ModelFileError",
    "Plane",
    "PointJoint",
    "PointShell",
    "PointSphereTree",
    "PoseError",
    "QueryScratch",
    "Reaction",
    "RecordingError",
    "Robot",
    "RobotError",
    "RobotWarning",
    "SettingsError",
    "SimulationError",
    "SliderJoint",
    "Sphere",
    "Sweep",
    "SweepBatch",
    "VoxshellError",
    "World",
    "WorldState",
    "Wrench",
    "__version__",
    "collide",
    "collide_batch",
    "contact_bounds",
    "contacts",
    "contacts_batch",
    "deepest_per_segment",
    "distance",
    "interpolate_pose",
    "load_urdf",
    "manifold",
    "pose",
    "sweep",
    "sweep_batch",
    "testing",
    "wrench",
]


def __getattr__(name: str) -> Any:
    if name not in _SIMULATION:
        raise AttributeError(f"module 'voxshell' has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(_SIMULATION[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
