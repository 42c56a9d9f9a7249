"""Collision of any mesh with any mesh, fast enough for haptics (1 kHz).

A :class:`Model` is built once from a mesh. It consists of a signed distance field, a shell of
points on the surface, and mass properties. Models and analytic shapes (:class:`Plane`,
:class:`Box`, :class:`Sphere`, :class:`Capsule`, :class:`Cylinder`, :class:`Cone`,
:class:`ConvexPolyhedron`) collide in any pose:

    >>> import numpy as np
    >>> import trimesh
    >>> import voxshell as vx
    >>> model = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
    >>> pose = np.eye(4)
    >>> pose[2, 3] = 0.099  # the lowest point is 1 mm below the ground
    >>> contacts = vx.contacts(model, vx.Plane(), a_pose=pose)
    >>> float(contacts.depths.max())
    0.001...

In a :class:`World`, stock Bullet simulates them.

Conventions: units are meters, kilograms, seconds and radians. Frames are right-handed, and poses
are 4x4 ``world_from_body`` matrices. Signed distances are negative inside, and depths are positive
inside. The normal of a contact is on body b and points toward body a.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if not TYPE_CHECKING:  # before all other imports
    from voxshell.base.compiled import reuse_compiled

    reuse_compiled()

from voxshell import _core, testing
from voxshell._core import version as __version__
from voxshell.base.compiled import keep_compiled
from voxshell.base.extras import explain_import
from voxshell.base.near_names import advise_on_name
from voxshell.base.poses import pose
from voxshell.base.user_warnings import UnitWarning
from voxshell.errors import (
    FileAccessError,
    InputTypeError,
    MemoryLimitError,
    MeshError,
    MissingExtraError,
    MissingFileError,
    ModelFileError,
    PoseError,
    RecordingError,
    RobotError,
    SettingsError,
    SimulationError,
    StateError,
    VoxshellError,
)
from voxshell.model import (
    Accuracy,
    AccuracyWarning,
    Box,
    CacheWarning,
    Capsule,
    Cone,
    ConvexPolyhedron,
    Cylinder,
    DistanceField,
    ErrorStatistic,
    Field,
    MassProperties,
    Mesh,
    MeshWarning,
    Model,
    Plane,
    PointShell,
    PointSphereTree,
    Sphere,
)
from voxshell.query import (
    Contact,
    ContactBatch,
    ContactBounds,
    Contacts,
    Distance,
    QueryScratch,
    Sweep,
    SweepBatch,
    Wrench,
    collide,
    collide_batch,
    contact_bounds,
    contacts,
    contacts_batch,
    deepest_per_segment,
    distance,
    distance_batch,
    interpolate_pose,
    manifold,
    sweep,
    sweep_batch,
    wrench,
)
from voxshell.recording import Recording

if TYPE_CHECKING:
    from voxshell.robots import Link, Robot, RobotWarning, load_mjcf, load_urdf
    from voxshell.simulation import (
        Body,
        Compound,
        ConvexDecomposition,
        ConvexHull,
        FixedJoint,
        GImpact,
        HingeJoint,
        Joint,
        LiveView,
        Material,
        PointJoint,
        Reaction,
        Recorder,
        SliderJoint,
        World,
        WorldState,
    )

__all__ = [
    "Accuracy",
    "AccuracyWarning",
    "Body",
    "Box",
    "CacheWarning",
    "Capsule",
    "Compound",
    "Cone",
    "Contact",
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
    "LiveView",
    "MassProperties",
    "Material",
    "MemoryLimitError",
    "Mesh",
    "MeshError",
    "MeshWarning",
    "MissingExtraError",
    "MissingFileError",
    "Model",
    "ModelFileError",
    "Plane",
    "PointJoint",
    "PointShell",
    "PointSphereTree",
    "PoseError",
    "QueryScratch",
    "Reaction",
    "Recorder",
    "Recording",
    "RecordingError",
    "Robot",
    "RobotError",
    "RobotWarning",
    "SettingsError",
    "SimulationError",
    "SliderJoint",
    "Sphere",
    "StateError",
    "Sweep",
    "SweepBatch",
    "UnitWarning",
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
    "distance_batch",
    "interpolate_pose",
    "load_mjcf",
    "load_urdf",
    "manifold",
    "pose",
    "sweep",
    "sweep_batch",
    "testing",
    "wrench",
]


keep_compiled(_core)


def __getattr__(name: str) -> Any:
    """Import names that need Bullet on first use."""
    if name not in __all__:
        advice = advise_on_name(name, __all__)
        raise AttributeError(
            f"module 'voxshell' has no attribute {name!r}{f': {advice}' if advice else ''}"
        )
    try:
        from voxshell import simulation
    except ImportError as error:
        explained = explain_import(error, str(error))
        if isinstance(explained, MemoryLimitError):
            raise explained from error
        raise

    if name in simulation.__all__:
        value = getattr(simulation, name)
    else:
        from voxshell import robots

        value = getattr(robots, name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
