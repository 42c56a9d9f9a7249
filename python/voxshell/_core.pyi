"""
The compiled core. Use it through the package voxshell, which checks arguments.
"""

from collections.abc import Callable, Sequence
import enum
from typing import Annotated, Final

import numpy
import numpy.typing
from numpy.typing import NDArray


version: str = '0.1.0'

class Field:
    """A signed distance field of any kind."""

    def sample(self, points: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float64], dict(shape=(None,))]:
        """Signed distances, metres, (n,)."""

    def gradient(self, points: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3))]:
        """Gradients of the distance, (n, 3)."""

class GridField:
    """What only a sampled field has."""

    @property
    def shape(self) -> list[int]: ...

    @property
    def voxel_size(self) -> float: ...

    @property
    def origin(self) -> list[float]: ...

    @property
    def nbytes(self) -> int: ...

    @property
    def interpolation_error(self) -> float: ...

    @property
    def surface_error(self) -> float: ...

    @property
    def sign_method(self) -> str: ...

    @property
    def sign_confidence(self) -> float: ...

    @property
    def was_turned(self) -> bool: ...

    @property
    def faults(self) -> list[int]:
        """
        Open, non-manifold and wrongly oriented edges, nodes in overlaps, hidden triangles.
        """

    @property
    def first_fault(self) -> list[float]: ...

def plane_field(normal: Sequence[float], offset: float) -> Field: ...

def box_field(half_extents: Sequence[float]) -> Field: ...

def sphere_field(radius: float) -> Field: ...

def capsule_field(radius: float, length: float) -> Field: ...

def cylinder_field(radius: float, length: float) -> Field: ...

def cone_field(radius: float, height: float) -> Field: ...

def convex_field(vertices: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.uint32], dict(shape=(None, 3), order='C', device='cpu', writable=False)]) -> tuple[Field, int]:
    """The field and how many faces it has."""

class PointShell:
    """Points on a surface, in the order of their tree."""

    def __len__(self) -> int: ...

    @property
    def points(self) -> Annotated[NDArray[numpy.float32], dict(shape=(None, 3), writable=False)]: ...

    @property
    def normals(self) -> Annotated[NDArray[numpy.float32], dict(shape=(None, 3), writable=False)]: ...

    @property
    def areas(self) -> Annotated[NDArray[numpy.float32], dict(shape=(None,), writable=False)]: ...

    @property
    def edges(self) -> Annotated[NDArray[numpy.float32], dict(shape=(None, 2, 3), writable=False)]: ...

    @property
    def spacing(self) -> float: ...

    @property
    def tree(self) -> PointSphereTree: ...

class PointSphereTree:
    """Nested clusters of a shell's points."""

    branching: Final[int] = ...
    """(arg: object, /) -> int"""

    deepest_level: Final[int] = ...
    """(arg: object, /) -> int"""

    @property
    def levels(self) -> int: ...

    def spheres(self, level: int) -> Annotated[NDArray[numpy.float32], dict(shape=(None, 4), writable=False)]:
        """Centres and radii, (m, 4); level 1 to levels."""

    def segments(self, level: int) -> Annotated[NDArray[numpy.int64], dict(shape=(None,))]:
        """The cluster of each point, (n,); level 1 to deepest_level."""

class Model:
    """Field, shell and mass properties of a mesh."""

    @staticmethod
    def build(vertices: numpy.typing.NDArray[numpy.float64], faces: numpy.typing.NDArray[numpy.uint32], *, tolerance: float, voxel_size: float, resolution: int, point_spacing: float, target_points: int, padding: float, sign: str, open: str, sheet_thickness: float, threads: int, progress: Callable[[str, float], object] | None) -> Model:
        """0 (padding: below 0) leaves a setting to the core."""

    def save(self, path: bytes) -> None: ...

    @staticmethod
    def load(path: bytes) -> Model: ...

    def to_bytes(self) -> bytes:
        """As `save` writes them."""

    @staticmethod
    def from_bytes(content: bytes) -> Model: ...

    @property
    def vertices(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def faces(self) -> Annotated[NDArray[numpy.uint32], dict(shape=(None, 3), writable=False)]: ...

    @property
    def bounds(self) -> list[list[float]]: ...

    @property
    def field(self) -> Field: ...

    @property
    def grid(self) -> GridField: ...

    @property
    def shell(self) -> PointShell: ...

    @property
    def accuracy(self) -> tuple[int, list[float], list[float], list[float], float, bool, float]:
        """
        Places, and median, 99 % and worst of distance, normal and coverage; gap, is_sharp, curvature.
        """

    @property
    def openings(self) -> tuple[int, float, int, float, list[float], float]:
        """
        Loops, fraction, mouths, largest diameter, first location, and the sheet's thickness or 0.
        """

    @property
    def tolerance(self) -> float:
        """Metres; 0 if the model is uniform."""

    @property
    def thickness(self) -> float:
        """Where the body is thinnest, metres."""

    @property
    def solid_mass_properties(self) -> tuple[list[float], list[list[float]]]:
        """Centre of mass and inertia tensor about it, at 1 kg."""

    @property
    def surface_mass_properties(self) -> tuple[list[float], list[list[float]]]:
        """Centre of mass and inertia tensor about it, at 1 kg."""

class Shells(enum.Enum):
    AUTOMATIC = 0

    FEWEST = 1

    A = 2

    B = 3

    BOTH = 4

class Role(enum.Enum):
    A = 0

    B = 1

    BOTH = 2

class ContactSet:
    """Contacts of a pair, world frame."""

    @property
    def points_a(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def points_b(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def normals(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def depths(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def ids(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), writable=False)]: ...

    @property
    def segments(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), writable=False)]: ...

    @property
    def shells(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,), writable=False)]:
        """0: a's point, 1: b's."""

    @property
    def inner(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,), writable=False)]: ...

    def __len__(self) -> int: ...

    @property
    def role(self) -> Role: ...

    def find_ambiguous(self) -> Annotated[NDArray[numpy.bool_], dict(shape=(None,))]:
        """Whether each contact's depth and normal are arbitrary."""

    @property
    def exact(self) -> bool: ...

    @property
    def depth_bound(self) -> float: ...

    def manifold(self, max_points: int) -> ContactSet:
        """At most 4 of them, in the order chosen."""

    def deepest_per_segment(self) -> ContactSet:
        """A's, then b's, each ascending by id."""

class QueryScratch:
    """Threads that share one take turns."""

    def __init__(self) -> None: ...

def contacts(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, margin: float, level: int, max_points: int | None, budget: int | None, scratch: QueryScratch | None) -> ContactSet:
    """By the point-sphere tree."""

def contacts_flat(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, margin: float, level: int, max_points: int | None, budget: int | None, scratch: QueryScratch | None) -> ContactSet:
    """By the flat loop."""

def manifold(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, margin: float, max_points: int, scratch: QueryScratch | None) -> ContactSet:
    """By branch and bound; of both shells, from the list of all."""

def deepest_per_segment(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, margin: float, level: int, scratch: QueryScratch | None) -> ContactSet:
    """By branch and bound, of each shell."""

def role(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, shells: Shells) -> tuple[Role, float, float, float, float, float, float, float]:
    """
    Role; metres: what it, a, b and both may miss, the smaller body's thickness and shortest side, and the thinner one's thickness.
    """

def pair_bounds(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, role: Role) -> tuple[float, float]:
    """Overlap and clearance, metres."""

def collide(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, margin: float) -> bool: ...

def distance(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, max_distance: float, scratch: QueryScratch | None) -> tuple[float, list[float], list[float], list[float], bool] | None:
    """
    Distance, point on a, point on b, normal, whether a's shell is nearest; or None.
    """

def sweep(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, a_end: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_end: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, margin: float, tolerance: float | None, scratch: QueryScratch | None) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.int64], NDArray[numpy.float64], NDArray[numpy.float64]]:
    """As sweep_batch() of one. Without an end, a body stays."""

def sweep_batch(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, count: int, a_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, a_ends: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, b_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, b_ends: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, shells: Shells, margin: float, tolerance: float | None, threads: int, progress: object | None) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.int64], NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Fractions, distances, points on a and b, normals, shells (0: a's, 1: b's, -1: none), poses of a and b.
    """

def interpolate(start: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, end: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, at: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> NDArray[numpy.float64]:
    """(k, 4, 4)."""

def wrench(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, stiffness: float, scratch: QueryScratch | None) -> tuple[list[float], list[float]]:
    """
    Force and torque on a about its origin, world frame; of both shells, the mean.
    """

class ContactBatch:
    """Contacts of many poses of a pair."""

    @property
    def points_a(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def points_b(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def normals(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def depths(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def ids(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), writable=False)]: ...

    @property
    def segments(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), writable=False)]: ...

    @property
    def shells(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,), writable=False)]:
        """0: a's point, 1: b's."""

    @property
    def inner(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,), writable=False)]: ...

    def __len__(self) -> int: ...

    @property
    def offsets(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), writable=False)]: ...

    def at(self, arg: int, /) -> ContactSet: ...

def contacts_batch(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, count: int, a_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, b_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, shells: Shells, margin: float, level: int, max_points: int | None, threads: int, progress: object | None) -> ContactBatch:
    """(count, 4, 4) poses; one that is to stand for all is (1, 4, 4)."""

def collide_batch(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, count: int, a_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, b_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, shells: Shells, margin: float, threads: int, progress: object | None) -> Annotated[NDArray[numpy.bool_], dict(shape=(None,))]:
    """(k,) bool."""
