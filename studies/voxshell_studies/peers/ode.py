"""ODE, the Open Dynamics Engine, through its C library: no Python package is maintained."""

from __future__ import annotations

import ctypes
from ctypes import POINTER, c_char_p, c_double, c_int, c_uint, c_void_p
from typing import TYPE_CHECKING, Any

import numpy as np
from voxshell.errors import MissingExtraError

from voxshell_studies.peers.protocol import seconds_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell_studies.peers.protocol import Case, Job, Other

LIBRARY = "libode.so.8"
"""Library in the Debian and Ubuntu package libode8, ODE 0.16 in double precision."""

MOST_CONTACTS = 8192
"""Largest number of contacts of a query: all."""

MOST_DROP_CONTACTS = 1024
"""Contacts per step of a drop: with 64, all may be on one foot, and the body keeps tumbling."""

SURFACE_LAYER, CORRECTING_SPEED, CFM, ITERATIONS = 1e-4, 0.5, 1e-5, 50
"""Settings of drops: allowed depth, meters; largest correcting velocity, m/s; softness of contacts;
QuickStep. With these the bunny rests at 200 to 20 Hz; with ODE's defaults at none of these
rates."""

FRICTION = 0.5
"""Friction, equal to that of the other peers' bodies."""

# From contact.h of ODE 0.16 in double precision.
_Vector = c_double * 4
_Matrix3 = c_double * 12


class _Surface(ctypes.Structure):
    _fields_ = [
        ("mode", c_int),
        *(
            (name, c_double)
            for name in (
                *("mu", "mu2", "rho", "rho2", "rhoN", "bounce", "bounce_vel", "soft_erp"),
                *("soft_cfm", "motion1", "motion2", "motionN", "slip1", "slip2"),
            )
        ),
    ]


class _ContactGeom(ctypes.Structure):
    _fields_ = [
        ("pos", _Vector),
        ("normal", _Vector),
        ("depth", c_double),
        ("g1", c_void_p),
        ("g2", c_void_p),
        ("side1", c_int),
        ("side2", c_int),
    ]


class _Contact(ctypes.Structure):
    _fields_ = [("surface", _Surface), ("geom", _ContactGeom), ("fdir1", _Vector)]


class _Mass(ctypes.Structure):
    _fields_ = [("mass", c_double), ("c", _Vector), ("I", _Matrix3)]


# Result and argument types of the functions in use.
_SIGNATURES: dict[str, tuple[Any, list[Any]]] = {
    "dInitODE2": (c_int, [c_uint]),
    "dCheckConfiguration": (c_int, [c_char_p]),
    "dGeomTriMeshDataCreate": (c_void_p, []),
    "dGeomTriMeshDataBuildDouble": (
        None,
        [c_void_p, c_void_p, c_int, c_int, c_void_p, c_int, c_int],
    ),
    "dGeomTriMeshDataPreprocess": (c_int, [c_void_p]),
    "dCreateTriMesh": (c_void_p, [c_void_p, c_void_p, c_void_p, c_void_p, c_void_p]),
    "dCreatePlane": (c_void_p, [c_void_p, c_double, c_double, c_double, c_double]),
    "dCreateBox": (c_void_p, [c_void_p, c_double, c_double, c_double]),
    "dGeomSetPosition": (None, [c_void_p, c_double, c_double, c_double]),
    "dGeomSetRotation": (None, [c_void_p, _Matrix3]),
    "dGeomSetBody": (None, [c_void_p, c_void_p]),
    "dCollide": (c_int, [c_void_p, c_void_p, c_int, c_void_p, c_int]),
    "dWorldCreate": (c_void_p, []),
    "dWorldSetGravity": (None, [c_void_p, c_double, c_double, c_double]),
    "dWorldSetContactSurfaceLayer": (None, [c_void_p, c_double]),
    "dWorldSetContactMaxCorrectingVel": (None, [c_void_p, c_double]),
    "dWorldSetCFM": (None, [c_void_p, c_double]),
    "dWorldSetQuickStepNumIterations": (None, [c_void_p, c_int]),
    "dWorldQuickStep": (c_int, [c_void_p, c_double]),
    "dBodyCreate": (c_void_p, [c_void_p]),
    "dBodySetMass": (None, [c_void_p, POINTER(_Mass)]),
    "dBodySetPosition": (None, [c_void_p, c_double, c_double, c_double]),
    "dBodySetRotation": (None, [c_void_p, _Matrix3]),
    "dBodyGetPosition": (POINTER(c_double), [c_void_p]),
    "dBodyGetRotation": (POINTER(c_double), [c_void_p]),
    "dJointGroupCreate": (c_void_p, [c_int]),
    "dJointGroupEmpty": (None, [c_void_p]),
    "dJointCreateContact": (c_void_p, [c_void_p, c_void_p, POINTER(_Contact)]),
    "dJointAttach": (None, [c_void_p, c_void_p, c_void_p]),
    "dMassSetParameters": (None, [POINTER(_Mass), *[c_double] * 10]),
}


def set_up(job: Job, variant: str) -> Ode:
    """Return a contender that calls ``dCollide``; ``variant`` is not used."""
    return Ode(job)


def load_ode() -> Any:
    """Return the C library, with types.

    Raises:
        MissingExtraError: It is not installed, or not in double precision.
    """
    try:
        ode = ctypes.CDLL(LIBRARY)
    except OSError as error:
        raise MissingExtraError(f"apt install libode8 ({error})") from error
    for name, (result, arguments) in _SIGNATURES.items():
        function = getattr(ode, name)
        function.restype, function.argtypes = result, arguments
    if not ode.dCheckConfiguration(b"ODE_double_precision"):
        raise MissingExtraError(f"{LIBRARY} is in single precision; Debian's libode8 is in double")
    return ode


class Ode:
    """The body as a triangle mesh of ODE's collider OPCODE."""

    timed = "dCollide called from Python, all contacts"

    def __init__(self, job: Job) -> None:
        self._ode = ode = load_ode()
        ode.dInitODE2(0)
        self.version = LIBRARY
        self.settings: dict[str, object] = {
            "collider": "OPCODE trimesh",
            "drops": f"QuickStep, {ITERATIONS} iterations, {MOST_DROP_CONTACTS} contacts at most, "
            f"surface layer {1e3 * SURFACE_LAYER:g} mm, CFM {CFM:g}, correcting at "
            f"{CORRECTING_SPEED:g} m/s at most",
        }
        self._job = job
        # ODE keeps pointers to these arrays.
        self._vertices = np.zeros((len(job.mesh.vertices), 4))
        self._vertices[:, :3] = job.mesh.vertices
        self._indices = np.ascontiguousarray(job.mesh.faces, np.uint32)
        self._mesh = ode.dGeomTriMeshDataCreate()
        ode.dGeomTriMeshDataBuildDouble(
            self._mesh,
            self._vertices.ctypes.data,
            self._vertices.strides[0],
            len(self._vertices),
            self._indices.ctypes.data,
            self._indices.size,
            self._indices.strides[0],
        )
        ode.dGeomTriMeshDataPreprocess(self._mesh)

    def meet(self, case: Case) -> _Query:
        """Return the pair of a case."""
        other = self._make_other(case.other)
        if case.other != "plane":  # ODE's planes cannot be placed
            _place(self._ode, "dGeom", other, case.other_pose)
        return _Query(self._ode, self._make_body(), other)

    def drop(self, other: Other, rate: float) -> _Fall:
        """Return the body above the plane or the box."""
        ground = self._make_other(other)
        if other == "box":
            below = np.eye(4)
            below[2, 3] = -self._job.box_half_extents[2]
            _place(self._ode, "dGeom", ground, below)
        return _Fall(self._ode, self._make_body(), ground, self._job, 1.0 / rate)

    def _make_body(self) -> int:
        return self._ode.dCreateTriMesh(None, self._mesh, None, None, None)

    def _make_other(self, other: Other) -> int:
        match other:
            case "plane":
                return self._ode.dCreatePlane(None, 0.0, 0.0, 1.0, 0.0)
            case "box":
                sides = (2.0 * half for half in self._job.box_half_extents)
                return self._ode.dCreateBox(None, *sides)
            case "body":
                return self._make_body()


class _Query:
    def __init__(self, ode: Any, body: int, other: int) -> None:
        self._ode = ode
        self._body = body
        self._other = other
        self._found = (_ContactGeom * MOST_CONTACTS)()
        self._count = 0

    def ask(self, pose: NDArray[np.float64]) -> float:
        _place(self._ode, "dGeom", self._body, pose)

        def find() -> None:
            self._count = self._ode.dCollide(
                self._body,
                self._other,
                MOST_CONTACTS,
                ctypes.addressof(self._found),
                ctypes.sizeof(_ContactGeom),
            )

        return seconds_of(find)

    def answer(self) -> tuple[int, float | None]:
        depths = [self._found[i].depth for i in range(self._count)]
        return self._count, max(depths, default=0.0)


class _Fall:
    def __init__(self, ode: Any, geom: int, ground: int, job: Job, time_step: float) -> None:
        self._ode = ode
        self._geom = geom
        self._ground = ground
        self._time_step = time_step
        self._world = ode.dWorldCreate()
        ode.dWorldSetGravity(self._world, 0.0, 0.0, -9.81)
        ode.dWorldSetContactSurfaceLayer(self._world, SURFACE_LAYER)
        ode.dWorldSetContactMaxCorrectingVel(self._world, CORRECTING_SPEED)
        ode.dWorldSetCFM(self._world, CFM)
        ode.dWorldSetQuickStepNumIterations(self._world, ITERATIONS)
        self._joints = ode.dJointGroupCreate(0)
        self._body = ode.dBodyCreate(self._world)
        mass = _Mass()
        matter = job.mass_properties
        inertia = matter.inertia
        ode.dMassSetParameters(
            ctypes.byref(mass),
            matter.mass,
            *matter.center_of_mass,
            *np.diag(inertia),
            inertia[0, 1],
            inertia[0, 2],
            inertia[1, 2],
        )
        ode.dBodySetMass(self._body, ctypes.byref(mass))
        ode.dGeomSetBody(geom, self._body)
        _place(ode, "dBody", self._body, job.drop_pose)
        self._contacts = (_Contact * MOST_DROP_CONTACTS)()

    def step(self) -> NDArray[np.float64]:
        ode = self._ode
        count = ode.dCollide(
            self._geom,
            self._ground,
            MOST_DROP_CONTACTS,
            ctypes.addressof(self._contacts) + _Contact.geom.offset,
            ctypes.sizeof(_Contact),
        )
        for contact in self._contacts[:count]:
            contact.surface.mode = 0
            contact.surface.mu = FRICTION
            joint = ode.dJointCreateContact(self._world, self._joints, ctypes.byref(contact))
            ode.dJointAttach(joint, self._body, None)
        ode.dWorldQuickStep(self._world, self._time_step)
        ode.dJointGroupEmpty(self._joints)
        pose = np.eye(4)
        pose[:3, 3] = ode.dBodyGetPosition(self._body)[:3]
        pose[:3, :3] = np.reshape(ode.dBodyGetRotation(self._body)[:12], (3, 4))[:, :3]
        return pose


def _place(ode: Any, kind: str, thing: int, pose: NDArray[np.float64]) -> None:
    """Set the pose of a geom or a body."""
    rotation = np.zeros((3, 4))
    rotation[:, :3] = pose[:3, :3]
    getattr(ode, f"{kind}SetPosition")(thing, *pose[:3, 3])
    getattr(ode, f"{kind}SetRotation")(thing, _Matrix3(*rotation.ravel()))
